//! Errors as the page gets them: `Error` objects with a sentence and a `kind` from a closed set.

use bundle::BundleError;
use serde_json::Serializer;
use wasm_bindgen::JsValue;

use super::numbers::BrowserNumbers;
use crate::player::PlayerError;
use crate::player::direct::DirectError;

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
    let error = js_sys::Error::new(message);
    // Setting a property of a fresh object does not fail.
    let _ = js_sys::Reflect::set(&error, &"kind".into(), &kind.word().into());
    error.into()
}

impl From<PlayerError> for JsValue {
    fn from(failure: PlayerError) -> Self {
        let kind = match failure {
            PlayerError::NotLoaded => ErrorKind::NotLoaded,
            PlayerError::NoFrame(_) => ErrorKind::BadArgument,
            PlayerError::Unreachable { .. } => ErrorKind::Unreachable,
            PlayerError::Damaged(_) | PlayerError::DamagedLooks => ErrorKind::Damaged,
        };
        error(kind, &failure.to_string())
    }
}

impl From<DirectError> for JsValue {
    fn from(failure: DirectError) -> Self {
        match failure {
            DirectError::Request(failure) => error(ErrorKind::BadArgument, &failure.to_string()),
            DirectError::Player(failure) => failure.into(),
        }
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

/// `value` as JSON.
///
/// # Errors
/// None in practice: numbers that are not finite become `null`.
pub fn json(value: &impl serde::Serialize) -> Result<String, JsValue> {
    let mut text = Vec::new();
    let written = value.serialize(&mut Serializer::with_formatter(&mut text, BrowserNumbers));
    let text = written.ok().and_then(|()| String::from_utf8(text).ok());
    text.ok_or_else(|| error(ErrorKind::BadArgument, "this cannot be written as JSON"))
}
