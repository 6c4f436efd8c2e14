//! What both modules say to the page: errors, and JSON.

use std::io::{Error, Result as Written, Write};

use actor::json::Json;
use js_sys::{Array, JSON, JsString, Number, Object};
use serde::Serialize;
use serde_json::Serializer;
use serde_json::ser::Formatter;
use wasm_bindgen::prelude::*;

#[wasm_bindgen]
extern "C" {
    /// Milliseconds since the page was opened.
    #[wasm_bindgen(js_namespace = performance, js_name = now)]
    pub fn now() -> f64;
}

/// An `Error` with this message, and a `kind` from a closed set.
#[must_use]
pub fn error(kind: &str, message: &str) -> JsValue {
    let error = js_sys::Error::new(message);
    // Setting a property of a fresh object does not fail.
    let _ = js_sys::Reflect::set(&error, &"kind".into(), &kind.into());
    error.into()
}

/// Compact JSON whose floating point numbers the browser writes: Rust's own code and tables would weigh 7 KB.
struct BrowserNumbers;

impl Formatter for BrowserNumbers {
    fn write_f64<W: ?Sized + Write>(&mut self, writer: &mut W, value: f64) -> Written<()> {
        let text = Number::from(value).to_string_with_radix(10).map_err(|_| Error::other("not a number"))?;
        writer.write_all(String::from(text).as_bytes())
    }

    fn write_f32<W: ?Sized + Write>(&mut self, writer: &mut W, value: f32) -> Written<()> {
        self.write_f64(writer, value.into())
    }
}

/// `value` as JSON.
///
/// # Errors
/// None in practice: numbers that are not finite become `null`.
pub fn json(value: &impl Serialize) -> Result<String, JsValue> {
    let mut text = Vec::new();
    let written = value.serialize(&mut Serializer::with_formatter(&mut text, BrowserNumbers));
    let text = written.ok().and_then(|()| String::from_utf8(text).ok());
    text.ok_or_else(|| error("bad-argument", "this cannot be written as JSON"))
}

/// The value that `text` holds, read by the browser: another parser would weigh 30 KB. `None` where it is no JSON.
#[must_use]
pub fn read_json(text: &str) -> Option<Json> {
    read(&JSON::parse(text).ok()?)
}

/// `value`, which the browser has read; `None` where stricter parsers would have found no JSON.
fn read(value: &JsValue) -> Option<Json> {
    Some(if let Some(number) = value.as_f64() {
        // What is too large for a number has become infinite.
        return number.is_finite().then_some(Json::Number(number));
    } else if let Some(text) = value.dyn_ref::<JsString>() {
        Json::Text(whole_text(text)?)
    } else if let Some(value) = value.as_bool() {
        Json::Bool(value)
    } else if let Some(list) = value.dyn_ref::<Array>() {
        Json::List(list.iter().map(|item| read(&item)).collect::<Option<_>>()?)
    } else if let Some(object) = value.dyn_ref::<Object>() {
        let mut fields = Vec::new();
        for entry in Object::entries(object).iter() {
            let entry: Array = entry.unchecked_into();
            fields.push((whole_text(&entry.get(0).unchecked_into())?, read(&entry.get(1))?));
        }
        Json::Object(fields)
    } else {
        Json::Null
    })
}

/// Text without halves of characters.
fn whole_text(text: &JsString) -> Option<String> {
    text.is_valid_utf16().then(|| String::from(text))
}
