//! Numbers in JSON, written by the browser.

use std::io::{Error, Result, Write};

use js_sys::Number;
use serde_json::ser::Formatter;

/// Compact JSON whose floating point numbers the browser writes: the tables of Rust's own would weigh 20 KB.
pub struct BrowserNumbers;

impl Formatter for BrowserNumbers {
    fn write_f64<W: ?Sized + Write>(&mut self, writer: &mut W, value: f64) -> Result<()> {
        let text = Number::from(value).to_string_with_radix(10).map_err(|_| Error::other("not a number"))?;
        writer.write_all(String::from(text).as_bytes())
    }

    fn write_f32<W: ?Sized + Write>(&mut self, writer: &mut W, value: f32) -> Result<()> {
        self.write_f64(writer, value.into())
    }
}
