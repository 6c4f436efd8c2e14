//! How well few dimensions hold a motion, and how long learning them takes (thesis figure 6.4).

use std::time::Instant;

use ::motion::numbers::Numbers;
use actor::capture::Capture;
use actor::timeline::Sequence;
use learn::dense::Matrix;
use learn::gpdm::{Gpdm, GpdmOptions};
use learn::symmetric::eigen;

/// Frames a second that are learned from, as variations do.
const LEARNED: f32 = 25.0;
/// Frames of a model, as variations have them at most.
const MOST: usize = 150;
/// Every so many learned frames are looked at.
const EVERY: usize = 3;

/// How far frames are off when few numbers stand for them.
#[derive(Clone, Copy, Debug)]
pub struct Held {
    /// Dimensions.
    pub dimensions: usize,
    /// Mean distance of a vertex, in millimetres: of a Gaussian process dynamical model, and of principal components.
    pub millimetres: [f64; 2],
}

/// The numbers of a sequence's first frames; `None` where it is too short or does not move.
pub fn numbers_of(capture: &Capture, sequence: &Sequence, most: usize) -> Option<Numbers> {
    let fps = capture.timeline.fps();
    let stride = (fps / LEARNED).round().max(1.0) as u32;
    let end = sequence.end_frame().min(sequence.first_frame + most as u32 * stride);
    Numbers::of(&capture.poses, capture.topology.weights(), sequence.first_frame..end, stride, fps)
}

/// How well `dimensions` numbers hold a sequence.
pub fn held(capture: &Capture, sequence: &Sequence, dimensions: &[usize]) -> Vec<Held> {
    let Some(numbers) = numbers_of(capture, sequence, MOST) else { return Vec::new() };
    let count = numbers.rows.rows();
    let components = principal(&numbers.rows);
    let of = |&dimensions: &usize| {
        let options = GpdmOptions { dimensions, ..GpdmOptions::default() };
        let model = Gpdm::train(numbers.rows.clone(), &[count], &options)?;
        let learned = |row: usize| model.frame(model.places.row(row));
        let projected = |row: usize| project(numbers.rows.row(row), &components, dimensions);
        let millimetres = [off(capture, &numbers, learned), off(capture, &numbers, projected)];
        Some(Held { dimensions, millimetres })
    };
    dimensions.iter().filter_map(of).collect()
}

/// Frames that a model of several sequences is learned from, and the seconds of it.
pub fn training(capture: &Capture, frames: usize) -> Option<(usize, f64)> {
    let mut lengths = Vec::new();
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for sequence in capture.timeline.sequences() {
        let left = frames - rows.len();
        let Some(numbers) = numbers_of(capture, sequence, left.min(MOST)).filter(|_| left > 2) else { continue };
        lengths.push(numbers.rows.rows());
        rows.extend((0..numbers.rows.rows()).map(|row| numbers.rows.row(row).to_vec()));
    }
    // Sequences have other numbers of components: time is what matters, and it does not depend on them.
    let width = rows.iter().map(Vec::len).min()?;
    let all = Matrix::from_fn(rows.len(), width, |row, column| rows[row][column]);
    let start = Instant::now();
    Gpdm::train(all, &lengths, &GpdmOptions { dimensions: 3, ..GpdmOptions::default() })?;
    Some((rows.len(), start.elapsed().as_secs_f64()))
}

/// The principal components of centred rows, the largest first.
fn principal(rows: &Matrix) -> Vec<Vec<f64>> {
    let transposed = rows.transposed();
    eigen(transposed.times_transposed(&transposed).values(), rows.columns()).vectors
}

/// What the first `dimensions` components keep of a row.
fn project(row: &[f64], components: &[Vec<f64>], dimensions: usize) -> Vec<f64> {
    let mut kept = vec![0.0; row.len()];
    for component in components.iter().take(dimensions) {
        let share: f64 = component.iter().zip(row).map(|(a, b)| a * b).sum();
        kept.iter_mut().zip(component).for_each(|(kept, part)| *kept += share * part);
    }
    kept
}

/// Mean distance of vertices, in millimetres, of frames that have the rows `row` instead of their own.
fn off(capture: &Capture, numbers: &Numbers, row: impl Fn(usize) -> Vec<f64>) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for k in (0..numbers.frames.len()).step_by(EVERY) {
        let by: Vec<f64> = row(k).iter().zip(numbers.rows.row(k)).map(|(made, own)| made - own).collect();
        let recorded = capture.poses.frame(numbers.frames[k]);
        let moved = numbers.moved(recorded, k * numbers.stride as usize, &by);
        sum += moved.iter().zip(recorded).map(|(a, b)| f64::from(a.distance(*b))).sum::<f64>();
        count += recorded.len() as f64;
    }
    1e3 * sum / f64::max(count, 1.0)
}
