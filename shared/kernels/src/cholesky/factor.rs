//! The numbers of a factor.

use super::numeric::{self, Scratch};
use super::{CholeskyError, Real, Symbolic, SymmetricEntries};

/// Rows whose diagonal is below this fraction of the mean one are held by nothing.
const LEAST_DIAGONAL: f64 = 1e-9;

/// Tries at a matrix that is not positive definite: so many pivots are raised one by one, then the whole diagonal.
const SINGLE_PIVOTS: usize = 8;
const MOST_ATTEMPTS: usize = SINGLE_PIVOTS + 8;

/// What elimination must leave of a diagonal entry at least. Double precision leaves 1e-16 times some dozens of a singular
/// matrix; less than this is rounding.
const SINGULAR: f64 = 1e-13;

/// The Cholesky factor of a matrix, in single precision unless said otherwise.
#[derive(Clone, Debug, Default)]
pub struct Factor<S = f32> {
    /// Panel by panel, see [`Panel`](super::symbolic::Panel).
    pub(super) values: Vec<S>,
    /// Pivots that had to be raised because the matrix was not positive definite: 0 on good meshes, and always where
    /// [`Symbolic::factorise`] made the factor.
    pub regularised: usize,
}

/// Memory that factorising and updating need and keep.
#[derive(Default)]
pub struct Workspace {
    pub(super) lower: Vec<f64>,
    values: Vec<f64>,
    scratch: Scratch,
    /// Of [`Symbolic::update`], by position; zeros in between.
    pub(super) vector: Vec<f64>,
    /// Of constraints, by position, and the entries between free and hard rows.
    pub(super) constraint_of_row: Vec<u32>,
    pub(super) couplings: Vec<(u32, u32, f64)>,
}

impl Symbolic {
    /// Factorises a matrix of the same pattern.
    ///
    /// # Errors
    /// [`CholeskyError::NotPositive`] or [`CholeskyError::NotFiniteRow`], which name the row; [`CholeskyError::Shape`] for
    /// a matrix of another pattern.
    pub fn factorise<S: Real>(
        &self,
        matrix: &impl SymmetricEntries,
        workspace: &mut Workspace,
    ) -> Result<Factor<S>, CholeskyError> {
        let mut factor = Factor::default();
        self.refactorise(matrix, workspace, &mut factor)?;
        Ok(factor)
    }

    /// As [`Self::factorise`], in the memory of a factor before, which stays as it was where this fails.
    ///
    /// # Errors
    /// As [`Self::factorise`].
    pub fn refactorise<S: Real>(
        &self,
        matrix: &impl SymmetricEntries,
        workspace: &mut Workspace,
        factor: &mut Factor<S>,
    ) -> Result<(), CholeskyError> {
        self.check_size(matrix)?;
        self.set_lower(matrix, &mut workspace.lower);
        self.factorise_lower(workspace, factor)
    }

    /// Factorises a matrix of the same pattern even if it is not quite positive definite, such as the Laplacian of a mesh
    /// with blunt or degenerate triangles: where it fails to be it is regularised, which [`Factor::regularised`] tells. Such
    /// a factor is still a good preconditioner.
    ///
    /// # Errors
    /// [`CholeskyError::NotFinite`], also where the matrix is too far from positive definite for that;
    /// [`CholeskyError::Shape`] for a matrix of another pattern.
    pub fn factorise_regularised<S: Real>(
        &self,
        matrix: &impl SymmetricEntries,
        workspace: &mut Workspace,
    ) -> Result<Factor<S>, CholeskyError> {
        self.check_size(matrix)?;
        let n = self.free_count();
        self.set_lower(matrix, &mut workspace.lower);
        let Workspace { lower, values, scratch, .. } = workspace;
        let diagonal_sum: f64 = self.column_start[..n].iter().map(|&start| lower[start as usize]).sum();
        let mean = (diagonal_sum / n.max(1) as f64).max(f64::from(f32::MIN_POSITIVE));
        if !mean.is_finite() {
            return Err(CholeskyError::NotFinite);
        }
        let loose = self.hold_loose_rows(mean, lower);
        for attempt in 0..MOST_ATTEMPTS {
            let Err(pivot) = numeric::factorise(&self.structure, self.matrix(lower), values, scratch) else {
                let mut factor = Factor { values: Vec::new(), regularised: loose + attempt };
                self.pack(values, &mut factor.values);
                return Ok(factor);
            };
            if attempt < SINGLE_PIVOTS {
                lower[self.column_start[pivot.min(n - 1)] as usize] += mean;
            } else {
                let shift = mean * 1e-6 * 10_f64.powi((attempt - SINGLE_PIVOTS) as i32);
                for &start in &self.column_start[..n] {
                    lower[start as usize] += shift;
                }
            }
        }
        Err(CholeskyError::NotFinite)
    }

    /// Rows that nothing holds (all triangles of a vertex are degenerate) have no diagonal: they get the mean one; their
    /// number.
    fn hold_loose_rows(&self, mean: f64, lower: &mut [f64]) -> usize {
        let mut loose = 0;
        for &start in &self.column_start[..self.free_count()] {
            let own = &mut lower[start as usize];
            if *own <= mean * LEAST_DIAGONAL {
                *own += mean;
                loose += 1;
            }
        }
        loose
    }

    /// Factorises what `workspace.lower` holds.
    pub(super) fn factorise_lower<S: Real>(
        &self,
        workspace: &mut Workspace,
        factor: &mut Factor<S>,
    ) -> Result<(), CholeskyError> {
        let Workspace { lower, values, scratch, .. } = workspace;
        let failed = numeric::factorise(&self.structure, self.matrix(lower), values, scratch).err();
        if let Some(column) = failed.or_else(|| self.singular_column(lower, values)) {
            return Err(self.error_at(column, lower, values));
        }
        self.pack(values, &mut factor.values);
        factor.regularised = 0;
        Ok(())
    }

    /// The lower triangle in compressed columns.
    fn matrix<'a>(&'a self, lower: &'a [f64]) -> (&'a [u32], &'a [u32], &'a [f64]) {
        (&self.column_start, &self.rows, lower)
    }

    /// The first column of whose diagonal elimination left no more than rounding.
    fn singular_column(&self, lower: &[f64], values: &[f64]) -> Option<usize> {
        let diagonal = self.column_start.iter().map(|&start| lower[start as usize]);
        self.roots(values).zip(diagonal).position(|(root, own)| root * root <= SINGULAR * own)
    }

    /// The error of the column at which a factorisation failed.
    fn error_at(&self, column: usize, lower: &[f64], values: &[f64]) -> CholeskyError {
        for (column, entries) in self.column_start.windows(2).enumerate() {
            if lower[entries[0] as usize..entries[1] as usize].iter().any(|entry| !entry.is_finite()) {
                return CholeskyError::NotFiniteRow { row: self.order[column] };
            }
        }
        // A column whose pivot has passed holds its root.
        let left = self.roots(values).nth(column).unwrap_or(f64::NAN);
        let pivot = if left > 0.0 { left * left } else { left };
        CholeskyError::NotPositive { row: self.order[column], pivot }
    }

    /// The diagonal of the supernodes' blocks, column by column.
    fn roots(&self, values: &[f64]) -> impl Iterator<Item = f64> {
        (0..self.structure.supernodes()).flat_map(move |index| {
            let node = self.structure.supernode(index);
            (0..node.columns()).map(move |own| values[node.value_start + own * (node.height() + 1)])
        })
    }

    /// The factor's numbers in the order of the panels.
    fn pack<S: Real>(&self, values: &[f64], packed: &mut Vec<S>) {
        packed.clear();
        packed.reserve(self.value_count());
        for supernode in 0..self.structure.supernodes() {
            let node = self.structure.supernode(supernode);
            let (first, height) = (node.value_start, node.height());
            for panel in self.panels(supernode) {
                let (column, width) = (panel.column as usize, panel.width as usize);
                let entry = |row: usize, j: usize| S::from_f64(values[first + (column + j) * height + row]);
                packed
                    .extend((0..width).map(|j| S::from_f64(1.0 / values[first + (column + j) * height + column + j])));
                for row in 1..width {
                    packed.extend((0..row).map(|j| entry(column + row, j)));
                }
                for row in column + width..height {
                    packed.extend((0..width).map(|j| entry(row, j)));
                }
            }
        }
    }
}
