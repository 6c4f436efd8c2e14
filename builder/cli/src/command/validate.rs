//! `builder validate`.

use std::fs;
use std::path::Path;

use anyhow::{Context, anyhow};
use bundle::{Finding, Severity, validate};
use capture_io::import::{Warning, import};
use job::Job;
#[cfg(feature = "complete")]
use reprise::look::{is_scan, look};
use reprise::pack::{PackError, PackOptions};
use reprise::preflight::preflight;
#[cfg(feature = "complete")]
use reprise::scans::ScanOptions;
use serde::Serialize;

use super::args::ValidateArguments;
use super::failure::Failure;
use super::inspect::is_bundle;
use super::output::{print_json, print_text};
use super::pack::import_options;
use super::terminal::Terminal;

/// A finding as it is printed.
#[derive(Serialize)]
struct Line {
    code: &'static str,
    severity: &'static str,
    message: String,
}

/// Lists what is wrong with a bundle or an input; fails where it, or a part of it, cannot be used.
pub fn run(arguments: &ValidateArguments, terminal: &Terminal) -> Result<(), Failure> {
    let lines = match arguments.inputs.as_slice() {
        [path] if is_bundle(Path::new(path)) || Path::new(path).extension().is_some_and(|end| end == "reprise") => {
            let bytes = fs::read(path).with_context(|| format!("cannot read {path}")).map_err(Failure::Input)?;
            validate(&bytes).into_iter().map(of_bundle).collect()
        }
        inputs => {
            let mut options = PackOptions::default();
            options.import = import_options(&arguments.import);
            let lines = of_input(inputs, options, terminal);
            if lines.iter().any(|line| line.code == "E_STOPPED") {
                return Err(Failure::StoppedReading);
            }
            lines
        }
    };
    let name = arguments.inputs.join(" ");
    if arguments.json {
        print_json(&lines)?;
    } else if lines.is_empty() {
        print_text(&format!("{name}: nothing is wrong"))?;
    } else {
        let text: Vec<String> =
            lines.iter().map(|line| format!("{} {}: {}", line.severity, line.code, line.message)).collect();
        print_text(&text.join("\n"))?;
    }
    let broken = lines.iter().any(|line| line.severity == "error");
    if broken { Err(Failure::Input(anyhow!("{name} cannot be used as it is"))) } else { Ok(()) }
}

fn of_bundle(finding: Finding) -> Line {
    let severity = match finding.severity {
        Severity::Note => "note",
        Severity::Warning => "warning",
        Severity::Error => "error",
    };
    Line { code: finding.code, severity, message: finding.message }
}

/// Reading stops at the first error; warnings do not stop it.
fn of_input(inputs: &[String], options: PackOptions, terminal: &Terminal) -> Vec<Line> {
    let report = |step| terminal.progress(step);
    let warning = |Warning { code, message }| Line { code, severity: "warning", message };
    let job = Job::new(&report);
    match import(inputs, &options.import, &job) {
        Ok(imported) => {
            let found = preflight(&imported, &options, &job);
            let error = |error: PackError| Line { code: error.code(), severity: "error", message: error.to_string() };
            let warnings = imported.warnings.into_iter().chain(found.warnings).map(warning);
            warnings.chain(found.refusal.map(error)).collect()
        }
        #[cfg(feature = "complete")]
        Err(error) if is_scan(&error) => {
            let mut scan = ScanOptions::default();
            scan.import = options.import;
            match look(inputs, &scan, &job) {
                Ok(found) => found.warnings.into_iter().map(warning).collect(),
                Err(error) => vec![Line { code: error.code(), severity: "error", message: error.to_string() }],
            }
        }
        Err(error) => vec![Line { code: error.code(), severity: "error", message: error.to_string() }],
    }
}
