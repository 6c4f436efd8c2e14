//! Why a driven sequence cannot be joined to the recording.

use thiserror::Error;

/// Why a driven sequence cannot be joined to the recording.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum HybridError {
    /// The driven frames are none of this capture's.
    #[error("the driven frames do not fit the capture: {0}")]
    Misfit(String),
    /// The edit cannot be made.
    #[error("the driven sequence cannot be edited: {0}")]
    Edit(#[from] editing::PreparedError),
    /// Transitions cannot be measured.
    #[error("transitions between the recording and the driven sequence cannot be measured: {0}")]
    Measure(String),
    /// It was asked to stop.
    #[error(transparent)]
    Stopped(#[from] job::Stopped),
}
