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
use crate::gpdm_objective::{EFFECTIVE, Kernels, Training, squared_distance};

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
        let frame_kernel = kernels.of_frames(&places);
        let inputs = places.of_rows(&training.inputs);
        let outputs = places.of_rows(&training.outputs);
        let step_kernel = kernels.of_steps(&inputs);
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

    /// The sum of the logarithms of the variances of the frames of all places but the first and the last; `share` of its gradient is added to
    /// `slopes`.
    pub(crate) fn log_variances(&self, places: &Matrix, share: f64, slopes: &mut Matrix) -> f64 {
        let inner = places.rows().saturating_sub(2);
        let near = Matrix::from_fn(inner, self.places.rows(), |row, k| {
            self.kernels.frame(self.places.row(k), places.row(row + 1))
        });
        let halfway = near.times_transposed(&self.lower_inverse);
        let mut weights = halfway.times(&self.lower_inverse);
        let mut sum = 0.0;
        for row in 0..inner {
            let explained: f64 = halfway.row(row).iter().map(|part| part * part).sum();
            let variance = (self.kernels.scale + self.kernels.noise - explained).max(1e-12);
            sum += variance.ln();
            let factor = 2.0 * share * self.kernels.narrowness / variance;
            weights.row_mut(row).iter_mut().zip(near.row(row)).for_each(|(weight, near)| *weight *= factor * near);
        }
        // Each place is pushed from those that tell of it.
        let pulled = weights.times(&self.places);
        for row in 0..inner {
            let total: f64 = weights.row(row).iter().sum();
            let own = slopes.row_mut(row + 1).iter_mut().zip(places.row(row + 1)).zip(pulled.row(row));
            own.for_each(|((slope, place), pulled)| *slope += total * place - pulled);
        }
        sum
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

/// k_X between places, a row each, and others, a column each; without noise.
pub(crate) struct Across {
    /// The part that depends on the distance.
    pub near: Matrix,
    /// All of it.
    pub whole: Matrix,
}

impl Steps<'_> {
    /// k_X between places and others.
    pub fn kernels(&self, places: &Matrix, others: &Matrix) -> Across {
        let near = Matrix::from_fn(places.rows(), others.rows(), |row, column| {
            self.kernels.step_near(places.row(row), others.row(column))
        });
        let whole = near.clone().plus(self.kernels.step_linear, &places.times_transposed(others));
        Across { near, whole }
    }

    /// For each place the sum of `factors` times the gradients of k_X between it and others, by the place.
    pub fn gradients(&self, factors: &Matrix, across: &Across, places: &Matrix, others: &Matrix) -> Matrix {
        let narrowness = self.kernels.step_narrowness;
        let mut near = across.near.clone();
        near.values_mut().iter_mut().zip(factors.values()).for_each(|(near, factor)| *near *= factor * narrowness);
        let totals: Vec<f64> = (0..near.rows()).map(|row| near.row(row).iter().sum()).collect();
        let mut slopes = near.plus(self.kernels.step_linear, factors).times(others);
        for (row, total) in totals.into_iter().enumerate() {
            slopes.row_mut(row).iter_mut().zip(places.row(row)).for_each(|(slope, place)| *slope -= total * place);
        }
        slopes
    }

    /// How the mean that follows a place changes with it: a row a dimension of what follows; `near` is k_X's part that depends on the distance.
    pub fn lead(&self, place: &[f64], near: &[f64]) -> Matrix {
        let d = place.len();
        let mut lead = Matrix::zeros(d, d);
        for (k, near) in near.iter().enumerate() {
            let (other, weights) = (self.inputs.row(k), self.weights.row(k));
            for (row, weight) in weights.iter().enumerate() {
                for (column, (x, other)) in place.iter().zip(other).enumerate() {
                    let slope = near * self.kernels.step_narrowness * (other - x) + self.kernels.step_linear * other;
                    lead[(row, column)] += weight * slope;
                }
            }
        }
        lead
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
