//! Why nothing can be learned.

use thiserror::Error;

/// Why nothing can be learned, or shown.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum TransferError {
    /// It was asked to stop.
    #[error(transparent)]
    Stopped(#[from] job::Stopped),
    /// Too little is told.
    #[error("{0} pairs of poses are too few to learn from: give at least {least}, best five for each sequence", least = TransferError::FEWEST)]
    FewPairs(usize),
    /// A frame that is not there.
    #[error("there is no frame {frame} in the {which}: it has {count}")]
    Frame {
        /// Source or target.
        which: &'static str,
        /// The frame, of the whole capture.
        frame: u32,
        /// Frames of the capture.
        count: u32,
    },
    /// Two keys that cannot both be right.
    #[error(
        "keys contradict each other: {source_name} {first_source} -> {target_name} {first_target} and {source_name} {second_source} -> \
         {target_name} {second_target}; time must go on in both: correct or remove one"
    )]
    Contradiction {
        /// Sequence of the source.
        source_name: String,
        /// Sequence of the target.
        target_name: String,
        /// Frame of the source in its sequence, of the first key.
        first_source: u32,
        /// Frame of the target in its sequence, of the first key.
        first_target: u32,
        /// The same of the second key.
        second_source: u32,
        /// The same of the second key.
        second_target: u32,
    },
    /// Between two keys one actor would be more than four times as fast as the other.
    #[error(
        "between the keys {source_name} {first_source} -> {target_name} {first_target} and {source_name} {second_source} -> {target_name} \
         {second_target} one actor is more than four times as fast as the other: correct one of them, or add keys between"
    )]
    TooFast {
        /// Sequence of the source.
        source_name: String,
        /// Sequence of the target.
        target_name: String,
        /// Frame of the source in its sequence, of the first key.
        first_source: u32,
        /// Frame of the target in its sequence, of the first key.
        first_target: u32,
        /// The same of the second key.
        second_source: u32,
        /// The same of the second key.
        second_target: u32,
    },
    /// The poses of one side are all alike.
    #[error("the poses of the {0} that the pairs name are all alike: nothing can be learned from them")]
    Still(&'static str),
    /// The surface cannot be solved for.
    #[error("the target's surface cannot be solved for: {0}")]
    Surface(String),
}

impl TransferError {
    /// Pairs from which something is learned at least.
    pub const FEWEST: usize = 3;
}
