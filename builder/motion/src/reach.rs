//! How far variations go at the largest amount: what hardly moves is varied by a little at least, nothing is stretched or shaken beyond a mark, and variations
//! are no farther from each other than is meant.
//!
//! Samples are in steps of the recorded motion, so that somebody who stands still would be varied by less than anybody sees. Their
//! differences are then lifted to what is asked for in metres: smoother, for what is slow in the recording would else shake, and
//! never beyond twice what the recording itself varies by, for more than that nobody has seen. Whose steps are long is varied by
//! less than they say.

use std::ops::Range;

use actor::capture::Poses;
use glam::Vec3;
use kernels::topology::Topology;
use learn::dense::{Cholesky, Matrix};
use rayon::prelude::*;

use crate::numbers::Numbers;
use crate::smooth::{ramp, smoothed};

/// How far variations are from the recording at least at the largest amount, in body sizes, on average over the surface: 15.6 mm of 1.8 m.
const LEAST: f64 = 0.00875;
/// Nothing is lifted beyond so many times what the recording varies by.
const SEEN: f64 = 2.0;
/// Deviation of what smooths that which is lifted, in learned frames, for each time that it is lifted by, and at most.
const SMOOTH: (f64, f64) = (2.0, 8.0);
/// What is lifted comes in and goes out over so many learned frames, or half of its stretch: the longer, the less it is accelerated.
const RAMP: usize = 30;
/// Edges of a stretch change by this at most, on average, as a part of their lengths: mixtures of alternatives, and feet that stand, make up
/// to two fifths more of it.
const EDGES: f64 = 0.009;
/// The worst of a frame's edges change by this much at most, on average, and so many of them are looked at: an arm that is drawn far too long
/// hardly changes the mean over the body.
const TORN: f64 = 0.3;
const WORST: f64 = 0.02;
/// Learned frames before and after a frame that is drawn nearer for that, over which others are drawn nearer as well.
const EASED: usize = 6;
/// How firmly edges are held, beside the numbers: the first that is enough.
const FIRM: [f64; 6] = [0.1, 0.3, 1.0, 3.0, 10.0, 30.0];
/// Every so many learned frames are looked at for that.
const EVERY: usize = 3;
/// Edges that are looked at, at most.
const LOOKED_AT: usize = 800;
/// Two mixtures of alternatives are nearer to each other than this, root mean square over alternatives, in body sizes: 26 mm of 1.8 m. What would
/// be as far as this is drawn nearer by a sixth, what would be half as far by a sixtieth. What is played is less far apart, for many mixtures
/// are less off than the root of their mean square.
const APART: f64 = 0.0145;
/// A mixture's acceleration over that of the recording, before it is stored: rounding adds some of it.
const SHAKES: f64 = 1.12;
/// How firmly differences are kept from bending over time where they shake, in learned frames to the fourth power: the first that is enough, or
/// the last. The last leaves what changes over some ten frames.
const STEADY: [f64; 6] = [4.0, 16.0, 64.0, 256.0, 1024.0, 4096.0];
/// Halvings of the interval in which the share lies that shakes no more.
const HALVINGS: usize = 12;

/// For each variation a row a learned frame: how its numbers differ from the recorded ones.
pub type Differences = Vec<Vec<Vec<f64>>>;

/// How far variations of a body of `size` metres are from the recording at least, at the largest amount.
pub fn least(size: f64) -> f64 {
    LEAST * size
}

/// Lifts `differences` of a model, which are drawn in stretches, until they are `wanted` metres off; `distance` says how far they are.
pub fn lift(
    differences: &mut Differences,
    stretches: &[Range<usize>],
    wanted: f64,
    distance: &dyn Fn(&Differences) -> f64,
) {
    let found = distance(differences);
    if !(found > 0.0 && found < wanted) {
        return;
    }
    let deviation = (SMOOTH.0 * wanted / found).min(SMOOTH.1);
    for one in differences.iter_mut() {
        for stretch in stretches {
            let last = stretch.len() - 1;
            let ease = RAMP.min(stretch.len() / 2).max(1) as f64;
            let soft = smoothed(&one[stretch.clone()], deviation);
            for (k, (row, soft)) in one[stretch.clone()].iter_mut().zip(soft).enumerate() {
                let share = ramp(k.min(last - k) as f64 / ease);
                row.iter_mut().zip(soft).for_each(|(own, soft)| *own = share * soft);
            }
        }
    }
    // Rows vary by one in all in the recording.
    let gain = wanted / distance(differences).max(f64::MIN_POSITIVE);
    let seen = SEEN / spread(differences).max(f64::MIN_POSITIVE);
    scale_by(differences.iter_mut().flatten(), gain.min(seen));
}

/// Some edges of a body in the frames that a model learned, and their ends: enough to measure by.
pub struct Looked {
    numbers: Numbers,
    edges: Vec<[usize; 2]>,
    /// The ends of these edges as recorded, frame by frame.
    recorded: Vec<Vec<Vec3>>,
}

impl Looked {
    /// Of the body with these numbers.
    pub fn new(numbers: &Numbers, topology: &Topology, poses: &Poses) -> Self {
        let triangles = topology.triangles();
        let chosen = || triangles.iter().step_by(triangles.len().div_ceil(LOOKED_AT).max(1));
        let mut vertices: Vec<u32> = chosen().flat_map(|&[a, b, _]| [a, b]).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let place = |vertex: u32| vertices.binary_search(&vertex).unwrap_or(0);
        let edges = chosen().map(|&[a, b, _]| [place(a), place(b)]).collect();
        let some = |&frame: &u32| vertices.iter().map(|&vertex| poses.frame(frame)[vertex as usize]).collect();
        let recorded = numbers.frames.iter().map(some).collect();
        Self { numbers: numbers.thinned(&vertices), edges, recorded }
    }

    fn moved(&self, k: usize, row: &[f64]) -> Vec<Vec3> {
        self.numbers.moved(&self.recorded[k], k * self.numbers.stride as usize, row)
    }

    /// How far variations are from the recording, on average over the surface and over frames that differ, in metres.
    pub fn distance(&self, differences: &Differences) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for one in differences {
            for k in (0..one.len()).step_by(EVERY).filter(|&k| one[k].iter().any(|number| *number != 0.0)) {
                let was = &self.recorded[k];
                let apart = self.moved(k, &one[k]).iter().zip(was).map(|(a, b)| f64::from(a.distance(*b))).sum::<f64>();
                sum += apart / was.len().max(1) as f64;
                count += 1.0;
            }
        }
        sum / f64::max(count, 1.0)
    }

    /// Takes out of the stretches of one variation what changes edges by more than the marks: first what does so most for what it moves, then
    /// some of all; then what is left of frames that would be torn somewhere.
    pub fn hold_edges(&self, one: &mut [Vec<f64>], stretches: &[Range<usize>]) {
        for stretch in stretches {
            self.hold_mean(one, stretch);
            self.hold_worst(one, stretch);
        }
    }

    fn hold_mean(&self, one: &mut [Vec<f64>], stretch: &Range<usize>) {
        let found = self.change(one, stretch);
        if found > EDGES {
            let given = one[stretch.clone()].to_vec();
            let stiff = self.stiffness(stretch);
            let mut change = found;
            for firm in FIRM {
                let Some(soft) = softened(&given.iter().collect::<Vec<_>>(), &stiff, firm) else { break };
                one[stretch.clone()].clone_from_slice(&soft);
                change = self.change(one, stretch);
                if change <= EDGES {
                    break;
                }
            }
            if change > EDGES {
                scale_by(one[stretch.clone()].iter_mut(), EDGES / change);
            }
        }
    }

    /// Draws frames nearer to the recording whose worst edges change by more than the mark, and those around them less and less.
    fn hold_worst(&self, one: &mut [Vec<f64>], stretch: &Range<usize>) {
        let share = |k: usize| {
            let mut all = changes(&self.edges, &self.moved(k, &one[k]), &self.recorded[k]).collect::<Vec<f64>>();
            all.sort_unstable_by(|a, b| b.total_cmp(a));
            let worst = &all[..((WORST * all.len() as f64).ceil() as usize).min(all.len())];
            (TORN * worst.len() as f64 / worst.iter().sum::<f64>().max(f64::MIN_POSITIVE)).min(1.0)
        };
        let shares: Vec<f64> = stretch.clone().map(share).collect();
        if shares.iter().any(|share| *share < 1.0) {
            one[stretch.clone()].iter_mut().zip(eased(&shares)).for_each(|(row, share)| {
                row.iter_mut().for_each(|number| *number *= share);
            });
        }
    }

    /// How much edges change in a stretch of a variation, on average, as a part of their lengths.
    fn change(&self, one: &[Vec<f64>], stretch: &Range<usize>) -> f64 {
        let looked = || stretch.clone().step_by(EVERY);
        let mean = |k: usize| {
            let sum = changes(&self.edges, &self.moved(k, &one[k]), &self.recorded[k]).sum::<f64>();
            sum / self.edges.len().max(1) as f64
        };
        looked().map(mean).sum::<f64>() / looked().count().max(1) as f64
    }

    /// What numbers change edges by in a stretch, on average, over the mean of all numbers.
    fn stiffness(&self, stretch: &Range<usize>) -> Matrix {
        let width = self.numbers.components();
        let mut sum = Matrix::zeros(width, width);
        for k in stretch.clone().step_by(EVERY) {
            let was = &self.recorded[k];
            let way = |&[a, b]: &[usize; 2]| {
                let edge = was[a] - was[b];
                ([a, b], edge / edge.length_squared().max(1e-12))
            };
            let ways: Vec<([usize; 2], Vec3)> = self.edges.iter().map(way).collect();
            let own = self.numbers.along(k * self.numbers.stride as usize, &ways);
            sum.values_mut().iter_mut().zip(own.values()).for_each(|(sum, own)| *sum += own);
        }
        let mean = (0..width).map(|k| sum[(k, k)]).sum::<f64>() / width.max(1) as f64;
        sum.values_mut().iter_mut().for_each(|value| *value /= mean.max(f64::MIN_POSITIVE));
        sum
    }

    /// Draws all variations of a stretch nearer to the recording, by one share, where their mixtures would be too far from each other or shake, on
    /// a body of `size` metres.
    pub fn hold_apart(&self, differences: &mut Differences, stretches: &[Range<usize>], size: f64) {
        for stretch in stretches {
            let mut found = Spread::of(self, differences, stretch);
            // What bends most for how far it goes is taken out first: drawing all of it nearer would cost much more of what is seen.
            for firm in STEADY {
                if found.shakes(found.near(size)) <= SHAKES {
                    break;
                }
                differences.par_iter_mut().for_each(|one| straighten(&mut one[stretch.clone()], firm));
                found = Spread::of(self, differences, stretch);
            }
            let share = f64::min(found.near(size), found.steady());
            differences.iter_mut().for_each(|one| scale_by(one[stretch.clone()].iter_mut(), share));
        }
    }
}

/// What mixtures of a stretch's alternatives are like: with shares whose squares add up to one, each differs on average by the mean square of
/// them.
struct Spread {
    /// How far two mixtures are from each other, in metres, on average over the surface.
    apart: f64,
    /// The squares of the recorded acceleration of each vertex in each inner frame, and of that of differences.
    bends: Vec<[f64; 2]>,
}

impl Spread {
    fn of(looked: &Looked, differences: &Differences, stretch: &Range<usize>) -> Self {
        let was = &looked.recorded[stretch.clone()];
        let vertices = was.first().map_or(0, Vec::len);
        let mut squares = vec![0.0; vertices * was.len()];
        let mut bends = vec![[0.0; 2]; vertices * was.len().saturating_sub(2)];
        let bend = |rows: &[Vec<Vec3>], k: usize, v: usize| {
            f64::from((rows[k][v] + rows[k + 2][v] - 2.0 * rows[k + 1][v]).length_squared())
        };
        for (at, bends) in bends.iter_mut().enumerate() {
            bends[0] = bend(was, at / vertices, at % vertices);
        }
        let share = 1.0 / differences.len().max(1) as f64;
        for one in differences {
            let off = |k: usize| -> Vec<Vec3> {
                let moved = looked.moved(k, &one[k]);
                moved.iter().zip(&looked.recorded[k]).map(|(own, was)| *own - *was).collect()
            };
            let off: Vec<Vec<Vec3>> = stretch.clone().map(off).collect();
            for (sum, off) in squares.iter_mut().zip(off.iter().flatten()) {
                *sum += share * f64::from(off.length_squared());
            }
            for (at, bends) in bends.iter_mut().enumerate() {
                bends[1] += share * bend(&off, at / vertices, at % vertices);
            }
        }
        let apart = squares.iter().map(|square| (2.0 * square).sqrt()).sum::<f64>() / squares.len().max(1) as f64;
        Self { apart, bends }
    }

    /// The share of the differences that is near enough on a body of `size` metres: as it is while that is little, and never more than the mark.
    fn near(&self, size: f64) -> f64 {
        let far = self.apart / (APART * size).max(f64::MIN_POSITIVE);
        (1.0 + far.powi(4)).powf(-0.25)
    }

    /// The acceleration with a share of the differences over that of the recording.
    fn shakes(&self, share: f64) -> f64 {
        let sum = |share: f64| self.bends.iter().map(|[was, own]| (was + share * share * own).sqrt()).sum::<f64>();
        sum(share) / sum(0.0).max(f64::MIN_POSITIVE)
    }

    /// The largest share, up to one, of the differences that shakes no more than the mark.
    fn steady(&self) -> f64 {
        if self.shakes(1.0) <= SHAKES {
            return 1.0;
        }
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            *(if self.shakes(middle) <= SHAKES { &mut low } else { &mut high }) = middle;
        }
        low
    }
}

/// The rows x nearest to those d of a stretch that bend little over time: those with least (x - d)^2 + firm (second differences of x)^2, on the
/// recording at both ends and beyond them.
fn straighten(rows: &mut [Vec<f64>], firm: f64) {
    let inner = rows.len().saturating_sub(2);
    let width = rows.first().map_or(0, Vec::len);
    // The product of second differences with themselves.
    let bend = |row: usize, column: usize| match row.abs_diff(column) {
        0 => 1.0 + 6.0 * firm,
        1 => -4.0 * firm,
        2 => firm,
        _ => 0.0,
    };
    let Some(factor) = Cholesky::of(&Matrix::from_fn(inner, inner, bend)).filter(|_| inner > 0) else { return };
    let found = factor.solve(&Matrix::from_fn(inner, width, |row, column| rows[row + 1][column]));
    (0..inner).for_each(|row| rows[row + 1].copy_from_slice(found.row(row)));
}

/// The rows x nearest to the given ones d: those with least (x - d)^2 + firm x' A x, of which A is about the first numbers alone.
pub fn softened(given: &[&Vec<f64>], stiff: &Matrix, firm: f64) -> Option<Vec<Vec<f64>>> {
    let width = stiff.rows();
    let normal = Matrix::from_fn(width, width, |row, column| {
        firm * stiff[(row, column)] + if row == column { 1.0 } else { 0.0 }
    });
    let columns = Matrix::from_fn(width, given.len(), |row, column| given[column][row]);
    let found = Cholesky::of(&normal)?.solve(&columns);
    let row = |(k, given): (usize, &&Vec<f64>)| {
        given.iter().enumerate().map(|(c, own)| if c < width { found[(c, k)] } else { *own }).collect()
    };
    Some(given.iter().enumerate().map(row).collect())
}

/// The root of the mean square of what differs, over frames that do.
fn spread(differences: &Differences) -> f64 {
    let square = |row: &Vec<f64>| row.iter().map(|number| number * number).sum::<f64>();
    let squares = differences.iter().flatten().map(square).filter(|square| *square > 0.0);
    let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), square| (sum + square, count + 1.0));
    (sum / f64::max(count, 1.0)).sqrt()
}

fn scale_by<'a>(rows: impl Iterator<Item = &'a mut Vec<f64>>, factor: f64) {
    rows.flatten().for_each(|number| *number *= factor);
}

/// Change of edges, each as a part of its length.
fn changes(edges: &[[usize; 2]], pose: &[Vec3], was: &[Vec3]) -> impl Iterator<Item = f64> {
    edges.iter().map(|&[a, b]| {
        let length = |pose: &[Vec3]| pose[a].distance(pose[b]);
        f64::from((length(pose) / length(was).max(1e-6) - 1.0).abs())
    })
}

/// Shares that change by steps, none larger than given: the least around each, then the mean of those around.
fn eased(shares: &[f64]) -> Vec<f64> {
    let around = |k: usize| k.saturating_sub(EASED)..(k + EASED + 1).min(shares.len());
    let least = |k: usize| shares[around(k)].iter().copied().fold(1.0, f64::min);
    let least: Vec<f64> = (0..shares.len()).map(least).collect();
    (0..shares.len()).map(|k| least[around(k)].iter().sum::<f64>() / around(k).len() as f64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two variations of 60 frames that differ by `most` at their middle, of one number.
    fn differences(most: f64) -> Differences {
        let row = |k: usize| vec![most * (std::f64::consts::PI * k as f64 / 59.0).sin()];
        let one: Vec<Vec<f64>> = (0..60).map(row).collect();
        vec![one.clone(), one.into_iter().map(|row| vec![-row[0]]).collect()]
    }

    #[test]
    fn frames_around_one_that_is_drawn_nearer_are_so_by_steps() {
        let mut shares = vec![1.0; 60];
        shares[30] = 0.2;
        let eased = eased(&shares);
        assert!(eased.iter().zip(&shares).all(|(eased, share)| eased <= share), "{eased:?}");
        assert!(eased.windows(2).all(|two| (two[1] - two[0]).abs() < 0.1), "{eased:?}");
        assert!((eased[30] - 0.2).abs() < 1e-12 && eased[10] == 1.0);
    }

    #[test]
    fn what_hardly_moves_is_lifted_to_what_is_asked_for() {
        // One is `scale` metres.
        let lifted = |wanted: f64, most: f64, scale: f64| {
            let mut all = differences(most);
            lift(&mut all, std::slice::from_ref(&(0..60)), wanted, &|all| spread(all) * scale);
            assert!(all.iter().all(|one| one[0][0] == 0.0 && one[59][0] == 0.0), "ends are pinned");
            spread(&all) * scale
        };
        // It varies by 2 cm in the recording, and was varied by a fraction of a millimetre.
        assert!((lifted(0.0065, 0.02, 0.02) - 0.0065).abs() < 1e-6);
        // Not beyond twice of what was seen.
        assert!((lifted(0.0065, 0.02, 0.002) - 0.004).abs() < 1e-6);
        // What moves enough stays as it is, and nothing stays nothing.
        let before = differences(0.1);
        let mut after = before.clone();
        lift(&mut after, std::slice::from_ref(&(0..60)), 0.0065, &|all| spread(all) * 0.2);
        assert_eq!(after, before);
        assert_eq!(lifted(0.0065, 0.0, 0.02), 0.0);
    }

    #[test]
    fn what_bends_goes_and_what_is_slow_stays() {
        let wave = |waves: f64| -> Vec<Vec<f64>> {
            // At rest at both ends.
            let at = |k: usize| 0.5 - 0.5 * (std::f64::consts::TAU * waves * k as f64 / 59.0).cos();
            (0..60).map(|k| vec![at(k)]).collect()
        };
        let left = |waves: f64, firm: f64| {
            let mut rows = wave(waves);
            straighten(&mut rows, firm);
            assert!(rows[0][0] == 0.0 && rows[59][0].abs() < 1e-12, "ends are pinned");
            let bends =
                |rows: &[Vec<f64>]| rows.windows(3).map(|w| (w[0][0] + w[2][0] - 2.0 * w[1][0]).powi(2)).sum::<f64>();
            (bends(&rows) / bends(&wave(waves))).sqrt()
        };
        assert!(left(1.0, 256.0) > 0.8 && left(10.0, 256.0) < 0.1, "{} {}", left(1.0, 256.0), left(10.0, 256.0));
        // Every entry by hand: (1 + 6 firm) x = d for one free row.
        let mut three = vec![vec![0.0], vec![7.0], vec![0.0]];
        straighten(&mut three, 1.0);
        assert!((three[1][0] - 1.0).abs() < 1e-12);
        straighten(&mut three[..2], 1.0);
        assert!((three[1][0] - 1.0).abs() < 1e-12, "nothing is free");
    }

    #[test]
    fn what_shakes_is_drawn_nearer_until_it_does_not() {
        let spread = |square: f64| Spread { apart: 0.0, bends: vec![[1.0, square]; 5] };
        assert_eq!(spread(0.1).steady(), 1.0);
        let share = spread(4.0).steady();
        let shakes = (1.0 + 4.0 * share * share).sqrt();
        assert!(shakes <= SHAKES && shakes > SHAKES - 1e-3, "{shakes}");
    }
}
