//! Which sequences are loops: their last frame goes on into the first as they go from frame to frame.
//!
//! Both distance and velocity must meet, measured by the sequence's own: the step from the last frame to the first must be
//! no longer than its long steps, and no more sudden than its sudden changes of speed. Steps are root mean squares over
//! the vertices, after the later pose is turned about the vertical and moved along the ground onto the earlier one, so
//! that where the actor walks does not matter.

use glam::{Vec2, Vec3};
use kernels::align::{Placement, align_heading, centre_of_mass};

/// A loop has at least as many frames.
const FEWEST: usize = 8;
/// A wrap may be this many times as long as all but one of ten steps are at most.
const LONGEST: f64 = 1.25;
/// A wrap may change speed this many times as much as all but one of ten frames do at most...
const MOST_SUDDEN: f64 = 2.0;
/// ...or this many times where the last frame is the first once more, as only loops are written.
const MOST_SUDDEN_REPEAT: f64 = 3.0;

/// Steps shorter than this part of the body's size are rounding.
const STILL: f64 = 1e-5;

/// How the end of a sequence meets its beginning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Meets {
    /// Not at all.
    No,
    /// In place, but with another speed.
    InPlace,
    /// In place and in speed: it is a loop.
    InStep,
}

/// How the end of the sequence `frames`, of `vertex_count` vertices each, meets its beginning; `repeats` where its last
/// frame is its first once more.
pub(super) fn meets(frames: &[Vec3], vertex_count: usize, weights: &[f32], repeats: bool) -> Meets {
    let mut poses: Vec<&[Vec3]> = frames.chunks_exact(vertex_count.max(1)).collect();
    if repeats {
        poses.pop();
    }
    let count = poses.len();
    if count < FEWEST {
        return Meets::No;
    }
    let measure = Measure { weights, total: weights.iter().map(|&w| f64::from(w)).sum() };
    let wrap = measure.step(poses[count - 1], poses[0]);
    let long = nine_tenths(poses.windows(2).map(|pair| measure.step(pair[0], pair[1])));
    // What does not move needs no loop.
    if long <= STILL * extent(poses[0]) || wrap > LONGEST * long {
        return Meets::No;
    }
    let changes = poses.windows(3).map(|three| measure.change([three[0], three[1], three[2]]));
    let sudden = nine_tenths(changes) * if repeats { MOST_SUDDEN_REPEAT } else { MOST_SUDDEN };
    let around = [[count - 2, count - 1, 0], [count - 1, 0, 1]];
    let in_step = around.iter().all(|three| measure.change(three.map(|k| poses[k])) <= sudden);
    if in_step { Meets::InStep } else { Meets::InPlace }
}

/// Diagonal of the box around `pose`.
fn extent(pose: &[Vec3]) -> f64 {
    let low = pose.iter().copied().reduce(Vec3::min).unwrap_or_default();
    let high = pose.iter().copied().reduce(Vec3::max).unwrap_or_default();
    low.as_dvec3().distance(high.as_dvec3())
}

/// What nine of ten values do not exceed.
fn nine_tenths(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() * 9 / 10).copied().unwrap_or(0.0)
}

/// Measures poses against each other.
struct Measure<'a> {
    weights: &'a [f32],
    total: f64,
}

impl Measure<'_> {
    /// How far `b` is from `a`, in metres.
    fn step(&self, a: &[Vec3], b: &[Vec3]) -> f64 {
        self.mean(a.iter().zip(self.onto(b, a)).map(|(&a, b)| b - a))
    }

    /// How much the step from the first pose to the second differs from that from the second to the third.
    fn change(&self, [a, b, c]: [&[Vec3]; 3]) -> f64 {
        let (before, after) = (self.onto(a, b), self.onto(c, b));
        self.mean(before.iter().zip(b).zip(after).map(|((&a, &b), c)| (c - b) - (b - a)))
    }

    /// `pose` turned and moved onto `target`.
    fn onto(&self, pose: &[Vec3], target: &[Vec3]) -> Vec<Vec3> {
        let mut moved = pose.to_vec();
        let heading = align_heading(target, pose, self.weights);
        let ground = |p: Vec3| Vec2::new(p.x, p.z);
        let from = ground(centre_of_mass(pose, self.weights));
        let to = ground(centre_of_mass(target, self.weights));
        Placement::turning(heading, from, to).apply_all(&mut moved);
        moved
    }

    fn mean(&self, differences: impl Iterator<Item = Vec3>) -> f64 {
        let squares = differences.zip(self.weights).map(|(d, &w)| f64::from(w) * d.as_dvec3().length_squared());
        (squares.sum::<f64>() / self.total.max(f64::MIN_POSITIVE)).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::TAU;

    const WEIGHTS: [f32; 4] = [0.25; 4];

    /// A tetrahedron whose tip swings by the phase, that turns and walks on.
    fn sequence(phases: impl Iterator<Item = f32>) -> Vec<Vec3> {
        let frames = phases.enumerate().flat_map(|(k, phase)| {
            let tip = Vec3::new(0.4 * (TAU * phase).sin(), 1.0 + 0.2 * (TAU * phase).cos(), 0.3);
            let pose = [Vec3::ZERO, Vec3::X, tip, Vec3::new(0.2, 0.1, 1.0)];
            let turn = glam::Quat::from_rotation_y(0.1 * k as f32);
            pose.map(|p| turn * p + Vec3::X * 0.3 * k as f32)
        });
        frames.collect()
    }

    fn found(phases: impl Iterator<Item = f32>, repeats: bool) -> Meets {
        meets(&sequence(phases), 4, &WEIGHTS, repeats)
    }

    #[test]
    fn a_cycle_is_a_loop_wherever_it_walks() {
        let cycle = |count: usize| (0..count).map(move |k| k as f32 / 24.0);
        assert_eq!(found(cycle(24), false), Meets::InStep);
        assert_eq!(found(cycle(48), false), Meets::InStep);
        // With the first frame once more at the end.
        assert_eq!(found(cycle(25), true), Meets::InStep);
        assert_eq!(found(cycle(18), false), Meets::No);
        assert_eq!(found(cycle(31), false), Meets::No);
    }

    #[test]
    fn what_turns_back_at_the_wrap_meets_in_place_only() {
        let there_and_back = (0..24).map(|k| if k < 12 { k as f32 / 48.0 } else { (23 - k) as f32 / 48.0 });
        assert_eq!(found(there_and_back, false), Meets::InPlace);
        // A pendulum turns back without a jerk.
        let pendulum = (0..24).map(|k| 0.1 * (TAU * k as f32 / 24.0).cos());
        assert_eq!(found(pendulum, false), Meets::InStep);
    }

    #[test]
    fn stills_and_short_clips_are_no_loops() {
        assert_eq!(found((0..24).map(|_| 0.3), false), Meets::No);
        assert_eq!(found((0..7).map(|k| k as f32 / 7.0), false), Meets::No);
        assert_eq!(meets(&[], 4, &WEIGHTS, false), Meets::No);
    }
}
