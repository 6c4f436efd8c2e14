//! How far variations go: what hardly moves is varied by a little at least, and nothing is stretched beyond a mark.
//!
//! Samples are in steps of the recorded motion, so that somebody who stands still would be varied by less than anybody sees. Their
//! differences are then lifted to what is asked for in metres: smoother, for what is slow in the recording would else shake, and
//! never beyond twice what the recording itself varies by, for more than that nobody has seen.

use std::ops::Range;

use glam::Vec3;

use crate::numbers::Numbers;
use crate::smooth::{ramp, smoothed};

/// How far variations are from the recording at least at an amount of 0.12, in body sizes, on average over the surface: 7.5 mm of 1.8 m. It
/// grows with the root of the amount: who stands still moves a little, whatever is asked for.
const LEAST: (f64, f64) = (0.12, 0.0042);
/// Nothing is lifted beyond so many times what the recording varies by.
const SEEN: f64 = 2.0;
/// Deviation of what smooths that which is lifted, in learned frames, for each time that it is lifted by, and at most.
const SMOOTH: (f64, f64) = (2.0, 8.0);
/// What is lifted comes in and goes out over so many learned frames, or half of its stretch: the longer, the less it is accelerated.
const RAMP: usize = 30;
/// Edges of a stretch change by this at most, on average, as a part of their lengths: mixtures of alternatives, and feet that stand, make up
/// to two fifths more of it.
const EDGES: f64 = 0.014;
/// Every so many learned frames are looked at for that.
const EVERY: usize = 3;

/// For each variation a row a learned frame: how its numbers differ from the recorded ones.
pub type Differences = Vec<Vec<Vec<f64>>>;

/// How far variations are from the recording at least, on a body of `size` metres.
pub fn least(amount: f64, size: f64) -> f64 {
    LEAST.1 * size * (amount / LEAST.0).sqrt()
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

/// How far variations are from the recording, on average over the surface and over frames that differ, in metres.
pub fn distance(differences: &Differences, numbers: &Numbers, recorded: &dyn Fn(u32) -> Vec<Vec3>) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for one in differences {
        for k in (0..one.len()).step_by(EVERY).filter(|&k| one[k].iter().any(|number| *number != 0.0)) {
            let was = recorded(numbers.frames[k]);
            let moved = numbers.moved(&was, k * numbers.stride as usize, &one[k]);
            sum +=
                moved.iter().zip(&was).map(|(a, b)| f64::from(a.distance(*b))).sum::<f64>() / was.len().max(1) as f64;
            count += 1.0;
        }
    }
    sum / f64::max(count, 1.0)
}

/// Draws the stretches of one variation nearer to the recording whose edges would change by more than the mark.
pub fn hold_edges(
    one: &mut [Vec<f64>],
    stretches: &[Range<usize>],
    numbers: &Numbers,
    triangles: &[[u32; 3]],
    recorded: &dyn Fn(u32) -> Vec<Vec3>,
) {
    for stretch in stretches {
        let (mut sum, mut count) = (0.0, 0.0);
        for k in stretch.clone().step_by(EVERY) {
            let was = recorded(numbers.frames[k]);
            sum += changes(triangles, &numbers.moved(&was, k * numbers.stride as usize, &one[k]), &was);
            count += 1.0;
        }
        let change = sum / f64::max(count, 1.0);
        if change > EDGES {
            scale_by(one[stretch.clone()].iter_mut(), EDGES / change);
        }
    }
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

/// Mean change of edges, as a part of their lengths; those that no triangle names first are left out.
fn changes(triangles: &[[u32; 3]], pose: &[Vec3], was: &[Vec3]) -> f64 {
    let change = |&[a, b, _]: &[u32; 3]| {
        let length = |pose: &[Vec3]| pose[a as usize].distance(pose[b as usize]);
        f64::from((length(pose) / length(was).max(1e-6) - 1.0).abs())
    };
    triangles.iter().map(change).sum::<f64>() / triangles.len().max(1) as f64
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
    fn what_hardly_moves_is_lifted_to_what_is_asked_for() {
        // One is `scale` metres.
        let lifted = |wanted: f64, most: f64, scale: f64| {
            let mut all = differences(most);
            lift(&mut all, std::slice::from_ref(&(0..60)), wanted, &|all| spread(all) * scale);
            assert!(all.iter().all(|one| one[0][0] == 0.0 && one[59][0] == 0.0), "ends are pinned");
            spread(&all) * scale
        };
        assert!((least(0.12, 1.8) - 0.00756).abs() < 1e-6 && least(0.25, 1.8) < 1.5 * least(0.12, 1.8));
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
}
