//! Gaussian process dynamical model: frames of motion as places in a space of few dimensions, with how a place becomes a frame and
//! how it leads to the next place (Wang, Fleet, Hertzmann 2008; thesis equations 6.3 to 6.9).
//!
//! ```text
//! k_Y(x, x') = a1 exp(-a2/2 |x - x'|^2)                 + noise     places to frames
//! k_X(x, x') = b1 exp(-b2/2 |x - x'|^2) + b3 x . x'     + noise     places to the places after them
//! L = D/2 ln|K_Y| + 1/2 tr(K_Y^-1 Y Y^T) + d/2 ln|K_X| + 1/2 tr(K_X^-1 X' X'^T) + 1/2 sum |x_first|^2 + sum ln a, b
//! ```
//!
//! X' are all places but the first of each sequence, K_X is that of all but the last. Both noises have a floor, without which
//! they fall to nothing on recordings that are smooth.

use std::ops::Range;

use crate::dense::{Cholesky, Matrix};
use crate::descent::descend;

/// The number of dimensions that frames are taken to have, in front of the determinant; that of the numbers of a frame would let the
/// first components drown all others.
const EFFECTIVE: f64 = 20.0;
/// The least variance of a frame's noise, in parts of what one of [`EFFECTIVE`] dimensions varies.
const FLOOR: f64 = 1e-3;
/// The least deviation of a step's noise, in mean steps of the first guess.
const STEP_FLOOR: f64 = 0.05;

/// What a model is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GpdmOptions {
    /// Dimensions of a place.
    pub dimensions: usize,
    /// Steps of the descent.
    pub steps: usize,
}

impl Default for GpdmOptions {
    fn default() -> Self {
        Self { dimensions: 5, steps: 400 }
    }
}

/// A trained model.
#[derive(Clone, Debug)]
pub struct Gpdm {
    /// Places of the training frames, one a row.
    pub places: Matrix,
    /// The training frames, one a row.
    pub frames: Matrix,
    /// Mean distance of one place from the next.
    pub mean_step: f64,
    kernels: Kernels,
    /// Inverse of the factor of K_Y.
    lower_inverse: Matrix,
    /// K_Y^-1 Y.
    weights: Matrix,
    /// The places that have a next one.
    inputs: Matrix,
    /// Inverse of the factor of K_X.
    step_lower_inverse: Matrix,
    /// K_X^-1 X'.
    step_weights: Matrix,
}

/// The numbers of both kernels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Kernels {
    scale: f64,
    narrowness: f64,
    noise: f64,
    step_scale: f64,
    step_narrowness: f64,
    step_linear: f64,
    step_noise: f64,
}

impl Kernels {
    fn new(logs: &[f64], floors: [f64; 2]) -> Self {
        let [scale, narrowness, noise, step_scale, step_narrowness, step_linear, step_noise] =
            std::array::from_fn(|k| logs[k].exp());
        let (noise, step_noise) = (floors[0] + noise, floors[1] + step_noise);
        Self { scale, narrowness, noise, step_scale, step_narrowness, step_linear, step_noise }
    }

    /// k_Y without its noise.
    fn frame(&self, a: &[f64], b: &[f64]) -> f64 {
        self.scale * (-0.5 * self.narrowness * squared_distance(a, b)).exp()
    }

    /// The part of k_X that depends on the distance.
    fn step_near(&self, a: &[f64], b: &[f64]) -> f64 {
        self.step_scale * (-0.5 * self.step_narrowness * squared_distance(a, b)).exp()
    }

    /// k_X without its noise.
    fn step(&self, a: &[f64], b: &[f64]) -> f64 {
        let product: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
        self.step_near(a, b) + self.step_linear * product
    }
}

fn squared_distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

impl Gpdm {
    /// The model of `frames`, one a row: sequences of as many rows as `lengths` says, one after the other. Columns have mean zero and
    /// vary by one in all. `None` where nothing can be learned: fewer than three frames a sequence, or all alike.
    #[must_use]
    pub fn train(frames: Matrix, lengths: &[usize], options: &GpdmOptions) -> Option<Self> {
        let dimensions = options.dimensions;
        if dimensions == 0 || lengths.iter().any(|&length| length < 3) || lengths.iter().sum::<usize>() != frames.rows()
        {
            return None;
        }
        let sequences = &ranges(lengths);
        let guess = first_guess(&frames, dimensions)?;
        let mean_step = mean_step(&guess, sequences);
        if !(mean_step > 0.0 && mean_step.is_finite()) {
            return None;
        }
        let floors = [FLOOR / EFFECTIVE, (STEP_FLOOR * mean_step).powi(2)];
        let training = Training::new(&frames, sequences, dimensions, floors);
        let step = mean_step * mean_step;
        let numbers = [1.0 / EFFECTIVE, 1.0, 0.1 / EFFECTIVE, 1.0, 1.0, 1.0, step];
        let mut start = guess.values().to_vec();
        start.extend(numbers.map(f64::ln));
        let found = descend(start, options.steps, |place, gradient| training.objective(place, gradient))?;
        let (places, logs) = found.place.split_at(frames.rows() * dimensions);
        let places = Matrix::from_fn(frames.rows(), dimensions, |row, column| places[row * dimensions + column]);
        let kernels = Kernels::new(logs, floors);
        let frame_kernel = kernel_of(&places, kernels.noise, |a, b| kernels.frame(a, b));
        let inputs = places.of_rows(&training.inputs);
        let outputs = places.of_rows(&training.outputs);
        let step_kernel = kernel_of(&inputs, kernels.step_noise, |a, b| kernels.step(a, b));
        let (frame_factor, step_factor) = (Cholesky::of(&frame_kernel)?, Cholesky::of(&step_kernel)?);
        let mean_step = self::mean_step(&places, sequences);
        Some(Self {
            weights: frame_factor.solve(&frames),
            step_weights: step_factor.solve(&outputs),
            places,
            frames,
            mean_step,
            kernels,
            lower_inverse: frame_factor.lower_inverse(),
            inputs,
            step_lower_inverse: step_factor.lower_inverse(),
        })
    }

    /// The frame of a place: the mean of thesis equation 6.11.
    #[must_use]
    pub fn frame(&self, place: &[f64]) -> Vec<f64> {
        let near = self.near(place);
        let mut frame = vec![0.0; self.frames.columns()];
        for (near, weights) in near.iter().zip(self.weights.values().chunks_exact(frame.len().max(1))) {
            frame.iter_mut().zip(weights).for_each(|(sum, weight)| *sum += near * weight);
        }
        frame
    }

    /// k_Y between a place and all training places.
    fn near(&self, place: &[f64]) -> Vec<f64> {
        (0..self.places.rows()).map(|row| self.kernels.frame(self.places.row(row), place)).collect()
    }

    /// The logarithm of the variance of a frame, and its gradient.
    pub(crate) fn log_variance(&self, place: &[f64], gradient: &mut [f64]) -> f64 {
        let near = self.near(place);
        let row = Matrix::from_fn(1, near.len(), |_, k| near[k]);
        let halfway = row.times_transposed(&self.lower_inverse);
        let explained = halfway.dot(&halfway);
        let weights = halfway.times(&self.lower_inverse);
        let variance = (self.kernels.scale + self.kernels.noise - explained).max(1e-12);
        gradient.fill(0.0);
        for (k, (weight, near)) in weights.values().iter().zip(&near).enumerate() {
            let factor = 2.0 * self.kernels.narrowness * weight * near / variance;
            for ((gradient, x), other) in gradient.iter_mut().zip(place).zip(self.places.row(k)) {
                *gradient += factor * (x - other);
            }
        }
        variance.ln()
    }

    /// What [`crate::stretch`] needs of the steps.
    pub(crate) fn steps(&self) -> Steps<'_> {
        Steps {
            inputs: &self.inputs,
            lower_inverse: &self.step_lower_inverse,
            weights: &self.step_weights,
            kernels: &self.kernels,
        }
    }
}

/// How places lead to the next ones.
pub(crate) struct Steps<'a> {
    /// Training places that have a next one.
    pub inputs: &'a Matrix,
    /// The inverse of the factor of K_X.
    pub lower_inverse: &'a Matrix,
    /// K_X^-1 X'.
    pub weights: &'a Matrix,
    kernels: &'a Kernels,
}

impl Steps<'_> {
    /// k_X of two places, without noise.
    pub fn kernel(&self, a: &[f64], b: &[f64]) -> f64 {
        self.kernels.step(a, b)
    }

    /// Adds `factor` times the gradient of k_X(a, b) by b to `out`.
    pub fn add_gradient(&self, a: &[f64], b: &[f64], factor: f64, out: &mut [f64]) {
        let near = factor * self.kernels.step_near(a, b) * self.kernels.step_narrowness;
        let linear = factor * self.kernels.step_linear;
        for ((out, a), b) in out.iter_mut().zip(a).zip(b) {
            *out += near * (a - b) + linear * a;
        }
    }
}

/// The rows of sequences of these lengths, one after the other.
fn ranges(lengths: &[usize]) -> Vec<Range<usize>> {
    let ends = lengths.iter().scan(0, |end, length| {
        *end += length;
        Some(*end)
    });
    ends.zip(lengths).map(|(end, length)| end - length..end).collect()
}

/// The first components of the frames, scaled so that the first one has deviation 1.
fn first_guess(frames: &Matrix, dimensions: usize) -> Option<Matrix> {
    let n = frames.rows();
    let gram = frames.times_transposed(frames);
    let eigen = crate::symmetric::eigen(gram.values(), n);
    let largest = *eigen.values.first()?;
    if !(largest > 0.0 && largest.is_finite()) {
        return None;
    }
    Some(Matrix::from_fn(n, dimensions, |row, column| {
        let value = eigen.values.get(column).copied().unwrap_or(0.0).max(0.0);
        let entry = eigen.vectors.get(column).map_or(0.0, |vector| vector[row]);
        // Of unit length, so that its deviation is that of one of the rows.
        entry * (n as f64).sqrt() * (value / largest).sqrt()
    }))
}

fn mean_step(places: &Matrix, sequences: &[Range<usize>]) -> f64 {
    let steps = sequences.iter().flat_map(|sequence| sequence.start..sequence.end - 1);
    let lengths: Vec<f64> = steps.map(|row| squared_distance(places.row(row), places.row(row + 1)).sqrt()).collect();
    lengths.iter().sum::<f64>() / lengths.len().max(1) as f64
}

fn kernel_of(places: &Matrix, noise: f64, kernel: impl Fn(&[f64], &[f64]) -> f64) -> Matrix {
    let mut matrix = Matrix::zeros(places.rows(), places.rows());
    for i in 0..places.rows() {
        for j in 0..=i {
            let value = kernel(places.row(i), places.row(j));
            (matrix[(i, j)], matrix[(j, i)]) = (value, value);
        }
        matrix[(i, i)] += noise;
    }
    matrix
}

/// What is minimised.
struct Training<'a> {
    frames: &'a Matrix,
    dimensions: usize,
    floors: [f64; 2],
    /// First frames of the sequences.
    firsts: Vec<usize>,
    /// Frames that have a next one.
    inputs: Vec<usize>,
    /// Those next ones.
    outputs: Vec<usize>,
}

impl<'a> Training<'a> {
    fn new(frames: &'a Matrix, sequences: &[Range<usize>], dimensions: usize, floors: [f64; 2]) -> Self {
        let firsts = sequences.iter().map(|sequence| sequence.start).collect();
        let inputs: Vec<usize> = sequences.iter().flat_map(|sequence| sequence.start..sequence.end - 1).collect();
        let outputs = inputs.iter().map(|frame| frame + 1).collect();
        Self { frames, dimensions, floors, firsts, inputs, outputs }
    }

    /// L at places and logarithms of the kernels' numbers; its gradient.
    fn objective(&self, variables: &[f64], gradient: &mut [f64]) -> f64 {
        let (n, d) = (self.frames.rows(), self.dimensions);
        let (places, logs) = variables.split_at(n * d);
        let places = Matrix::from_fn(n, d, |row, column| places[row * d + column]);
        let kernels = Kernels::new(logs, self.floors);
        gradient.fill(0.0);
        let (by_place, by_log) = gradient.split_at_mut(n * d);
        let parts = [
            self.frames_part(&places, &kernels, logs, by_place, by_log),
            self.steps_part(&places, &kernels, logs, by_place, by_log),
        ];
        let [Some(frames), Some(steps)] = parts else { return f64::INFINITY };
        let mut value = frames + steps;
        for &first in &self.firsts {
            let row = places.row(first);
            value += 0.5 * row.iter().map(|x| x * x).sum::<f64>();
            by_place[first * d..(first + 1) * d].iter_mut().zip(row).for_each(|(g, x)| *g += x);
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
            by_log[k] += sign * logs[k].exp() / number;
        }
        value
    }

    fn frames_part(
        &self,
        places: &Matrix,
        kernels: &Kernels,
        logs: &[f64],
        by_place: &mut [f64],
        by_log: &mut [f64],
    ) -> Option<f64> {
        let n = places.rows();
        let kernel = kernel_of(places, kernels.noise, |a, b| kernels.frame(a, b));
        let cholesky = Cholesky::of(&kernel)?;
        let inverse = cholesky.inverse();
        let weights = inverse.times(self.frames);
        let value = 0.5 * EFFECTIVE * cholesky.log_determinant() + 0.5 * weights.dot(self.frames);
        // dL/dK
        let outer = weights.times_transposed(&weights);
        for i in 0..n {
            for j in 0..n {
                let slope = 0.5 * (EFFECTIVE * inverse[(i, j)] - outer[(i, j)]);
                if i == j {
                    by_log[0] += slope * kernels.scale;
                    by_log[2] += slope * logs[2].exp();
                    continue;
                }
                let near = slope * kernel[(i, j)];
                by_log[0] += near;
                by_log[1] -= near * 0.5 * kernels.narrowness * squared_distance(places.row(i), places.row(j));
                push(by_place, places, [i, j], -2.0 * near * kernels.narrowness);
            }
        }
        Some(value)
    }

    fn steps_part(
        &self,
        places: &Matrix,
        kernels: &Kernels,
        logs: &[f64],
        by_place: &mut [f64],
        by_log: &mut [f64],
    ) -> Option<f64> {
        let d = self.dimensions;
        let (inputs, outputs) = (places.of_rows(&self.inputs), places.of_rows(&self.outputs));
        let kernel = kernel_of(&inputs, kernels.step_noise, |a, b| kernels.step(a, b));
        let cholesky = Cholesky::of(&kernel)?;
        let inverse = cholesky.inverse();
        let weights = inverse.times(&outputs);
        let value = 0.5 * d as f64 * cholesky.log_determinant() + 0.5 * weights.dot(&outputs);
        for (row, &frame) in self.outputs.iter().enumerate() {
            by_place[frame * d..(frame + 1) * d].iter_mut().zip(weights.row(row)).for_each(|(g, w)| *g += w);
        }
        let outer = weights.times_transposed(&weights);
        for i in 0..inputs.rows() {
            for j in 0..inputs.rows() {
                let slope = 0.5 * (d as f64 * inverse[(i, j)] - outer[(i, j)]);
                let (a, b) = (inputs.row(i), inputs.row(j));
                let near = slope * kernels.step_near(a, b);
                let product: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
                by_log[3] += near;
                by_log[4] -= near * 0.5 * kernels.step_narrowness * squared_distance(a, b);
                by_log[5] += slope * kernels.step_linear * product;
                if i == j {
                    by_log[6] += slope * logs[6].exp();
                }
                push(by_place, places, [self.inputs[i], self.inputs[j]], -2.0 * near * kernels.step_narrowness);
                let own = self.inputs[i] * d;
                let linear = 2.0 * slope * kernels.step_linear;
                by_place[own..own + d].iter_mut().zip(b).for_each(|(g, x)| *g += linear * x);
            }
        }
        Some(value)
    }
}

/// Adds `factor` times the way from place `j` to place `i` to what is said of `i`.
fn push(by_place: &mut [f64], places: &Matrix, [i, j]: [usize; 2], factor: f64) {
    let d = places.columns();
    let (a, b) = (places.row(i), places.row(j));
    by_place[i * d..(i + 1) * d].iter_mut().zip(a).zip(b).for_each(|((g, a), b)| *g += factor * (a - b));
}

#[cfg(test)]
mod tests {
    use super::*;
    use kernels::random::signed;

    /// A closed curve in eight dimensions, twice around, with something that never repeats.
    fn motion(frames: usize) -> Matrix {
        let mut motion = Matrix::from_fn(frames, 8, |row, column| {
            let phase = row as f64 * 0.37 + column as f64;
            phase.sin() + 0.4 * (2.0 * phase).cos() + 0.02 * f64::from(signed(3, (row * 8 + column) as u64))
        });
        normalise(&mut motion);
        motion
    }

    fn normalise(motion: &mut Matrix) {
        let (n, m) = (motion.rows(), motion.columns());
        for column in 0..m {
            let mean = (0..n).map(|row| motion[(row, column)]).sum::<f64>() / n as f64;
            (0..n).for_each(|row| motion[(row, column)] -= mean);
        }
        let scale = (n as f64 / motion.dot(motion)).sqrt();
        motion.values_mut().iter_mut().for_each(|value| *value *= scale);
    }

    #[test]
    fn the_gradient_is_that_of_differences() {
        let frames = motion(14);
        let sequences = ranges(&[8, 6]);
        let training = Training::new(&frames, &sequences, 3, [1e-4, 1e-4]);
        let mut at = first_guess(&frames, 3).unwrap().values().to_vec();
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

    #[test]
    fn frames_come_back_from_few_dimensions() {
        let frames = motion(60);
        let options = GpdmOptions { dimensions: 2, steps: 200 };
        let model = Gpdm::train(frames.clone(), &[60], &options).unwrap();
        let error = |of: &dyn Fn(usize) -> Vec<f64>| {
            let apart = (0..60).map(|row| squared_distance(&of(row), frames.row(row))).sum::<f64>();
            (apart / 60.0).sqrt()
        };
        let learned = error(&|row| model.frame(model.places.row(row)));
        // Two components of the same frames keep this much.
        let eigen = crate::symmetric::eigen(frames.times_transposed(&frames).values(), 60);
        let kept: f64 = eigen.values[2..].iter().sum::<f64>() / 60.0;
        assert!(learned < kept.sqrt() / 3.0, "{learned} of {}", kept.sqrt());
    }

    #[test]
    fn what_holds_no_motion_has_no_model() {
        let options = GpdmOptions::default();
        assert!(Gpdm::train(Matrix::zeros(20, 4), &[20], &options).is_none());
        assert!(Gpdm::train(motion(4), &[2, 2], &options).is_none());
        assert!(Gpdm::train(motion(3), &[3], &options).is_some());
    }
}
