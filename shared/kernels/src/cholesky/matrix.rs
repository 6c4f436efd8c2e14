//! The numbers of a symmetric matrix over a pattern.

use super::{CholeskyError, SymmetricPattern};

/// Numbers over a [`SymmetricPattern`]: what a factorisation reads.
pub trait SymmetricEntries {
    /// Numbers of rows and edges of the pattern.
    fn size(&self) -> [usize; 2];
    /// The entry (row, row).
    fn diagonal(&self, row: usize) -> f64;
    /// The entry at both places of an edge.
    fn off_diagonal(&self, edge: usize) -> f64;
}

/// A symmetric matrix in double precision: a number for each row (the diagonal) and one for each edge of its pattern.
///
/// Normal equations are summed equation by equation. Here a path is bent: three places on a line are to be one apart, the
/// first one at 0 and, half as important, the last one at 3.
///
/// ```
/// use kernels::cholesky::{SymmetricMatrix, SymmetricPattern, solve_once};
///
/// let equations: [(&[(u32, f64)], f64, f64); 4] = [
///     (&[(0, -1.0), (1, 1.0)], 1.0, 1.0),
///     (&[(1, -1.0), (2, 1.0)], 1.0, 1.0),
///     (&[(0, 1.0)], 1.0, 0.0),
///     (&[(2, 1.0)], 0.5, 3.0),
/// ];
/// let pattern = SymmetricPattern::from_edges(3, &[[0, 1], [1, 2]])?;
/// let mut matrix = SymmetricMatrix::zeros(&pattern);
/// let mut right = [0.0; 3];
/// for (row, weight, wanted) in equations {
///     matrix.add_equation(&pattern, row, weight)?;
///     for &(unknown, factor) in row {
///         right[unknown as usize] += weight * factor * wanted;
///     }
/// }
/// let places = solve_once(&pattern, &matrix, &right, 1)?;
/// // What is missing is shared out: a fifth each, and twice that where the weight is a half.
/// for (place, expected) in places.iter().zip([0.2, 1.4, 2.6]) {
///     assert!((place - expected).abs() < 1e-12);
/// }
/// # Ok::<(), kernels::cholesky::CholeskyError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SymmetricMatrix {
    diagonal: Vec<f64>,
    off_diagonal: Vec<f64>,
}

impl SymmetricMatrix {
    /// All zeros over `pattern`.
    #[must_use]
    pub fn zeros(pattern: &SymmetricPattern) -> Self {
        Self { diagonal: vec![0.0; pattern.row_count()], off_diagonal: vec![0.0; pattern.edges().len()] }
    }

    /// Sets all entries to zero.
    pub fn clear(&mut self) {
        self.diagonal.fill(0.0);
        self.off_diagonal.fill(0.0);
    }

    /// The diagonal, one per row.
    #[must_use]
    pub fn diagonal(&self) -> &[f64] {
        &self.diagonal
    }

    /// The diagonal, to be changed.
    pub fn diagonal_mut(&mut self) -> &mut [f64] {
        &mut self.diagonal
    }

    /// The other entries, one per edge.
    #[must_use]
    pub fn off_diagonal(&self) -> &[f64] {
        &self.off_diagonal
    }

    /// The other entries, to be changed.
    pub fn off_diagonal_mut(&mut self) -> &mut [f64] {
        &mut self.off_diagonal
    }

    /// Adds `value` to the entry (row, column), and where that is not on the diagonal to (column, row).
    ///
    /// # Errors
    /// [`CholeskyError::NoEntry`] where the pattern has none there.
    pub fn add(&mut self, pattern: &SymmetricPattern, row: u32, column: u32, value: f64) -> Result<(), CholeskyError> {
        *self.entry(pattern, row, column)? += value;
        Ok(())
    }

    /// Adds `weight a a^T`, the part of an equation `a^T x = wanted` of this weight in normal equations; `a` is given by
    /// its entries, those of a row that is named twice being added. The right side gets `weight wanted a`.
    ///
    /// # Errors
    /// [`CholeskyError::NoEntry`] where the pattern lacks an entry; the matrix is then as it was.
    pub fn add_equation(
        &mut self,
        pattern: &SymmetricPattern,
        a: &[(u32, f64)],
        weight: f64,
    ) -> Result<(), CholeskyError> {
        for (k, &(row, _)) in a.iter().enumerate() {
            for &(column, _) in &a[k..] {
                self.entry(pattern, row, column)?;
            }
        }
        for (k, &(row, own)) in a.iter().enumerate() {
            self.diagonal[row as usize] += weight * own * own;
            for &(column, other) in &a[k + 1..] {
                // On the diagonal both (row, column) and (column, row) are the same entry.
                let times = if row == column { 2.0 } else { 1.0 };
                *self.entry(pattern, row, column)? += times * weight * own * other;
            }
        }
        Ok(())
    }

    /// `out = A x` for `k` columns: `x` and `out` hold `k` numbers a row, row after row.
    ///
    /// # Errors
    /// [`CholeskyError::Shape`] where lengths do not fit.
    pub fn multiply(
        &self,
        pattern: &SymmetricPattern,
        x: &[f64],
        k: usize,
        out: &mut [f64],
    ) -> Result<(), CholeskyError> {
        let rows = pattern.row_count();
        CholeskyError::check_length("diagonal", self.diagonal.len(), rows)?;
        CholeskyError::check_length("off-diagonal", self.off_diagonal.len(), pattern.edges().len())?;
        CholeskyError::check_length("x", x.len(), rows * k)?;
        CholeskyError::check_length("product", out.len(), rows * k)?;
        for row in 0..rows {
            let (columns, edges) = pattern.row(row);
            let product = &mut out[row * k..][..k];
            for (product, &own) in product.iter_mut().zip(&x[row * k..]) {
                *product = self.diagonal[row] * own;
            }
            for (&column, &edge) in columns.iter().zip(edges) {
                let entry = self.off_diagonal[edge as usize];
                for (product, &other) in product.iter_mut().zip(&x[column as usize * k..]) {
                    *product += entry * other;
                }
            }
        }
        Ok(())
    }

    fn entry(&mut self, pattern: &SymmetricPattern, row: u32, column: u32) -> Result<&mut f64, CholeskyError> {
        let entry = if row == column {
            self.diagonal.get_mut(row as usize)
        } else {
            pattern.edge(row, column).and_then(|edge| self.off_diagonal.get_mut(edge))
        };
        entry.ok_or(CholeskyError::NoEntry { row, column })
    }
}

impl SymmetricEntries for SymmetricMatrix {
    fn size(&self) -> [usize; 2] {
        [self.diagonal.len(), self.off_diagonal.len()]
    }

    fn diagonal(&self, row: usize) -> f64 {
        self.diagonal[row]
    }

    fn off_diagonal(&self, edge: usize) -> f64 {
        self.off_diagonal[edge]
    }
}
