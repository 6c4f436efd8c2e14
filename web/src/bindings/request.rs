//! Requests as the browser reads them: its own JSON parser is there anyway, and another one would weigh 30 KB. What a
//! request may say is decided by the engine.

use js_sys::{Array, JSON, JsString, Object};
use search::{Json, Request};
use wasm_bindgen::{JsCast, JsValue};

use crate::player::direct::DirectError;

/// The request that `text` holds as JSON.
///
/// # Errors
/// What is wrong with it.
pub fn parse(text: &str) -> Result<Request, JsValue> {
    Ok(Request::parse(text, |text| read(&JSON::parse(text).ok()?)).map_err(DirectError::from)?)
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
