//! Small dense matrices of double precision, in a fixed order of operations: products, and Cholesky's factor with what follows
//! from it.
//!
//! Chains of random numbers are walked with the results: the last bit of a product decides where they end. A library's
//! version picks its operations by the processor, and the same seed would show another motion on another machine.

use std::ops::{Index, IndexMut};

use kernels::simd::{Kernel, Level};

/// Partial sums of a product of two rows.
const LANES: usize = 16;

/// A matrix, row-major.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Matrix {
    rows: usize,
    columns: usize,
    values: Vec<f64>,
}

impl Matrix {
    /// All zero.
    #[must_use]
    pub fn zeros(rows: usize, columns: usize) -> Self {
        Self { rows, columns, values: vec![0.0; rows * columns] }
    }

    /// The matrix of the entries `entry(row, column)`.
    #[must_use]
    pub fn from_fn(rows: usize, columns: usize, mut entry: impl FnMut(usize, usize) -> f64) -> Self {
        let mut matrix = Self::zeros(rows, columns);
        for (row, values) in matrix.values.chunks_exact_mut(columns.max(1)).enumerate() {
            values.iter_mut().enumerate().for_each(|(column, value)| *value = entry(row, column));
        }
        matrix
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// A row.
    #[must_use]
    pub fn row(&self, row: usize) -> &[f64] {
        &self.values[row * self.columns..(row + 1) * self.columns]
    }

    /// A row.
    #[must_use]
    pub fn row_mut(&mut self, row: usize) -> &mut [f64] {
        &mut self.values[row * self.columns..(row + 1) * self.columns]
    }

    /// All entries, row-major.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// All entries, row-major.
    #[must_use]
    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// Some rows, in the order of `rows`.
    #[must_use]
    pub fn of_rows(&self, rows: &[usize]) -> Self {
        let mut chosen = Self::zeros(rows.len(), self.columns);
        for (row, &from) in rows.iter().enumerate() {
            chosen.row_mut(row).copy_from_slice(self.row(from));
        }
        chosen
    }

    /// The transposed matrix.
    #[must_use]
    pub fn transposed(&self) -> Self {
        Self::from_fn(self.columns, self.rows, |row, column| self[(column, row)])
    }

    /// `self * other`.
    ///
    /// # Panics
    /// Where the sizes do not fit, as all that follow do.
    #[must_use]
    pub fn times(&self, other: &Self) -> Self {
        self.times_transposed(&other.transposed())
    }

    /// `self * other^T`: the products of all pairs of rows.
    #[must_use]
    pub fn times_transposed(&self, other: &Self) -> Self {
        assert_eq!(self.columns, other.columns, "matrices that do not fit");
        Level::best().run(Products { left: self, right: other })
    }

    /// `self + factor * other`.
    #[must_use]
    pub fn plus(mut self, factor: f64, other: &Self) -> Self {
        assert_eq!((self.rows, self.columns), (other.rows, other.columns), "matrices that do not fit");
        self.values.iter_mut().zip(&other.values).for_each(|(own, other)| *own += factor * other);
        self
    }

    /// The sum of the products of entries.
    #[must_use]
    pub fn dot(&self, other: &Self) -> f64 {
        self.values.iter().zip(&other.values).map(|(a, b)| a * b).sum()
    }
}

impl Index<(usize, usize)> for Matrix {
    type Output = f64;

    fn index(&self, (row, column): (usize, usize)) -> &f64 {
        &self.values[row * self.columns + column]
    }
}

impl IndexMut<(usize, usize)> for Matrix {
    fn index_mut(&mut self, (row, column): (usize, usize)) -> &mut f64 {
        &mut self.values[row * self.columns + column]
    }
}

/// Cholesky's factor L of a symmetric positive definite matrix, A = L L^T.
#[derive(Clone, Debug)]
pub struct Cholesky {
    /// Lower triangle; zero above.
    factor: Matrix,
}

impl Cholesky {
    /// The factor of `matrix`, of which the lower triangle is read; `None` where it is not positive definite.
    #[must_use]
    pub fn of(matrix: &Matrix) -> Option<Self> {
        assert_eq!(matrix.rows, matrix.columns, "only square matrices have a factor");
        Level::best().run(Factorise { matrix }).map(|factor| Self { factor })
    }

    /// The logarithm of the determinant of A.
    #[must_use]
    pub fn log_determinant(&self) -> f64 {
        (0..self.factor.rows).map(|k| 2.0 * self.factor[(k, k)].ln()).sum()
    }

    /// The inverse of A.
    #[must_use]
    pub fn inverse(&self) -> Matrix {
        // Rows are the columns of the inverse of L: zero before the diagonal.
        let halves = Level::best().run(Invert { factor: &self.factor });
        halves.times_transposed(&halves)
    }

    /// The lower triangle of the inverse of A; zero above. A sixth of the work of [`Self::inverse`], which sums in another order.
    #[must_use]
    pub fn inverse_lower(&self) -> Matrix {
        Level::best().run(LowerInverse { columns: Level::best().run(Invert { factor: &self.factor }) })
    }

    /// The inverse of L. Products with it and with its transpose lose less than those with the inverse of A.
    #[must_use]
    pub fn lower_inverse(&self) -> Matrix {
        Level::best().run(Invert { factor: &self.factor }).transposed()
    }

    /// X of A X = `right`.
    #[must_use]
    pub fn solve(&self, right: &Matrix) -> Matrix {
        Level::best().run(Solve { factor: &self.factor, right: right.transposed() }).transposed()
    }
}

/// The sum of the products of two rows of one length.
#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; LANES];
    let (a, b) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
    for (a, b) in a.0.iter().zip(b.0) {
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane];
        }
    }
    for (lane, (a, b)) in a.1.iter().zip(b.1).enumerate() {
        sums[lane] += a * b;
    }
    let mut width = LANES / 2;
    while width > 0 {
        for lane in 0..width {
            sums[lane] += sums[lane + width];
        }
        width /= 2;
    }
    sums[0]
}

struct Products<'a> {
    left: &'a Matrix,
    right: &'a Matrix,
}

impl Kernel for Products<'_> {
    type Output = Matrix;

    #[inline(always)]
    fn run(self) -> Matrix {
        let mut products = Matrix::zeros(self.left.rows, self.right.rows);
        for i in 0..self.left.rows {
            for j in 0..self.right.rows {
                products.values[i * self.right.rows + j] = dot(self.left.row(i), self.right.row(j));
            }
        }
        products
    }
}

struct Factorise<'a> {
    matrix: &'a Matrix,
}

impl Kernel for Factorise<'_> {
    type Output = Option<Matrix>;

    #[inline(always)]
    fn run(self) -> Option<Matrix> {
        let n = self.matrix.rows;
        let mut factor = Matrix::zeros(n, n);
        for i in 0..n {
            for j in 0..=i {
                let (before, row) = factor.values.split_at_mut(i * n);
                let own = &row[..j];
                let rest = if i == j {
                    self.matrix.values[i * n + i] - dot(own, own)
                } else {
                    self.matrix.values[i * n + j] - dot(own, &before[j * n..j * n + j])
                };
                if i == j {
                    if !(rest > 0.0 && rest.is_finite()) {
                        return None;
                    }
                    row[i] = rest.sqrt();
                } else {
                    row[j] = rest / before[j * n + j];
                }
            }
        }
        Some(factor)
    }
}

struct Invert<'a> {
    factor: &'a Matrix,
}

impl Kernel for Invert<'_> {
    type Output = Matrix;

    #[inline(always)]
    fn run(self) -> Matrix {
        let n = self.factor.rows;
        let mut columns = Matrix::zeros(n, n);
        for c in 0..n {
            let column = &mut columns.values[c * n..(c + 1) * n];
            column[c] = 1.0 / self.factor.values[c * n + c];
            for i in c + 1..n {
                let row = &self.factor.values[i * n..(i + 1) * n];
                column[i] = -dot(&row[c..i], &column[c..i]) / row[i];
            }
        }
        columns
    }
}

struct LowerInverse {
    /// Columns of the inverse of L, a row each: zero before the diagonal.
    columns: Matrix,
}

impl Kernel for LowerInverse {
    type Output = Matrix;

    #[inline(always)]
    fn run(self) -> Matrix {
        let n = self.columns.rows;
        let mut inverse = Matrix::zeros(n, n);
        for i in 0..n {
            for j in 0..=i {
                inverse.values[i * n + j] = dot(&self.columns.row(i)[i..], &self.columns.row(j)[i..]);
            }
        }
        inverse
    }
}

struct Solve<'a> {
    factor: &'a Matrix,
    /// A right side a row.
    right: Matrix,
}

impl Kernel for Solve<'_> {
    type Output = Matrix;

    #[inline(always)]
    fn run(mut self) -> Matrix {
        let n = self.factor.rows;
        assert_eq!(self.right.columns, n, "matrices that do not fit");
        for x in self.right.values.chunks_exact_mut(n.max(1)) {
            for i in 0..n {
                let row = &self.factor.values[i * n..(i + 1) * n];
                x[i] = (x[i] - dot(&row[..i], &x[..i])) / row[i];
            }
            for i in (0..n).rev() {
                let row = &self.factor.values[i * n..(i + 1) * n];
                x[i] /= row[i];
                let own = x[i];
                for j in 0..i {
                    x[j] -= row[j] * own;
                }
            }
        }
        self.right
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kernels::random::signed;

    fn random(rows: usize, columns: usize, seed: u64) -> Matrix {
        Matrix::from_fn(rows, columns, |row, column| f64::from(signed(seed, (row * columns + column) as u64)))
    }

    #[test]
    fn products_are_those_of_plain_sums() {
        let (a, b) = (random(7, 37, 1), random(37, 5, 2));
        let product = a.times(&b);
        for i in 0..7 {
            for j in 0..5 {
                let plain: f64 = (0..37).map(|k| a[(i, k)] * b[(k, j)]).sum();
                assert!((product[(i, j)] - plain).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn what_is_solved_and_inverted_gives_the_matrix_back() {
        for n in [1, 2, 16, 33, 70] {
            let half = random(n, n, 3);
            let matrix =
                half.times_transposed(&half).plus(1.0, &Matrix::from_fn(n, n, |i, j| f64::from(u8::from(i == j))));
            let cholesky = Cholesky::of(&matrix).unwrap();
            let unit = matrix.times(&cholesky.inverse());
            let right = random(n, 3, 4);
            let back = matrix.times(&cholesky.solve(&right));
            for i in 0..n {
                for j in 0..n {
                    assert!((unit[(i, j)] - f64::from(u8::from(i == j))).abs() < 1e-9);
                }
                for j in 0..3 {
                    assert!((back[(i, j)] - right[(i, j)]).abs() < 1e-9);
                }
            }
        }
        let two = Matrix::from_fn(2, 2, |i, j| if i == j { 2.0 } else { 1.0 });
        assert!((Cholesky::of(&two).unwrap().log_determinant() - 3.0_f64.ln()).abs() < 1e-15);
        assert!(Cholesky::of(&Matrix::from_fn(2, 2, |_, _| 1.0)).is_none());
        assert!(Cholesky::of(&Matrix::from_fn(1, 1, |_, _| f64::NAN)).is_none());
    }

    #[test]
    fn every_level_of_instructions_gives_the_same_bits() {
        let half = random(40, 40, 5);
        let matrix = half.times_transposed(&half);
        let all = Level::available();
        let of = |level: Level| level.run(Factorise { matrix: &matrix });
        assert!(all.iter().all(|&level| of(level) == of(all[0])));
    }
}
