//! Which vertices a body stands on.

use actor::feet::Feet;
use glam::Vec3;

/// A vertex is part of a sole from this share on, in [`actor::feet::SHARE_STEP`].
const SOLE: u8 = 128;
/// What is this close to the lowest point stands, relative to the body's height, where no feet are known.
const LOW: f32 = 0.011;

/// The vertices of a foot's sole.
pub fn sole(feet: &Feet, foot: usize) -> impl Iterator<Item = u32> {
    feet.vertices(foot).iter().filter(|vertex| vertex.sole >= SOLE).map(|vertex| vertex.vertex)
}

/// The vertices on which a pose stands where no feet are known: those that are about as low as the lowest.
pub(crate) fn lowest(pose: &[Vec3]) -> Vec<u32> {
    let low = pose.iter().map(|point| point.y).fold(f32::INFINITY, f32::min);
    let high = pose.iter().map(|point| point.y).fold(f32::NEG_INFINITY, f32::max);
    let most = low + LOW * (high - low);
    (0..pose.len() as u32).filter(|&vertex| pose[vertex as usize].y <= most).collect()
}
