//! Least squares of unknowns in a row, each tied to its neighbours only.
//!
//! Beside [`crate::cholesky`], for any pattern, because a walk's band is another one each time, and as long as the walk.

/// Unknowns that follow each other in one row: three places and turns of a walk.
const WIDTH: usize = 9;

/// Normal equations of a least-squares problem of which no row spans more than nine unknowns that follow each other:
/// the lower half of a band matrix, row by row, and the right side.
pub struct Band {
    lower: Vec<[f64; WIDTH]>,
    right: Vec<f64>,
}

impl Band {
    /// No equation yet. What no row ties down stays near zero.
    #[must_use]
    pub fn new(unknowns: usize) -> Self {
        let mut still = [0.0; WIDTH];
        still[WIDTH - 1] = 1e-6;
        Self { lower: vec![still; unknowns], right: vec![0.0; unknowns] }
    }

    /// Adds the square of `weight * (residual + sum of coefficients times unknowns)`, the unknowns from `first` on, which must exist.
    pub fn add(&mut self, first: usize, coefficients: &[f64], residual: f64, weight: f64) {
        let square = weight * weight;
        for (row, &a) in coefficients.iter().enumerate() {
            if a == 0.0 {
                continue;
            }
            let scaled = square * a;
            self.right[first + row] -= scaled * residual;
            let lower = &mut self.lower[first + row];
            for (into, &b) in lower[WIDTH - 1 - row..].iter_mut().zip(&coefficients[..=row]) {
                *into += scaled * b;
            }
        }
    }

    /// The unknowns for which the sum of squares is least, by Cholesky's factorisation.
    #[must_use]
    pub fn solve(mut self) -> Vec<f64> {
        let count = self.right.len();
        for row in 0..count {
            let first = (row + 1).saturating_sub(WIDTH);
            for column in first..=row {
                // Products of what both rows have left of `column`.
                let from = first.max((column + 1).saturating_sub(WIDTH));
                let mut sum = self.lower[row][WIDTH - 1 + column - row];
                for k in from..column {
                    sum -= self.lower[row][WIDTH - 1 + k - row] * self.lower[column][WIDTH - 1 + k - column];
                }
                self.lower[row][WIDTH - 1 + column - row] = match column == row {
                    true => sum.max(1e-9).sqrt(),
                    false => sum / self.lower[column][WIDTH - 1],
                };
            }
            let mut sum = self.right[row];
            for k in first..row {
                sum -= self.lower[row][WIDTH - 1 + k - row] * self.right[k];
            }
            self.right[row] = sum / self.lower[row][WIDTH - 1];
        }
        for row in (0..count).rev() {
            self.right[row] /= self.lower[row][WIDTH - 1];
            for k in (row + 1).saturating_sub(WIDTH)..row {
                self.right[k] -= self.lower[row][WIDTH - 1 + k - row] * self.right[row];
            }
        }
        self.right
    }
}

#[cfg(test)]
mod tests {
    use super::Band;

    /// Against elimination on the whole matrix.
    #[test]
    fn solves_what_elimination_solves() {
        let mut random = fixtures::Random::new(7);
        let count = 23;
        let mut band = Band::new(count);
        let mut whole = vec![vec![0.0_f64; count + 1]; count];
        (0..count).for_each(|row| whole[row][row] = 1e-6);
        for first in 0..count - 8 {
            for _ in 0..3 {
                let row: [f64; 9] = std::array::from_fn(|_| f64::from(random.range(-1.0, 1.0)));
                let (residual, weight) = (f64::from(random.range(-1.0, 1.0)), f64::from(random.range(0.1, 3.0)));
                band.add(first, &row, residual, weight);
                for a in 0..9 {
                    for b in 0..9 {
                        whole[first + a][first + b] += weight * weight * row[a] * row[b];
                    }
                    whole[first + a][count] -= weight * weight * row[a] * residual;
                }
            }
        }
        for pivot in 0..count {
            let row = whole[pivot].clone();
            for (_, other) in whole.iter_mut().enumerate().filter(|&(index, _)| index != pivot) {
                let share = other[pivot] / row[pivot];
                other.iter_mut().zip(&row).for_each(|(value, of)| *value -= share * of);
            }
        }
        for (index, found) in band.solve().into_iter().enumerate() {
            let exact = whole[index][count] / whole[index][index];
            assert!((found - exact).abs() < 1e-8 * exact.abs().max(1.0), "{index}: {found} against {exact}");
        }
    }
}
