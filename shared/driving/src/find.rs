//! Which joints of a skeleton are which, from its shape and how it stands; names help where that leaves a choice.

use std::collections::BTreeMap;

use glam::Vec3;

use crate::clip::Clip;
use crate::hints;
use crate::role::Role;
use crate::tree::Tree;

/// Shares of the height of thigh, shin, upper arm and forearm.
const THIGH: f32 = 0.246;
const SHIN: f32 = 0.243;
const UPPER_ARM: f32 = 0.172;
const FOREARM: f32 = 0.15;
/// What a fitting name is worth beside shares of the height.
const HINT: f32 = 0.05;
/// How bad it is to pass by a joint that is called an elbow.
const CALLED: f32 = 1.0;
/// Ends that are higher than the feet by more than this share of the size, or as much lower, are no feet.
const LOW: f32 = 0.12;
/// Ends that are looked at for feet, and for heads and hands.
const MOST_ENDS: usize = 48;
/// Ways with more joints are no limbs.
const LONGEST_WAY: usize = 40;

pub type Joints = BTreeMap<Role, usize>;

/// The joints that are found in `clip`; none where it has no two legs.
#[must_use]
pub fn found(clip: &Clip) -> Joints {
    let tree = Tree::new(clip);
    let mut joints = Joints::new();
    let Some((pelvis, feet)) = feet(&tree) else { return joints };
    let legs = feet.map(|foot| leg(&tree, pelvis, foot));
    let [Some(first), Some(second)] = legs else { return joints };
    joints.insert(Role::Pelvis, pelvis);
    let left_is_first = left_is_first(&tree, &first, &second);
    let sided = if left_is_first { [&first, &second] } else { [&second, &first] };
    for (leg, roles) in sided.iter().zip(Role::LEGS) {
        joints.extend(roles.into_iter().zip(leg.iter().copied()));
    }
    let across = (sided[0][0], sided[1][0]);
    upper_body(&mut joints, &tree, pelvis, feet, across);
    joints
}

/// Adds chest, arms and head to a pelvis and legs that were named.
pub fn above(clip: &Clip, joints: &mut Joints) {
    let of = |role: Role| joints.get(&role).copied();
    let foot = |[.., ankle, ball]: [Role; 4]| of(ball).or(of(ankle));
    let [left, right] = Role::LEGS.map(foot);
    let (Some(pelvis), Some(left), Some(right)) = (of(Role::Pelvis), left, right) else { return };
    let (Some(hip_l), Some(hip_r)) = (of(Role::HipL), of(Role::HipR)) else { return };
    upper_body(joints, &Tree::new(clip), pelvis, [left, right], (hip_l, hip_r));
}

/// An end of a foreleg and one of a hind leg of a body that stands on four: a second pair of limbs ends as low as the feet, on average
/// and where it rests, and what joins both pairs lies. Who only crawls stands upright where it rests.
#[must_use]
pub fn four_legs(clip: &Clip) -> Option<(usize, usize)> {
    let tree = Tree::new(clip);
    let (pelvis, feet) = feet(&tree)?;
    let own: Vec<usize> =
        feet.iter().flat_map(|&foot| tree.way(pelvis, foot)).filter(|&joint| joint != pelvis).collect();
    let low = |at: &[Vec3], end: usize| {
        let lowest = feet.iter().map(|&foot| at[foot].y).fold(f32::INFINITY, f32::min);
        (at[end].y - lowest).abs() < LOW * tree.size
    };
    let stands = |end: usize| {
        let count = tree.frames.iter().filter(|&&frame| low(clip.positions(frame), end)).count();
        2 * count > tree.frames.len() && clip.rest().is_none_or(|rest| low(&rest.positions, end))
    };
    let ends = tree.ends.iter().copied().filter(|end| !own.contains(end) && !hints::is_helper(tree.name(*end)));
    let ends: Vec<usize> = ends.filter(|&end| stands(end)).take(MOST_ENDS).collect();
    let lies = |at: &[Vec3], meet: usize| {
        let trunk = at[meet] - at[pelvis];
        Vec3::new(trunk.x, 0.0, trunk.z).length() > trunk.y.abs()
    };
    for (k, &a) in ends.iter().enumerate() {
        for &b in &ends[..k] {
            let way = tree.way(a, b);
            let Some(&meet) = way.iter().min() else { continue };
            let is_leg = |end: usize| {
                let way = tree.way(meet, end);
                way.len() >= 3 && tree.length(&way) > 0.3 * tree.size && !way.iter().any(|joint| own.contains(joint))
            };
            if is_leg(a) && is_leg(b) && lies(clip.positions(tree.frames[0]), meet) {
                return Some((b, feet[0]));
            }
        }
    }
    None
}

/// Chest, arms and head.
fn upper_body(joints: &mut Joints, tree: &Tree, pelvis: usize, feet: [usize; 2], across: (usize, usize)) {
    let Upper { head, arms } = upper(tree, pelvis, feet);
    let mut top = pelvis;
    if let Some((chest, hands)) = arms {
        let height = height(tree, joints);
        let arms = divided_alike(tree, chest, hands, height);
        if let [Some(first), Some(second)] = arms {
            joints.insert(Role::Chest, chest);
            top = chest;
            let sided = if is_left(tree, first[0], second[0], across) { [first, second] } else { [second, first] };
            for (arm, roles) in sided.iter().zip(Role::ARMS) {
                joints.extend(roles.into_iter().zip(arm.iter().copied()));
            }
        }
    }
    if let Some(head) = head {
        let way = tree.way(top, head);
        let named = way[1..].iter().copied().find(|&joint| hints::fit(tree.name(joint), Role::Head) > 0.0);
        let last = way.iter().rev().nth(1).copied().filter(|&joint| joint != top);
        if let Some(joint) = named.or(last).or(Some(head)).filter(|&joint| joint != top) {
            joints.insert(Role::Head, joint);
        }
    }
}

/// The two feet's ends, and where the legs meet.
fn feet(tree: &Tree) -> Option<(usize, [usize; 2])> {
    let mut ends = tree.ends.clone();
    ends.sort_by(|&a, &b| tree.heights[a].total_cmp(&tree.heights[b]).then(a.cmp(&b)));
    ends.truncate(MOST_ENDS);
    let lowest = ends.first().map(|&end| tree.heights[end])?;
    let mut best: Option<(f32, usize, [usize; 2])> = None;
    for (k, &a) in ends.iter().enumerate() {
        for &b in &ends[..k] {
            let way = tree.way(a, b);
            let Some(&meet) = way.iter().min() else { continue };
            let lengths = [a, b].map(|end| tree.length(&tree.way(meet, end)) / tree.size);
            let is_other = |end: usize| tree.way(meet, end)[1..].iter().any(|&joint| !is_leg(tree.name(joint)));
            if is_other(a) || is_other(b) {
                continue;
            }
            if lengths.iter().any(|&length| length < 0.3) || [a, b].iter().any(|&e| tree.way(meet, e).len() < 4) {
                continue;
            }
            let heights = (tree.heights[a] + tree.heights[b] - 2.0 * lowest) / tree.size;
            let badness = heights + 2.0 * (lengths[0] - lengths[1]).abs() - 0.1 * (lengths[0] + lengths[1]);
            if best.is_none_or(|(least, ..)| badness < least) {
                best = Some((badness, meet, [b, a]));
            }
        }
    }
    best.map(|(_, meet, feet)| (meet, feet))
}

/// Whether a name may be of a leg.
fn is_leg(name: &str) -> bool {
    !hints::is_helper(name) && !hints::is_arm(name)
}

/// What is above the legs.
struct Upper {
    head: Option<usize>,
    /// Where the arms meet, and their ends.
    arms: Option<(usize, [usize; 2])>,
}

fn upper(tree: &Tree, pelvis: usize, feet: [usize; 2]) -> Upper {
    let legs: Vec<usize> = feet.iter().filter_map(|&foot| tree.way(pelvis, foot).get(1).copied()).collect();
    let is_free = |end: usize| {
        let way = tree.way(pelvis, end);
        let is_body = |joint: &usize| !legs.contains(joint) && !hints::is_helper(tree.name(*joint));
        way.len() > 1 && way[1..].iter().all(is_body)
    };
    let mut ends: Vec<usize> = tree.ends.iter().copied().filter(|&end| is_free(end)).collect();
    ends.sort_by(|&a, &b| tree.heights[b].total_cmp(&tree.heights[a]).then(a.cmp(&b)));
    ends.truncate(MOST_ENDS);
    let mut best: Option<(f32, usize, usize, [usize; 2])> = None;
    for &head in ends.iter().take(6) {
        for (k, &a) in ends.iter().enumerate() {
            for &b in &ends[..k] {
                if a == head || b == head {
                    continue;
                }
                let chest = tree.fork(a, b, head);
                let ways = [a, b].map(|end| tree.way(chest, end));
                let lengths = ways.each_ref().map(|way| tree.length(way) / tree.size);
                let own = tree.length(&tree.way(chest, head)) / tree.size;
                let is_trunk = chest == a || chest == b || chest == head || ways.iter().any(|way| way.len() < 4);
                let is_below = tree.heights[chest] < tree.heights[pelvis] - 0.02 * tree.size;
                if is_trunk || is_below || lengths.iter().any(|&length| length < 0.2) {
                    continue;
                }
                let heights = (tree.heights[a] - tree.heights[b]).abs() / tree.size;
                let rise = (tree.heights[head] - tree.heights[chest]) / tree.size;
                let badness =
                    2.0 * (lengths[0] - lengths[1]).abs() + 0.5 * heights - 0.3 * (lengths[0] + lengths[1]) - rise
                        + own
                        - hints::fit(tree.name(head), Role::Head).max(0.0)
                        + if hints::is_arm(tree.name(head)) { 1.0 } else { 0.0 }
                        + if chest == pelvis { 0.2 } else { 0.0 };
                if best.is_none_or(|(least, ..)| badness < least) {
                    best = Some((badness, head, chest, [b, a]));
                }
            }
        }
    }
    match best {
        Some((_, head, chest, hands)) => Upper { head: Some(head), arms: Some((chest, hands)) },
        None => Upper { head: ends.first().copied(), arms: None },
    }
}

/// Hip, knee, ankle and ball on the way to a foot's end.
fn leg(tree: &Tree, pelvis: usize, foot: usize) -> Option<Vec<usize>> {
    let way = tree.way(pelvis, foot);
    if way.len() > LONGEST_WAY {
        return None;
    }
    let mut best: Option<(f32, Vec<usize>)> = None;
    for hip in 1..way.len() {
        for knee in hip + 1..way.len() {
            for ankle in knee + 1..way.len() {
                let whole = tree.length(&way[hip..]).max(1e-6);
                let share = |from: usize, to: usize| tree.length(&way[from..=to]) / whole;
                let hint = |at: usize, role| HINT * hints::fit(tree.name(way[at]), role);
                let reach = THIGH + SHIN;
                // Of the leg to the toes' tips, which is as long as thigh, shin and a fifth of the leg.
                let off =
                    (share(hip, knee) - 0.82 * THIGH / reach).abs() + (share(knee, ankle) - 0.82 * SHIN / reach).abs();
                let first = tree.length(&way[..=hip]);
                let apart = if first < 0.01 * tree.size { 0.3 } else { first / tree.size };
                let hints = hint(hip, Role::HipL) + hint(knee, Role::KneeL) + hint(ankle, Role::AnkleL);
                let badness = off + 0.5 * apart - hints;
                if best.as_ref().is_none_or(|(least, _)| badness < *least) {
                    let ball = way[ankle + 1..]
                        .iter()
                        .copied()
                        .find(|&j| tree.length(&tree.way(way[ankle], j)) > 0.02 * tree.size);
                    best = Some((badness, [way[hip], way[knee], way[ankle]].into_iter().chain(ball).collect()));
                }
            }
        }
    }
    best.map(|(_, leg)| leg)
}

/// The height of whom these legs would belong to.
fn height(tree: &Tree, joints: &BTreeMap<Role, usize>) -> f32 {
    let leg = |roles: [Role; 4]| {
        let [Some(&hip), Some(&ankle)] = [joints.get(&roles[0]), joints.get(&roles[2])] else { return tree.size };
        tree.length(&tree.way(hip, ankle)) / (THIGH + SHIN)
    };
    0.5 * (leg(Role::LEGS[0]) + leg(Role::LEGS[1]))
}

/// Shoulder, elbow and wrist on the ways to both hands' ends; both arms are divided alike where they have as many joints.
fn divided_alike(tree: &Tree, chest: usize, hands: [usize; 2], height: f32) -> [Option<Vec<usize>>; 2] {
    let ways = hands.map(|hand| tree.way(chest, hand));
    let [first, second] = ways.each_ref().map(|way| divided(tree, way, height));
    let best = |all: &mut dyn Iterator<Item = Division>| {
        let least = all.reduce(|best, other| if other.0 < best.0 { other } else { best });
        least.map(|(_, cuts)| cuts)
    };
    let cuts = if first.len() == second.len() {
        let both = best(&mut first.iter().zip(&second).map(|(a, b)| (a.0 + b.0, a.1)));
        [both, both]
    } else {
        [best(&mut first.into_iter()), best(&mut second.into_iter())]
    };
    [0, 1].map(|k| cuts[k].map(|cuts| cuts.map(|at| ways[k][at]).to_vec()))
}

/// How bad it is to divide a way at a shoulder, an elbow and a wrist.
type Division = (f32, [usize; 3]);

/// All divisions of the way to a hand's end. An elbow that is called one is one.
fn divided(tree: &Tree, way: &[usize], height: f32) -> Vec<Division> {
    let mut all = Vec::new();
    if way.len() > LONGEST_WAY {
        return all;
    }
    let hint = |at: usize, role| hints::fit(tree.name(way[at]), role);
    let called = (2..way.len().saturating_sub(1)).find(|&at| hint(at, Role::ElbowL) > 0.0);
    for shoulder in 1..way.len() {
        for elbow in shoulder + 1..way.len() {
            for wrist in elbow + 1..way.len() {
                let share = |from: usize, to: usize| tree.length(&way[from..=to]) / height.max(1e-6);
                let off = (share(shoulder, elbow) - UPPER_ARM).abs() + (share(elbow, wrist) - FOREARM).abs();
                let hints = hint(shoulder, Role::ShoulderL) + hint(elbow, Role::ElbowL) + hint(wrist, Role::WristL);
                let other = if called.is_some_and(|called| called != elbow) { CALLED } else { 0.0 };
                all.push((off - HINT * hints + other, [shoulder, elbow, wrist]));
            }
        }
    }
    all
}

/// Whether the first leg is the left one: of where the feet point. Names decide where feet say little.
fn left_is_first(tree: &Tree, first: &[usize], second: &[usize]) -> bool {
    let (mut sum, mut all) = (0.0, 0.0);
    for &frame in &tree.frames {
        let at = tree.clip().positions(frame);
        let toes = |leg: &[usize]| leg.get(3).map_or(Vec3::ZERO, |&ball| at[ball] - at[leg[2]]);
        let ahead = toes(first) + toes(second);
        let across = at[first[0]] - at[second[0]];
        // Up times forward is left.
        let left = Vec3::new(ahead.z, 0.0, -ahead.x);
        sum += left.dot(across);
        all += left.length() * across.length();
    }
    if sum.abs() > 0.3 * all && all > 0.0 {
        return sum > 0.0;
    }
    let told = first.iter().find_map(|&joint| hints::side(tree.name(joint)));
    told.map_or(sum >= 0.0, |side| side == 0)
}

/// Whether `first` is more to the left than `second`, from the right hip to the left one.
fn is_left(tree: &Tree, first: usize, second: usize, (left, right): (usize, usize)) -> bool {
    let dot = |&frame: &usize| {
        let at = tree.clip().positions(frame);
        (at[first] - at[second]).dot(at[left] - at[right])
    };
    tree.frames.iter().map(dot).sum::<f32>() >= 0.0
}
