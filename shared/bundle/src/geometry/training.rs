//! Learning the prediction weights: for each vertex, least squares over a sample of the capture's frames.

use super::model::{KINDS, ONE, Weights, prior};
use super::traversal::Traversal;
use kernels::codec::Steps;

/// Strength of the prior: so many squared steps pull each weight towards equal shares.
const PRIOR: f64 = 50.0;
/// Residuals much larger than this many steps count less.
const LARGE: f64 = 50.0;
const MOST: usize = 8;

/// Normal equations of one vertex.
#[derive(Clone)]
struct Equations {
    matrix: [[f64; MOST]; MOST],
    right: [f64; MOST],
}

/// Collects samples of one kind of weights.
pub struct Trainer<'a> {
    traversal: &'a Traversal,
    kind: usize,
    equations: Vec<Equations>,
}

impl<'a> Trainer<'a> {
    /// For weights of `kind`: 0 predicts positions of independent frames, 1 differences from other frames.
    #[must_use]
    pub fn new(traversal: &'a Traversal, kind: usize) -> Self {
        let empty = Equations { matrix: [[0.0; MOST]; MOST], right: [0.0; MOST] };
        Self { traversal, kind: kind.min(KINDS - 1), equations: vec![empty; traversal.vertex_of_place.len()] }
    }

    /// Adds a frame; `slots` hold what is to be predicted, slot 0 being zero.
    pub fn add(&mut self, slots: &[Steps]) {
        for (place, equations) in self.equations.iter_mut().enumerate() {
            let (row, count) = parents(self.traversal, place);
            let first = usize::from(self.kind == 0);
            if count <= first {
                continue;
            }
            for axis in 0..3 {
                // Weights of kind 0 have the sum 1: everything is taken relative to the first parent.
                let base = if self.kind == 0 { slots[row[0] as usize][axis] } else { 0 };
                let mut values = [0.0; MOST];
                for (value, &slot) in values.iter_mut().zip(&row[first..count]) {
                    *value = f64::from(slots[slot as usize][axis] - base);
                }
                equations.add(&values, f64::from(slots[place + 1][axis] - base), count - first);
            }
        }
    }

    /// The learnt weights, one per parent slot.
    #[must_use]
    pub fn weights(self) -> Vec<i16> {
        let most = self.traversal.most_parents;
        let mut weights = vec![0; self.traversal.parent_slots.len()];
        for (place, equations) in self.equations.into_iter().enumerate() {
            let count = usize::from(self.traversal.parent_count[place]);
            let first = usize::from(self.kind == 0);
            let solution = equations.solve(count.saturating_sub(first), count);
            let row = &mut weights[place * most..place * most + count];
            let mut sum = 0;
            for (weight, value) in row.iter_mut().skip(first).zip(solution) {
                *weight = (value * f64::from(ONE)).round().clamp(-2048.0, 2048.0) as i16;
                sum += i32::from(*weight);
            }
            if self.kind == 0 && count > 0 {
                row[0] = (ONE - sum) as i16;
            }
        }
        weights
    }
}

/// Weights for captures that are too short to learn from: equal shares.
#[must_use]
pub fn untrained(traversal: &Traversal) -> Weights {
    let mut weights = vec![0_i16; traversal.parent_slots.len()];
    for place in 0..traversal.parent_count.len() {
        let count = usize::from(traversal.parent_count[place]);
        let row = &mut weights[place * traversal.most_parents..][..count];
        row.fill(prior(count) as i16);
    }
    let mut independent = weights.clone();
    for (place, row) in independent.chunks_exact_mut(traversal.most_parents).enumerate() {
        let count = usize::from(traversal.parent_count[place]);
        if count > 0 {
            row[0] = (ONE - prior(count) * (count as i32 - 1)) as i16;
        }
    }
    [independent, weights]
}

fn parents(traversal: &Traversal, place: usize) -> (&[u32], usize) {
    let row = &traversal.parent_slots[place * traversal.most_parents..][..traversal.most_parents];
    (row, usize::from(traversal.parent_count[place]))
}

impl Equations {
    fn add(&mut self, values: &[f64; MOST], target: f64, count: usize) {
        let importance = 1.0 / (1.0 + target.abs() / LARGE);
        for i in 0..count {
            let scaled = importance * values[i];
            for j in 0..=i {
                self.matrix[i][j] += scaled * values[j];
            }
            self.right[i] += scaled * target;
        }
    }

    /// Weights of the first `unknowns` values, pulled towards 1 / `shares`; by Cholesky's method.
    fn solve(mut self, unknowns: usize, shares: usize) -> [f64; MOST] {
        for i in 0..unknowns {
            self.matrix[i][i] += PRIOR;
            self.right[i] += PRIOR / shares as f64;
        }
        let mut x = self.right;
        for i in 0..unknowns {
            for j in 0..=i {
                let mut sum = self.matrix[i][j];
                for k in 0..j {
                    sum -= self.matrix[i][k] * self.matrix[j][k];
                }
                // The prior keeps pivots positive; rounding may eat it where coordinates are huge.
                self.matrix[i][j] = if i == j { sum.max(1e-3).sqrt() } else { sum / self.matrix[j][j] };
            }
            for k in 0..i {
                x[i] -= self.matrix[i][k] * x[k];
            }
            x[i] /= self.matrix[i][i];
        }
        for i in (0..unknowns).rev() {
            for k in i + 1..unknowns {
                x[i] -= self.matrix[k][i] * x[k];
            }
            x[i] /= self.matrix[i][i];
        }
        x
    }
}
