//! A human's skeleton: which of the joints between a surface's parts are ankles, knees, hips, shoulders, elbows, neck, waist.
//!
//! The ends of the body say what is what: the highest one on average is the head, the lowest two are feet, two of the others hands.
//! On the way from each of them to the trunk the joints are taken that lie where a human's do (segment lengths as shares of
//! the height, Drillis and Contini 1966) and gape least.

use glam::{Vec3, Vec3Swizzles};

use super::clusters::Clusters;
use super::joints::{Joint, way};
use super::keys::Keys;
use super::skeleton::{Segment, Skeleton};

/// Shares of the height: from the toe's tip to the ankle, shin, thigh, upper arm, from the elbow to the fingertips, from the
/// neck to the top of the head, from the hips to the waist.
const TOE_TO_ANKLE: f32 = 0.11;
const SHIN: f32 = 0.243;
const THIGH: f32 = 0.246;
const UPPER_ARM: f32 = 0.168;
const ELBOW_TO_TIP: f32 = 0.245;
const HEAD: f32 = 0.17;
const WAIST: f32 = 0.12;
/// A share that is off by so much is as bad as a gap of [`GAP`] of the height.
const SHARE: f32 = 0.05;
const GAP: f32 = 0.01;
/// Sums of badness beyond which it is no human: for each joint about three times what is usual.
const WORST_LEG: f32 = 14.0;
const WORST_ARM: f32 = 11.0;
/// The two sides of a human reach equally far within this factor.
const SIDES: f32 = 1.3;

/// The human skeleton over `clusters`, whose tree is `tree`; `tips` are the ends of the body with how far from its middle they
/// are. `None` where it is no human's.
#[must_use]
pub fn human(keys: &Keys, clusters: &Clusters, tree: &[Joint], tips: &[(u32, f32)]) -> Option<Skeleton> {
    let rest = &keys.poses[0];
    let low = rest.iter().copied().reduce(Vec3::min)?;
    let high = rest.iter().copied().reduce(Vec3::max)?;
    let height = high.y - low.y;
    let mut ends: Vec<u32> = tips.iter().map(|(tip, _)| *tip).collect();
    let mean = |v: u32| keys.poses.iter().map(|pose| pose[v as usize].y).sum::<f32>() / keys.poses.len() as f32;
    ends.sort_by(|&a, &b| mean(a).total_cmp(&mean(b)));
    let ([first, second, others @ ..], place) = (ends.as_slice(), |v: u32| rest[v as usize]) else { return None };
    let (head, others) = others.split_last()?;
    let part = |v: u32| clusters.of_vertex[v as usize];
    let pelvis = fork(tree, part(*first), part(*second), part(*head))?;
    let [first, second] = [first, second].map(|&foot| leg(&way(tree, part(foot), pelvis), place(foot), height));
    let (first, second) = (first?, second?);
    // Hair and the hem of a skirt are ends, too: hands are the two whose ways are most like arms.
    let mut hands: Option<(f32, usize, [Limb; 2])> = None;
    for (index, &a) in others.iter().enumerate() {
        for &b in &others[..index] {
            let Some(chest) = fork(tree, part(a), part(b), part(*head)) else { continue };
            let arms = [a, b].map(|hand| arm(&way(tree, part(hand), chest), place(hand), height));
            let [Some((one, left)), Some((other, right))] = arms else { continue };
            let [low, high] = [&left, &right].map(|arm| arm.joints[0].place.y);
            let badness = one + other + off(low / height, high / height);
            if hands.as_ref().is_none_or(|(worst, ..)| badness < *worst) {
                hands = Some((badness, chest, [left, right]));
            }
        }
    }
    let (_, chest, [left, right]) = hands?;
    let long = |limb: &Limb| limb.joints.windows(2).map(|j| j[0].place.distance(j[1].place)).sum::<f32>();
    let even = |a: &Limb, b: &Limb| (long(a) / long(b)).max(long(b) / long(a)) < SIDES;
    if !even(&first, &second) || !even(&left, &right) {
        return None;
    }
    let sides = sides(clusters, rest, [&first, &second], [&left, &right])?;
    let mut builder = Builder::new(pelvis, middle(&first, &second));
    let trunk = way(tree, pelvis, chest);
    let chest_bone = builder.trunk(&trunk, height);
    builder.head(&way(tree, part(*head), chest), chest_bone, place(*head), height);
    for (side, limb) in sides.arms {
        builder.limb(&["upper_arm", "forearm"], side, limb, chest_bone);
    }
    for (side, limb) in sides.legs {
        builder.limb(&["thigh", "shin", "foot"], side, limb, 0);
    }
    Some(Skeleton::new(builder.segments, tree, clusters.motions.len(), true))
}

/// The part at which the ways between three parts meet.
fn fork(tree: &[Joint], a: usize, b: usize, c: usize) -> Option<usize> {
    let between: Vec<usize> = way(tree, a, b).iter().map(|joint| joint.parts[1]).collect();
    way(tree, a, c).iter().rev().map(|joint| joint.parts[1]).find(|part| between.contains(part))
}

/// A limb: its joints from the trunk outwards, and the parts of each of its bones.
struct Limb {
    joints: Vec<Joint>,
    cores: Vec<Vec<usize>>,
    /// Parts of the way that belong to the trunk.
    rest: Vec<usize>,
}

fn middle(a: &Limb, b: &Limb) -> Vec3 {
    0.5 * (a.joints[0].place + b.joints[0].place)
}

/// How bad it is that a length is `length` and should be `wanted`, both as shares.
fn off(length: f32, wanted: f32) -> f32 {
    (length - wanted).abs() / SHARE
}

/// The way from the end of a limb inwards, cut at its joints `cuts`, in the order of the way.
fn cut(way: &[Joint], cuts: &[usize]) -> Limb {
    let nodes: Vec<usize> =
        way.iter().take(1).map(|joint| joint.parts[0]).chain(way.iter().map(|j| j.parts[1])).collect();
    let mut cores = Vec::new();
    let mut from = 0;
    for &at in cuts {
        cores.push(nodes[from..=at].to_vec());
        from = at + 1;
    }
    let rest = nodes[from..].to_vec();
    cores.reverse();
    Limb { joints: cuts.iter().rev().map(|&at| way[at]).collect(), cores, rest }
}

fn leg(way: &[Joint], toe: Vec3, height: f32) -> Option<Limb> {
    let mut best: Option<(f32, [usize; 3])> = None;
    for ankle in 0..way.len() {
        for knee in ankle + 1..way.len() {
            for hip in knee + 1..way.len() {
                let [a, k, h] = [ankle, knee, hip].map(|at| way[at].place);
                let gaps: f32 = [ankle, knee, hip].map(|at| way[at].gap / height / GAP).iter().sum();
                let lengths = off(toe.distance(a) / height, TOE_TO_ANKLE)
                    + off(a.distance(k) / height, SHIN)
                    + off(k.distance(h) / height, THIGH);
                if best.is_none_or(|(badness, _)| gaps + lengths < badness) {
                    best = Some((gaps + lengths, [ankle, knee, hip]));
                }
            }
        }
    }
    best.filter(|(badness, _)| *badness < WORST_LEG).map(|(_, cuts)| cut(way, &cuts))
}

/// How bad the best arm on a way is, and the arm.
fn arm(way: &[Joint], tip: Vec3, height: f32) -> Option<(f32, Limb)> {
    let mut best: Option<(f32, [usize; 2])> = None;
    for elbow in 0..way.len() {
        for shoulder in elbow + 1..way.len() {
            let [e, s] = [elbow, shoulder].map(|at| way[at].place);
            let gaps: f32 = [elbow, shoulder].map(|at| way[at].gap / height / GAP).iter().sum();
            // A bent wrist shortens the way to the tip; the elbow's own place counts less.
            let lengths = 0.6 * off(tip.distance(e) / height, ELBOW_TO_TIP) + off(e.distance(s) / height, UPPER_ARM);
            if best.is_none_or(|(badness, _)| gaps + lengths < badness) {
                best = Some((gaps + lengths, [elbow, shoulder]));
            }
        }
    }
    best.filter(|(badness, _)| *badness < WORST_ARM).map(|(badness, cuts)| (badness, cut(way, &cuts)))
}

/// Limbs by side.
struct Sides<'a> {
    arms: [(&'static str, &'a Limb); 2],
    legs: [(&'static str, &'a Limb); 2],
}

/// Which side is left: feet point forwards of their ankles.
fn sides<'a>(clusters: &Clusters, rest: &[Vec3], legs: [&'a Limb; 2], arms: [&'a Limb; 2]) -> Option<Sides<'a>> {
    let members = clusters.members();
    let ahead = |limb: &Limb| {
        let foot: Vec<u32> = limb.cores[2].iter().flat_map(|&part| members[part].iter().copied()).collect();
        let centre = foot.iter().map(|&v| rest[v as usize]).sum::<Vec3>() / foot.len().max(1) as f32;
        (centre - limb.joints[2].place).xz()
    };
    let forward = ahead(legs[0]) + ahead(legs[1]);
    if forward.length() < 1e-6 {
        return None;
    }
    // Up times forward.
    let left = Vec3::new(forward.y, 0.0, -forward.x);
    let sorted = |[a, b]: [&'a Limb; 2]| {
        let a_is_left = a.joints[0].place.dot(left) > b.joints[0].place.dot(left);
        if a_is_left { [("l", a), ("r", b)] } else { [("l", b), ("r", a)] }
    };
    Some(Sides { arms: sorted(arms), legs: sorted(legs) })
}

struct Builder {
    segments: Vec<Segment>,
    limbs: u32,
}

impl Builder {
    fn new(pelvis: usize, joint: Vec3) -> Self {
        let pelvis = Segment { name: "pelvis".into(), parent: 0, joint, gap: 0.0, limb: 0, core: vec![pelvis] };
        Self { segments: vec![pelvis], limbs: 0 }
    }

    /// The chest, where the trunk has a joint; the bone that arms and head hang on.
    fn trunk(&mut self, way: &[Joint], height: f32) -> usize {
        let hips = self.segments[0].joint;
        let badness = |at: usize| way[at].gap / height / GAP + off(hips.distance(way[at].place) / height, WAIST);
        let Some(waist) = (0..way.len()).min_by(|&a, &b| badness(a).total_cmp(&badness(b))) else { return 0 };
        let Limb { mut cores, joints, rest } = cut(way, &[waist]);
        self.segments[0].core.append(&mut cores[0]);
        self.segments[0].core.dedup();
        let (joint, gap) = (joints[0].place, joints[0].gap);
        self.segments.push(Segment { name: "chest".into(), parent: 0, joint, gap, limb: 0, core: rest });
        1
    }

    fn head(&mut self, way: &[Joint], chest: usize, top: Vec3, height: f32) {
        let badness = |at: usize| way[at].gap / height / GAP + off(top.distance(way[at].place) / height, HEAD);
        let Some(neck) = (0..way.len()).min_by(|&a, &b| badness(a).total_cmp(&badness(b))) else { return };
        let Limb { mut cores, joints, rest } = cut(way, &[neck]);
        self.keep(chest, &rest);
        let (joint, gap, core) = (joints[0].place, joints[0].gap, cores.remove(0));
        self.segments.push(Segment { name: "head".into(), parent: chest, joint, gap, limb: 0, core });
    }

    fn limb(&mut self, names: &[&str], side: &str, limb: &Limb, on: usize) {
        self.limbs += 1;
        self.keep(on, &limb.rest);
        let mut parent = on;
        for ((name, joint), core) in names.iter().zip(&limb.joints).zip(&limb.cores) {
            let (name, core) = (format!("{name}_{side}"), core.clone());
            self.segments.push(Segment { name, parent, joint: joint.place, gap: joint.gap, limb: self.limbs, core });
            parent = self.segments.len() - 1;
        }
    }

    /// Parts of a limb's way that lie within the trunk.
    fn keep(&mut self, on: usize, parts: &[usize]) {
        let free: Vec<usize> =
            parts.iter().copied().filter(|part| self.segments.iter().all(|other| !other.core.contains(part))).collect();
        self.segments[on].core.extend(free);
    }
}
