//! A body leans so that its centre of mass stays on its way while feet are put elsewhere.
//!
//! Not in the papers. A leg that goes elsewhere takes the centre of mass along by some centimetres, off the way that was planned
//! for it; all that does not follow a foot leans against that.

use actor::feet::{Feet, SHARE_STEP};
use glam::Vec3;

/// What is more than this share of the surface is no legs, on which a body could lean.
const MOST_LEGS: f32 = 0.8;

/// Moves the body of `pose`, whose feet have carried its centre of mass by `carried` metres, back along the ground: legs by as
/// much as they do not follow their feet. `weights` are those of the centre of mass, with a sum of 1.
pub(crate) fn lean(feet: &Feet, carried: Vec3, weights: &[f32], pose: &mut [Vec3]) {
    let vertices = || (0..feet.count()).flat_map(|foot| feet.vertices(foot));
    let legs: f32 = vertices().map(|vertex| weights[vertex.vertex as usize] * share(vertex.leg)).sum();
    if carried == Vec3::ZERO || legs > MOST_LEGS {
        return;
    }
    let by = carried.with_y(0.0) / (legs - 1.0);
    pose.iter_mut().for_each(|point| *point += by);
    for vertex in vertices() {
        pose[vertex.vertex as usize] -= by * share(vertex.leg);
    }
}

/// A share from 0 to 1.
pub(crate) fn share(steps: u8) -> f32 {
    f32::from(steps) * SHARE_STEP
}
