//! The command line: arguments, terminal, exit codes. The work itself is the library's.

mod args;
mod asked;
mod direct;
#[cfg(feature = "complete")]
mod drive;
#[cfg(feature = "complete")]
mod drive_actor;
#[cfg(feature = "complete")]
mod drive_capture;
#[cfg(feature = "complete")]
mod drive_frames;
#[cfg(feature = "complete")]
mod evaluate;
mod failure;
#[cfg(feature = "complete")]
mod family;
mod inspect;
mod output;
mod pack;
mod performer;
#[cfg(feature = "complete")]
mod register;
#[cfg(feature = "complete")]
mod report;
mod rig;
mod rigged;
mod terminal;
#[cfg(feature = "complete")]
mod transfer;
#[cfg(feature = "complete")]
mod transfer_alone;
mod typed;
mod validate;
#[cfg(feature = "complete")]
mod vary;
mod walked;
mod work;

use std::process::ExitCode;

use anyhow::anyhow;
use clap::Parser;
use clap::error::ErrorKind;

use args::{Arguments, Command};
use failure::Failure;
use terminal::Terminal;

/// Runs the command that was typed.
pub fn run() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => {
            // Help and version come as errors too. Nothing is left to do where even this cannot be printed.
            let _ = error.print();
            let asked_for = matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion);
            return if asked_for { ExitCode::SUCCESS } else { ExitCode::from(2) };
        }
    };
    // The panic's own message is already on stderr.
    let result = std::panic::catch_unwind(|| dispatch(&arguments))
        .unwrap_or_else(|_| Err(Failure::Internal(anyhow!("builder stopped in the middle of its work"))));
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}

fn dispatch(arguments: &Arguments) -> Result<(), Failure> {
    if let Some(threads) = arguments.threads {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.into()).build_global();
        pool.map_err(|error| Failure::Internal(error.into()))?;
    }
    terminal::stop_when_interrupted();
    let terminal = Terminal::new(arguments.quiet);
    match &arguments.command {
        Command::Pack(arguments) => pack::run(arguments, &terminal),
        #[cfg(feature = "complete")]
        Command::Register(arguments) => register::run(arguments, &terminal),
        #[cfg(feature = "complete")]
        Command::Vary(arguments) => vary::run(arguments, &terminal),
        #[cfg(feature = "complete")]
        Command::Transfer(arguments) => transfer::run(arguments, &terminal),
        Command::Performer(arguments) => performer::run(arguments, &terminal),
        Command::Direct(arguments) => direct::run(arguments, &terminal),
        #[cfg(feature = "complete")]
        Command::Drive(arguments) => drive::run(arguments, &terminal),
        #[cfg(feature = "complete")]
        Command::Family(arguments) => family::run(arguments, &terminal),
        Command::Rig(arguments) => rig::run(arguments, &terminal),
        Command::Inspect(arguments) => inspect::run(arguments, &terminal),
        Command::Validate(arguments) => validate::run(arguments, &terminal),
        #[cfg(feature = "complete")]
        Command::Evaluate(arguments) => evaluate::run(arguments, &terminal),
        #[cfg(feature = "complete")]
        Command::Report(arguments) => report::run(arguments, &terminal),
        Command::Work(arguments) => work::run(arguments, &terminal),
    }
}
