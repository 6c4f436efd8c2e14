//! A skeleton of local offsets and rotations becomes world positions.

use driving::{ClipJoint, Stance};
use glam::{DQuat, DVec3};

/// The stance of `joints` whose local offsets and rotations against their parents these are; parents come first.
pub fn stance(joints: &[ClipJoint], offsets: &[DVec3], turns: &[DQuat]) -> Stance {
    let mut world: Vec<(DQuat, DVec3)> = Vec::with_capacity(joints.len());
    for ((joint, &offset), &turn) in joints.iter().zip(offsets).zip(turns) {
        let (rotation, place) = joint.parent.map_or((DQuat::IDENTITY, DVec3::ZERO), |parent| world[parent]);
        world.push((rotation * turn, place + rotation * offset));
    }
    Stance {
        positions: world.iter().map(|(_, place)| place.as_vec3()).collect(),
        rotations: world.iter().map(|(rotation, _)| rotation.normalize().as_quat()).collect(),
    }
}
