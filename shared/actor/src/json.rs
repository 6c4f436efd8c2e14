//! JSON from outside, whoever has read its text: this library, or the browser. What documents may say is decided by grammars over
//! its values, with the same sentences natively and on a page.

use thiserror::Error;

/// Lists and objects within each other that are read; no document has more than ten.
const DEEPEST: usize = 32;

/// What is wrong with a document.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{0}")]
pub struct Unread(pub String);

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
    /// An object's fields, no two with the same name: parsers keep the last one. A list, since a map's code weighs more than
    /// the few fields of a request take to look through.
    Object(Vec<(String, Json)>),
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

    /// The value of a document from outside, which `read` reads: this library ([`Self::read`]), or the browser, whose parser is
    /// there anyway.
    ///
    /// # Errors
    /// It is nested too deeply, or no JSON.
    pub fn document(text: &str, read: impl FnOnce(&str) -> Option<Self>) -> Result<Self, Unread> {
        if depth(text) > DEEPEST {
            return Err(wrong(&["it is nested too deeply"]));
        }
        read(text).ok_or_else(|| wrong(&["it is no JSON"]))
    }
}

/// What is wrong, of pieces.
#[must_use]
pub fn wrong(why: &[&str]) -> Unread {
    Unread(why.concat())
}

/// That something is of another kind.
#[must_use]
pub fn is_no(what: &str, kind: &str) -> Unread {
    wrong(&[what, " is no ", kind])
}

/// An object's fields.
pub struct Fields<'a> {
    /// They, in no order.
    pub fields: &'a [(String, Json)],
    what: &'static str,
}

impl<'a> Fields<'a> {
    /// Those of an object, which is called `what` where it is none.
    ///
    /// # Errors
    /// It is no object.
    pub fn new(value: &'a Json, what: &'static str) -> Result<Self, Unread> {
        match value {
            Json::Object(fields) => Ok(Self { fields, what }),
            _ => Err(is_no(what, "object")),
        }
    }

    /// The same, where there are no others than these.
    ///
    /// # Errors
    /// A field that is not known.
    pub fn only(self, known: &[&str]) -> Result<Self, Unread> {
        let names = self.fields.iter().map(|(name, _)| name);
        match names.filter(|name| !known.contains(&name.as_str())).min() {
            Some(name) => Err(wrong(&[self.what, " has a field that nobody knows: ", name])),
            None => Ok(self),
        }
    }

    /// A field, where it is there.
    #[must_use]
    pub fn maybe(&self, name: &str) -> Option<&'a Json> {
        let field = self.fields.iter().find(|(field, _)| field == name);
        field.map(|(_, value)| value).filter(|value| **value != Json::Null)
    }

    /// A field.
    ///
    /// # Errors
    /// It is not there.
    pub fn need(&self, name: &str) -> Result<&'a Json, Unread> {
        self.maybe(name).ok_or_else(|| wrong(&[self.what, " has no ", name]))
    }

    /// A field that is a number.
    ///
    /// # Errors
    /// It is not there, or is none.
    pub fn number(&self, name: &str) -> Result<f64, Unread> {
        number(self.need(name)?, name)
    }

    /// A field that is a number, or what is usual.
    ///
    /// # Errors
    /// It is none.
    pub fn number_or(&self, name: &str, usual: f64) -> Result<f64, Unread> {
        self.maybe(name).map_or(Ok(usual), |value| number(value, name))
    }

    /// A field that is a text.
    ///
    /// # Errors
    /// It is not there, or is none.
    pub fn text(&self, name: &str) -> Result<String, Unread> {
        match self.need(name)? {
            Json::Text(text) => Ok(text.clone()),
            _ => Err(is_no(name, "text")),
        }
    }

    /// A field that is a list, or an empty one.
    ///
    /// # Errors
    /// It is none, or what reading its elements says.
    pub fn list<T, E: From<Unread>>(&self, name: &str, read: impl Fn(&Json) -> Result<T, E>) -> Result<Vec<T>, E> {
        self.maybe(name).map_or(Ok(Vec::new()), |value| each(value, name, read))
    }
}

/// The elements of a list.
///
/// # Errors
/// It is none, or what reading them says.
pub fn each<T, E: From<Unread>>(value: &Json, what: &str, read: impl Fn(&Json) -> Result<T, E>) -> Result<Vec<T>, E> {
    match value {
        Json::List(list) => list.iter().map(read).collect(),
        _ => Err(is_no(what, "list").into()),
    }
}

/// A number.
///
/// # Errors
/// It is none.
pub fn number(value: &Json, what: &str) -> Result<f64, Unread> {
    match value {
        Json::Number(number) => Ok(*number),
        _ => Err(is_no(what, "number")),
    }
}

/// A whole number that is not negative.
///
/// # Errors
/// It is none.
pub fn whole_number(value: &Json, what: &str) -> Result<f64, Unread> {
    let number = number(value, what)?;
    if number.fract() == 0.0 && number >= 0.0 { Ok(number) } else { Err(is_no(what, "whole number")) }
}

/// The same below 2^32.
///
/// # Errors
/// It is none.
pub fn whole(value: &Json, what: &str) -> Result<u32, Unread> {
    let number = whole_number(value, what)?;
    if number <= f64::from(u32::MAX) { Ok(number as u32) } else { Err(is_no(what, "whole number below 2^32")) }
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
