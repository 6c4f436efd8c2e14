//! Sparse Cholesky factors of symmetric positive definite matrices: `P A P^T = L L^T`.
//!
//! | step | what | how often |
//! |---|---|---|
//! | [`SymmetricPattern`] | where a matrix has entries: from edges, triangles, groups of unknowns, with extra ties | once |
//! | [`EliminationOrder`] | in which order rows are eliminated, so that few entries fill in | once |
//! | [`Symbolic`] | what all factors of the pattern share | once |
//! | [`Factor`], [`ConstrainedFactor`] | the numbers, for a matrix and its [`Constraints`] | for each matrix |
//! | [`Symbolic::update`] | a small change of the matrix, taken over into the factor | for each change |
//! | [`Symbolic::solve`], [`ConstrainedFactor::solve`] | any number of right sides | for each right side |
//!
//! Matrices give their numbers by [`SymmetricEntries`]: [`SymmetricMatrix`] is one of plain `f64`,
//! [`Laplacian`](crate::laplacian::Laplacian) another one. For one system, once, there is [`solve_once`].
//!
//! ```
//! use kernels::cholesky::{EliminationOrder, SolveScratch, Symbolic, SymmetricMatrix, SymmetricPattern, Workspace};
//!
//! // A screened Laplacian: four rows in a ring, each tied to its neighbours by 1 and to nothing by 0.5.
//! let pattern = SymmetricPattern::from_edges(4, &[[0, 1], [1, 2], [2, 3], [3, 0]])?;
//! let mut matrix = SymmetricMatrix::zeros(&pattern);
//! matrix.diagonal_mut().fill(2.5);
//! matrix.off_diagonal_mut().fill(-1.0);
//!
//! let symbolic = Symbolic::new(&pattern, &EliminationOrder::minimum_degree(&pattern))?;
//! let mut workspace = Workspace::default();
//! let factor = symbolic.factorise::<f64>(&matrix, &mut workspace)?;
//! let mut x = [1.0; 4];
//! symbolic.solve(&factor, &mut x, 1, &mut SolveScratch::default())?;
//! assert!(x.iter().all(|x| (x - 2.0).abs() < 1e-12));
//!
//! // Without the 0.5 nothing holds the ring, and the error names a row of it.
//! matrix.diagonal_mut().fill(2.0);
//! let error = symbolic.factorise::<f64>(&matrix, &mut workspace).unwrap_err();
//! assert!(error.to_string().contains("not positive definite"));
//! # Ok::<(), kernels::cholesky::CholeskyError>(())
//! ```
//!
//! All of it is our own for the page's sake: a general library's would be a sixth of all that the page loads, and no
//! faster in WebAssembly. It is sequential and factorises in double precision; the factor is kept in single precision or in
//! double (see [`Real`]), laid out for four right sides at once. The same input gives the same bits on every machine.

mod constraints;
mod error;
mod factor;
mod matrix;
mod numeric;
mod order;
mod pattern;
mod real;
mod solve;
mod structure;
mod symbolic;
mod update;

pub use constraints::{ConstrainedFactor, Constraints};
pub use error::CholeskyError;
pub use factor::{Factor, Workspace};
pub use matrix::{SymmetricEntries, SymmetricMatrix};
pub use order::EliminationOrder;
pub use pattern::SymmetricPattern;
pub use real::{Real, RightSides};
pub use solve::SolveScratch;
pub use symbolic::{MOST_ENTRIES, Symbolic};

use crate::topology::Topology;

/// A fill-reducing order of elimination for the Laplacians of `topology`: all vertices, each once; the last vertex of
/// each connected component in it becomes its anchor.
#[must_use]
pub fn elimination_order(topology: &Topology) -> Vec<u32> {
    // A topology's triangles name vertices that exist.
    SymmetricPattern::from_triangles(topology.vertex_count(), topology.triangles())
        .map(|pattern| EliminationOrder::minimum_degree(&pattern).rows().to_vec())
        .unwrap_or_default()
}

/// Solves `A x = b` for `k` right sides, once: `right` holds `k` numbers for each row, row after row, and so does what is
/// returned.
///
/// # Errors
/// As [`Symbolic::new`], [`Symbolic::factorise`] and [`Symbolic::solve`].
pub fn solve_once(
    pattern: &SymmetricPattern,
    matrix: &impl SymmetricEntries,
    right: &[f64],
    k: usize,
) -> Result<Vec<f64>, CholeskyError> {
    let symbolic = Symbolic::new(pattern, &EliminationOrder::minimum_degree(pattern))?;
    let factor = symbolic.factorise(matrix, &mut Workspace::default())?;
    let mut x = right.to_vec();
    symbolic.solve(&factor, &mut x, k, &mut SolveScratch::default())?;
    Ok(x)
}
