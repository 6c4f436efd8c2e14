//! Other ways through a stretch of learned motion: how likely a row of places is, and rows drawn by it (thesis section 6.6).
//!
//! ```text
//! C = k(X~in, X~in) + s^2 1 - A^T K_X^-1 A,   A = k(X_in, X~in),   Z = X~' - A^T K_X^-1 X'
//! E = d/2 ln|C| + 1/2 tr(C^-1 Z Z^T) + 1/2 sum ln var_Y(x~) + sum |x~ - x|^2 / (2 t^2)
//! ```
//!
//! Not as printed there: the noise s of a step is set after training, by how much is wanted ([`StretchOptions::amount`]); a free
//! chain of the trained noise shakes. The third term keeps places where frames were seen, the fourth near the recording: without
//! it chains drift away on real captures. First and last place are those of the recording.

use std::ops::Range;

use crate::dense::{Cholesky, Matrix};
use crate::gpdm::Gpdm;
use crate::hmc::{Chain, HmcOptions, sample};

/// How far samples go from the recording.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StretchOptions {
    /// Noise of a step, in mean steps: 0.06 to 0.25.
    pub amount: f64,
    /// Deviation from the recording that is easily had, in mean steps: 1 to 2.
    pub tether: f64,
    /// Samples that are wanted.
    pub samples: usize,
    /// Seed of the random numbers.
    pub seed: u64,
}

/// Steps of a slide, its first length in noises of a step, slides before the first sample, and between two.
const SLIDE: (usize, f64, usize, usize) = (60, 0.12, 15, 2);

/// Samples of the places of training frames `stretch`, each as long as it.
///
/// Frames of less than four have nothing to vary, and have no samples.
#[must_use]
pub fn sample_stretch(model: &Gpdm, stretch: Range<usize>, options: &StretchOptions) -> (Vec<Matrix>, f64) {
    if stretch.len() < 4 {
        return (Vec::new(), 0.0);
    }
    let rows: Vec<usize> = stretch.collect();
    let energy = Energy::new(model, model.places.of_rows(&rows), options);
    let (steps, length, before, between) = SLIDE;
    let hmc = HmcOptions {
        steps,
        length: length * options.amount * model.mean_step,
        before,
        between,
        samples: options.samples,
        seed: options.seed,
    };
    let start = energy.free(&energy.recorded).to_vec();
    let Chain { samples, accepted } = sample(&start, &hmc, |free, gradient| energy.of(free, gradient));
    (samples.iter().map(|free| energy.whole(free)).collect(), accepted)
}

/// The energy of a row of places whose ends are held.
struct Energy<'a> {
    model: &'a Gpdm,
    recorded: Matrix,
    /// s^2.
    noise: f64,
    /// t.
    tether: f64,
}

impl<'a> Energy<'a> {
    fn new(model: &'a Gpdm, recorded: Matrix, options: &StretchOptions) -> Self {
        let noise = (options.amount * model.mean_step).powi(2);
        Self { model, recorded, noise, tether: options.tether * model.mean_step }
    }

    /// The places between the ends.
    fn free<'m>(&self, places: &'m Matrix) -> &'m [f64] {
        let d = places.columns();
        &places.values()[d..places.values().len() - d]
    }

    /// With the ends.
    fn whole(&self, free: &[f64]) -> Matrix {
        let d = self.recorded.columns();
        let mut places = self.recorded.clone();
        places.values_mut()[d..d + free.len()].copy_from_slice(free);
        places
    }

    /// Value and gradient by the places between the ends.
    fn of(&self, free: &[f64], gradient: &mut [f64]) -> f64 {
        let places = self.whole(free);
        let (m, d) = (places.rows(), places.columns());
        let mut slopes = Matrix::zeros(m, d);
        let Some(mut value) = self.steps(&places, &mut slopes) else { return f64::INFINITY };
        let mut slope = vec![0.0; d];
        for row in 1..m - 1 {
            value += 0.5 * self.model.log_variance(places.row(row), &mut slope);
            let own = slopes.row_mut(row);
            own.iter_mut().zip(&slope).for_each(|(own, slope)| *own += 0.5 * slope);
            for ((own, place), recorded) in own.iter_mut().zip(places.row(row)).zip(self.recorded.row(row)) {
                let apart = (place - recorded) / self.tether;
                value += 0.5 * apart * apart;
                *own += apart / self.tether;
            }
        }
        gradient.copy_from_slice(self.free(&slopes));
        value
    }

    /// The first two terms.
    fn steps(&self, places: &Matrix, slopes: &mut Matrix) -> Option<f64> {
        let (m, d) = (places.rows() - 1, places.columns());
        let steps = self.model.steps();
        let n = steps.inputs.rows();
        // Row j holds k between the place j and all training places.
        let across = Matrix::from_fn(m, n, |j, i| steps.kernel(steps.inputs.row(i), places.row(j)));
        let halfway = across.times_transposed(steps.lower_inverse);
        let explained = halfway.times_transposed(&halfway);
        // A^T K_X^-1, row by row.
        let through = halfway.times(steps.lower_inverse);
        let covariance = Matrix::from_fn(m, m, |i, j| {
            let own = steps.kernel(places.row(i), places.row(j)) + if i == j { self.noise } else { 0.0 };
            own - explained[(i, j)]
        });
        let cholesky = Cholesky::of(&covariance)?;
        let mean = across.times(steps.weights);
        let besides = Matrix::from_fn(m, d, |row, column| places[(row + 1, column)] - mean[(row, column)]);
        let inverse = cholesky.inverse();
        let pulls = inverse.times(&besides);
        let value = 0.5 * d as f64 * cholesky.log_determinant() + 0.5 * pulls.dot(&besides);
        for row in 0..m {
            slopes.row_mut(row + 1).iter_mut().zip(pulls.row(row)).for_each(|(slope, pull)| *slope += pull);
        }
        // By C, then by what it is made of.
        let outer = pulls.times_transposed(&pulls);
        let by_own = Matrix::from_fn(m, m, |i, j| 0.5 * (d as f64 * inverse[(i, j)] - outer[(i, j)]));
        let by_across = by_own.times(&through);
        let by_mean = pulls.times_transposed(steps.weights);
        for j in 0..m {
            let mut slope = vec![0.0; d];
            for i in 0..m {
                steps.add_gradient(places.row(i), places.row(j), 2.0 * by_own[(i, j)], &mut slope);
            }
            for i in 0..n {
                let factor = -2.0 * by_across[(j, i)] - by_mean[(j, i)];
                steps.add_gradient(steps.inputs.row(i), places.row(j), factor, &mut slope);
            }
            slopes.row_mut(j).iter_mut().zip(&slope).for_each(|(own, slope)| *own += slope);
        }
        Some(value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpdm::GpdmOptions;
    use kernels::random::signed;

    fn model() -> Gpdm {
        let mut frames = Matrix::from_fn(50, 6, |row, column| {
            let phase = f64::from(row as u32) * 0.3 + column as f64;
            0.4 * phase.sin() + 0.01 * f64::from(signed(5, (row * 6 + column) as u64))
        });
        for column in 0..6 {
            let mean = (0..50).map(|row| frames[(row, column)]).sum::<f64>() / 50.0;
            (0..50).for_each(|row| frames[(row, column)] -= mean);
        }
        Gpdm::train(frames, &[50], &GpdmOptions { dimensions: 2, steps: 100 }).unwrap()
    }

    const OPTIONS: StretchOptions = StretchOptions { amount: 0.12, tether: 1.0, samples: 6, seed: 3 };

    #[test]
    fn the_gradient_is_that_of_differences() {
        let model = model();
        let rows: Vec<usize> = (10..22).collect();
        let energy = Energy::new(&model, model.places.of_rows(&rows), &OPTIONS);
        let mut at = energy.free(&energy.recorded).to_vec();
        at.iter_mut().enumerate().for_each(|(k, x)| *x += 0.1 * f64::from(signed(9, k as u64)));
        let mut gradient = vec![0.0; at.len()];
        let mut none = gradient.clone();
        energy.of(&at, &mut gradient);
        for k in 0..at.len() {
            let mut moved = |by: f64| {
                let mut place = at.clone();
                place[k] += by;
                energy.of(&place, &mut none)
            };
            let difference = (moved(1e-5) - moved(-1e-5)) / 2e-5;
            assert!(
                (difference - gradient[k]).abs() < 1e-4 * gradient[k].abs().max(1.0),
                "{k} {difference} {}",
                gradient[k]
            );
        }
    }

    #[test]
    fn samples_hold_their_ends_and_differ() {
        let model = model();
        let (samples, accepted) = sample_stretch(&model, 5..35, &OPTIONS);
        assert!(samples.len() == 6 && accepted > 0.4, "{accepted}");
        for sample in &samples {
            assert_eq!(sample.row(0), model.places.row(5));
            assert_eq!(sample.row(29), model.places.row(34));
        }
        assert!(samples[0] != samples[3]);
        assert!(sample_stretch(&model, 5..8, &OPTIONS).0.is_empty());
    }
}
