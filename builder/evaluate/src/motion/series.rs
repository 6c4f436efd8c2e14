//! How a surface moves from frame to frame, as it is seen: ways, changes of ways, slide on the ground, stutter.

use actor::capture::Poses;
use glam::{Vec3, Vec3Swizzles};
use kernels::align::{Placement, align_heading, centre_of_mass};

use crate::statistics::percentile;

/// What is this close to the ground touches it, relative to the body's height: 2 cm of 1.8 m.
const TOUCHES: f32 = 0.011;
/// A way this much shorter than both its neighbours is a frozen frame, this much longer a doubled one.
const FROZEN: f64 = 0.5;
const DOUBLED: f64 = 1.8;

/// How a capture's surface is looked at.
#[derive(Clone, Copy, Debug)]
pub struct Look<'a> {
    /// Weights of the vertices for planar alignment, with the sum 1.
    weights: &'a [f32],
    /// Height of the ground in metres.
    pub ground: f32,
    /// Height of the body.
    pub height: f32,
    /// What is below this height touches the ground, in metres.
    touches: f32,
}

impl<'a> Look<'a> {
    /// The ground is where the lowest vertices are in most frames.
    #[must_use]
    pub fn of(poses: &Poses, weights: &'a [f32]) -> Self {
        let range =
            |pose: &[Vec3]| pose.iter().fold((f32::MAX, f32::MIN), |(low, high), p| (low.min(p.y), high.max(p.y)));
        let lowest: Vec<f64> = poses.iter().map(|pose| f64::from(range(pose).0)).collect();
        let ground = percentile(&lowest, 0.25).unwrap_or(0.0) as f32;
        let (low, high) = range(poses.iter().next().unwrap_or_default());
        let height = (high - low).max(0.0);
        Self { weights, ground, height, touches: ground + TOUCHES * height }
    }

    /// Whether a point touches the ground.
    #[must_use]
    pub fn touches(&self, point: Vec3) -> bool {
        point.y < self.touches
    }
}

/// Frames in a row. Interval t lies between frames t and t + 1; lengths are in metres.
#[derive(Clone, Debug, Default)]
pub struct Series {
    /// Root mean square way of the vertices in each interval.
    pub way: Vec<f64>,
    /// The same once both frames are aligned in the plane: the motion in place.
    pub in_place: Vec<f64>,
    /// Root mean square change of the way at the frame after each interval but the last.
    pub change: Vec<f64>,
    /// Mean way along the ground of the vertices that touch it on both sides of each interval, where any do.
    pub slide: Vec<Option<f64>>,
    /// Height of the lowest vertex of each frame, from the ground.
    pub lowest: Vec<f64>,
    /// The last two frames, the later one last.
    last: Vec<Vec<Vec3>>,
}

impl Series {
    /// Adds the next frame.
    pub fn push(&mut self, pose: &[Vec3], look: &Look) {
        let lowest = pose.iter().fold(f32::MAX, |low, point| low.min(point.y));
        self.lowest.push(f64::from(lowest - look.ground));
        if let Some(before) = self.last.last() {
            self.way.push(root_mean_square(before, pose));
            self.in_place.push(in_place(before, pose, look.weights));
            self.slide.push(slide(before, pose, look.touches));
        }
        if let [earlier, before] = self.last.as_slice() {
            let turns = earlier.iter().zip(before).zip(pose).map(|((&e, &b), &p)| (p - b) - (b - e));
            self.change.push(mean_square(turns).sqrt());
            self.last.remove(0);
        }
        self.last.push(pose.to_vec());
    }

    /// Intervals that are stuck, and intervals that leap: between two others that are both at least twice as long, or both
    /// hardly more than half as long, as seen or in place. Ways below `least` are no motion to begin with.
    #[must_use]
    pub fn stutter(&self, least: f64) -> [Vec<usize>; 2] {
        let mut found = [Vec::new(), Vec::new()];
        for at in 1..self.way.len().saturating_sub(1) {
            let any = |is: &dyn Fn(f64, f64, f64) -> bool| {
                [&self.way, &self.in_place].iter().any(|ways| is(ways[at - 1], ways[at], ways[at + 1]))
            };
            if any(&|a, b, c| a.min(c) > least && b < FROZEN * a.min(c)) {
                found[0].push(at);
            }
            if any(&|a, b, c| a.max(c) > least && b > DOUBLED * a.max(c)) {
                found[1].push(at);
            }
        }
        found
    }
}

fn mean_square(ways: impl ExactSizeIterator<Item = Vec3>) -> f64 {
    let count = ways.len().max(1) as f64;
    ways.map(|way| f64::from(way.length_squared())).sum::<f64>() / count
}

fn root_mean_square(before: &[Vec3], after: &[Vec3]) -> f64 {
    mean_square(before.iter().zip(after).map(|(&b, &a)| a - b)).sqrt()
}

fn in_place(before: &[Vec3], after: &[Vec3], weights: &[f32]) -> f64 {
    let heading = align_heading(before, after, weights);
    let [from, to] = [after, before].map(|pose| centre_of_mass(pose, weights).xz());
    let mut aligned = after.to_vec();
    Placement::turning(heading, from, to).apply_all(&mut aligned);
    root_mean_square(before, &aligned)
}

fn slide(before: &[Vec3], after: &[Vec3], touches: f32) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0_u32);
    for (b, a) in before.iter().zip(after).filter(|(b, a)| b.y < touches && a.y < touches) {
        sum += f64::from(b.xz().distance(a.xz()));
        count += 1;
    }
    (count > 0).then(|| sum / f64::from(count))
}

#[cfg(test)]
mod tests {
    use super::*;

    const WEIGHTS: [f32; 3] = [0.4, 0.3, 0.3];

    fn pose(x: f32) -> Vec<Vec3> {
        vec![Vec3::new(x, 0.0, 0.0), Vec3::new(x, 1.0, 0.5), Vec3::new(x + 1.0, 1.8, 0.0)]
    }

    fn series(places: &[f32]) -> Series {
        let mut poses = Poses::new(3);
        poses.push(&pose(0.0));
        let look = Look::of(&poses, &WEIGHTS);
        let mut series = Series::default();
        places.iter().for_each(|&x| series.push(&pose(x), &look));
        series
    }

    #[test]
    fn a_body_that_only_travels_stands_in_place() {
        let series = series(&[0.0, 1.0, 2.0, 2.5]);
        assert_eq!(series.way, [1.0, 1.0, 0.5]);
        assert_eq!(series.change, [0.0, 0.5]);
        assert!(series.in_place.iter().all(|way| *way < 1e-6));
        // Only the first vertex is near the ground.
        assert_eq!(series.slide, [Some(1.0), Some(1.0), Some(0.5)]);
    }

    #[test]
    fn frozen_and_doubled_frames_are_found() {
        let places = [0.0, 1.0, 2.0, 2.1, 3.1, 4.1, 6.1, 7.1, 8.1];
        assert_eq!(series(&places).stutter(0.1), [vec![2], vec![5]]);
        assert_eq!(series(&places).stutter(2.0), [Vec::<usize>::new(), Vec::new()]);
        // A motion that only slows down and speeds up again does not stutter.
        let smooth = [0.0, 1.0, 1.8, 2.4, 2.9, 3.5, 4.3, 5.3];
        assert_eq!(series(&smooth).stutter(0.1), [Vec::<usize>::new(), Vec::new()]);
    }
}
