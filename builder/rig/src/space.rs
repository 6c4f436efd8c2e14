//! The learned space of a capture: the few ways in which its poses differ (Tejera et al. (2013), III-B).
//!
//! Principal components of aligned poses, within what some recorded frames span: those that the ones before explain least, by
//! pivoted Cholesky. Of the built-in performer 64 frames keep 99.8 % of what moves, so that a list of frames and some shares of them
//! stand for modes of megabytes.

use actor::capture::Poses;
use editing::space::{SHARE_STEPS, StoredMode, StoredSpace, difference};
use glam::Vec3;
use kernels::topology::Topology;
use learn::symmetric::eigen;
use rayon::prelude::*;

/// Frames that are looked at, and vertices of each, at most.
const LOOKED_AT: usize = 480;
const SAMPLES: usize = 4000;
/// What differs from the frames before by less than this, root mean square in metres, is no frame of its own.
const LEAST: f64 = 5e-4;
/// Modes whose variance is a smaller part of the first one's are rounding.
const SMALLEST: f64 = 1e-7;

/// How much is learned.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SpaceOptions {
    /// Modes at most.
    pub modes: usize,
    /// Frames that they are made of, at most.
    pub frames: usize,
    /// No more modes than are needed to miss the capture by so much: root mean square, as a share of its size.
    pub misfit: f32,
}

impl Default for SpaceOptions {
    fn default() -> Self {
        Self { modes: 48, frames: 64, misfit: 0.003 }
    }
}

/// A space that was learned.
#[derive(Clone, Debug, PartialEq)]
pub struct Learned {
    /// The space.
    pub space: StoredSpace,
    /// What it misses of the capture: root mean square in metres.
    pub misfit: f32,
    /// What its reference pose misses.
    pub moves: f32,
}

/// The space of `poses`, which are numbered as `frames` says; `None` where nothing moves.
#[must_use]
pub fn learn_space(topology: &Topology, poses: &Poses, frames: &[u32], options: &SpaceOptions) -> Option<Learned> {
    let weights = topology.weights();
    let step = frames.len().div_ceil(LOOKED_AT).max(1);
    let looked_at: Vec<u32> = frames.iter().copied().step_by(step).collect();
    let n = poses.vertex_count();
    let sampled: Vec<usize> = (0..n).step_by(n.div_ceil(SAMPLES).max(1)).collect();
    let first = *looked_at.first()?;
    let rows = |reference: u32| -> Vec<Vec<Vec3>> {
        let row = |&frame: &u32| {
            let moved = difference(poses.frame(reference), poses.frame(frame), weights);
            sampled.iter().map(|&vertex| moved[vertex]).collect()
        };
        looked_at.par_iter().map(row).collect()
    };
    let reference = looked_at[middle(&rows(first))];
    let rows = rows(reference);
    if !rows.iter().flatten().all(|moved| moved.is_finite()) {
        return None;
    }
    let count = rows.len() as f64;
    let samples = sampled.len() as f64;
    let moves = (rows.iter().map(|row| dot(row, row)).sum::<f64>() / count / samples).sqrt();
    let most = options.frames.clamp(2, editing::space::MOST_FRAMES) - 1;
    let Spanned { pivots, lower, left } = span(&rows, most, LEAST * LEAST * samples);
    let m = pivots.len();
    if m == 0 {
        return None;
    }
    let mean: Vec<f64> = (0..m).map(|k| lower.iter().map(|row| row[k]).sum::<f64>() / count).collect();
    let covariance: Vec<f64> = (0..m * m)
        .map(|at| {
            let (a, b) = (at / m, at % m);
            lower.iter().map(|row| (row[a] - mean[a]) * (row[b] - mean[b])).sum::<f64>() / count
        })
        .collect();
    let found = eigen(&covariance, m);
    let beyond = left.iter().sum::<f64>() / count;
    let enough = (f64::from(options.misfit * size(poses.frame(reference)))).powi(2) * samples;
    let missed = |kept: usize| found.values[kept..].iter().sum::<f64>().max(0.0) + beyond;
    let most = options.modes.clamp(1, editing::space::MOST_MODES).min(m);
    let kept = (1..most).find(|&kept| missed(kept) <= enough).unwrap_or(most);
    let kept = (1..=kept).take_while(|k| found.values[k - 1] > SMALLEST * found.values[0]).last()?;
    let triangle: Vec<&[f64]> = pivots.iter().map(|&pivot| &lower[pivot][..m]).collect();
    let modes = (0..kept).map(|k| stored(&shares(&triangle, &found.vectors[k]), found.values[k]));
    let frames = std::iter::once(reference).chain(pivots.iter().map(|&pivot| looked_at[pivot])).collect();
    let space = StoredSpace { frames, modes: modes.collect::<Option<_>>()? };
    Some(Learned { space, misfit: (missed(kept) / samples).sqrt() as f32, moves: moves as f32 })
}

/// What some rows span, and where in it all of them are.
struct Spanned {
    /// The rows that span it.
    pivots: Vec<usize>,
    /// By row its coordinates along the axes that the pivots bring, one after the other.
    lower: Vec<Vec<f64>>,
    /// By row what it has beyond, squared.
    left: Vec<f64>,
}

/// At most `most` rows that span the others best, none of which has less than `least` beyond those before it: Cholesky with pivots.
fn span(rows: &[Vec<Vec3>], most: usize, least: f64) -> Spanned {
    let mut left: Vec<f64> = rows.par_iter().map(|row| dot(row, row)).collect();
    let mut lower = vec![Vec::with_capacity(most); rows.len()];
    let mut pivots = Vec::new();
    while pivots.len() < most {
        let pivot = (0..left.len()).fold(0, |best, k| if left[k] > left[best] { k } else { best });
        if left[pivot].is_nan() || left[pivot] <= least || pivots.contains(&pivot) {
            break;
        }
        let root = left[pivot].sqrt();
        let of_pivot: Vec<f64> = lower[pivot].clone();
        lower.par_iter_mut().zip(rows).zip(&mut left).for_each(|((own, row), left)| {
            let known: f64 = own.iter().zip(&of_pivot).map(|(a, b): (&f64, &f64)| a * b).sum();
            let along = (dot(row, &rows[pivot]) - known) / root;
            own.push(along);
            *left = (*left - along * along).max(0.0);
        });
        left[pivot] = 0.0;
        pivots.push(pivot);
    }
    Spanned { pivots, lower, left }
}

/// The shares of the pivots that make the direction `axis` of the coordinates: the solution of `L^T s = axis`.
fn shares(lower: &[&[f64]], axis: &[f64]) -> Vec<f64> {
    let mut shares = axis.to_vec();
    for k in (0..shares.len()).rev() {
        let known: f64 = (k + 1..shares.len()).map(|j| lower[j][k] * shares[j]).sum();
        shares[k] = (shares[k] - known) / lower[k][k];
    }
    shares
}

/// A mode in whole steps; `None` where there is no finite one.
fn stored(shares: &[f64], variance: f64) -> Option<StoredMode> {
    let largest = shares.iter().fold(0.0_f64, |most, share| most.max(share.abs()));
    let (step, variance) = ((largest / f64::from(SHARE_STEPS)) as f32, variance as f32);
    let positive = |number: f32| number.is_finite() && number > 0.0;
    let whole = |share: &f64| (share / f64::from(step)).round().clamp(-2047.0, 2047.0) as i16;
    (positive(step) && positive(variance)).then(|| StoredMode {
        variance,
        step,
        shares: shares.iter().map(whole).collect(),
    })
}

/// The row that is nearest to the mean of all.
fn middle(rows: &[Vec<Vec3>]) -> usize {
    let count = rows.len() as f32;
    let mean: Vec<Vec3> = (0..rows[0].len()).map(|v| rows.iter().map(|row| row[v] / count).sum::<Vec3>()).collect();
    let off = |row: &Vec<Vec3>| -> f64 { row.iter().zip(&mean).map(|(a, b)| f64::from(a.distance_squared(*b))).sum() };
    let off: Vec<f64> = rows.par_iter().map(off).collect();
    (0..off.len()).fold(0, |best, k| if off[k] < off[best] { k } else { best })
}

fn dot(a: &[Vec3], b: &[Vec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| f64::from(a.dot(*b))).sum()
}

fn size(pose: &[Vec3]) -> f32 {
    let low = pose.iter().copied().reduce(Vec3::min).unwrap_or_default();
    let high = pose.iter().copied().reduce(Vec3::max).unwrap_or_default();
    (high - low).max_element()
}

#[cfg(test)]
mod tests {
    use kernels::random::signed;

    use super::*;

    const COUNT: usize = 40;

    /// Poses of a ribbon that moves in `ways` ways, each half as far as the one before, turned and moved about.
    fn capture(ways: usize, frames: u32) -> (Topology, Poses) {
        let at = |v: usize| Vec3::new((v / 2) as f32 * 0.1, (v % 2) as f32 * 0.1, 0.0);
        let triangles =
            (0..COUNT as u32 / 2 - 1).flat_map(|k| [[2 * k, 2 * k + 2, 2 * k + 1], [2 * k + 1, 2 * k + 2, 2 * k + 3]]);
        let topology = Topology::new(COUNT as u32, triangles.collect(), vec![1.0; COUNT]).unwrap();
        let mut poses = Poses::new(COUNT);
        for frame in 0..u64::from(frames) {
            let turn = glam::Quat::from_rotation_y(0.3 * signed(7, frame));
            let to = Vec3::new(signed(8, frame), 0.0, signed(9, frame));
            let amounts: Vec<f32> = (0..ways as u64).map(|way| signed(way, frame) * 0.5_f32.powi(way as i32)).collect();
            let pose: Vec<Vec3> = (0..COUNT)
                .map(|v| {
                    // Up and down alone: where the body is, and which way it faces, does not depend on it.
                    let lift = |way: usize| (v as f32 * 0.16 * (way + 1) as f32).cos();
                    let y: f32 = amounts.iter().enumerate().map(|(way, amount)| 0.1 * amount * lift(way)).sum();
                    turn * (at(v) + Vec3::Y * y) + to
                })
                .collect();
            poses.push(&pose);
        }
        (topology, poses)
    }

    #[test]
    fn the_ways_in_which_it_moves_are_found() {
        let (topology, poses) = capture(3, 50);
        let frames: Vec<u32> = (0..50).collect();
        let learned =
            learn_space(&topology, &poses, &frames, &SpaceOptions { misfit: 0.0, ..SpaceOptions::default() }).unwrap();
        assert_eq!((learned.space.modes.len(), learned.space.frames.len()), (3, 4), "{learned:?}");
        assert!(learned.misfit < 5e-4 && learned.moves > 0.02, "{learned:?}");
        assert_eq!(learned.space.check(50), Ok(()));
        let of: Vec<Vec<Vec3>> = learned.space.frames.iter().map(|&frame| poses.frame(frame).to_vec()).collect();
        let space = learned.space.space(&of, topology.weights()).unwrap();
        // Modes are as long as one metre over all vertices, and stand on each other, but for what rounding does.
        for (a, one) in space.modes().iter().enumerate() {
            for (b, other) in space.modes().iter().enumerate() {
                let wanted = if a == b { 1.0 } else { 0.0 };
                assert!((dot(one, other) - wanted).abs() < 0.02, "{a} {b}: {}", dot(one, other));
            }
        }
        // A frame that was not kept is a sum of them.
        let off: Vec<Vec3> = difference(&of[0], poses.frame(33), topology.weights());
        let mut rest = off.clone();
        for mode in space.modes() {
            let share = dot(&off, mode) as f32;
            rest.iter_mut().zip(mode).for_each(|(rest, &moved)| *rest -= moved * share);
        }
        assert!((dot(&rest, &rest) / COUNT as f64).sqrt() < 2e-3, "{:?}", dot(&rest, &rest));
        // Less is enough where more may be missed.
        let coarse =
            learn_space(&topology, &poses, &frames, &SpaceOptions { misfit: 0.02, ..SpaceOptions::default() }).unwrap();
        assert!(coarse.space.modes.len() < 3 && coarse.misfit > learned.misfit, "{coarse:?}");
    }

    #[test]
    fn what_does_not_move_has_none() {
        let (topology, poses) = capture(0, 6);
        assert_eq!(learn_space(&topology, &poses, &[0, 1, 2, 3, 4, 5], &SpaceOptions::default()), None);
        let (topology, poses) = capture(2, 1);
        assert_eq!(learn_space(&topology, &poses, &[0], &SpaceOptions::default()), None);
        assert_eq!(learn_space(&topology, &poses, &[], &SpaceOptions::default()), None);
    }
}
