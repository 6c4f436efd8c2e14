//! What a user should know about an input that can be used all the same.

use std::fmt;
use std::ops::Deref;
use std::path::{Path, PathBuf};

use serde::Serialize;

/// A sentence about an input, and a name for its kind that never changes.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Warning {
    /// For scripts and for `builder validate`, for example `W_LOOSE_VERTICES`.
    pub code: &'static str,
    /// What is unusual, where, and what to do about it.
    pub message: String,
}

impl Warning {
    /// A warning of the kind `code`.
    #[must_use]
    pub fn new(code: &'static str, message: String) -> Self {
        Self { code, message }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl Deref for Warning {
    type Target = str;

    fn deref(&self) -> &str {
        &self.message
    }
}

/// What is unusual about one file, before it is known how many are like it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Note {
    /// The code of the warning that it becomes.
    pub code: &'static str,
    /// The sentence, without the file.
    pub message: String,
}

impl Note {
    pub fn new(code: &'static str, message: impl Into<String>) -> Self {
        Self { code, message: message.into() }
    }
}

/// Notes about many files: those of one kind become one warning, which names the first file.
#[derive(Debug, Default)]
pub(super) struct Notes {
    kinds: Vec<WarningKind>,
}

#[derive(Debug)]
struct WarningKind {
    first: PathBuf,
    last: PathBuf,
    note: Note,
    files: usize,
}

impl Notes {
    /// Adds what is unusual about `path`; notes of one file must be added together.
    pub fn add(&mut self, path: &Path, notes: impl IntoIterator<Item = Note>) {
        for note in notes {
            match self.kinds.iter_mut().find(|kind| kind.note.code == note.code) {
                Some(kind) if kind.last == path => {}
                Some(kind) => {
                    kind.files += 1;
                    kind.last = path.to_owned();
                }
                None => self.kinds.push(WarningKind { first: path.to_owned(), last: path.to_owned(), note, files: 1 }),
            }
        }
    }

    /// One warning a kind, in the order in which they were first met.
    pub fn into_warnings(self) -> impl Iterator<Item = Warning> {
        self.kinds.into_iter().map(|WarningKind { first, last, note, files }| {
            let more = match files {
                1 => String::new(),
                2 => format!("; the same in {}", last.display()),
                _ => format!("; the same in {} more files, the last of them {}", files - 1, last.display()),
            };
            Warning::new(note.code, format!("{}: {}{more}", first.display(), note.message))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn notes_of_a_kind_become_one_warning() {
        let mut notes = Notes::default();
        for k in 0..4 {
            let path = PathBuf::from(format!("f{k}"));
            notes.add(&path, [Note::new("W_SIZE", format!("a{k}")), Note::new("W_SIZE", "again")]);
            notes.add(&path, (k == 2).then(|| Note::new("W_NO_UV", "b")));
        }
        let warnings: Vec<String> = notes.into_warnings().map(|w| w.message).collect();
        assert_eq!(warnings, ["f0: a0; the same in 3 more files, the last of them f3", "f2: b"]);
    }
}
