//! The body's own frame: where the body is and how it is turned in each frame, so that what is left is its shape.
//!
//! Generalised Procrustes analysis with weights that fall where the surface moves: arms and legs say little of where the body is
//! (method note of thesis chapter 5; eight rounds are enough).

use actor::capture::Poses;
use glam::{DMat3, Quat, Vec3};
use kernels::rotation::best_rotation;
use rayon::prelude::*;

/// Rounds of aligning and weighing.
const ROUNDS: usize = 8;
/// A vertex that moves by this much has half the weight of one that does not: 1 cm of 1.8 m.
const MOVES: f32 = 0.0056;
/// Vertices that are looked at, at most.
const LOOKED_AT: usize = 2000;

/// Where a body is: a rotation, then a translation, from its own frame to where it was recorded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyFrame {
    /// How it is turned.
    pub rotation: Quat,
    /// Where its centre is, in metres.
    pub centre: Vec3,
}

impl BodyFrame {
    /// A point of the body's own frame where it was recorded.
    #[must_use]
    pub fn place(&self, point: Vec3) -> Vec3 {
        self.rotation * point + self.centre
    }

    /// A recorded point in the body's own frame.
    #[must_use]
    pub fn own(&self, point: Vec3) -> Vec3 {
        self.rotation.inverse() * (point - self.centre)
    }
}

/// How far the body reaches at most along an axis, in metres, in the frames that are looked at.
#[must_use]
pub fn body_size(poses: &Poses, frames: &[u32]) -> f32 {
    let reach = |frame: &u32| {
        let pose = poses.frame(*frame);
        let low = pose.iter().copied().fold(Vec3::INFINITY, Vec3::min);
        (pose.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max) - low).max_element()
    };
    frames.iter().step_by(frames.len().div_ceil(20).max(1)).map(reach).fold(0.0, f32::max)
}

/// The body's frame in each of `frames`; `areas` are the topology's weights, `size` is the body's. The body's own frame is that of the first one.
#[must_use]
pub fn body_frames(poses: &Poses, frames: &[u32], areas: &[f32], size: f32) -> Vec<BodyFrame> {
    let stride = areas.len().div_ceil(LOOKED_AT).max(1);
    let chosen: Vec<usize> = (0..areas.len()).step_by(stride).collect();
    let areas: Vec<f32> = chosen.iter().map(|&vertex| areas[vertex]).collect();
    let points = |frame: u32| -> Vec<Vec3> {
        let pose = poses.frame(frame);
        chosen.iter().map(|&vertex| pose[vertex]).collect()
    };
    let shapes: Vec<Vec<Vec3>> = frames.par_iter().map(|&frame| points(frame)).collect();
    let Some(first) = shapes.first() else { return Vec::new() };
    let mut weights = areas.clone();
    let centre = mean(first, &weights);
    let mut middle: Vec<Vec3> = first.iter().map(|point| point - centre).collect();
    let mut found: Vec<BodyFrame> = Vec::new();
    for _ in 0..ROUNDS {
        found = shapes.par_iter().map(|shape| align(&middle, shape, &weights)).collect();
        let own: Vec<Vec<Vec3>> = shapes
            .par_iter()
            .zip(&found)
            .map(|(shape, frame)| shape.iter().map(|&point| frame.own(point)).collect())
            .collect();
        let count = own.len() as f32;
        for (vertex, middle) in middle.iter_mut().enumerate() {
            *middle = own.iter().map(|shape| shape[vertex]).sum::<Vec3>() / count;
            let variance = own.iter().map(|shape| shape[vertex].distance_squared(*middle)).sum::<f32>() / count;
            weights[vertex] = areas[vertex] / (variance + (MOVES * size).powi(2));
        }
        // As the first frame is turned, so that rounds do not turn the whole.
        let back = found[0].rotation;
        middle.iter_mut().for_each(|point| *point = back * *point);
    }
    let back = found[0].rotation.inverse();
    found.iter_mut().for_each(|frame| frame.rotation = (frame.rotation * back).normalize());
    found
}

fn mean(points: &[Vec3], weights: &[f32]) -> Vec3 {
    let sum: Vec3 = points.iter().zip(weights).map(|(point, weight)| *point * *weight).sum();
    sum / weights.iter().sum::<f32>().max(f32::MIN_POSITIVE)
}

/// The frame in which `own` lies nearest to `recorded`.
fn align(own: &[Vec3], recorded: &[Vec3], weights: &[f32]) -> BodyFrame {
    let (centre, middle) = (mean(recorded, weights), mean(own, weights));
    let mut sum = DMat3::ZERO;
    for ((own, recorded), weight) in own.iter().zip(recorded).zip(weights) {
        let (before, after) = (((own - middle) * *weight).as_dvec3(), (recorded - centre).as_dvec3());
        sum += DMat3::from_cols(after * before.x, after * before.y, after * before.z);
    }
    let rotation = best_rotation(&sum).as_quat();
    BodyFrame { rotation, centre: centre - rotation * middle }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kernels::random::signed;

    #[test]
    fn a_body_is_found_whatever_its_arm_does() {
        let body: Vec<Vec3> =
            (0..300).map(|k| Vec3::from_array(std::array::from_fn(|a| signed(1, 3 * k + a as u64)))).collect();
        let truth: Vec<BodyFrame> = (0..20)
            .map(|k| BodyFrame {
                rotation: Quat::from_rotation_y(0.2 * k as f32) * Quat::from_rotation_x(0.02 * k as f32),
                centre: Vec3::new(0.1 * k as f32, 1.0, 0.0),
            })
            .collect();
        let mut poses = Poses::new(300);
        for (k, frame) in truth.iter().enumerate() {
            let arm = |v: usize, p: Vec3| if v >= 240 { p + Vec3::Y * (0.3 * k as f32).sin() } else { p };
            let pose: Vec<Vec3> = body.iter().enumerate().map(|(v, &p)| frame.place(arm(v, p))).collect();
            poses.push(&pose);
        }
        let frames: Vec<u32> = (0..20).collect();
        let found = body_frames(&poses, &frames, &[1.0; 300], 2.0);
        for (found, truth) in found.iter().zip(&truth) {
            assert!(
                found.rotation.angle_between(truth.rotation) < 2e-3,
                "{}",
                found.rotation.angle_between(truth.rotation)
            );
            let apart = found.place(found.own(Vec3::ONE)).distance(Vec3::ONE);
            assert!(apart < 1e-5);
        }
    }
}
