//! How unlikely places and kernels of a dynamical model are, and which way they get likelier ([`crate::gpdm`]).

use std::ops::Range;

use crate::dense::{Cholesky, Matrix};

/// The number of dimensions that frames are taken to have, in front of the determinant; that of the numbers of a frame would let the
/// first components drown all others.
pub const EFFECTIVE: f64 = 20.0;

/// The numbers of both kernels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kernels {
    pub scale: f64,
    pub narrowness: f64,
    pub noise: f64,
    pub step_scale: f64,
    pub step_narrowness: f64,
    pub step_linear: f64,
    pub step_noise: f64,
}

impl Kernels {
    /// Of their logarithms; noises are above floors.
    pub fn new(logs: &[f64], floors: [f64; 2]) -> Self {
        let [scale, narrowness, noise, step_scale, step_narrowness, step_linear, step_noise] =
            std::array::from_fn(|k| logs[k].exp());
        let (noise, step_noise) = (floors[0] + noise, floors[1] + step_noise);
        Self { scale, narrowness, noise, step_scale, step_narrowness, step_linear, step_noise }
    }

    /// k_Y without its noise.
    pub fn frame(&self, a: &[f64], b: &[f64]) -> f64 {
        self.scale * (-0.5 * self.narrowness * squared_distance(a, b)).exp()
    }

    /// The part of k_X that depends on the distance.
    pub fn step_near(&self, a: &[f64], b: &[f64]) -> f64 {
        self.step_scale * (-0.5 * self.step_narrowness * squared_distance(a, b)).exp()
    }

    /// k_X without its noise.
    pub fn step(&self, a: &[f64], b: &[f64]) -> f64 {
        let product: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
        self.step_near(a, b) + self.step_linear * product
    }

    /// K_Y of places.
    pub fn of_frames(&self, places: &Matrix) -> Matrix {
        symmetric(places.rows(), |i, j| self.frame(places.row(i), places.row(j)) + self.noise * on_diagonal(i, j))
    }

    /// K_X of places.
    pub fn of_steps(&self, places: &Matrix) -> Matrix {
        symmetric(places.rows(), |i, j| self.step(places.row(i), places.row(j)) + self.step_noise * on_diagonal(i, j))
    }
}

fn on_diagonal(i: usize, j: usize) -> f64 {
    if i == j { 1.0 } else { 0.0 }
}

/// The square of the distance of two places.
pub fn squared_distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

/// The symmetric matrix of the entries `entry(row, column)` on and below the diagonal.
fn symmetric(size: usize, mut entry: impl FnMut(usize, usize) -> f64) -> Matrix {
    let mut matrix = Matrix::zeros(size, size);
    for i in 0..size {
        for j in 0..=i {
            let value = entry(i, j);
            (matrix[(i, j)], matrix[(j, i)]) = (value, value);
        }
    }
    matrix
}

/// What is minimised.
pub struct Training<'a> {
    frames: &'a Matrix,
    dimensions: usize,
    floors: [f64; 2],
    /// First frames of the sequences.
    firsts: Vec<usize>,
    /// Frames that have a next one.
    pub inputs: Vec<usize>,
    /// Those next ones.
    pub outputs: Vec<usize>,
}

/// Where the objective is looked at.
struct Here<'a> {
    places: Matrix,
    kernels: Kernels,
    logs: &'a [f64],
}

/// What is said of the gradient.
struct Slopes<'a> {
    by_place: &'a mut [f64],
    by_log: &'a mut [f64],
}

impl<'a> Training<'a> {
    /// Of frames, one a row, in sequences.
    pub fn new(frames: &'a Matrix, sequences: &[Range<usize>], dimensions: usize, floors: [f64; 2]) -> Self {
        let firsts = sequences.iter().map(|sequence| sequence.start).collect();
        let inputs: Vec<usize> = sequences.iter().flat_map(|sequence| sequence.start..sequence.end - 1).collect();
        let outputs = inputs.iter().map(|frame| frame + 1).collect();
        Self { frames, dimensions, floors, firsts, inputs, outputs }
    }

    /// L at places and logarithms of the kernels' numbers; its gradient.
    pub fn objective(&self, variables: &[f64], gradient: &mut [f64]) -> f64 {
        let (n, d) = (self.frames.rows(), self.dimensions);
        let (places, logs) = variables.split_at(n * d);
        let places = Matrix::from_fn(n, d, |row, column| places[row * d + column]);
        let here = Here { places, kernels: Kernels::new(logs, self.floors), logs };
        gradient.fill(0.0);
        let (by_place, by_log) = gradient.split_at_mut(n * d);
        let mut slopes = Slopes { by_place, by_log };
        let parts = [self.frames_part(&here, &mut slopes), self.steps_part(&here, &mut slopes)];
        let [Some(frames), Some(steps)] = parts else { return f64::INFINITY };
        frames + steps + self.rest(&here, &mut slopes)
    }

    /// What first places and the kernels' numbers cost.
    fn rest(&self, Here { places, kernels, logs }: &Here, slopes: &mut Slopes) -> f64 {
        let d = self.dimensions;
        let mut value = 0.0;
        for &first in &self.firsts {
            let row = places.row(first);
            value += 0.5 * row.iter().map(|x| x * x).sum::<f64>();
            slopes.by_place[first * d..(first + 1) * d].iter_mut().zip(row).for_each(|(g, x)| *g += x);
        }
        // Small numbers and great noise are likelier.
        let numbers = [
            (kernels.scale, 1.0),
            (kernels.narrowness, 1.0),
            (kernels.noise, -1.0),
            (kernels.step_scale, 1.0),
            (kernels.step_narrowness, 1.0),
            (kernels.step_linear, 1.0),
            (kernels.step_noise, -1.0),
        ];
        for (k, (number, sign)) in numbers.into_iter().enumerate() {
            value += sign * number.ln();
            slopes.by_log[k] += sign * logs[k].exp() / number;
        }
        value
    }

    fn frames_part(&self, Here { places, kernels, logs }: &Here, slopes: &mut Slopes) -> Option<f64> {
        let n = places.rows();
        let kernel = kernels.of_frames(places);
        let cholesky = Cholesky::of(&kernel)?;
        let inverse = cholesky.inverse();
        let weights = inverse.times(self.frames);
        // dL/dK = 1/2 (D K^-1 - K^-1 Y Y^T K^-1); each entry below the diagonal stands for two.
        let outer = weights.gram();
        for i in 0..n {
            let (kernel, inverse, outer) = (kernel.row(i), inverse.row(i), outer.row(i));
            let own = 0.5 * (EFFECTIVE * inverse[i] - outer[i]);
            slopes.by_log[0] += own * kernels.scale;
            slopes.by_log[2] += own * logs[2].exp();
            for j in 0..i {
                let near = (EFFECTIVE * inverse[j] - outer[j]) * kernel[j];
                slopes.by_log[0] += near;
                let apart = push(slopes.by_place, places, [i, j], -near * kernels.narrowness);
                slopes.by_log[1] -= near * 0.5 * kernels.narrowness * apart;
            }
        }
        Some(0.5 * EFFECTIVE * cholesky.log_determinant() + 0.5 * weights.dot(self.frames))
    }

    fn steps_part(&self, Here { places, kernels, logs }: &Here, slopes: &mut Slopes) -> Option<f64> {
        let d = self.dimensions;
        let dimensions = d as f64;
        let (inputs, outputs) = (places.of_rows(&self.inputs), places.of_rows(&self.outputs));
        let kernel = kernels.of_steps(&inputs);
        let products = inputs.gram();
        let cholesky = Cholesky::of(&kernel)?;
        let inverse = cholesky.inverse();
        let weights = inverse.times(&outputs);
        for (row, &frame) in self.outputs.iter().enumerate() {
            slopes.by_place[frame * d..(frame + 1) * d].iter_mut().zip(weights.row(row)).for_each(|(g, w)| *g += w);
        }
        let outer = weights.gram();
        // dL/dK of the entries beside the diagonal, as they stand for two; what the linear part makes of it is one product.
        let mut linear = Matrix::zeros(inputs.rows(), inputs.rows());
        for i in 0..inputs.rows() {
            let own = 0.5 * (dimensions * inverse[(i, i)] - outer[(i, i)]);
            slopes.by_log[3] += own * kernels.step_scale;
            slopes.by_log[5] += own * kernels.step_linear * products[(i, i)];
            slopes.by_log[6] += own * logs[6].exp();
            linear[(i, i)] = 2.0 * own;
            for j in 0..i {
                let slope = dimensions * inverse[(i, j)] - outer[(i, j)];
                let apart_of = kernels.step_linear * products[(i, j)];
                let near = slope * (kernel[(i, j)] - apart_of);
                slopes.by_log[3] += near;
                slopes.by_log[5] += slope * apart_of;
                let ends = [self.inputs[i], self.inputs[j]];
                let apart = push(slopes.by_place, places, ends, -near * kernels.step_narrowness);
                slopes.by_log[4] -= near * 0.5 * kernels.step_narrowness * apart;
                (linear[(i, j)], linear[(j, i)]) = (slope, slope);
            }
        }
        let pulls = linear.times(&inputs);
        for (row, &frame) in self.inputs.iter().enumerate() {
            let own = &mut slopes.by_place[frame * d..(frame + 1) * d];
            own.iter_mut().zip(pulls.row(row)).for_each(|(g, pull)| *g += kernels.step_linear * pull);
        }
        Some(0.5 * dimensions * cholesky.log_determinant() + 0.5 * weights.dot(&outputs))
    }
}

/// Moves two different places apart by `factor` times the way between them; the square of the
/// way's length.
fn push(by_place: &mut [f64], places: &Matrix, [i, j]: [usize; 2], factor: f64) -> f64 {
    let d = places.columns();
    let (before, after) = by_place.split_at_mut(i.max(j) * d);
    let (low, high) = (i.min(j), i.max(j));
    let ways = places.row(high).iter().zip(places.row(low));
    let mut apart = 0.0;
    for ((high, low), (a, b)) in after[..d].iter_mut().zip(&mut before[low * d..(low + 1) * d]).zip(ways) {
        let way = a - b;
        apart += way * way;
        *high += factor * way;
        *low -= factor * way;
    }
    apart
}

#[cfg(test)]
mod tests {
    use super::*;
    use kernels::random::signed;

    #[test]
    fn the_gradient_is_that_of_differences() {
        let frames = Matrix::from_fn(14, 8, |row, column| {
            (row as f64 * 0.37 + column as f64).sin() + 0.1 * f64::from(signed(3, (row * 8 + column) as u64))
        });
        let training = Training::new(&frames, &[0..8, 8..14], 3, [1e-4, 1e-4]);
        let mut at: Vec<f64> = (0..42).map(|k| f64::from(signed(4, k))).collect();
        at.extend([-2.0, 0.3, -4.0, -0.5, 0.2, -0.3, -3.0]);
        let mut gradient = vec![0.0; at.len()];
        let mut none = gradient.clone();
        training.objective(&at, &mut gradient);
        for k in 0..at.len() {
            let mut moved = |by: f64| {
                let mut place = at.clone();
                place[k] += by;
                training.objective(&place, &mut none)
            };
            let difference = (moved(1e-5) - moved(-1e-5)) / 2e-5;
            let error = (difference - gradient[k]).abs();
            assert!(error < 1e-5 * gradient[k].abs().max(1.0), "{k}: {difference} {}", gradient[k]);
        }
    }
}
