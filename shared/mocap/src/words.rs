//! The words of a text file, with their lines.

use std::borrow::Cow;

use kernels::decimal::decimal;

use crate::error::MocapError;

/// Words one after another.
pub struct Words<'a> {
    source: &'a str,
    words: Vec<(usize, &'a str)>,
    next: usize,
}

/// The bytes of a text file as text: without a byte order mark; what is not UTF-8 is not needed to be right.
pub fn text(bytes: &[u8]) -> Cow<'_, str> {
    String::from_utf8_lossy(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes))
}

/// Lines that are not empty and no comments, with their numbers from 1.
pub fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let lines = text.lines().enumerate().map(|(index, line)| (index + 1, line.trim()));
    lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'))
}

/// An error about a line.
pub fn syntax(source: &str, line: usize, reason: impl Into<String>) -> MocapError {
    MocapError::Syntax { file: source.into(), line, reason: reason.into() }
}

/// `word` as a finite number.
pub fn number(source: &str, line: usize, word: &str) -> Result<f64, MocapError> {
    let shown: String = word.chars().take(40).collect();
    let number: f64 = decimal(word).ok_or_else(|| syntax(source, line, format!("{shown:?} is not a number")))?;
    // Nothing that stands for a place or an angle is as large; sums of what is smaller stay finite.
    if number.abs() > 1e9 {
        return Err(syntax(source, line, format!("{shown} is no length and no angle")));
    }
    Ok(number)
}

impl<'a> Words<'a> {
    /// The words of `text`.
    pub fn new(source: &'a str, text: &'a str) -> Self {
        let words = lines(text).flat_map(|(line, text)| text.split_whitespace().map(move |word| (line, word)));
        Self { source, words: words.collect(), next: 0 }
    }

    /// The line of the word that comes next.
    pub fn line(&self) -> usize {
        self.words.get(self.next).or(self.words.last()).map_or(1, |(line, _)| *line)
    }

    /// An error where the next word is.
    pub fn wrong(&self, reason: impl Into<String>) -> MocapError {
        syntax(self.source, self.line(), reason)
    }

    /// The next word; `what` is what the file goes on with.
    pub fn word(&mut self, what: &str) -> Result<&'a str, MocapError> {
        let ends = || MocapError::Truncated { file: self.source.into(), what: what.into() };
        let (_, word) = *self.words.get(self.next).ok_or_else(ends)?;
        self.next += 1;
        Ok(word)
    }

    /// Takes `word`, which must come next.
    pub fn expect(&mut self, word: &str) -> Result<(), MocapError> {
        let line = self.line();
        let found = self.word(word)?;
        if found.eq_ignore_ascii_case(word) {
            return Ok(());
        }
        let shown: String = found.chars().take(40).collect();
        Err(syntax(self.source, line, format!("{word} is missing, here is {shown:?}")))
    }

    /// The next word as a number.
    pub fn number(&mut self, what: &str) -> Result<f64, MocapError> {
        let line = self.line();
        let word = self.word(what)?;
        number(self.source, line, word)
    }

    /// Three numbers.
    pub fn vector(&mut self, what: &str) -> Result<glam::DVec3, MocapError> {
        Ok(glam::DVec3::new(self.number(what)?, self.number(what)?, self.number(what)?))
    }

    /// Words that are left, with their lines.
    pub fn rest(&self) -> &[(usize, &'a str)] {
        &self.words[self.next..]
    }
}
