//! Requests as JSON. Whoever reads the text (this library for files, the browser for the page), what it may say is decided
//! here and in the [grammar](super::grammar) alone, so that all refuse the same with the same words.

use actor::json::Json;

use super::{KeysRequest, PathRequest, Request, RequestError, grammar, limits};

impl Request {
    /// Reads a request and checks all that can be checked without a capture.
    ///
    /// # Errors
    /// See [`RequestError`].
    pub fn from_json(text: &str) -> Result<Self, RequestError> {
        Self::parse(text, Json::read)
    }

    /// The same where `read` knows what JSON is: the browser, whose parser is there anyway.
    ///
    /// # Errors
    /// See [`RequestError`].
    pub fn parse(text: &str, read: impl FnOnce(&str) -> Option<Json>) -> Result<Self, RequestError> {
        if text.len() > limits::MAX_BYTES {
            let (what, limit) = ("bytes", limits::MAX_BYTES);
            return Err(RequestError::TooMany { what, count: text.len(), limit });
        }
        let value = Json::document(text, read)?;
        let request = grammar::request(&value)?;
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

impl PathRequest {
    /// The path of a file that holds nothing else.
    ///
    /// # Errors
    /// What it is not.
    pub fn of_json(value: &Json) -> Result<Self, RequestError> {
        grammar::path(value)
    }
}

impl KeysRequest {
    /// The key poses of a file that holds nothing else.
    ///
    /// # Errors
    /// What they are not.
    pub fn of_json(value: &Json) -> Result<Self, RequestError> {
        grammar::keys(value)
    }
}
