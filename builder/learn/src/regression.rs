//! Gaussian process regression: rows of numbers from rows of numbers, learned from pairs of them.
//!
//! Thesis section 5.5.2, equations 5.11, 5.12 and 5.16, 5.17. All outputs share one kernel, which is quicker than one each and ends in fewer bad optima. Its
//! parameters are those that make the pairs most likely, by L-BFGS from several starts. The noise is not learned below a
//! floor: without one it falls to nothing on clean data, and what was not seen is extrapolated wildly.

use crate::dense::{Cholesky, Matrix};
use crate::descent::descend_until;
use crate::kernel::{Kernel, Parameters};

/// Pairs from which starts are compared.
const FEW: usize = 120;
/// Logarithms of parameters stay within this of where they start: else they run away where they mean nothing.
const BOUNDS: f64 = 9.0;
/// Parameters that make all pairs likelier by no more than this factor's logarithm are as good as those before.
const LIKELIER: f64 = 0.01;
/// How firmly the gain of a linear kernel is held back, by the square of its logarithm.
const STIFF: f64 = 100.0;
/// The affine map's noise over its signal: nothing but what keeps its matrix regular.
const REGULAR: f64 = 1e-6;

/// What is learned, and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RegressionOptions {
    /// The kernel.
    pub kernel: Kernel,
    /// The noise's deviation at least, in the unit of outputs.
    pub floor: f64,
    /// How much of an output a linear kernel easily makes of a unit of an input: more must be told by many pairs. Other kernels do not
    /// heed it.
    pub gain: f64,
    /// Steps of the descent from the best start.
    pub steps: usize,
}

/// A map that was learned.
#[derive(Clone, Debug)]
pub struct Regression {
    kernel: Kernel,
    parameters: Parameters,
    /// What inputs are divided by once their mean is taken off.
    scale: f64,
    means: [Vec<f64>; 2],
    /// Inputs of all pairs, centred and scaled, and their squared lengths.
    inputs: Matrix,
    squares: Vec<f64>,
    /// K^-1 Y, transposed: a row an output.
    answers: Matrix,
}

impl Regression {
    /// Learns the map from the rows of `inputs` to those of `outputs`. `None` where there are not two pairs, inputs do not differ, or
    /// numbers are not finite.
    #[must_use]
    pub fn train(inputs: &Matrix, outputs: &Matrix, options: &RegressionOptions) -> Option<Self> {
        let count = inputs.rows();
        if count < 2 || outputs.rows() != count {
            return None;
        }
        let (mut x, input_mean) = centred(inputs);
        let (y, output_mean) = centred(outputs);
        let scale = (x.dot(&x) / count as f64).sqrt();
        if !(scale > 0.0 && scale.is_finite() && y.dot(&y).is_finite()) {
            return None;
        }
        x.values_mut().iter_mut().for_each(|value| *value /= scale);
        // Inputs are scaled: so is what is made of them.
        let scaled = RegressionOptions { gain: options.gain * scale, ..*options };
        let parameters = best_parameters(&x, &y, &scaled)?;
        let products = Products::of(&x);
        let factor = products.factor(options.kernel, &parameters, options.floor)?;
        let answers = factor.solve(&y).transposed();
        let squares = products.squares();
        let means = [input_mean, output_mean];
        Some(Self { kernel: options.kernel, parameters, scale, means, inputs: x, squares, answers })
    }

    /// The output for an input.
    ///
    /// # Panics
    /// Where `input` has another length than those of the pairs.
    #[must_use]
    pub fn predict(&self, input: &[f64]) -> Vec<f64> {
        assert_eq!(input.len(), self.inputs.columns(), "an input of another length");
        let own: Vec<f64> = input.iter().zip(&self.means[0]).map(|(x, mean)| (x - mean) / self.scale).collect();
        let square = own.iter().map(|x| x * x).sum();
        let own = Matrix::from_fn(1, own.len(), |_, column| own[column]);
        let products = own.times_transposed(&self.inputs);
        let likeness = self.kernel.with(&self.parameters);
        let alike = Matrix::from_fn(1, self.squares.len(), |_, row| {
            likeness.value(products[(0, row)], square, self.squares[row]).0
        });
        let output = alike.times_transposed(&self.answers);
        output.row(0).iter().zip(&self.means[1]).map(|(y, mean)| y + mean).collect()
    }

    /// How far an input is from the nearest one that was learned from, in deviations of all of these: what is far is guessed.
    ///
    /// # Panics
    /// Where `input` has another length than those of the pairs.
    #[must_use]
    pub fn far(&self, input: &[f64]) -> f64 {
        assert_eq!(input.len(), self.inputs.columns(), "an input of another length");
        let own: Vec<f64> = input.iter().zip(&self.means[0]).map(|(x, mean)| (x - mean) / self.scale).collect();
        let square =
            |row: usize| -> f64 { self.inputs.row(row).iter().zip(&own).map(|(a, b)| (a - b) * (a - b)).sum() };
        (0..self.inputs.rows()).map(square).fold(f64::INFINITY, f64::min).sqrt()
    }

    /// The parameters that were found.
    #[must_use]
    pub fn parameters(&self) -> Parameters {
        self.parameters
    }
}

/// The rows without their mean, and the mean.
fn centred(rows: &Matrix) -> (Matrix, Vec<f64>) {
    let count = rows.rows() as f64;
    let mean: Vec<f64> = (0..rows.columns())
        .map(|column| (0..rows.rows()).map(|row| rows[(row, column)]).sum::<f64>() / count)
        .collect();
    (Matrix::from_fn(rows.rows(), rows.columns(), |row, column| rows[(row, column)] - mean[column]), mean)
}

/// The parameters by which the pairs are most likely: from three starts on some of them, then on all from the best.
fn best_parameters(x: &Matrix, y: &Matrix, options: &RegressionOptions) -> Option<Parameters> {
    let deviation = (y.dot(y) / (y.rows() * y.columns().max(1)) as f64).sqrt().max(options.floor).max(1e-9);
    let start = |length: f64| [deviation.ln(), length.ln(), (0.1 * deviation).ln()];
    if options.kernel == Kernel::Affine {
        let noise = (REGULAR * deviation).ln();
        return Some(Parameters { signal: deviation.ln(), length: 0.0, noise });
    }
    let few: Vec<usize> = (0..FEW.min(x.rows())).map(|k| k * x.rows() / FEW.min(x.rows())).collect();
    let some = Likelihood::new(&x.of_rows(&few), &y.of_rows(&few), options);
    let all = Likelihood::new(x, y, options);
    let middle = start(1.0);
    let down = |from: [f64; 3], of: &Likelihood, steps: usize| {
        descend_until(from.to_vec(), steps, LIKELIER, |place, gradient| {
            let near = place.iter().zip(middle).all(|(place, middle)| (place - middle).abs() < BOUNDS);
            let there = if near { of.at(&parameters(place)) } else { None };
            let Some((value, slope)) = there else { return f64::INFINITY };
            gradient.copy_from_slice(&slope);
            value
        })
    };
    let best = [1.0, 0.3, 3.0]
        .into_iter()
        .filter_map(|length| down(start(length), &some, options.steps))
        .min_by(|a, b| a.value.total_cmp(&b.value))?;
    let from = [best.place[0], best.place[1], best.place[2]];
    let found = down(from, &all, options.steps / 2).map_or(best.place, |found| found.place);
    Some(parameters(&found))
}

fn parameters(place: &[f64]) -> Parameters {
    Parameters { signal: place[0], length: place[1], noise: place[2] }
}

/// Products of all pairs of inputs.
struct Products(Matrix);

impl Products {
    fn of(x: &Matrix) -> Self {
        Self(x.times_transposed(x))
    }

    fn squares(&self) -> Vec<f64> {
        (0..self.0.rows()).map(|k| self.0[(k, k)]).collect()
    }

    /// The kernels of all pairs with their noise, lower triangle, and the derivatives by the logarithm of the length.
    fn kernels(&self, kernel: Kernel, parameters: &Parameters, floor: f64) -> [Matrix; 2] {
        let n = self.0.rows();
        let (mut values, mut slopes) = (Matrix::zeros(n, n), Matrix::zeros(n, n));
        let likeness = kernel.with(parameters);
        for i in 0..n {
            for j in 0..=i {
                let (value, slope) = likeness.value(self.0[(i, j)], self.0[(i, i)], self.0[(j, j)]);
                (values[(i, j)], slopes[(i, j)]) = (value, slope);
            }
            values[(i, i)] += noise(kernel, parameters, floor);
        }
        [values, slopes]
    }

    fn factor(&self, kernel: Kernel, parameters: &Parameters, floor: f64) -> Option<Cholesky> {
        let [mut values, _] = self.kernels(kernel, parameters, floor);
        let n = values.rows();
        // A rounded matrix of the affine map may not be regular yet.
        for _ in 0..8 {
            if let Some(factor) = Cholesky::of(&values) {
                return Some(factor);
            }
            (0..n).for_each(|k| values[(k, k)] *= 1.0 + 1e-9);
        }
        None
    }
}

/// The variance of the noise. The affine map has none but what keeps it regular.
fn noise(kernel: Kernel, parameters: &Parameters, floor: f64) -> f64 {
    let own = (2.0 * parameters.noise).exp();
    if kernel == Kernel::Affine { own } else { floor * floor + own }
}

/// How unlikely the pairs are, by a kernel's parameters (5.17).
pub(crate) struct Likelihood<'a> {
    products: Products,
    outputs: Matrix,
    options: &'a RegressionOptions,
}

impl<'a> Likelihood<'a> {
    /// Of centred inputs and outputs.
    pub fn new(x: &Matrix, y: &Matrix, options: &'a RegressionOptions) -> Self {
        Self { products: Products::of(x), outputs: y.clone(), options }
    }

    /// `1/2 tr(Y^T K^-1 Y) + m/2 ln |K| + N m / 2 ln 2 pi`, and what too much gain costs, with their derivatives; `None` where K is not regular.
    pub fn at(&self, parameters: &Parameters) -> Option<(f64, [f64; 3])> {
        let RegressionOptions { kernel, floor, .. } = *self.options;
        let [values, slopes] = self.products.kernels(kernel, parameters, floor);
        let factor = Cholesky::of(&values)?;
        let inverse = factor.inverse();
        let answers = inverse.times(&self.outputs);
        let (n, m) = (values.rows(), self.outputs.columns() as f64);
        let value = 0.5 * self.outputs.dot(&answers)
            + 0.5 * m * factor.log_determinant()
            + 0.5 * n as f64 * m * std::f64::consts::TAU.ln();
        // dL/dK = 1/2 (m K^-1 - K^-1 Y Y^T K^-1)
        let spread = answers.gram();
        let mut slope = [0.0; 3];
        let noise = noise(kernel, parameters, floor);
        let own = (2.0 * parameters.noise).exp();
        for i in 0..n {
            for j in 0..=i {
                // Each entry beside the diagonal stands for two.
                let twice = if i == j { 1.0 } else { 2.0 };
                let by_entry = 0.5 * twice * (m * inverse[(i, j)] - spread[(i, j)]);
                let signal = if i == j { values[(i, j)] - noise } else { values[(i, j)] };
                slope[0] += by_entry * 2.0 * signal;
                slope[1] += by_entry * slopes[(i, j)];
                if i == j {
                    slope[2] += by_entry * 2.0 * own;
                }
            }
        }
        let too_much = match kernel {
            Kernel::Linear => (parameters.signal - parameters.length - self.options.gain.ln()).max(0.0),
            _ => 0.0,
        };
        let value = value + 0.5 * STIFF * too_much * too_much;
        slope[0] += STIFF * too_much;
        slope[1] -= STIFF * too_much;
        value.is_finite().then_some((value, slope))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kernels::random::signed;

    fn pairs(count: usize) -> (Matrix, Matrix) {
        let x = Matrix::from_fn(count, 2, |row, column| f64::from(signed(3, (2 * row + column) as u64)));
        let y = Matrix::from_fn(count, 3, |row, column| {
            let [a, b] = [x[(row, 0)], x[(row, 1)]];
            [(2.0 * a).sin() + 0.3 * b, a * b, 0.5 - a][column]
        });
        (x, y)
    }

    const OPTIONS: RegressionOptions =
        RegressionOptions { kernel: Kernel::NeuralNetwork, floor: 0.003, gain: f64::INFINITY, steps: 80 };

    #[test]
    fn slopes_of_the_likelihood_are_those_of_differences() {
        let (x, y) = pairs(12);
        for kernel in [Kernel::NeuralNetwork, Kernel::SquaredExponential, Kernel::Linear] {
            let options = RegressionOptions { kernel, ..OPTIONS };
            let likelihood = Likelihood::new(&x, &y, &options);
            let place = [0.2, -0.3, -1.5];
            let (_, slope) = likelihood.at(&parameters(&place)).unwrap();
            for k in 0..3 {
                let at = |step: f64| {
                    let mut moved = place;
                    moved[k] += step;
                    likelihood.at(&parameters(&moved)).unwrap().0
                };
                let plain = (at(1e-5) - at(-1e-5)) / 2e-5;
                assert!((slope[k] - plain).abs() < 1e-5 * plain.abs().max(1.0), "{kernel:?} {k}: {} {plain}", slope[k]);
            }
        }
    }

    /// By Gauss's elimination of an explicit matrix, written out apart from all of this.
    #[test]
    fn the_likelihood_is_that_of_an_explicit_gaussian() {
        let x: [f64; 8] = [-1.7, -1.1, -0.6, -0.1, 0.4, 0.9, 1.3, 1.9];
        let y: [f64; 8] = [0.3, -0.4, -0.9, -0.2, 0.5, 0.8, 0.6, -0.7];
        let options =
            RegressionOptions { kernel: Kernel::SquaredExponential, floor: 0.1, gain: f64::INFINITY, steps: 0 };
        let rows = |values: [f64; 8]| Matrix::from_fn(8, 1, |row, _| values[row]);
        let likelihood = Likelihood::new(&rows(x), &rows(y), &options);
        let at = Parameters { signal: 0.7_f64.ln(), length: 0.5_f64.ln(), noise: 0.2_f64.ln() };
        let (value, _) = likelihood.at(&at).unwrap();
        assert!((value - FIXTURE).abs() < 1e-9, "{value}");
    }

    const FIXTURE: f64 = 5.9102856825835675;

    #[test]
    fn what_was_shown_comes_back_and_what_was_not_is_near() {
        let (x, y) = pairs(60);
        let learned: Vec<usize> = (0..40).collect();
        for kernel in [Kernel::NeuralNetwork, Kernel::SquaredExponential] {
            let options = RegressionOptions { kernel, ..OPTIONS };
            let map = Regression::train(&x.of_rows(&learned), &y.of_rows(&learned), &options).unwrap();
            let error = |row: usize| {
                let found = map.predict(x.row(row));
                found.iter().zip(y.row(row)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
            };
            assert!((0..40).map(error).fold(0.0, f64::max) < 0.02, "{kernel:?}");
            assert!((40..60).map(error).sum::<f64>() / 20.0 < 0.03, "{kernel:?}");
            // Inputs lie within 1 of nothing.
            let deviation = (x.of_rows(&learned).dot(&x.of_rows(&learned)) / 40.0).sqrt();
            assert!(map.far(x.row(7)) < 1e-9);
            assert!((map.far(&[1e3, 0.0]) - 1e3 / deviation).abs() < 3.0 / deviation);
        }
    }

    #[test]
    fn the_affine_map_is_exact_on_affine_data() {
        let (x, _) = pairs(20);
        let y = Matrix::from_fn(20, 1, |row, _| 3.0 * x[(row, 0)] - x[(row, 1)] + 0.7);
        for kernel in [Kernel::Affine, Kernel::Linear] {
            let options = RegressionOptions { kernel, floor: 1e-5, gain: f64::INFINITY, steps: 80 };
            let map = Regression::train(&x, &y, &options).unwrap();
            let found = map.predict(&[2.0, -3.0])[0];
            assert!((found - 9.7).abs() < 1e-3, "{kernel:?}: {found}");
        }
    }

    #[test]
    fn pairs_that_are_there_twice_do_no_harm() {
        let (x, y) = pairs(10);
        let twice: Vec<usize> = (0..30).map(|k| k % 10).collect();
        for kernel in [Kernel::NeuralNetwork, Kernel::SquaredExponential, Kernel::Linear, Kernel::Affine] {
            let options = RegressionOptions { kernel, ..OPTIONS };
            let map = Regression::train(&x.of_rows(&twice), &y.of_rows(&twice), &options).unwrap();
            assert!(map.predict(x.row(3)).iter().all(|value| value.is_finite()), "{kernel:?}");
        }
        let still = Matrix::zeros(10, 2);
        assert!(Regression::train(&still, &y, &OPTIONS).is_none());
        assert!(Regression::train(&x.of_rows(&[0]), &y.of_rows(&[0]), &OPTIONS).is_none());
    }
}
