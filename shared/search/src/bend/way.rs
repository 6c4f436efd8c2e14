//! A walk's way over the ground.

use glam::Vec2;
use kernels::scalar::exp;

use super::limits::{STEP, WALKS};
use crate::ground_pose::{GroundPose, turn_of};

/// Seconds over which sway evens out.
const SWAY: f32 = 0.3;

/// A walk's way without its sway.
#[derive(Clone, Debug)]
pub(super) struct Way {
    pub points: Vec<Vec2>,
    /// From each point to the next.
    pub steps: Vec<Vec2>,
    /// Steps of the body up to each point.
    pub budget: Vec<f32>,
    pub fps: f32,
}

impl Way {
    pub fn of(track: &[Vec2], fps: f32) -> Self {
        let points = smooth(track, SWAY * fps);
        let steps: Vec<Vec2> = points.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let last = steps.len() - 1;
        let speed = |at: usize| (steps[at.saturating_sub(1)] + steps[at.min(last)]).length() * fps / 2.0;
        let speeds: Vec<f32> = (0..points.len()).map(speed).collect();
        let mut budget = vec![0.0];
        for pair in speeds.windows(2) {
            let walks = ((pair[0] + pair[1]) / 2.0 / WALKS).min(1.0);
            budget.push(budget[budget.len() - 1] + walks / (STEP * fps));
        }
        Self { points, steps, budget, fps }
    }

    /// Where the way leads once it is turned so.
    pub fn rolled(&self, turns: &[f32]) -> Vec<Vec2> {
        let mut rolled = vec![self.points[0]];
        for (at, step) in self.steps.iter().enumerate() {
            let turn = (turns[at] + turns[at + 1]) / 2.0;
            let goes = GroundPose { turn: turn_of(turn), shift: Vec2::ZERO }.rotate(*step);
            rolled.push(rolled[at] + goes);
        }
        rolled
    }
}

/// Points, each the mean of those around it with the weights of a normal distribution; the ends stay, for beyond them points
/// are reflected.
pub(super) fn smooth(points: &[Vec2], sigma: f32) -> Vec<Vec2> {
    let last = points.len() as isize - 1;
    let at = |index: isize| match index {
        ..0 => 2.0 * points[0] - points[index.unsigned_abs().min(last as usize)],
        _ if index > last => 2.0 * points[last as usize] - points[(2 * last - index).max(0) as usize],
        _ => points[index as usize],
    };
    let weights: Vec<f32> =
        (0..=(3.0 * sigma) as isize).map(|away| exp(-0.5 * (away as f32 / sigma).powi(2))).collect();
    let total = 2.0 * weights.iter().sum::<f32>() - weights[0];
    let mean = |index: isize| {
        let mut sum = at(index) * weights[0];
        for (away, &weight) in (1..).zip(&weights[1..]) {
            sum += (at(index - away) + at(index + away)) * weight;
        }
        sum / total
    };
    (0..=last).map(mean).collect()
}
