//! The shapes of a part as few numbers: principal components in the body's own frame (thesis section 5.4.3).
//!
//! A number is in metres: the root mean square over the part's surface of what its component moves.

use glam::Vec3;
use learn::dense::Matrix;
use learn::symmetric::eigen;
use rayon::prelude::*;

use crate::subject::Subject;

/// Components are added until this much is missing (root mean square): 2 mm of 1.8 m.
const MISSING: f64 = 0.0011;
/// Components at most.
const MOST: usize = 60;
/// Frames from which they are found at most.
const FRAMES: usize = 240;

/// The shapes of a part.
#[derive(Clone, Debug)]
pub struct Space {
    /// The part's vertices.
    pub vertices: Vec<u32>,
    /// Share of each vertex of the part's area.
    shares: Vec<f32>,
    mean: Vec<Vec3>,
    /// Components, in metres a metre.
    modes: Vec<Vec<Vec3>>,
}

/// The spaces of all parts of a subject, from some of its frames. `whole` takes the body for one part.
pub fn spaces(subject: &Subject, frames: &[u32], whole: bool) -> Vec<Space> {
    let stride = frames.len().div_ceil(FRAMES).max(1);
    let shapes: Vec<Vec<Vec3>> = frames.par_iter().step_by(stride).map(|&frame| subject.own(frame)).collect();
    spaces_of(subject, &shapes, whole)
}

/// The spaces of all parts of a subject, from shapes.
pub fn spaces_of(subject: &Subject, shapes: &[Vec<Vec3>], whole: bool) -> Vec<Space> {
    let parts = if whole { 1 } else { subject.parts.count() };
    let of = |part: usize| {
        let belongs = |vertex: &u32| whole || subject.parts.weights(part)[*vertex as usize] > 0.0;
        let vertices = (0..subject.topology.vertex_count() as u32).filter(belongs).collect();
        Space::learn(shapes, vertices, subject.areas(), MISSING * f64::from(subject.size))
    };
    (0..parts).into_par_iter().map(of).collect()
}

impl Space {
    /// The space of the vertices `vertices` over `shapes`; less than `allowed` metres is missing of them.
    fn learn(shapes: &[Vec<Vec3>], vertices: Vec<u32>, areas: &[f32], allowed: f64) -> Self {
        let total: f32 = vertices.iter().map(|&v| areas[v as usize]).sum::<f32>().max(f32::MIN_POSITIVE);
        let shares: Vec<f32> = vertices.iter().map(|&v| areas[v as usize] / total).collect();
        let count = shapes.len().max(1) as f32;
        let mean: Vec<Vec3> =
            vertices.iter().map(|&v| shapes.iter().map(|shape| shape[v as usize]).sum::<Vec3>() / count).collect();
        let rows = Matrix::from_fn(shapes.len(), 3 * vertices.len(), |row, column| {
            let k = column / 3;
            let off = shapes[row][vertices[k] as usize] - mean[k];
            f64::from(off[column % 3]) * f64::from(shares[k]).sqrt()
        });
        let found = eigen(rows.times_transposed(&rows).values(), shapes.len());
        let mut missing: f64 = found.values.iter().filter(|&&value| value > 0.0).sum();
        let mut modes = Vec::new();
        while modes.len() < MOST.min(shapes.len().saturating_sub(1))
            && missing > allowed * allowed * f64::from(count)
            && found.values[modes.len()] > 0.0
        {
            let (value, vector) = (found.values[modes.len()], &found.vectors[modes.len()]);
            missing -= value;
            let mut mode = vec![Vec3::ZERO; vertices.len()];
            for (shape, entry) in shapes.iter().zip(vector) {
                let share = (entry / value.sqrt()) as f32;
                for ((sum, &v), mean) in mode.iter_mut().zip(&vertices).zip(&mean) {
                    *sum += (shape[v as usize] - *mean) * share;
                }
            }
            modes.push(mode);
        }
        Self { vertices, shares, mean, modes }
    }

    /// How many numbers a shape is.
    pub fn width(&self) -> usize {
        self.modes.len()
    }

    /// The numbers of a shape of the whole body in its own frame.
    pub fn numbers(&self, shape: &[Vec3]) -> Vec<f64> {
        let off: Vec<Vec3> = self
            .vertices
            .iter()
            .zip(&self.mean)
            .zip(&self.shares)
            .map(|((&v, mean), share)| (shape[v as usize] - *mean) * *share)
            .collect();
        let number = |mode: &Vec<Vec3>| mode.iter().zip(&off).map(|(a, b)| f64::from(a.dot(*b))).sum();
        self.modes.iter().map(number).collect()
    }

    /// The places of the part's vertices, by its numbers.
    pub fn shape(&self, numbers: &[f64]) -> Vec<Vec3> {
        let mut shape = self.mean.clone();
        for (mode, &number) in self.modes.iter().zip(numbers) {
            shape.iter_mut().zip(mode).for_each(|(point, mode)| *point += *mode * number as f32);
        }
        shape
    }
}

/// The numbers of all parts in one frame.
pub fn numbers(subject: &Subject, spaces: &[Space], frame: u32) -> Vec<Vec<f64>> {
    let shape = subject.own(frame);
    spaces.iter().map(|space| space.numbers(&shape)).collect()
}

/// The numbers of a subject between two frames of one sequence.
pub fn numbers_at(subject: &Subject, spaces: &[Space], time: f64) -> Vec<Vec<f64>> {
    let before = (time as u32).min(subject.poses.len() as u32 - 1);
    let share = time - f64::from(before);
    let first = numbers(subject, spaces, before);
    let goes_on = subject.timeline.sequence_index(before + 1) == subject.timeline.sequence_index(before);
    if share < 1e-6 || !goes_on { first } else { between(&first, &numbers(subject, spaces, before + 1), share) }
}

/// Numbers between two frames.
pub fn between(before: &[Vec<f64>], after: &[Vec<f64>], share: f64) -> Vec<Vec<f64>> {
    let blend = |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(|(a, b)| a + (b - a) * share).collect();
    before.iter().zip(after).map(blend).collect()
}
