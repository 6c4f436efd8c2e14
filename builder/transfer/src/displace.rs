//! Where the target goes: as the source does, by the ratio of what both cover.
//!
//! Thesis section 5.5.3 learns the steps from frame to frame; their errors add up. One ratio for ways along the ground, turns kept,
//! and affine maps for height and tilt, which do not add up, drift ten times less.

use glam::{Quat, Vec2, Vec3, Vec3Swizzles};

use crate::pair::Pair;
use crate::subject::{Root, Subject};

/// Ways are compared over this long, in seconds: steps from frame to frame are lost in their errors.
const WINDOW: f32 = 0.8;
/// Less than this much of the body's size a window is no travel.
const STANDS: f32 = 0.03;
/// How sure it is without any pair that tilts are the same, in radians, and heights in proportion, in body sizes.
const TILTS: f64 = 0.03;
const RISES: f64 = 0.01;

/// How the target's body goes, from how the source's does.
#[derive(Clone, Debug)]
pub struct Displacement {
    /// What a metre of the source is for the target.
    pub ratio: f64,
    height: Line,
    tilt: [Line; 3],
}

/// y = slope x + offset
#[derive(Clone, Copy, Debug)]
struct Line {
    slope: f64,
    offset: f64,
}

impl Line {
    /// The line through points, whose slope would be `slope` if x varied by less than `sure`.
    fn fit(points: &[(f64, f64)], slope: f64, sure: f64) -> Self {
        let count = points.len().max(1) as f64;
        let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / count;
        let (x, y) = (mean(|point| point.0), mean(|point| point.1));
        let both = points.iter().map(|point| (point.0 - x) * (point.1 - y)).sum::<f64>();
        let own = points.iter().map(|point| (point.0 - x).powi(2)).sum::<f64>();
        let prior = sure * sure * count;
        let slope = (both + prior * slope) / (own + prior);
        Self { slope, offset: y - slope * x }
    }

    fn at(&self, x: f32) -> f32 {
        (self.slope * f64::from(x) + self.offset) as f32
    }
}

impl Displacement {
    /// From pairs of frames, those of a sequence in its order.
    pub fn fit(source: &Subject, target: &Subject, pairs: &[Pair]) -> Self {
        let roots: Vec<(Root, Root)> =
            pairs.iter().map(|pair| (source.root_at(pair.source), target.roots[pair.target as usize])).collect();
        let points = |of: &dyn Fn(&Root) -> f32| -> Vec<(f64, f64)> {
            roots.iter().map(|(a, b)| (f64::from(of(a)), f64::from(of(b)))).collect()
        };
        let heights = points(&|root| root.centre.y);
        let middle = |of: fn(&(f64, f64)) -> f64| heights.iter().map(of).sum::<f64>();
        let taller = middle(|point| point.1) / middle(|point| point.0);
        let sizes = f64::from(target.size / source.size.max(f32::MIN_POSITIVE));
        // Heights above anything but the ground tell nothing.
        let fallback = if (0.5..2.0).contains(&(taller / sizes)) { taller } else { sizes };
        let ratio = ratio(source, target, pairs, &roots).unwrap_or(fallback);
        let height = Line::fit(&heights, ratio, RISES * f64::from(source.size));
        let tilt = std::array::from_fn(|axis| Line::fit(&points(&|root| root.tilt[axis]), 1.0, TILTS));
        Self { ratio, height, tilt }
    }

    /// Where the target is when the source is at `root`.
    pub fn at(&self, root: &Root) -> Root {
        let ratio = self.ratio as f32;
        let tilt = Vec3::from_array(std::array::from_fn(|axis| self.tilt[axis].at(root.tilt[axis])));
        let centre = Vec3::new(root.centre.x * ratio, self.height.at(root.centre.y), root.centre.z * ratio);
        Root { heading: root.heading, tilt, centre }
    }
}

/// The ratio of ways over windows of time, in the frames that are turned as the bodies face; `None` where they stand.
fn ratio(source: &Subject, target: &Subject, pairs: &[Pair], roots: &[(Root, Root)]) -> Option<f64> {
    let window = (WINDOW * target.timeline.fps()).round().max(1.0) as u32;
    let (mut both, mut own, mut begin) = (0.0, 0.0, 0);
    for end in 0..pairs.len() {
        let is_one = |a: usize, b: usize| {
            let sequence = |frame: u32| target.timeline.sequence_index(frame);
            pairs[b].target > pairs[a].target && sequence(pairs[a].target) == sequence(pairs[b].target)
        };
        while begin < end && (!is_one(begin, end) || pairs[end].target - pairs[begin].target > window) {
            begin += 1;
        }
        let same = |a: usize| source.timeline.sequence_index(pairs[a].source as u32);
        if begin == end || same(begin) != same(end) || 2 * (pairs[end].target - pairs[begin].target) < window {
            continue;
        }
        let way = |from: &Root, to: &Root| -> Vec2 {
            (Quat::from_rotation_y(-from.heading) * (to.centre - from.centre)).xz()
        };
        let (a, b) = (way(&roots[begin].0, &roots[end].0), way(&roots[begin].1, &roots[end].1));
        if a.length() > STANDS * source.size && b.length() > STANDS * target.size {
            both += f64::from(a.dot(b));
            own += f64::from(a.length_squared());
        }
    }
    let ratio = both / own;
    (own > 0.0 && ratio > 0.05 && ratio < 20.0).then_some(ratio)
}
