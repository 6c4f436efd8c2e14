//! Requests as JSON. Whoever reads the text (this library for files, the browser for the page), what it may say is decided
//! here and in the [grammar](super::grammar) alone, so that all refuse the same with the same words.

use super::value::Json;
use super::{KeysRequest, PathRequest, Request, RequestError, grammar, limits};

/// Lists and objects within each other that are read; a request has no more than ten.
const DEEPEST: usize = 32;

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
        if depth(text) > DEEPEST {
            return Err(RequestError::Json("it is nested too deeply".into()));
        }
        let value = read(text).ok_or_else(|| RequestError::Json("it is no JSON".into()))?;
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

/// How many lists and objects are within each other at most, if `text` is JSON.
fn depth(text: &str) -> usize {
    let (mut depth, mut deepest) = (0_usize, 0);
    let (mut in_text, mut escaped) = (false, false);
    for byte in text.bytes() {
        match byte {
            _ if escaped => escaped = false,
            b'\\' if in_text => escaped = true,
            b'"' => in_text = !in_text,
            b'[' | b'{' if !in_text => {
                depth += 1;
                deepest = deepest.max(depth);
            }
            b']' | b'}' if !in_text => depth = depth.saturating_sub(1),
            _ => {}
        }
    }
    deepest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depth_is_counted_outside_of_texts() {
        assert_eq!(depth(r#"{"a":[1,{"b":2}],"c":[[]]}"#), 3);
        assert_eq!(depth(r#"["[[[\"[[\\"]"#), 1);
        assert_eq!(depth("]]["), 1);
        assert_eq!(depth(""), 0);
    }
}
