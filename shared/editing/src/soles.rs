//! Which vertices a body stands on.

use actor::feet::Feet;
use actor::timeline::Timeline;
use glam::Vec3;

use crate::propagate::firmness;

/// A vertex is part of a sole from this share on, in [`actor::feet::SHARE_STEP`].
const SOLE: u8 = 128;
/// What is this close to the lowest point stands, relative to the body's height, where no feet are known.
const LOW: f32 = 0.011;

/// The vertices of a foot's sole.
pub fn sole(feet: &Feet, foot: usize) -> impl Iterator<Item = u32> {
    feet.vertices(foot).iter().filter(|vertex| vertex.sole >= SOLE).map(|vertex| vertex.vertex)
}

/// Whether one of `handles` is part of a foot.
pub(crate) fn is_grabbed(feet: &Feet, foot: usize, handles: &[u32]) -> bool {
    feet.vertices(foot).iter().any(|vertex| vertex.sole > 0 && handles.contains(&vertex.vertex))
}

/// How firmly a foot is on the ground in `pose` whether it was found to stand there or not: 1 below half of what is close to the ground, 0
/// beyond as much again above that.
fn touches(feet: &Feet, foot: usize, pose: &[Vec3], ground: f32) -> f32 {
    let [low, high] = [f32::min, f32::max].map(|of| pose.iter().map(|point| point.y).reduce(of).unwrap_or(0.0));
    let near = LOW * (high - low).max(f32::MIN_POSITIVE);
    let height = sole(feet, foot).map(|vertex| pose[vertex as usize].y).fold(f32::INFINITY, f32::min) - ground;
    let u = (height / near - 0.5).clamp(0.0, 1.0);
    1.0 - u * u * (3.0 - 2.0 * u)
}

/// How firmly each foot is held in `frame`, which is `pose` as it was recorded: 1 where it stands, less and less in the frames beside; and
/// where none stands, as far as it is on the ground: a body that is held nowhere would go wherever it is dragged.
pub(crate) fn firm(timeline: &Timeline, feet: &Feet, frame: u32, pose: &[Vec3], ground: f32) -> Vec<f32> {
    let stands = |foot| firmness(timeline, frame, |frame| feet.stands(frame, foot));
    let mut firm: Vec<f32> = (0..feet.count()).map(stands).collect();
    let left = 1.0 - firm.iter().copied().fold(0.0, f32::max);
    if left > 0.0 {
        let on_ground = |(foot, firm): (usize, &mut f32)| *firm = firm.max(left * touches(feet, foot, pose, ground));
        firm.iter_mut().enumerate().for_each(on_ground);
    }
    firm
}

/// The vertices on which a pose stands where no feet are known: those that are about as low as the lowest.
pub(crate) fn lowest(pose: &[Vec3]) -> Vec<u32> {
    let low = pose.iter().map(|point| point.y).fold(f32::INFINITY, f32::min);
    let high = pose.iter().map(|point| point.y).fold(f32::NEG_INFINITY, f32::max);
    let most = low + LOW * (high - low);
    (0..pose.len() as u32).filter(|&vertex| pose[vertex as usize].y <= most).collect()
}
