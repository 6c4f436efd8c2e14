//! How the bones of a skeleton hang together once small ones are gone: which is the root, what hangs on what, which limb is which.

use std::collections::BTreeMap;

use glam::Vec3;

/// A bone as it came.
#[derive(Clone, Debug, PartialEq)]
pub struct GivenBone {
    /// Its name.
    pub name: String,
    /// The bone that it hangs on, before it in the list.
    pub parent: Option<usize>,
    /// Where it begins in the first frame, in metres.
    pub joint: Vec3,
    /// What it is of a human body, by the names that rigs have.
    pub role: Option<&'static str>,
}

/// A bone that was kept, in an order in which parents come first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hung {
    /// Its index as it came.
    pub bone: usize,
    /// Its parent's place in this list; its own where it is the root.
    pub parent: usize,
    /// Its limb; 0 is the trunk.
    pub limb: u32,
}

/// A limb of a body that is no human's reaches this share of its size from where it begins, at least.
const LONG: f32 = 0.2;

/// What hangs on what in a human body.
const CHAINS: [(&str, &[&str]); 9] = [
    ("chest", &["pelvis"]),
    ("head", &["chest", "pelvis"]),
    ("thigh_l", &["pelvis"]),
    ("thigh_r", &["pelvis"]),
    ("shin_l", &["thigh_l"]),
    ("shin_r", &["thigh_r"]),
    ("foot_l", &["shin_l"]),
    ("foot_r", &["shin_r"]),
    ("forearm_l", &["upper_arm_l"]),
];

/// The bones that are left: those that `into` says go into themselves. `pose` is the one that their joints are of.
#[must_use]
pub fn hung(bones: &[GivenBone], into: &[usize], is_human: bool, pose: &[Vec3]) -> Vec<Hung> {
    let kept: Vec<usize> = (0..bones.len()).filter(|&bone| into[bone] == bone).collect();
    let above = |bone: usize| {
        let mut at = bones[bone].parent;
        while let Some(parent) = at.filter(|&parent| into[parent] == bone) {
            at = bones[parent].parent;
        }
        at.map(|parent| into[parent])
    };
    let mut parents: BTreeMap<usize, Option<usize>> = kept.iter().map(|&bone| (bone, above(bone))).collect();
    let root = if is_human { hang_human(bones, &kept, &mut parents) } else { widest(&kept, &parents) };
    // What is above the root, or beside it, hangs on it.
    let mut at = root;
    let mut before = None;
    while let Some(next) = parents.insert(at, before).flatten() {
        (before, at) = (Some(at), next);
    }
    for (&bone, parent) in &mut parents {
        if bone != root && parent.is_none() {
            *parent = Some(root);
        }
    }
    let order = parents_first(root, &kept, &parents);
    let limbs = if is_human { human_limbs(bones, &order, &parents) } else { limbs(bones, &order, &parents, pose) };
    let place = |bone: usize| order.iter().position(|&other| other == bone).unwrap_or_default();
    let one = |&bone: &usize| Hung {
        bone,
        parent: parents[&bone].map_or(0, place),
        limb: limbs.get(&bone).copied().unwrap_or_default(),
    };
    order.iter().map(one).collect()
}

type Parents = BTreeMap<usize, Option<usize>>;

fn is_below(parents: &Parents, mut bone: usize, above: usize) -> bool {
    // No way up is longer than there are bones.
    for _ in 0..=parents.len() {
        if bone == above {
            return true;
        }
        let Some(parent) = parents.get(&bone).copied().flatten() else { return false };
        bone = parent;
    }
    false
}

/// Hangs a human's bones as a human's hang where they do not; the pelvis.
fn hang_human(bones: &[GivenBone], kept: &[usize], parents: &mut Parents) -> usize {
    let find = |role: &str| kept.iter().copied().find(|&bone| bones[bone].role == Some(role));
    let chains = CHAINS.into_iter().chain([("forearm_r", &["upper_arm_r"][..])]);
    let arms = ["upper_arm_l", "upper_arm_r"].map(|role| (role, &["chest", "pelvis"][..]));
    for (role, on) in chains.chain(arms) {
        let (Some(bone), Some(on)) = (find(role), on.iter().find_map(|role| find(role))) else { continue };
        if !is_below(parents, bone, on) && !is_below(parents, on, bone) {
            parents.insert(bone, Some(on));
        }
    }
    find("pelvis").unwrap_or(kept[0])
}

/// Of the bones that nothing is above the one with most bones below it.
fn widest(kept: &[usize], parents: &Parents) -> usize {
    let tops = kept.iter().copied().filter(|bone| parents[bone].is_none());
    let below = |top: usize| kept.iter().filter(|&&bone| is_below(parents, bone, top)).count();
    tops.max_by_key(|&top| (below(top), std::cmp::Reverse(top))).unwrap_or(kept[0])
}

fn parents_first(root: usize, kept: &[usize], parents: &Parents) -> Vec<usize> {
    let mut order = vec![root];
    let mut at = 0;
    while at < order.len() {
        let own = order[at];
        order.extend(kept.iter().copied().filter(|bone| *bone != root && parents[bone] == Some(own)));
        at += 1;
    }
    order
}

/// Arms and legs are limbs, all else is trunk or of the limb that it hangs on.
fn human_limbs(bones: &[GivenBone], order: &[usize], parents: &Parents) -> BTreeMap<usize, u32> {
    let mut limbs = BTreeMap::new();
    for &bone in order {
        let first = ["upper_arm_l", "upper_arm_r", "thigh_l", "thigh_r"];
        let own = first.iter().position(|&role| bones[bone].role == Some(role));
        let of_parent = parents[&bone].and_then(|parent| limbs.get(&parent).copied()).unwrap_or(0);
        limbs.insert(bone, own.map_or(of_parent, |own| own as u32 + 1));
    }
    limbs
}

/// What branches into several long ways is trunk, each long way that does not is a limb; short ones go with what they hang on.
fn limbs(bones: &[GivenBone], order: &[usize], parents: &Parents, pose: &[Vec3]) -> BTreeMap<usize, u32> {
    let size = crate::estimate::size(pose);
    let joint = |bone: usize| bones[bone].joint;
    let reach = |bone: usize| {
        let below = order.iter().filter(|&&other| is_below(parents, other, bone));
        below.map(|&other| joint(other).distance(joint(bone))).fold(0.0, f32::max)
    };
    let long: BTreeMap<usize, bool> = order.iter().map(|&bone| (bone, reach(bone) > LONG * size)).collect();
    let children = |bone: usize| order.iter().copied().filter(move |other| parents[other] == Some(bone));
    let mut is_trunk: BTreeMap<usize, bool> = BTreeMap::new();
    for &bone in order.iter().rev() {
        let branches = children(bone).filter(|child| long[child]).count() > 1;
        let above = children(bone).any(|child| is_trunk[&child]);
        is_trunk.insert(bone, branches || above || bone == order[0]);
    }
    let mut limbs: BTreeMap<usize, u32> = BTreeMap::new();
    let mut count = 0;
    for &bone in order {
        let on = parents[&bone];
        let own = match on {
            _ if is_trunk[&bone] => 0,
            Some(parent) if is_trunk[&parent] => {
                count += 1;
                count
            }
            on => on.and_then(|parent| limbs.get(&parent).copied()).unwrap_or(0),
        };
        limbs.insert(bone, own);
    }
    limbs
}
