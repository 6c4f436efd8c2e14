//! Conjugate gradients on a pose's own Laplacian, preconditioned by the factor of another pose, for three right sides
//! at once, one per lane.

use glam::{DVec3, Vec4};

use crate::cholesky::{Factor, Symbolic};
use crate::laplacian::{Laplacian, LaplacianPattern};

/// A system under way: `L x = b` from a guess, in elimination order.
#[derive(Default)]
pub(super) struct System {
    /// Residual `b - L x`.
    pub residual: Vec<Vec4>,
    /// What is to be added to the guess.
    pub correction: Vec<Vec4>,
    preconditioned: Vec<Vec4>,
    direction: Vec<Vec4>,
    product: Vec<Vec4>,
    scratch: Vec<Vec4>,
}

/// The factor of a pose.
pub(super) struct Preconditioner<'a> {
    pub symbolic: &'a Symbolic,
    pub factor: &'a Factor,
    /// Diagonal of that pose's Laplacian.
    pub diagonal: &'a [f32],
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Outcome {
    /// Solves with the preconditioner.
    pub solves: usize,
    /// Estimate of the largest error left at a vertex, in metres; not a number where the system holds none.
    pub error: f32,
    /// What one solve leaves of the error, where there were two solves to tell.
    pub contraction: Option<f32>,
    /// Whether the tolerance was met. Where not, the system can be run on with another preconditioner.
    pub done: bool,
}

impl System {
    /// Forgets the system before; `residual` is then to be filled.
    pub fn reset(&mut self, free_count: usize) {
        for vector in
            [&mut self.residual, &mut self.correction, &mut self.preconditioned, &mut self.direction, &mut self.product]
        {
            vector.clear();
            vector.resize(free_count, Vec4::ZERO);
        }
    }

    /// `z = M^-1 r`, and where the matrix is softer at a vertex than the preconditioner's pose, the difference besides:
    /// errors there would otherwise hardly show in z. Symmetric and positive definite, as M is.
    fn precondition(&mut self, laplacian: &Laplacian, preconditioner: &Preconditioner<'_>) {
        self.preconditioned.copy_from_slice(&self.residual);
        preconditioner.symbolic.solve_in_order(preconditioner.factor, &mut self.preconditioned, &mut self.scratch);
        let diagonals = laplacian.diagonal.iter().zip(preconditioner.diagonal);
        for ((z, &r), (&own, &other)) in self.preconditioned.iter_mut().zip(&self.residual).zip(diagonals) {
            let softer = own < other && own > 0.0;
            *z += r * if softer { 1.0 / own - 1.0 / other } else { 0.0 };
        }
    }

    /// Iterates until the error that is left is estimated at no more than `tolerance` metres at any vertex, or
    /// `most_solves` are spent.
    ///
    /// The preconditioned residual `z = M^-1 r` *is* the error, in metres, as far as the preconditioner M is the matrix.
    /// It is added in the end, which leaves the part that M gets wrong: the contraction, the ratio of the last two
    /// residuals, known once there are two; `expected` is what to take for it before.
    pub fn run(
        &mut self,
        pattern: &LaplacianPattern,
        laplacian: &Laplacian,
        preconditioner: &Preconditioner<'_>,
        Stop { expected, tolerance, most_solves }: Stop,
    ) -> Outcome {
        let mut outcome = Outcome { solves: 0, error: f32::INFINITY, contraction: None, done: false };
        let mut product_before = DVec3::ZERO;
        let mut size_before = None;
        loop {
            self.precondition(laplacian, preconditioner);
            outcome.solves += 1;
            let product = dot(&self.residual, &self.preconditioned);
            if !product.is_finite() {
                outcome.error = f32::NAN;
                return outcome;
            }
            let size = largest(&self.preconditioned);
            outcome.contraction = size_before.map(|before: f32| (size / before).min(1.0));
            outcome.error = size * outcome.contraction.unwrap_or(expected);
            if outcome.error <= tolerance {
                for (correction, &z) in self.correction.iter_mut().zip(&self.preconditioned) {
                    *correction += z;
                }
                outcome.done = true;
                return outcome;
            }
            if outcome.solves >= most_solves {
                return outcome;
            }
            let beta = ratio(product, product_before);
            for (direction, &z) in self.direction.iter_mut().zip(&self.preconditioned) {
                *direction = z + *direction * beta;
            }
            pattern.multiply(laplacian, &self.direction, &mut self.product);
            let alpha = ratio(product, dot(&self.direction, &self.product));
            for k in 0..self.residual.len() {
                self.correction[k] += self.direction[k] * alpha;
                self.residual[k] -= self.product[k] * alpha;
            }
            product_before = product;
            size_before = Some(size);
        }
    }
}

/// When to stop.
pub(super) struct Stop {
    /// What a solve is expected to leave of the error.
    pub expected: f32,
    /// Largest error at a vertex in metres.
    pub tolerance: f32,
    /// Solves that may be spent.
    pub most_solves: usize,
}

/// Largest absolute value over three lanes.
fn largest(vectors: &[Vec4]) -> f32 {
    let mut most = Vec4::ZERO;
    for v in vectors {
        most = most.max(v.abs());
    }
    most.truncate().max_element()
}

/// Products per lane; blocks in single precision, their sums in double.
fn dot(a: &[Vec4], b: &[Vec4]) -> DVec3 {
    let mut sum = DVec3::ZERO;
    for (a, b) in a.chunks(32).zip(b.chunks(32)) {
        let mut block = Vec4::ZERO;
        for (&a, &b) in a.iter().zip(b) {
            block += a * b;
        }
        sum += block.truncate().as_dvec3();
    }
    sum
}

/// `a / b` per lane, 0 where there is nothing left to divide by.
fn ratio(a: DVec3, b: DVec3) -> Vec4 {
    DVec3::select(b.cmpgt(DVec3::ZERO), a / b, DVec3::ZERO).as_vec3().extend(0.0)
}
