//! Where the target goes: as the source does, by the ratio of what both cover.
//!
//! Thesis section 5.5.3 learns the steps from frame to frame; their errors add up. One ratio for ways along the ground, turns kept,
//! and affine maps for height and tilt, which do not add up, drift ten times less. What is left over is learned from the pose: one body's
//! frame may follow its hips and the other's its chest, which sway against each other. Of ways and turns only what sways about a
//! smoothed way is learned, so that this does not add up either.

use glam::{Quat, Vec2, Vec3, Vec3Swizzles};
use learn::dense::Matrix;
use learn::kernel::Kernel;
use learn::regression::{Regression, RegressionOptions};
use motion::smooth::smoothed;

use crate::pair::Pair;
use crate::subject::{Root, Subject};

/// Ways are compared over this long, in seconds: steps from frame to frame are lost in their errors.
const WINDOW: f32 = 0.8;
/// Less than this much of the body's size a window is no travel.
const STANDS: f32 = 0.03;
/// How sure it is without any pair that tilts are the same, in radians, and heights in proportion, in body sizes.
const TILTS: f64 = 0.03;
const RISES: f64 = 0.01;
/// How far from its axis a turn counts, in body sizes: 30 cm of 1.8 m.
pub const LEVER: f32 = 0.17;
/// Deviation of what smooths ways, in seconds: shorter than a step, longer than a sway.
const SMOOTH: f64 = 0.35;
/// Ways of fewer frames have no sway that is known.
const FEWEST: usize = 6;
/// What poses leave over is known this far from the nearest one that was seen, in deviations of all of them.
const KNOWN: f64 = 0.5;
/// Steps of the search for parameters.
const STEPS: usize = 40;

/// How the target's body goes, from how the source's does.
#[derive(Clone, Debug)]
pub struct Displacement {
    /// What a metre of the source is for the target.
    pub ratio: f64,
    height: Line,
    tilt: [Line; 3],
    /// From poses to what is left over: sway along x and z and turn, height and tilt, in metres at the lever.
    rest: Option<Regression>,
    /// The least and the most of each that is left over of the pairs.
    range: [[f32; 2]; 7],
    lever: f32,
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
    /// From pairs of frames, those of a sequence in its order; `learned` are the ones that are learned from, with the source's poses as
    /// numbers.
    pub fn fit(source: &Subject, target: &Subject, pairs: &[Pair], learned: &[(usize, Vec<f64>)], floor: f64) -> Self {
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
        let lever = LEVER * target.size;
        let mut own = Self { ratio, height, tilt, rest: None, range: [[0.0; 2]; 7], lever };
        let left = own.left_over(target, pairs, &roots);
        let inputs = Matrix::from_fn(learned.len(), learned[0].1.len(), |row, k| learned[row].1[k]);
        let outputs = Matrix::from_fn(learned.len(), 7, |row, k| left[learned[row].0][k]);
        let options =
            RegressionOptions { kernel: Kernel::SquaredExponential, floor, gain: f64::INFINITY, steps: STEPS };
        own.rest = Regression::train(&inputs, &outputs, &options);
        own.range = std::array::from_fn(|k| {
            let column = || left.iter().map(|row| row[k] as f32);
            [column().fold(f32::INFINITY, f32::min), column().fold(f32::NEG_INFINITY, f32::max)]
        });
        own
    }

    /// What ratio and lines leave over of each pair.
    fn left_over(&self, target: &Subject, pairs: &[Pair], roots: &[(Root, Root)]) -> Vec<[f64; 7]> {
        let guesses: Vec<Root> = roots.iter().map(|(source, _)| self.plain(source)).collect();
        let deviation = SMOOTH * f64::from(target.timeline.fps());
        let mut left = vec![[0.0; 7]; pairs.len()];
        let mut first = 0;
        while first < pairs.len() {
            let follows = |k: usize| pairs[k].target == pairs[k - 1].target + 1;
            let end = (first + 1..pairs.len()).find(|&k| !follows(k)).unwrap_or(pairs.len());
            if end - first >= FEWEST {
                let truth: Vec<Root> = roots[first..end].iter().map(|(_, root)| *root).collect();
                let sways = [sways(&truth, deviation), sways(&guesses[first..end], deviation)];
                for k in first..end {
                    let [a, b] = [sways[0][k - first], sways[1][k - first]];
                    let turn = (a[2] - b[2]) * self.lever;
                    left[k][..3].copy_from_slice(&[a[0] - b[0], a[1] - b[1], turn].map(f64::from));
                }
            }
            for k in first..end {
                let tilt = (roots[k].1.tilt - guesses[k].tilt) * self.lever;
                let rest = [roots[k].1.centre.y - guesses[k].centre.y, tilt.x, tilt.y, tilt.z];
                left[k][3..].copy_from_slice(&rest.map(f64::from));
            }
            first = end;
        }
        left
    }

    /// Where the target is when the source is at `root` in a pose with these numbers.
    pub fn at(&self, root: &Root, pose: &[f64]) -> Root {
        let plain = self.plain(root);
        let Some(rest) = &self.rest else { return plain };
        // No more than was seen, and the less the farther a pose is from all that were: those of other motions lead anywhere.
        let known = (-0.5 * (rest.far(pose) / KNOWN).powi(2)).exp() as f32;
        let by: Vec<f32> = rest
            .predict(pose)
            .iter()
            .zip(&self.range)
            .map(|(by, [low, high])| known * (*by as f32).clamp(*low, *high))
            .collect();
        let aside = Quat::from_rotation_y(plain.heading) * Vec3::new(by[0], by[3], by[1]);
        Root {
            heading: plain.heading + by[2] / self.lever,
            tilt: plain.tilt + Vec3::new(by[4], by[5], by[6]) / self.lever,
            centre: plain.centre + aside,
        }
    }

    /// The same by ratio and lines alone.
    fn plain(&self, root: &Root) -> Root {
        let ratio = self.ratio as f32;
        let tilt = Vec3::from_array(std::array::from_fn(|axis| self.tilt[axis].at(root.tilt[axis])));
        let centre = Vec3::new(root.centre.x * ratio, self.height.at(root.centre.y), root.centre.z * ratio);
        Root { heading: root.heading, tilt, centre }
    }
}

/// How far bodies are off their own smoothed way, along x and z as they face, and in heading.
fn sways(roots: &[Root], deviation: f64) -> Vec<[f32; 3]> {
    let way: Vec<Vec<f64>> =
        roots.iter().map(|root| [root.centre.x, root.centre.z, root.heading].map(f64::from).to_vec()).collect();
    let sway = |(own, smooth): (&Vec<f64>, Vec<f64>)| {
        let off = Vec3::new((own[0] - smooth[0]) as f32, 0.0, (own[1] - smooth[1]) as f32);
        let off = Quat::from_rotation_y(-smooth[2] as f32) * off;
        [off.x, off.z, (own[2] - smooth[2]) as f32]
    };
    way.iter().zip(smoothed(&way, deviation)).map(sway).collect()
}

/// The ratio of ways over windows of time, in the frames that are turned as the bodies face; `None` where they stand.
fn ratio(source: &Subject, target: &Subject, pairs: &[Pair], roots: &[(Root, Root)]) -> Option<f64> {
    let window = (WINDOW * target.timeline.fps()).round().max(1.0) as u32;
    let (mut both, mut own, mut begin) = (0.0, 0.0, 0);
    for end in 0..pairs.len() {
        let is_one = |a: usize, b: usize| {
            let sequence = |frame: u32| target.timeline.sequence_index(frame);
            pairs[b].target == pairs[a].target + (b - a) as u32
                && sequence(pairs[a].target) == sequence(pairs[b].target)
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
