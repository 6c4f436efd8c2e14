//! `builder validate`.

use std::fs;

use anyhow::{Context, anyhow};
use serde::Serialize;
use shared::bundle::{Finding, Severity, validate};

use super::args::ValidateArguments;
use super::failure::Failure;
use super::output::{print_json, print_text};

#[derive(Serialize)]
struct Line {
    code: &'static str,
    severity: &'static str,
    message: String,
}

/// Lists what is wrong with a bundle; fails where it, or a part of it, cannot be used.
pub fn run(arguments: &ValidateArguments) -> Result<(), Failure> {
    let path = &arguments.bundle;
    let bytes = fs::read(path).with_context(|| format!("cannot read {}", path.display())).map_err(Failure::Input)?;
    let findings = validate(&bytes);
    let broken = findings.iter().any(|finding| finding.severity == Severity::Error);
    let lines: Vec<Line> = findings.into_iter().map(line).collect();
    if arguments.json {
        print_json(&lines)?;
    } else if lines.is_empty() {
        print_text(&format!("{}: nothing is wrong", path.display()))?;
    } else {
        let text: Vec<String> =
            lines.iter().map(|line| format!("{} {}: {}", line.severity, line.code, line.message)).collect();
        print_text(&text.join("\n"))?;
    }
    if broken { Err(Failure::Input(anyhow!("{} cannot be used as it is", path.display()))) } else { Ok(()) }
}

fn line(finding: Finding) -> Line {
    let severity = match finding.severity {
        Severity::Note => "note",
        Severity::Warning => "warning",
        Severity::Error => "error",
    };
    Line { code: finding.code, severity, message: finding.message }
}
