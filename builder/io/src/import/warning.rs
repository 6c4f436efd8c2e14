//! What a user should know about an input that can be used all the same.

use std::fmt;
use std::ops::Deref;

use serde::Serialize;

/// A sentence about an input, and a name for its kind that never changes.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Warning {
    /// For scripts and for `builder validate`, for example `W_LOOSE_VERTICES`.
    pub code: &'static str,
    /// What is unusual, where, and what to do about it.
    pub message: String,
}

impl Warning {
    /// A warning with a stable code, for example `W_FRAMES_MISSING`.
    #[must_use]
    pub fn new(code: &'static str, message: String) -> Self {
        Self { code, message }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl Deref for Warning {
    type Target = str;

    fn deref(&self) -> &str {
        &self.message
    }
}
