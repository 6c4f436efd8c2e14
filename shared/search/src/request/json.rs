//! Requests as JSON.

use serde::Deserialize;

use super::check::check_version;
use super::{Request, RequestError, limits};

impl Request {
    /// Reads a request and checks all that can be checked without a capture.
    ///
    /// # Errors
    /// See [`RequestError`].
    pub fn from_json(text: &str) -> Result<Self, RequestError> {
        #[derive(Deserialize)]
        struct Versioned {
            version: u32,
        }
        if text.len() > limits::MAX_BYTES {
            let (what, limit) = ("bytes", limits::MAX_BYTES);
            return Err(RequestError::TooMany { what, count: text.len(), limit });
        }
        // A later version may have other fields: that is to be said first.
        if let Ok(Versioned { version }) = serde_json::from_str(text) {
            check_version(version)?;
        }
        let request: Self = serde_json::from_str(text).map_err(|error| RequestError::Json(error.to_string()))?;
        request.check_numbers()?;
        Ok(request)
    }

    /// The request as JSON.
    #[must_use]
    pub fn to_json(&self) -> String {
        // All fields are plain: there is nothing that could fail.
        serde_json::to_string(self).unwrap_or_default()
    }
}
