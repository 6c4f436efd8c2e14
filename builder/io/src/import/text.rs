//! Lines of text files, with their numbers.

use std::borrow::Cow;
use std::path::Path;

use super::error::ImportError;

/// Whether a backslash at the end of a line carries the statement on to the next one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Continues {
    /// It does.
    Always,
    /// It does where it stands apart from the last word: a name may end in a backslash (`D:\takes\`).
    WhereApart,
    /// It does not: the line is skipped or a name, whatever it ends in.
    Never,
}

/// Calls `each` with the number (from 1) and the words' text of every statement that is not empty and no `#` comment.
///
/// Lines end in LF, CR LF or CR. A byte order mark is skipped, and text in UTF-16 that begins with one is read, too. A
/// backslash at the end carries on a statement as `continues` says of its keyword, and never within a comment. A line
/// that is not UTF-8 counts as Latin-1.
pub(super) fn for_each_line(
    bytes: &[u8],
    continues: impl Fn(&str) -> Continues,
    mut each: impl FnMut(usize, &str) -> Result<(), ImportError>,
) -> Result<(), ImportError> {
    let bytes = utf8_without_mark(bytes);
    let mut joined = String::new();
    // The first line of what is carried on, and how it may be.
    let mut open: Option<(usize, Continues)> = None;
    for (line, bytes) in lines(&bytes) {
        let text = decoded(bytes);
        let text = text.trim();
        let (first, rule) = open.take().unwrap_or_else(|| (line, continues(keyword_and_rest(text).0)));
        if let Some(start) = carried_on(text, rule) {
            joined.push_str(start);
            joined.push(' ');
            open = Some((first, rule));
            continue;
        }
        if joined.is_empty() {
            statement(first, text, &mut each)?;
        } else {
            joined.push_str(text);
            statement(first, joined.trim(), &mut each)?;
            joined.clear();
        }
    }
    match open {
        Some((first, _)) => statement(first, joined.trim(), &mut each),
        None => Ok(()),
    }
}

fn statement(
    line: usize,
    text: &str,
    each: &mut impl FnMut(usize, &str) -> Result<(), ImportError>,
) -> Result<(), ImportError> {
    if text.is_empty() || text.starts_with('#') { Ok(()) } else { each(line, text) }
}

/// `text` without the backslash that carries it on; `None` where none does.
fn carried_on(text: &str, rule: Continues) -> Option<&str> {
    let start = text.strip_suffix('\\')?;
    let is = match rule {
        Continues::Always => !text.contains('#'),
        Continues::WhereApart => !text.starts_with('#') && start.ends_with(|c: char| c.is_whitespace()),
        Continues::Never => false,
    };
    is.then_some(start)
}

/// The lines of `bytes` with their numbers from 1, without what ends them.
fn lines(bytes: &[u8]) -> impl Iterator<Item = (usize, &[u8])> {
    let mut rest = Some(bytes);
    let mut number = 0;
    std::iter::from_fn(move || {
        let bytes = rest?;
        let (line, tail) = split_line(bytes);
        rest = tail;
        number += 1;
        Some((number, line))
    })
}

/// The first line of `bytes`, and what follows its end; `None` where nothing ends it.
pub(super) fn split_line(bytes: &[u8]) -> (&[u8], Option<&[u8]>) {
    let Some(end) = bytes.iter().position(|&b| b == b'\n' || b == b'\r') else { return (bytes, None) };
    let ending = if bytes[end..].starts_with(b"\r\n") { 2 } else { 1 };
    (&bytes[..end], Some(&bytes[end + ending..]))
}

/// `bytes` without a byte order mark; what one marks as UTF-16 is converted to UTF-8.
pub(super) fn utf8_without_mark(bytes: &[u8]) -> Cow<'_, [u8]> {
    let utf16 = |rest: &[u8], number: fn([u8; 2]) -> u16| {
        let units = rest.chunks(2).map(|pair| number([pair[0], pair.get(1).copied().unwrap_or(0)]));
        let text: String = char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect();
        Cow::Owned(text.into_bytes())
    };
    match bytes {
        [0xef, 0xbb, 0xbf, rest @ ..] => Cow::Borrowed(rest),
        [0xff, 0xfe, rest @ ..] => utf16(rest, u16::from_le_bytes),
        [0xfe, 0xff, rest @ ..] => utf16(rest, u16::from_be_bytes),
        _ => Cow::Borrowed(bytes),
    }
}

/// A line as text: UTF-8, or else Latin-1, which every line can be.
fn decoded(line: &[u8]) -> Cow<'_, str> {
    match std::str::from_utf8(line) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => Cow::Owned(line.iter().map(|&byte| char::from(byte)).collect()),
    }
}

/// The first word of a statement, and what follows it.
pub(super) fn keyword_and_rest(text: &str) -> (&str, &str) {
    let (keyword, rest) = text.split_once(|c: char| c.is_ascii_whitespace()).unwrap_or((text, ""));
    (keyword, rest.trim())
}

/// What stands before a `#` in a statement that holds numbers only. What follows a point is a number that is none, as some
/// systems write it (`1.#QNAN`).
pub(super) fn without_comment(text: &str) -> &str {
    let start = text.match_indices('#').map(|(at, _)| at).find(|&at| !text[..at].ends_with('.'));
    start.map_or(text, |at| text[..at].trim_end())
}

/// An error about line `line` of `path`.
pub(super) fn syntax(path: &Path, line: usize, reason: impl Into<String>) -> ImportError {
    ImportError::Syntax { path: path.to_owned(), line, reason: reason.into() }
}

/// `word` as a number.
pub(super) fn number(path: &Path, line: usize, word: &str) -> Result<f64, ImportError> {
    word.parse().map_err(|_| syntax(path, line, not_a_number(word)))
}

/// What is wrong with `word`, which should be a number.
pub(super) fn not_a_number(word: &str) -> String {
    let hint = if word.contains(',') { ": decimals are written with a point" } else { "" };
    format!("\"{}\" is not a number{hint}", shorten(word))
}

/// The first words of `text`, for messages.
pub(super) fn shorten(text: &str) -> String {
    let mut short: String = text.chars().take(40).collect();
    if short.len() < text.len() {
        short.push_str("...");
    }
    short
}

#[cfg(test)]
mod tests {
    use super::*;

    fn statements(bytes: &[u8]) -> Vec<(usize, String)> {
        let mut found = Vec::new();
        let rule = |keyword: &str| match keyword {
            "f" => Continues::Always,
            "name" => Continues::WhereApart,
            _ => Continues::Never,
        };
        for_each_line(bytes, rule, |line, text| {
            found.push((line, text.to_owned()));
            Ok(())
        })
        .unwrap();
        found
    }

    fn texts(bytes: &[u8]) -> Vec<String> {
        statements(bytes).into_iter().map(|(_, text)| text).collect()
    }

    #[test]
    fn lines_end_in_whatever_a_system_writes() {
        for end in ["\n", "\r\n", "\r"] {
            let text = ["a 1", "", "# c", "f 1 \\", "2 \\", "3", "b"].join(end);
            let expected = [(1, "a 1"), (4, "f 1  2  3"), (7, "b")].map(|(line, text)| (line, text.to_owned()));
            assert_eq!(statements(text.as_bytes()), expected, "{end:?}");
        }
    }

    #[test]
    fn comments_and_names_never_swallow_the_next_line() {
        for eaten in ["# D:\\a\\", "f 1 2 # D:\\a\\", "g D:\\a\\", "name D:\\a\\", "unknown \\"] {
            let found = texts(format!("{eaten}\nf 4 5 6\n").as_bytes());
            assert_eq!(found.last().map(String::as_str), Some("f 4 5 6"), "{eaten}");
        }
        assert_eq!(texts(b"name \\\nb c\nd"), ["name  b c", "d"]);
        assert_eq!(texts(b"f 1 2 3 \\"), ["f 1 2 3"], "the end of the file ends a statement");
    }

    #[test]
    fn byte_order_marks_are_skipped_and_utf_16_is_read() {
        assert_eq!(texts("\u{feff}f 1\n".as_bytes()), ["f 1"]);
        let wide = |number: fn(u16) -> [u8; 2]| "\u{feff}f ä\r\nb".encode_utf16().flat_map(number).collect::<Vec<_>>();
        assert_eq!(texts(&wide(u16::to_le_bytes)), ["f ä", "b"]);
        assert_eq!(texts(&wide(u16::to_be_bytes)), ["f ä", "b"]);
        assert_eq!(texts(b"gr\xf6\xdfe\nf \xc3\xb6"), ["größe", "f ö"]);
    }
}
