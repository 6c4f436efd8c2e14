//! Why a family cannot be made, with its name.

use family::FamilyError;
use thiserror::Error;

/// Why there are no samples of a family.
#[derive(Debug, Error)]
#[error("family \"{name}\": {cause}")]
pub struct FamilyFailure {
    /// The family.
    pub name: String,
    /// What is wrong.
    pub cause: FamilyError,
}

#[cfg(feature = "variations")]
impl FamilyFailure {
    /// Whether it was only asked to stop.
    pub(crate) fn is_stopped(&self) -> bool {
        matches!(self.cause, FamilyError::Stopped(_))
    }
}
