//! Why the text of a file is no clip.

use driving::ClipError;
use thiserror::Error;

/// Why a file is no clip of motion capture. Each message names the file, the place in it, and what is wrong there.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MocapError {
    /// The name ends in nothing that is read.
    #[error("{file}: no motion capture that is read: {known}")]
    Format {
        /// The file.
        file: String,
        /// What is read.
        known: &'static str,
    },
    /// An AMC file without its skeleton, or the other way round.
    #[error("{file}: {missing}: an .asf file and an .amc file belong together (02.asf+02_01.amc)")]
    Half {
        /// The file.
        file: String,
        /// What is missing.
        missing: &'static str,
    },
    /// A line that is not written as the format asks.
    #[error("{file}: line {line}: {reason}")]
    Syntax {
        /// The file.
        file: String,
        /// The line, from 1.
        line: usize,
        /// What is wrong.
        reason: String,
    },
    /// The file ends too early.
    #[error("{file}: the file ends in the middle of {what}")]
    Truncated {
        /// The file.
        file: String,
        /// What it should have gone on with.
        what: String,
    },
    /// What was read is no clip.
    #[error("{file}: {cause}")]
    Clip {
        /// The file.
        file: String,
        /// Why.
        cause: ClipError,
    },
}

/// A clip's fault in a file.
pub fn clip_error(file: &str) -> impl Fn(ClipError) -> MocapError + '_ {
    move |cause| MocapError::Clip { file: file.into(), cause }
}
