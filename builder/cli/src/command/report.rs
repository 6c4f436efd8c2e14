//! `builder report`.

use std::fs;

use anyhow::Context;
use evaluate::html;
use evaluate::short::{ReportError, report_on};
use job::{Job, Progress};

use super::args::ReportArguments;
use super::failure::Failure;
use super::output::write_whole;
use super::terminal::Terminal;

/// Writes a page about a bundle.
pub fn run(arguments: &ReportArguments, terminal: &Terminal) -> Result<(), Failure> {
    let path = &arguments.bundle;
    let bytes = fs::read(path).with_context(|| format!("cannot read {}", path.display())).map_err(Failure::Input)?;
    let report = |step: Progress| terminal.progress(step);
    let document = report_on(&bytes, &Job::new(&report)).map_err(|error| match error {
        ReportError::Picture(_) => Failure::Internal(error.into()),
        _ => Failure::Input(anyhow::Error::from(error).context(path.display().to_string())),
    })?;
    let output = arguments.output.clone().unwrap_or_else(|| path.with_extension("html"));
    write_whole(&output, html::page(&document, false).as_bytes()).map_err(Failure::Input)?;
    terminal.log(&output.display().to_string());
    Ok(())
}
