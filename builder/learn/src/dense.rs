//! Small dense matrices of double precision, in a fixed order of operations: products, and Cholesky's factor with what follows
//! from it.
//!
//! Chains of random numbers are walked with the results: the last bit of a product decides where they end. A library's
//! version picks its operations by the processor, and the same seed would show another motion on another machine.

use std::ops::{Index, IndexMut};

use kernels::simd::{Kernel, Level};

use crate::blocks::{Factorise, Gram, Invert, Padded, Product, Solve, add_multiple};

/// Partial sums of a product of two rows.
const LANES: usize = 16;
/// Fewer rows than this are multiplied one by one: filling up the other matrix would take as long as the product.
const FEW: usize = 4;

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
        assert_eq!(self.columns, other.rows, "matrices that do not fit");
        if self.rows < FEW {
            return Level::best().run(FewTimes { left: self, right: other });
        }
        product(&self.padded_transposed(), &other.padded(), [self.rows, other.columns])
    }

    /// `self * other^T`: the products of all pairs of rows.
    #[must_use]
    pub fn times_transposed(&self, other: &Self) -> Self {
        assert_eq!(self.columns, other.columns, "matrices that do not fit");
        if self.rows < FEW {
            return Level::best().run(Products { left: self, right: other });
        }
        product(&self.padded_transposed(), &other.padded_transposed(), [self.rows, other.rows])
    }

    /// `self * self^T`, with half of the work.
    #[must_use]
    pub fn gram(&self) -> Self {
        let own = self.padded_transposed();
        let mut gram =
            Self::trimmed(&Level::best().run(Gram { values: &own, is_lower: false }), [self.rows, self.rows]);
        gram.mirror();
        gram
    }

    fn padded(&self) -> Padded {
        Padded::of(&self.values, [self.rows, self.columns])
    }

    fn padded_transposed(&self) -> Padded {
        Padded::transposed(&self.values, [self.rows, self.columns])
    }

    /// The first rows and columns of what was filled up.
    fn trimmed(padded: &Padded, size: [usize; 2]) -> Self {
        Self { rows: size[0], columns: size[1], values: padded.trimmed(size) }
    }

    /// Copies what is above the diagonal of a square matrix below it.
    fn mirror(&mut self) {
        for row in 1..self.rows {
            for column in 0..row {
                self[(row, column)] = self[(column, row)];
            }
        }
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
    size: usize,
    /// L^T: its upper triangle; what is below means nothing.
    factor: Padded,
}

impl Cholesky {
    /// The factor of `matrix`, of which the lower triangle is read; `None` where it is not positive definite.
    #[must_use]
    pub fn of(matrix: &Matrix) -> Option<Self> {
        assert_eq!(matrix.rows, matrix.columns, "only square matrices have a factor");
        let mut padded = matrix.padded_transposed();
        // What fills it up is a matrix of its own, whose factor is itself.
        padded.fill_diagonal(matrix.rows);
        let factor = Level::best().run(Factorise { values: padded })?;
        Some(Self { size: matrix.rows, factor })
    }

    /// The logarithm of the determinant of A.
    #[must_use]
    pub fn log_determinant(&self) -> f64 {
        (0..self.size).map(|k| 2.0 * self.factor.row(k)[k].ln()).sum()
    }

    /// The inverse of A.
    #[must_use]
    pub fn inverse(&self) -> Matrix {
        let halves = Level::best().run(Invert { factor: &self.factor });
        let mut inverse =
            Matrix::trimmed(&Level::best().run(Gram { values: &halves, is_lower: true }), [self.size, self.size]);
        inverse.mirror();
        inverse
    }

    /// The inverse of L. Products with it and with its transpose lose less than those with the inverse of A.
    #[must_use]
    pub fn lower_inverse(&self) -> Matrix {
        Matrix::trimmed(&Level::best().run(Invert { factor: &self.factor }), [self.size, self.size])
    }

    /// X of A X = `right`.
    #[must_use]
    pub fn solve(&self, right: &Matrix) -> Matrix {
        assert_eq!(right.rows, self.size, "matrices that do not fit");
        let solved = Level::best().run(Solve { factor: &self.factor, right: right.padded() });
        Matrix::trimmed(&solved, [self.size, right.columns])
    }
}

/// `left^T * right` without what fills it up.
fn product(left: &Padded, right: &Padded, size: [usize; 2]) -> Matrix {
    Matrix::trimmed(&Level::best().run(Product { left, right }), size)
}

/// The sum of the products of two rows of one length.
#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; LANES];
    let (a, b) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
    for (a, b) in a.0.iter().zip(b.0) {
        for lane in 0..LANES {
            sums[lane] = a[lane].mul_add(b[lane], sums[lane]);
        }
    }
    for (lane, (a, b)) in a.1.iter().zip(b.1).enumerate() {
        sums[lane] = a.mul_add(*b, sums[lane]);
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

struct FewTimes<'a> {
    left: &'a Matrix,
    right: &'a Matrix,
}

impl Kernel for FewTimes<'_> {
    type Output = Matrix;

    #[inline(always)]
    fn run(self) -> Matrix {
        let mut products = Matrix::zeros(self.left.rows, self.right.columns);
        for i in 0..self.left.rows {
            for (k, share) in self.left.row(i).iter().enumerate() {
                add_multiple(products.row_mut(i), *share, self.right.row(k));
            }
        }
        products
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
        for (rows, inner, columns) in [(7, 37, 5), (1, 37, 5), (8, 16, 24), (30, 1, 9)] {
            let (a, b) = (random(rows, inner, 1), random(inner, columns, 2));
            let (product, other, own) = (a.times(&b), a.times_transposed(&b.transposed()), a.gram());
            for i in 0..rows {
                for j in 0..columns {
                    let plain: f64 = (0..inner).map(|k| a[(i, k)] * b[(k, j)]).sum();
                    assert!((product[(i, j)] - plain).abs() < 1e-13 && (other[(i, j)] - plain).abs() < 1e-13);
                }
                for j in 0..rows {
                    let plain: f64 = (0..inner).map(|k| a[(i, k)] * a[(j, k)]).sum();
                    assert!((own[(i, j)] - plain).abs() < 1e-13);
                }
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
            let lower = cholesky.lower_inverse();
            let same = lower.transposed().gram();
            assert!(same.values().iter().zip(cholesky.inverse().values()).all(|(a, b)| (a - b).abs() < 1e-9));
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
        let of = |level: Level| {
            let factor = level.run(Factorise { values: matrix.padded() }).unwrap();
            let inverse = level.run(Invert { factor: &factor });
            let product = level.run(Gram { values: &inverse, is_lower: true });
            let solved = level.run(Solve { factor: &factor, right: half.padded() });
            let all = level.run(Product { left: &product, right: &solved });
            (
                all,
                level.run(Gram { values: &inverse, is_lower: false }),
                level.run(FewTimes { left: &half, right: &matrix }),
            )
        };
        assert!(all.iter().all(|&level| of(level) == of(all[0])));
    }
}
