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
use crate::gpdm::{Across, Gpdm};
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

/// Steps of a slide, its first length where every direction varies by one, slides before the first sample, and between two. Such a slide is a
/// quarter of a swing long: where it ends depends little on where it began.
const SLIDE: (usize, f64, usize, usize) = (4, 0.37, 5, 1);

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
    let Some(even) = energy.even() else { return (Vec::new(), 0.0) };
    let (steps, length, before, between) = SLIDE;
    let hmc = HmcOptions { steps, length, before, between, samples: options.samples, seed: options.seed };
    let recorded = energy.free(&energy.recorded);
    let free =
        |numbers: &[f64]| -> Vec<f64> { recorded.iter().zip(even.places(numbers)).map(|(was, by)| was + by).collect() };
    let mut slope = vec![0.0; recorded.len()];
    let Chain { samples, accepted } = sample(&vec![0.0; recorded.len()], &hmc, |place, gradient| {
        let value = energy.of(&free(place), &mut slope);
        gradient.copy_from_slice(&even.slopes(&slope));
        value
    });
    (samples.iter().map(|place| energy.whole(&free(place))).collect(), accepted)
}

/// Places as numbers of which each varies by about one, each by itself: slides of a few steps go everywhere, where one that is as short as the
/// narrowest direction needs takes hundreds to go along the widest.
struct Even {
    /// Inverse of the factor L of the energy's curvature at the recording: places differ from it by L^-T of the numbers.
    lower_inverse: Matrix,
}

impl Even {
    /// How far the places of these numbers are from the recorded ones.
    fn places(&self, even: &[f64]) -> Vec<f64> {
        row(even).times(&self.lower_inverse).values().to_vec()
    }

    /// The gradient by the numbers of one by places.
    fn slopes(&self, slopes: &[f64]) -> Vec<f64> {
        row(slopes).times_transposed(&self.lower_inverse).values().to_vec()
    }
}

fn row(values: &[f64]) -> Matrix {
    Matrix::from_fn(1, values.len(), |_, column| values[column])
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

/// How places follow from the places before them.
struct Following {
    /// k_X between places and all training places, and among places.
    across: Across,
    own: Across,
    /// A^T K_X^-1, row by row.
    through: Matrix,
    /// C, without what it leaves of it.
    covariance: Matrix,
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

    /// The numbers in which the energy is about as steep in each direction: by the curvature, at the recording, of the steps' term with C held, and of
    /// the tether.
    fn even(&self) -> Option<Even> {
        let places = &self.recorded;
        let d = places.columns();
        let following = self.following(places);
        let inverse = Cholesky::of(&following.covariance)?.inverse();
        let steps = self.model.steps();
        // How the mean that follows a place changes with it.
        let leads: Vec<Matrix> =
            (0..places.rows() - 1).map(|k| steps.lead(places.row(k), following.across.near.row(k))).collect();
        let products: Vec<Vec<Matrix>> =
            leads.iter().map(|lead| leads.iter().map(|other| lead.transposed().times(other)).collect()).collect();
        let free = places.rows() - 2;
        let tether = self.tether.powi(-2);
        let curvature = Matrix::from_fn(free * d, free * d, |row, column| {
            let ((p, a), (q, b)) = ((row / d + 1, row % d), (column / d + 1, column % d));
            let mut sum = if row == column { tether } else { 0.0 };
            if a == b {
                sum += inverse[(p - 1, q - 1)];
            }
            sum - inverse[(p - 1, q)] * leads[q][(a, b)] - inverse[(p, q - 1)] * leads[p][(b, a)]
                + inverse[(p, q)] * products[p][q][(a, b)]
        });
        Some(Even { lower_inverse: Cholesky::of(&curvature)?.lower_inverse() })
    }

    /// Value and gradient by the places between the ends.
    fn of(&self, free: &[f64], gradient: &mut [f64]) -> f64 {
        let places = self.whole(free);
        let mut slopes = Matrix::zeros(places.rows(), places.columns());
        let Some(mut value) = self.steps(&places, &mut slopes) else { return f64::INFINITY };
        value += 0.5 * self.model.log_variances(&places, 0.5, &mut slopes);
        for row in 1..places.rows() - 1 {
            for ((own, place), recorded) in
                slopes.row_mut(row).iter_mut().zip(places.row(row)).zip(self.recorded.row(row))
            {
                let apart = (place - recorded) / self.tether;
                value += 0.5 * apart * apart;
                *own += apart / self.tether;
            }
        }
        gradient.copy_from_slice(self.free(&slopes));
        value
    }

    /// How the places but the first follow from those before.
    fn following(&self, places: &Matrix) -> Following {
        let steps = self.model.steps();
        let m = places.rows() - 1;
        let inputs = places.of_rows(&(0..m).collect::<Vec<_>>());
        // Row j holds k between the place j and all training places.
        let across = steps.kernels(&inputs, steps.inputs);
        let halfway = across.whole.times_transposed(steps.lower_inverse);
        let explained = halfway.gram();
        let own = steps.kernels(&inputs, &inputs);
        let mut covariance = own.whole.clone().plus(-1.0, &explained);
        (0..m).for_each(|k| covariance[(k, k)] += self.noise);
        Following { across, own, through: halfway.times(steps.lower_inverse), covariance }
    }

    /// The first two terms.
    fn steps(&self, places: &Matrix, slopes: &mut Matrix) -> Option<f64> {
        let (m, d) = (places.rows() - 1, places.columns());
        let steps = self.model.steps();
        let inputs = places.of_rows(&(0..m).collect::<Vec<_>>());
        let Following { across, own, through, covariance } = self.following(places);
        let cholesky = Cholesky::of(&covariance)?;
        let mean = across.whole.times(steps.weights);
        let besides = Matrix::from_fn(m, d, |row, column| places[(row + 1, column)] - mean[(row, column)]);
        let inverse = cholesky.inverse();
        let pulls = inverse.times(&besides);
        let value = 0.5 * d as f64 * cholesky.log_determinant() + 0.5 * pulls.dot(&besides);
        for row in 0..m {
            slopes.row_mut(row + 1).iter_mut().zip(pulls.row(row)).for_each(|(slope, pull)| *slope += pull);
        }
        // By C, then by what it is made of.
        let outer = pulls.gram();
        let by_own = Matrix::from_fn(m, m, |i, j| 0.5 * (d as f64 * inverse[(i, j)] - outer[(i, j)]));
        let by_across = by_own.times(&through);
        let by_mean = pulls.times_transposed(steps.weights);
        let twice = Matrix::zeros(m, m).plus(2.0, &by_own);
        let factors = Matrix::zeros(m, steps.inputs.rows()).plus(-2.0, &by_across).plus(-1.0, &by_mean);
        for (factors, across, others) in [(&twice, &own, &inputs), (&factors, &across, steps.inputs)] {
            let slope = steps.gradients(factors, across, &inputs, others);
            for row in 0..m {
                slopes.row_mut(row).iter_mut().zip(slope.row(row)).for_each(|(own, slope)| *own += slope);
            }
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

    #[test]
    fn slides_of_a_few_steps_go_as_far_as_is_likely() {
        let model = model();
        let options = StretchOptions { samples: 200, ..OPTIONS };
        let (samples, accepted) = sample_stretch(&model, 5..35, &options);
        assert!(accepted > 0.6, "{accepted}");
        let recorded = model.places.of_rows(&(5..35).collect::<Vec<_>>());
        let off = |sample: &Matrix| sample.clone().plus(-1.0, &recorded);
        let squares = samples.iter().map(|sample| off(sample).dot(&off(sample))).sum::<f64>();
        let deviation = (squares / (200.0 * 28.0 * 2.0)).sqrt() / model.mean_step;
        // The tether lets each number go one mean step off, the steps keep it from some of it.
        assert!(deviation > 0.2 && deviation < 1.2, "{deviation}");
        // Where one slide ends says little of where the next one does.
        let mean = samples.iter().fold(Matrix::zeros(30, 2), |sum, sample| sum.plus(1.0 / 200.0, sample));
        let about = |sample: &Matrix| sample.clone().plus(-1.0, &mean);
        let alike = samples.windows(2).map(|two| about(&two[0]).dot(&about(&two[1]))).sum::<f64>();
        let own = samples.iter().map(|sample| about(sample).dot(&about(sample))).sum::<f64>();
        assert!(alike / own < 0.5, "{}", alike / own);
    }
}
