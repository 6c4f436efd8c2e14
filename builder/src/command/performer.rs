//! `builder performer`.
use super::args::PerformerArguments;
use super::failure::Failure;
use super::terminal::Terminal;

/// Writes the built-in performer's capture.
pub fn run(_arguments: &PerformerArguments, _terminal: &Terminal) -> Result<(), Failure> {
    Err(Failure::Input(anyhow::anyhow!("missing")))
}
