//! Errors as the page gets them: `Error` objects with a sentence and a `kind` from a closed set.

use bundle::BundleError;
use searcher::page;
use wasm_bindgen::JsValue;

use crate::player::PlayerError;

/// What went wrong, in the page's words for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorKind {
    /// The bytes are no bundle.
    NotReprise,
    /// The bundle is of a later version.
    TooNew,
    /// The bundle is damaged.
    Damaged,
    /// The bundle is cut off.
    Truncated,
    /// The browser has no WebGPU.
    NoWebGpu,
    /// It has, but no device for it.
    NoAdapter,
    /// The device was lost.
    DeviceLost,
    /// Nothing leads to the target.
    Unreachable,
    /// This part has not arrived.
    NotLoaded,
    /// An argument makes no sense.
    BadArgument,
}

impl ErrorKind {
    fn word(self) -> &'static str {
        match self {
            Self::NotReprise => "not-reprise",
            Self::TooNew => "too-new",
            Self::Damaged => "damaged",
            Self::Truncated => "truncated",
            Self::NoWebGpu => "no-webgpu",
            Self::NoAdapter => "no-adapter",
            Self::DeviceLost => "device-lost",
            Self::Unreachable => "unreachable",
            Self::NotLoaded => "not-loaded",
            Self::BadArgument => "bad-argument",
        }
    }
}

/// An `Error` with this message and kind.
#[must_use]
pub fn error(kind: ErrorKind, message: &str) -> JsValue {
    page::error(kind.word(), message)
}

impl From<PlayerError> for JsValue {
    fn from(failure: PlayerError) -> Self {
        let kind = match failure {
            PlayerError::NotLoaded => ErrorKind::NotLoaded,
            PlayerError::NoFrame(_) | PlayerError::NoVertex(_) | PlayerError::Behaviour(_) => ErrorKind::BadArgument,
            PlayerError::Unreachable { .. } => ErrorKind::Unreachable,
            PlayerError::Damaged(_) | PlayerError::DamagedLooks => ErrorKind::Damaged,
        };
        error(kind, &failure.to_string())
    }
}

/// What is wrong with a bundle.
#[must_use]
pub fn bundle_error(failure: BundleError) -> JsValue {
    let kind = match failure {
        BundleError::NotOurs => ErrorKind::NotReprise,
        BundleError::TooNew { .. } | BundleError::UnknownSection { .. } => ErrorKind::TooNew,
        BundleError::Damaged { .. } | BundleError::Inconsistent { .. } => ErrorKind::Damaged,
        BundleError::Truncated { .. } => ErrorKind::Truncated,
    };
    error(kind, &failure.to_string())
}
