//! Files that are there in full or not at all, and objects on stdout.

use std::io::Write;
use std::path::Path;

use anyhow::{Context, Result};
use job::files::write_for_good;
use serde::Serialize;

use super::failure::Failure;

/// Prints `value` as one JSON object on stdout.
pub fn print_json(value: &impl Serialize) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(value).map_err(|error| Failure::Internal(error.into()))?;
    print_text(&text)
}

/// Prints `text` and a line end on stdout.
pub fn print_text(text: &str) -> Result<(), Failure> {
    let mut stdout = std::io::stdout().lock();
    match writeln!(stdout, "{text}") {
        // A reader that has seen enough, such as `head`, is no failure.
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        result => result.context("cannot write to stdout").map_err(Failure::Input),
    }
}

/// Writes `bytes` to `path`, all of them or none.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    write_for_good(path, bytes).with_context(|| format!("cannot write {}", path.display()))
}
