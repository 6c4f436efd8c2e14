//! Why there is no family.

use job::Stopped;
use kernels::cholesky::CholeskyError;
use thiserror::Error;

use crate::parameter::Parameter;

/// Why sequences are no family.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FamilyError {
    /// Nothing stands in the whole capture.
    #[error(
        "nothing in this capture comes to rest on the ground, so that cycles cannot be cut at contacts: clips that walk on the spot, \
         and actors that float, have no families"
    )]
    NoContacts,
    /// Fewer than two sequences.
    #[error("a family needs two sequences at least, and has {0}")]
    TooFew(usize),
    /// A sequence has no cycle.
    #[error("sequence {name:?} has no cycle: {why}")]
    NoCycle {
        /// The sequence.
        name: String,
        /// What is missing.
        why: String,
    },
    /// Frames were named that a sequence does not have.
    #[error("sequence {name:?} has frames 0 to {last}: a cycle cannot be looked for from {from} to {to}")]
    Frames {
        /// The sequence.
        name: String,
        /// First frame that was named.
        from: u32,
        /// Last one.
        to: u32,
        /// The last frame that there is.
        last: u32,
    },
    /// Two cycles do not do the same.
    #[error("{one:?} and {other:?} do not match: {why}")]
    Unlike {
        /// A sequence.
        one: String,
        /// Another one.
        other: String,
        /// What differs.
        why: String,
    },
    /// Two cycles have the same parameter.
    #[error("{one:?} and {other:?} have nearly the same {parameter}, {value}: there is nothing between them")]
    Alike {
        /// A sequence.
        one: String,
        /// Another one.
        other: String,
        /// The parameter.
        parameter: Parameter,
        /// What both have, with its unit.
        value: String,
    },
    /// Poses could not be interpolated.
    #[error("poses cannot be interpolated: {0}")]
    Poses(#[from] CholeskyError),
    /// It was asked to stop.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}
