//! Requests as JSON. Whoever reads the text (this library for files, the browser for the page), what it may say is decided
//! here and in the [grammar](super::grammar) alone, so that all refuse the same with the same words.

use std::collections::BTreeMap;

use super::{KeysRequest, PathRequest, Request, RequestError, grammar, limits};

/// Lists and objects within each other that are read; a request has no more than ten.
const DEEPEST: usize = 32;

/// A value of JSON.
#[derive(Clone, Debug, PartialEq)]
pub enum Json {
    /// `null`: as if it were not there.
    Null,
    /// `true` or `false`.
    Bool(bool),
    /// A finite number.
    Number(f64),
    /// A text.
    Text(String),
    /// A list.
    List(Vec<Json>),
    /// An object: the last of fields with the same name.
    Object(BTreeMap<String, Json>),
}

impl From<serde_json::Value> for Json {
    fn from(value: serde_json::Value) -> Self {
        match value {
            serde_json::Value::Null => Self::Null,
            serde_json::Value::Bool(value) => Self::Bool(value),
            serde_json::Value::Number(number) => number.as_f64().map_or(Self::Null, Self::Number),
            serde_json::Value::String(text) => Self::Text(text),
            serde_json::Value::Array(list) => Self::List(list.into_iter().map(Self::from).collect()),
            serde_json::Value::Object(fields) => {
                Self::Object(fields.into_iter().map(|(name, value)| (name, Self::from(value))).collect())
            }
        }
    }
}

impl Json {
    /// The value that `text` holds; `None` where it is no JSON.
    #[must_use]
    pub fn read(text: &str) -> Option<Self> {
        serde_json::from_str::<serde_json::Value>(text).ok().map(Self::from)
    }
}

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
