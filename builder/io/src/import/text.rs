//! Lines of text files, with their numbers.

use std::borrow::Cow;
use std::path::Path;

use super::error::ImportError;

/// Calls `each` with the number (from 1) and the words' text of every line that is not empty and no `#` comment.
/// A backslash at the end of a line continues it. Bytes that are no UTF-8 are replaced.
pub(super) fn for_each_line(
    bytes: &[u8],
    mut each: impl FnMut(usize, &str) -> Result<(), ImportError>,
) -> Result<(), ImportError> {
    let mut joined = String::new();
    for (index, line) in bytes.split(|&b| b == b'\n').enumerate() {
        let line = String::from_utf8_lossy(line);
        let line = line.trim();
        if let Some(start) = line.strip_suffix('\\') {
            joined.push_str(start);
            joined.push(' ');
            continue;
        }
        let whole =
            if joined.is_empty() { Cow::Borrowed(line) } else { Cow::Owned(std::mem::take(&mut joined) + line) };
        if !whole.is_empty() && !whole.starts_with('#') {
            each(index + 1, &whole)?;
        }
    }
    Ok(())
}

/// An error about line `line` of `path`.
pub(super) fn syntax(path: &Path, line: usize, reason: impl Into<String>) -> ImportError {
    ImportError::Syntax { path: path.to_owned(), line, reason: reason.into() }
}

/// `word` as a number.
pub(super) fn number(path: &Path, line: usize, word: &str) -> Result<f32, ImportError> {
    word.parse().map_err(|_| syntax(path, line, format!("\"{}\" is not a number", shorten(word))))
}

/// The first words of `text`, for messages.
pub(super) fn shorten(text: &str) -> String {
    let mut short: String = text.chars().take(40).collect();
    if short.len() < text.len() {
        short.push_str("...");
    }
    short
}
