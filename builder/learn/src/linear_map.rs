//! A linear map from few examples that knows how little it knows.
//!
//! Thesis equations 5.4 to 5.7: Bayes' linear regression, a Gaussian of variance 1 before each entry of the map M. The
//! variance of a prediction is that of M and of the noise; equation 5.8 leaves the noise out, and divides by zero at the
//! mean pose.

use crate::dense::{Cholesky, Matrix};

/// A map y = M x, as far as examples tell it.
#[derive(Clone, Debug)]
pub struct LinearMap {
    /// Means of inputs and outputs, which are taken off.
    means: [Vec<f64>; 2],
    /// The mean of M: a row an output.
    map: Matrix,
    /// A^-1: how little is known along each direction of inputs.
    unknown: Matrix,
    /// The variance of the noise.
    noise: f64,
}

impl LinearMap {
    /// The map from the rows of `inputs` to those of `outputs`, which have noise of the variance `noise`. `None` where numbers are not
    /// finite, or there is no example.
    #[must_use]
    pub fn fit(inputs: &Matrix, outputs: &Matrix, noise: f64) -> Option<Self> {
        let count = inputs.rows();
        if count == 0 || outputs.rows() != count {
            return None;
        }
        let mean = |rows: &Matrix| -> Vec<f64> {
            (0..rows.columns()).map(|k| (0..count).map(|row| rows[(row, k)]).sum::<f64>() / count as f64).collect()
        };
        let means = [mean(inputs), mean(outputs)];
        // Transposed: a row a number.
        let x = Matrix::from_fn(inputs.columns(), count, |k, row| inputs[(row, k)] - means[0][k]);
        let y = Matrix::from_fn(outputs.columns(), count, |k, row| outputs[(row, k)] - means[1][k]);
        let identity = Matrix::from_fn(x.rows(), x.rows(), |row, column| f64::from(u8::from(row == column)));
        let unknown = Cholesky::of(&identity.plus(1.0 / noise, &x.times_transposed(&x)))?.inverse();
        let mut map = y.times_transposed(&x).times_transposed(&unknown);
        map.values_mut().iter_mut().for_each(|value| *value /= noise);
        map.values().iter().all(|value| value.is_finite()).then_some(Self { means, map, unknown, noise })
    }

    /// The output for an input, and the variance of each of its numbers.
    #[must_use]
    pub fn predict(&self, input: &[f64]) -> (Vec<f64>, f64) {
        let x: Vec<f64> = input.iter().zip(&self.means[0]).map(|(x, mean)| x - mean).collect();
        let dot = |row: &[f64]| row.iter().zip(&x).map(|(a, b)| a * b).sum::<f64>();
        let variance = (0..x.len()).map(|k| x[k] * dot(self.unknown.row(k))).sum::<f64>();
        let output = self.means[1].iter().enumerate().map(|(k, mean)| mean + dot(self.map.row(k))).collect();
        (output, variance.max(0.0) + self.noise)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kernels::random::signed;

    #[test]
    fn what_examples_tell_is_sure_and_the_rest_is_not() {
        // Examples along one direction of three.
        let x = Matrix::from_fn(9, 3, |row, column| if column == 0 { row as f64 - 3.0 } else { 0.0 });
        let y = Matrix::from_fn(9, 2, |row, column| [2.0, -1.0][column] * (row as f64 - 3.0) + 5.0);
        let map = LinearMap::fit(&x, &y, 1e-4).unwrap();
        let (along, sure) = map.predict(&[2.0, 0.0, 0.0]);
        assert!((along[0] - 9.0).abs() < 1e-3 && (along[1] - 3.0).abs() < 1e-3 && sure < 3e-4, "{along:?} {sure}");
        let (across, unsure) = map.predict(&[1.0, 2.0, 0.0]);
        assert!((across[0] - 7.0).abs() < 1e-3 && (unsure - 4.0).abs() < 1e-2, "{across:?} {unsure}");
    }

    /// Equation 5.6 with the outputs one by one, by solving instead of inverting.
    #[test]
    fn the_map_is_the_ridge_regression() {
        let number = |seed: u64, k: usize| f64::from(signed(seed, k as u64));
        let x = Matrix::from_fn(7, 4, |row, column| number(1, 4 * row + column));
        let y = Matrix::from_fn(7, 2, |row, column| number(2, 2 * row + column));
        let map = LinearMap::fit(&x, &y, 0.3).unwrap();
        let mean = |m: &Matrix, k: usize| (0..7).map(|row| m[(row, k)]).sum::<f64>() / 7.0;
        let a = Matrix::from_fn(4, 4, |i, j| {
            let sum = (0..7).map(|r| (x[(r, i)] - mean(&x, i)) * (x[(r, j)] - mean(&x, j))).sum::<f64>();
            sum + if i == j { 0.3 } else { 0.0 }
        });
        let b = Matrix::from_fn(4, 2, |i, k| {
            (0..7).map(|r| (x[(r, i)] - mean(&x, i)) * (y[(r, k)] - mean(&y, k))).sum::<f64>()
        });
        let weights = Cholesky::of(&a).unwrap().solve(&b);
        let (found, _) = map.predict(x.row(2));
        for k in 0..2 {
            let plain = mean(&y, k) + (0..4).map(|i| (x[(2, i)] - mean(&x, i)) * weights[(i, k)]).sum::<f64>();
            assert!((found[k] - plain).abs() < 1e-12);
        }
        assert!(LinearMap::fit(&Matrix::zeros(0, 4), &Matrix::zeros(0, 2), 1.0).is_none());
    }
}
