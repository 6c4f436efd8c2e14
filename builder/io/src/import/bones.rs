//! The skeleton that an input brings with its surface.

use std::collections::BTreeMap;

use actor::capture::Capture;
use glam::{DVec3, Mat4, Quat, Vec3};

use super::frames::Axes;
use super::inputs::Source;
use super::plan::Plan;

/// Frames in which the skeleton is looked at, to tell what its bones are.
const LOOKS: usize = 60;
/// A file with more bones than this has something else than a skeleton.
const MOST: usize = 512;
/// A node that moves by less than this share against its parent does not move.
const STILL: f32 = 1e-4;
/// A bone whose beginning goes about by more than this share of the size in its parent's frame is not held by that; one that stays within
/// the other share in that of another bone, in most frames, is held there.
const LOOSE: f32 = 0.08;
const HELD: f32 = 0.015;
const MOSTLY: f32 = 0.8;

/// A bone of a file's skeleton.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileBone {
    /// Its name, as the file has it.
    pub name: String,
    /// The bone that it hangs on, before it in the list.
    pub parent: Option<usize>,
    /// What it is of a human body, by the names that rigs have ("thigh_l"); `None` where it is nothing of one.
    pub role: Option<&'static str>,
}

/// Bones that move a capture's surface, as its file has them.
#[derive(Clone, Debug, PartialEq)]
pub struct FileSkeleton {
    /// The bones, parents first.
    pub bones: Vec<FileBone>,
    /// Where each begins in the capture's first frame, in metres, +Y up.
    pub joints: Vec<Vec3>,
    /// For each vertex of the capture the bones that move it, and by how much: together 1.
    pub influences: Vec<Vec<(u32, f32)>>,
}

/// Where the bones of a file are in one frame, in metres, +Y up.
struct Look {
    positions: Vec<Vec3>,
    rotations: Vec<Quat>,
}

/// What a file says of its nodes and of what they move.
pub(super) struct Moved {
    /// Whether each node is a joint of a skin.
    pub is_joint: Vec<bool>,
    /// Names and parents of all nodes.
    pub names: Vec<String>,
    pub parents: Vec<Option<usize>>,
    /// All nodes, parents first.
    pub order: Vec<usize>,
    /// For each file vertex the nodes that move it.
    pub by: Vec<Vec<(usize, f32)>>,
}

/// The skeleton of `capture`, where the first sequence of `plan` is a clip of a file that has one: more than one of its nodes moves
/// vertices.
pub(super) fn skeleton(plan: &Plan, offset: DVec3, capture: &Capture) -> Option<FileSkeleton> {
    let Source::Clip { file, clip } = &plan.sequences.first()?.source else { return None };
    let moved = file.moved();
    if moved.by.len() != capture.vertex_of_file_vertex.len() {
        return None;
    }
    let mut frames = vec![];
    for sequence in &plan.sequences {
        if let Source::Clip { file: other, clip } = &sequence.source
            && other.path() == file.path()
        {
            let count = other.frame_count(*clip, plan.fps) as usize;
            frames.extend((0..count).map(|frame| (*clip, frame)));
        }
    }
    let step = frames.len().div_ceil(LOOKS).max(1);
    let world = |(clip, frame)| file.world(clip, f64::from(plan.fps), frame);
    let worlds: Vec<Vec<Mat4>> = frames.into_iter().step_by(step).map(world).collect();
    let into = carriers(&moved, &worlds);
    let mut is_bone = vec![false; into.len()];
    moved.by.iter().flatten().for_each(|&(node, _)| is_bone[into[node]] = true);
    if is_bone.iter().filter(|is_bone| **is_bone).count() < 2 {
        return None;
    }
    // What bones hang on joins them.
    for &node in moved.order.iter().rev() {
        if let (true, Some(parent)) = (is_bone[node], moved.parents[node]) {
            is_bone[into[parent]] = true;
        }
    }
    let chosen: Vec<usize> = moved.order.iter().copied().filter(|&node| is_bone[node]).collect();
    if chosen.len() > MOST {
        return None;
    }
    let place: BTreeMap<usize, usize> = chosen.iter().enumerate().map(|(bone, &node)| (node, bone)).collect();
    let mut influences = vec![Vec::new(); capture.topology.vertex_count()];
    for (&vertex, by) in capture.vertex_of_file_vertex.iter().zip(&moved.by) {
        let own: &mut Vec<(u32, f32)> = &mut influences[vertex as usize];
        if own.is_empty() {
            *own = by.iter().filter_map(|(node, weight)| Some((*place.get(&into[*node])? as u32, *weight))).collect();
        }
    }
    let axes = Axes { up: plan.up, unit: plan.metres_per_unit(), offset };
    let first = look(&world((*clip, 0)), &chosen, axes);
    let looks: Vec<Look> = worlds.iter().map(|world| look(world, &chosen, axes)).collect();
    let parents = chosen.iter().map(|&node| place.get(&into[moved.parents[node]?]).copied()).collect();
    let (parents, order) = hung(parents, &looks);
    let is_joint: Vec<bool> = order.iter().map(|&bone| moved.is_joint[chosen[bone]]).collect();
    let at = |bone: usize| order.iter().position(|&other| other == bone).unwrap_or_default();
    let mut bones: Vec<FileBone> = order
        .iter()
        .map(|&bone| FileBone { name: moved.names[chosen[bone]].clone(), parent: parents[bone].map(at), role: None })
        .collect();
    influences.iter_mut().flatten().for_each(|(bone, _)| *bone = at(*bone as usize) as u32);
    let looks: Vec<Look> = looks.iter().map(|look| look.of(&order)).collect();
    name(&mut bones, &is_joint, &looks, plan.fps);
    Some(FileSkeleton { bones, joints: first.of(&order).positions, influences })
}

/// For each node the one that carries it: what is no joint and never moves against its parent goes with that.
fn carriers(moved: &Moved, worlds: &[Vec<Mat4>]) -> Vec<usize> {
    let mut into: Vec<usize> = (0..moved.parents.len()).collect();
    for &node in &moved.order {
        let Some(parent) = moved.parents[node].filter(|_| !moved.is_joint[node]) else { continue };
        let against = |world: &Vec<Mat4>| world[parent].inverse() * world[node];
        let Some(first) = worlds.first().map(against) else { continue };
        let largest = first.to_cols_array().iter().fold(0.0_f32, |largest, x| largest.max(x.abs()));
        if worlds.iter().all(|world| against(world).abs_diff_eq(first, STILL * largest)) {
            into[node] = into[parent];
        }
    }
    into
}

/// What each bone hangs on, and the bones with parents first. A foot on a control that follows its leg hangs on the leg: it does not keep its place
/// in its parent's frame, but in that of another bone.
fn hung(mut parents: Vec<Option<usize>>, looks: &[Look]) -> (Vec<Option<usize>>, Vec<usize>) {
    let count = parents.len();
    let places = looks.iter().flat_map(|look| &look.positions);
    let (low, high) = places.fold((Vec3::MAX, Vec3::MIN), |(low, high), &place| (low.min(place), high.max(place)));
    let size = (high - low).max_element();
    // How far it goes about at most, in so many of the frames: a limb may be stretched or lost in some.
    let drift = |bone: usize, on: usize, share: f32| {
        let own = |look: &Look| look.rotations[on].conjugate() * (look.positions[bone] - look.positions[on]);
        let mean = looks.iter().map(own).sum::<Vec3>() / looks.len().max(1) as f32;
        let mut off: Vec<f32> = looks.iter().map(|look| own(look).distance(mean)).collect();
        off.sort_by(f32::total_cmp);
        let last = off.len().saturating_sub(1);
        off.get((last as f32 * share).round() as usize).copied().unwrap_or_default()
    };
    let is_below = |parents: &[Option<usize>], mut bone: usize, above: usize| {
        for _ in 0..=count {
            if bone == above {
                return true;
            }
            let Some(parent) = parents[bone] else { return false };
            bone = parent;
        }
        true
    };
    for bone in 0..count {
        let Some(parent) = parents[bone].filter(|&parent| drift(bone, parent, 1.0) > LOOSE * size) else { continue };
        let others = (0..count).filter(|&other| other != parent && !is_below(&parents, other, bone));
        let best = others.map(|other| (drift(bone, other, MOSTLY), other)).min_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((_, other)) = best.filter(|(drift, _)| *drift < HELD * size) {
            parents[bone] = Some(other);
        }
    }
    let mut order: Vec<usize> = (0..count).filter(|&bone| parents[bone].is_none()).collect();
    let mut at = 0;
    while at < order.len() {
        let own = order[at];
        order.extend((0..count).filter(|&bone| parents[bone] == Some(own)));
        at += 1;
    }
    (parents, order)
}

impl Look {
    /// Of these bones, in this order.
    fn of(&self, order: &[usize]) -> Self {
        let positions = order.iter().map(|&bone| self.positions[bone]).collect();
        Self { positions, rotations: order.iter().map(|&bone| self.rotations[bone]).collect() }
    }
}

fn look(world: &[Mat4], chosen: &[usize], axes: Axes) -> Look {
    let position =
        |node: &usize| (axes.metres_from_input(world[*node].w_axis.truncate().as_dvec3()) - axes.offset).as_vec3();
    let turned = axes.rotation();
    let rotation = |node: &usize| {
        let (_, rotation, _) = world[*node].to_scale_rotation_translation();
        // What is scaled to nothing points nowhere.
        let is_one = rotation.is_finite() && rotation.length_squared() > 0.5;
        if is_one { turned * rotation.normalize() } else { turned }
    };
    Look { positions: chosen.iter().map(position).collect(), rotations: chosen.iter().map(rotation).collect() }
}

/// Says of a human's bones what they are. Joints of skins tell it, where there are any, and what joins them: no cape, and no sword.
#[cfg(feature = "mocap")]
fn name(bones: &mut [FileBone], is_joint: &[bool], looks: &[Look], fps: f32) {
    use driving::{Clip, ClipJoint, Mapping, MappingFile, Role, Stance};
    let mut is_told = is_joint.to_vec();
    if !is_told.contains(&true) {
        is_told.fill(true);
    }
    for bone in (0..bones.len()).rev() {
        if let (true, Some(parent)) = (is_told[bone], bones[bone].parent) {
            is_told[parent] = true;
        }
    }
    let told: Vec<usize> = (0..bones.len()).filter(|&bone| is_told[bone]).collect();
    let at = |bone: usize| told.iter().position(|&other| other == bone);
    let joint = |&bone: &usize| ClipJoint { name: bones[bone].name.clone(), parent: bones[bone].parent.and_then(at) };
    let joints = told.iter().map(joint).collect();
    let stance = |look: Look| Stance { positions: look.positions, rotations: look.rotations };
    let stances = looks.iter().map(|look| stance(look.of(&told))).collect();
    let Ok(clip) = Clip::new(joints, fps, stances, None) else { return };
    let Ok(mapping) = Mapping::of(&clip, &MappingFile::default()) else { return };
    let roles = [
        (Role::Pelvis, "pelvis"),
        (Role::Chest, "chest"),
        (Role::Head, "head"),
        (Role::HipL, "thigh_l"),
        (Role::KneeL, "shin_l"),
        (Role::AnkleL, "foot_l"),
        (Role::HipR, "thigh_r"),
        (Role::KneeR, "shin_r"),
        (Role::AnkleR, "foot_r"),
        (Role::ShoulderL, "upper_arm_l"),
        (Role::ElbowL, "forearm_l"),
        (Role::ShoulderR, "upper_arm_r"),
        (Role::ElbowR, "forearm_r"),
    ];
    for (role, name) in roles {
        if let Some(joint) = mapping.joint(role) {
            let bone = &mut bones[told[joint]];
            bone.role = bone.role.or(Some(name));
        }
    }
}

#[cfg(not(feature = "mocap"))]
fn name(_: &mut [FileBone], _: &[bool], _: &[Look], _: f32) {}
