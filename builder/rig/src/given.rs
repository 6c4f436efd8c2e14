//! A rig from the skeleton that came with a surface: its bones, joints and weights, and from the recording how they move.
//!
//! ```text
//! bones -> those that move enough of the surface -> a human's, hung as a human's are -> Rig
//! ```
//!
//! Small bones go into their parents: fingers, toes, twists. Where the skeleton is a human's its pelvis is the root, and what hangs on
//! controls hangs on limbs.

use actor::capture::Poses;
use editing::rig::{MOST_BONES, NO_BONE};
use editing::rotation::Fit;
use editing::{INFLUENCES, Influences, Rig, Rigid};
use kernels::topology::Topology;

use crate::estimate::keys::Keys;
use crate::estimate::skeleton::Segment;
use crate::estimate::{Estimate, RigError, RigOptions, bone, clusters, size, weights};
use crate::hung::{GivenBone, hung};

/// The bones that move a vertex, and by how much: together 1.
pub type BonesOfVertex = Vec<(u32, f32)>;

/// A vertex is part of a bone as one rigid piece from this share on; where these are too few, if no bone has more of it, and the bone
/// this much.
const WHOLLY: f32 = 0.9;
const LEAST: f32 = 0.3;
/// Vertices that tell how a bone moves, at least.
const FEWEST: usize = 4;
/// A bone that moves less than this share of the surface goes into its parent, unless it is one of a human's.
const SMALL: f32 = 5e-4;
/// Bones that are not of a human's body go into their parents, the smallest first, until so many are left.
const MOST: usize = 40;

/// The rig of these `bones`, parents first, which move each vertex by `influences`, their shares 1 together. `None` where fewer
/// than two of them move enough of the surface.
///
/// # Errors
/// What was found does not make a rig.
pub fn given(
    topology: &Topology,
    poses: &Poses,
    (bones, influences): (&[GivenBone], &[BonesOfVertex]),
    options: &RigOptions,
) -> Result<Option<Estimate>, RigError> {
    let into = kept(bones, influences, topology.weights());
    let is_kept = |bone: &usize| into[*bone] == *bone;
    let is_human = is_human(bones, &is_kept);
    let chosen: Vec<usize> = (0..bones.len()).filter(is_kept).collect();
    if !(2..=MOST_BONES).contains(&chosen.len()) {
        return Ok(None);
    }
    let hung = hung(bones, &into, is_human, poses.frame(0));
    let place = |bone: usize| hung.iter().position(|one| one.bone == bone).unwrap_or_default();
    let merged: Vec<usize> = into.iter().map(|&bone| place(bone)).collect();
    let skin: Vec<Influences> = influences.iter().map(|own| largest(own, &merged)).collect();

    let keys = Keys::choose(poses, topology.weights(), options.keys.max(2), 1e-4 * size(poses.frame(0)));
    let cores: Vec<Vec<u32>> = (0..hung.len()).map(|bone| core(&skin, bone)).collect();
    let motions: Vec<Vec<Rigid>> = cores.iter().map(|core| clusters::fit(&keys, core)).collect();
    // The file's weights are those of the pose that it was bound in; of the rest pose others explain the motion better.
    let own = |v: usize| {
        let parts = skin[v].joints.iter().zip(&skin[v].weights).filter(|(_, weight)| **weight > 0.0);
        parts.map(|(&bone, _)| usize::from(bone)).collect()
    };
    let skin = weights::weights(&keys, &motions, own);
    let rest = &keys.poses[0];
    let mut segments: Vec<Segment> = Vec::with_capacity(hung.len());
    for (index, one) in hung.iter().enumerate() {
        let mut to_first = Fit::default();
        cores[index].iter().for_each(|&v| to_first.add(rest[v as usize], poses.frame(0)[v as usize], 1.0));
        let back = to_first.rigid().inverse();
        let joint = back.apply(bones[one.bone].joint);
        let off = motions[index].iter().zip(&motions[one.parent]);
        let off: f32 = off.map(|(own, parent)| own.apply(joint).distance_squared(parent.apply(joint))).sum();
        let gap = (off / motions[index].len().max(1) as f32).sqrt();
        let name = unique(name(&bones[one.bone], one.bone, is_human), &segments);
        segments.push(Segment { name, parent: one.parent, joint, gap, limb: one.limb, core: Vec::new() });
    }
    let made = segments.iter().enumerate();
    let made =
        made.map(|(index, segment)| bone(segment, &motions[index], &motions[segment.parent], index == 0)).collect();
    let mut core = vec![NO_BONE; rest.len()];
    for (bone, own) in cores.iter().enumerate() {
        own.iter().for_each(|&v| core[v as usize] = bone as u8);
    }
    let misfit = weights::misfit(&keys, &motions, &skin);
    let bone_misfit = weights::misfit_by_bone(&keys, &motions, &skin);
    let rig = Rig::new(made, skin, core, rest.clone())?;
    let (parts, frames) = (segments.len(), keys.frames);
    Ok(Some(Estimate { rig, is_human, is_given: true, parts, keys: frames, parts_misfit: misfit, misfit, bone_misfit }))
}

/// For each bone the one that it goes into: itself where it moves enough of the surface.
fn kept(bones: &[GivenBone], influences: &[BonesOfVertex], weights: &[f32]) -> Vec<usize> {
    let mut into: Vec<usize> = (0..bones.len()).collect();
    if is_human(bones, &|_| true) {
        // What divides a limb's bones or clothes them goes with them; below the ankles there is one bone.
        for bone in 0..bones.len() {
            let Some(parent) = bones[bone].parent.map(|parent| into[parent]) else { continue };
            if bones[bone].role.is_none() && bones[parent].role.is_some_and(is_of_limb) {
                into[bone] = parent;
            }
        }
    }
    let all: f32 = weights.iter().sum();
    // From the ends inwards: what a parent gets may be enough for it.
    for bone in (0..bones.len()).rev().filter(|&bone| into[bone] == bone).collect::<Vec<_>>() {
        let mut own = moved(bone, &into, (influences, weights));
        let has_role = bones[bone].role.is_some();
        if has_role && own.tellers < FEWEST {
            // The bones of the file that move what it is of the body hang on it: rather those that nothing of the body hangs on.
            for is_end in [true, false] {
                for child in (bone + 1..bones.len()).filter(|&k| into[k] == k).collect::<Vec<_>>() {
                    let hangs = bones[child].parent.map(|on| root(&into, on)) == Some(bone);
                    if own.tellers < FEWEST && hangs && bones[child].role.is_none() && is_end != has_roles(bones, child)
                    {
                        into[child] = bone;
                    }
                }
                own = moved(bone, &into, (influences, weights));
            }
        }
        if own.tellers < FEWEST || (own.mass < SMALL * all && !has_role) {
            // One that nothing is above goes to what is below: the one that moves most of those that hang on it.
            let below = || {
                let tops = (bone + 1..bones.len()).filter(|&k| into[k] == k && is_top(bones, &into, k, bone));
                let mass = |k: usize| moved(k, &into, (influences, weights)).mass;
                tops.map(|k| (mass(k), k)).max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1))).map(|(_, k)| k)
            };
            if let Some(other) = bones[bone].parent.or_else(below) {
                into[bone] = other;
            }
        }
    }
    let mut mass: Vec<f32> = (0..bones.len())
        .map(|bone| if into[bone] == bone { moved(bone, &into, (influences, weights)).mass } else { 0.0 })
        .collect();
    loop {
        let left: Vec<usize> = (0..bones.len()).filter(|&bone| into[bone] == bone).collect();
        // What a bone without vertices has gone into is where its own children go: it stays.
        let on = |bone: usize| bones[bone].parent.map(|parent| root(&into, parent)).filter(|&parent| parent != bone);
        let small = left.iter().filter(|&&bone| bones[bone].role.is_none() && on(bone).is_some());
        let least = small.min_by(|&&a, &&b| mass[a].total_cmp(&mass[b]).then(b.cmp(&a)));
        let least = least.filter(|_| left.len() > MOST).and_then(|&bone| Some((bone, on(bone)?)));
        let Some((bone, parent)) = least else { break };
        into[bone] = parent;
        let share = mass[bone];
        mass[parent] += share;
    }
    (0..bones.len()).map(|bone| root(&into, bone)).collect()
}

/// Whether anything below a bone is a part of the body.
fn has_roles(bones: &[GivenBone], bone: usize) -> bool {
    let mut is_below = vec![false; bones.len()];
    is_below[bone] = true;
    for other in bone + 1..bones.len() {
        is_below[other] |= bones[other].parent.is_some_and(|parent| is_below[parent]);
        if is_below[other] && bones[other].role.is_some() {
            return true;
        }
    }
    false
}

fn is_of_limb(role: &str) -> bool {
    ["thigh", "shin", "foot", "upper_arm"].iter().any(|part| role.starts_with(part))
}

/// What a bone moves with all that has gone into it: its share of the surface, and vertices that tell how it moves.
struct OfBone {
    mass: f32,
    tellers: usize,
}

fn moved(bone: usize, into: &[usize], (influences, weights): (&[BonesOfVertex], &[f32])) -> OfBone {
    let (mut mass, mut tellers) = (0.0, 0);
    for (own, &weight) in influences.iter().zip(weights) {
        let share_of = |bone: usize| -> f32 {
            own.iter().filter(|(other, _)| root(into, *other as usize) == bone).map(|(_, share)| share).sum()
        };
        let share = share_of(bone);
        mass += share * weight;
        let most = own.iter().map(|(other, _)| share_of(root(into, *other as usize))).fold(0.0, f32::max);
        tellers += usize::from(share > LEAST && share >= most);
    }
    OfBone { mass, tellers }
}

/// Whether nothing that is left lies between a bone and `top`.
fn is_top(bones: &[GivenBone], into: &[usize], mut bone: usize, top: usize) -> bool {
    while let Some(parent) = bones[bone].parent {
        if parent == top {
            return true;
        }
        if into[parent] == parent {
            return false;
        }
        bone = parent;
    }
    false
}

/// Where a bone ends up.
fn root(into: &[usize], mut bone: usize) -> usize {
    while into[bone] != bone {
        bone = into[bone];
    }
    bone
}

fn is_human(bones: &[GivenBone], is_kept: &dyn Fn(&usize) -> bool) -> bool {
    let has = |role: &str| (0..bones.len()).any(|bone| bones[bone].role == Some(role) && is_kept(&bone));
    ["pelvis", "thigh_l", "thigh_r", "shin_l", "shin_r", "foot_l", "foot_r"].into_iter().all(has)
}

fn name(bone: &GivenBone, index: usize, is_human: bool) -> String {
    match (bone.role.filter(|_| is_human), bone.name.is_empty()) {
        (Some(role), _) => role.into(),
        (None, false) => bone.name.clone(),
        (None, true) => format!("bone {index}"),
    }
}

fn unique(name: String, before: &[Segment]) -> String {
    let is_free = |name: &str| before.iter().all(|other| other.name != name);
    if is_free(&name) {
        return name;
    }
    (2..).map(|number| format!("{name} {number}")).find(|name| is_free(name)).unwrap_or(name)
}

/// The largest shares of a vertex, those of bones that are one now added up.
fn largest(own: &[(u32, f32)], merged: &[usize]) -> Influences {
    let mut shares: Vec<(usize, f32)> = Vec::new();
    for &(bone, weight) in own {
        let bone = merged[bone as usize];
        match shares.iter_mut().find(|(other, _)| *other == bone) {
            Some((_, share)) => *share += weight,
            None => shares.push((bone, weight)),
        }
    }
    shares.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    shares.truncate(INFLUENCES);
    let sum: f32 = shares.iter().map(|(_, share)| share).sum();
    let mut largest = Influences::default();
    for k in 0..INFLUENCES {
        let first = shares.first().map_or(0, |(bone, _)| *bone);
        let (bone, share) = shares.get(k).copied().unwrap_or((first, 0.0));
        let alone = if k == 0 { 1.0 } else { 0.0 };
        (largest.joints[k], largest.weights[k]) = (bone as u8, if sum > 0.0 { share / sum } else { alone });
    }
    largest
}

/// Vertices that move with a bone as one rigid piece, or mostly where these are too few.
fn core(skin: &[Influences], bone: usize) -> Vec<u32> {
    let share = |v: u32| {
        let own = &skin[v as usize];
        let parts = own.joints.iter().zip(&own.weights).filter(|(joint, _)| usize::from(**joint) == bone);
        parts.map(|(_, weight)| weight).sum::<f32>()
    };
    let from = |least: f32| -> Vec<u32> { (0..skin.len() as u32).filter(|&v| share(v) > least).collect() };
    let wholly = from(WHOLLY);
    if wholly.len() >= FEWEST {
        return wholly;
    }
    // The first of its bones is the one that has most of it.
    let mut mostly = from(LEAST);
    mostly.retain(|&v| usize::from(skin[v as usize].joints[0]) == bone);
    mostly
}

#[cfg(test)]
mod tests;
