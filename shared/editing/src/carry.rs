//! What bones have to do with the vertices that are dragged, that stay, and that are around.

use glam::{Quat, Vec3};

use crate::deform::Deformer;
use crate::document::Scope;
use crate::reach::Target;
use crate::rig::{NO_BONE, Rig};
use crate::rigid::Rigid;
use crate::rotation::between;
use crate::skin::{Influences, Skin};

/// Weight of handles and pins in the inverse kinematics.
pub(crate) const HANDLE: f32 = 4.0;
pub(crate) const PIN: f32 = 20.0;

/// A vertex that takes hold of a bone: what is around it follows the bone, too, by these shares.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Carried {
    pub vertex: u32,
    pub bone: usize,
    pub around: Vec<(u32, f32)>,
    /// How near the same are, from 1 at the vertex to 0 at the end of what it takes hold of.
    pub near: Vec<(u32, f32)>,
}

/// How far handles go `beyond` where their bones bring them, spread over what is near: one vertex alone would be drawn out to a point.
pub(crate) fn spread<'a>(near: impl Iterator<Item = &'a [(u32, f32)]>, beyond: &[Vec3], count: usize) -> Vec<Vec3> {
    let mut sums = vec![(Vec3::ZERO, 0.0_f32); count];
    for (near, &beyond) in near.zip(beyond) {
        for &(vertex, near) in near {
            let (sum, all) = &mut sums[vertex as usize];
            (*sum, *all) = (*sum + beyond * near, *all + near);
        }
    }
    sums.into_iter().map(|(sum, all)| sum / all.max(1.0)).collect()
}

/// How large a pose is: the longest side of its box.
pub(crate) fn size(pose: &[Vec3]) -> f32 {
    let low = pose.iter().copied().reduce(Vec3::min).unwrap_or_default();
    let high = pose.iter().copied().reduce(Vec3::max).unwrap_or_default();
    (high - low).max_element()
}

/// The bone that a handle takes hold of, and how far what is around follows. That of its own piece; cloth and hair, which
/// belong to none, are grabbed for the nearest of the bones that move them: a skirt for the thigh under it.
pub(crate) fn carry(
    rig: &Rig,
    deformer: &Deformer,
    (pose, motions): (&[Vec3], &[Rigid]),
    vertex: u32,
    radius: f32,
) -> Carried {
    let Influences { joints, weights } = &rig.influences()[vertex as usize];
    let (from, to) = (rig.joints(motions), rig.ends(motions));
    let point = pose[vertex as usize];
    let distance = |k: usize| {
        let bone = joints[k] as usize;
        let along = to[bone] - from[bone];
        let share = ((point - from[bone]).dot(along) / along.length_squared().max(1e-12)).clamp(0.0, 1.0);
        point.distance(from[bone] + along * share)
    };
    let is_loose = rig.core()[vertex as usize] == NO_BONE;
    let is_better = |k: usize, best: usize| match is_loose {
        true => weights[k] > 0.0 && (weights[best] <= 0.0 || distance(k) < distance(best)),
        false => weights[k] > weights[best],
    };
    let best = (1..joints.len()).fold(0, |best, k| if is_better(k, best) { k } else { best });
    let bone = joints[best] as usize;
    let share = weights[best];
    let near = deformer.near(pose, vertex, radius);
    let around = near.iter().map(|&(other, near)| (other, (1.0 - share) * near)).collect();
    Carried { vertex, bone, around, near }
}

/// Which bones may turn.
pub(crate) fn free(rig: &Rig, scope: Scope, limbs: &[u32]) -> Vec<bool> {
    let bones = rig.bones().iter().enumerate();
    bones.map(|(index, bone)| scope == Scope::Body || (index > 0 && limbs.contains(&bone.limb))).collect()
}

/// What brings a handle to where it is wanted.
pub(crate) fn handle_target(carried: &Carried, pose: &[Vec3]) -> Target {
    let point = pose[carried.vertex as usize];
    Target { parts: vec![(carried.bone, 1.0, point)], to: point, weight: Vec3::splat(HANDLE), is_floor: false }
}

/// Targets that hold the vertices `pins` where they are: of each bone the outermost along each axis.
pub(crate) fn pin_targets(rig: &Rig, pose: &[Vec3], pins: &[u32]) -> Vec<Target> {
    let mut by_bone: Vec<Vec<u32>> = vec![Vec::new(); rig.bones().len()];
    pins.iter().for_each(|&pin| by_bone[rig.bone_of(pin)].push(pin));
    let mut targets = Vec::new();
    for (bone, pins) in by_bone.iter().enumerate() {
        let mut chosen: Vec<u32> = Vec::new();
        for axis in [Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z, Vec3::Y, Vec3::NEG_Y] {
            let along = |pin: u32| pose[pin as usize].dot(axis);
            let outermost = pins.iter().copied().reduce(|best, pin| if along(pin) > along(best) { pin } else { best });
            chosen.extend(outermost.filter(|pin| !chosen.contains(pin)));
        }
        targets.extend(chosen.into_iter().map(|pin| {
            let point = pose[pin as usize];
            Target { parts: vec![(bone, 1.0, point)], to: point, weight: Vec3::splat(PIN), is_floor: false }
        }));
    }
    targets
}

/// How each vertex of `pose` is turned and displaced where its bones do `motions`.
pub(crate) fn skin(rig: &Rig, pose: &[Vec3], motions: &[Rigid], carried: &[Carried]) -> (Vec<Quat>, Vec<Vec3>) {
    let origin = vec![Rigid { rotation: Quat::IDENTITY, translation: Vec3::ZERO }; motions.len()];
    let skin = Skin::new(&origin, motions);
    let is_still: Vec<bool> = motions.iter().map(|motion| *motion == origin[0]).collect();
    let (mut turns, mut told) = (Vec::with_capacity(pose.len()), Vec::with_capacity(pose.len()));
    for (influences, &point) in rig.influences().iter().zip(pose) {
        let moves = |k: usize| influences.weights[k] > 0.0 && !is_still[influences.joints[k] as usize];
        // What no bone moves is not moved by rounding, either.
        let motion = if (0..influences.joints.len()).any(moves) { skin.motion(influences) } else { origin[0] };
        turns.push(motion.rotation);
        told.push(motion.apply(point) - point);
    }
    for one in carried.iter().filter(|one| !is_still[one.bone]) {
        let motion = &motions[one.bone];
        for &(vertex, share) in &one.around {
            let vertex = vertex as usize;
            turns[vertex] = between(turns[vertex], motion.rotation, share);
            told[vertex] = told[vertex].lerp(motion.apply(pose[vertex]) - pose[vertex], share);
        }
    }
    (turns, told)
}
