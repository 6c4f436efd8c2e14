//! What can be wrong with a system.

use thiserror::Error;

/// Why numbers are not an elimination order, or a matrix has no factor.
///
/// Rows are those of the pattern, in its own numbering: vertices, where the matrix is that of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum CholeskyError {
    /// An order does not name every row once.
    #[error("the elimination order does not name each of the {0} vertices once")]
    Order(usize),
    /// The order, or a mesh that is no surface, makes a factor that nobody should wait for.
    #[error("eliminated in this order, the matrix fills in: its factor has more than {0} entries")]
    Fill(usize),
    /// The matrix, or what it is solved for, holds something that is not a number.
    #[error("the matrix or its right side is not finite")]
    NotFinite,
    /// The matrix holds something in this row that is not a number.
    #[error("the matrix is not finite in row {row}")]
    NotFiniteRow {
        /// The row.
        row: u32,
    },
    /// The matrix is not positive definite, or so nearly singular that its factor would mean nothing.
    // The page prints no floating-point number, which would take it some kilobytes: `pivot` is not in the sentence.
    #[error("the matrix is not positive definite in row {row}: what nothing holds needs a constraint")]
    NotPositive {
        /// The row of the pivot, in the pattern's numbering.
        row: u32,
        /// What is left on its diagonal.
        pivot: f64,
    },
    /// Taking something away from a factored matrix would leave it singular, or its factor without digits. The factor is as
    /// it was.
    #[error("taking this away leaves too little of the matrix at row {row}: factorise it anew")]
    Downdate {
        /// The row of the pivot.
        row: u32,
    },
    /// A row that does not exist is named.
    #[error("row {row} does not exist: there are {row_count}")]
    NoRow {
        /// The row.
        row: u32,
        /// The number of rows.
        row_count: usize,
    },
    /// The pattern has no such entry.
    #[error("the matrix has no entry in row {row}, column {column}")]
    NoEntry {
        /// Its row.
        row: u32,
        /// Its column.
        column: u32,
    },
    /// A constraint's weight is not a positive number, or its row is constrained already, or left out of the factor.
    #[error("constraint {index}, on row {row}, is none: {reason}")]
    Constraint {
        /// The constraint, in the order in which they were made.
        index: usize,
        /// Its row.
        row: u32,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// Something given has the wrong length: it is of another pattern, or has another number of columns.
    #[error("{what}: {found} numbers were given where {expected} belong")]
    Shape {
        /// What was given.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length that it should have.
        expected: usize,
    },
}

impl CholeskyError {
    pub(super) fn check_length(what: &'static str, found: usize, expected: usize) -> Result<(), Self> {
        if found == expected { Ok(()) } else { Err(Self::Shape { what, found, expected }) }
    }
}
