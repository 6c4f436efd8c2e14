//! How long the player's own passes take on this machine's GPU, by the GPU's clock, outside of a browser.
//!
//! ```text
//! cargo run --release -p reprise-web --example gpu_times -- actor.reprise
//! ```
//!
//! The stage is the page's (`web::gpu`), drawn into a texture instead of a canvas; [`open`] finds the device, [`moments`]
//! lets the player walk, [`rounds`] draws what it showed and takes the times, [`table`] prints them.
#![allow(clippy::print_stdout, reason = "the result is what is printed")]

mod moments;
mod open;
mod options;
mod rounds;
mod table;

use std::process::ExitCode;

use anyhow::Result;

use options::{Asked, HELP, Options};
use table::Report;

fn main() -> ExitCode {
    match run() {
        Ok(code) => code,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<ExitCode> {
    let options = match Options::parse(std::env::args().skip(1))? {
        Asked::Help => {
            print!("{HELP}");
            return Ok(ExitCode::SUCCESS);
        }
        Asked::Times(options) => options,
    };
    // A bundle that cannot be read is told first: it needs no device.
    let walk = moments::walk(&options.bundle, options.frames)?;
    let Some(opened) = open::open(options.adapter.as_deref())? else {
        eprintln!("{}", open::NO_ADAPTER);
        return Ok(ExitCode::from(2));
    };
    let rounds = rounds::rounds(&walk, &opened, &options)?;
    let timestamps = opened.stopwatch.is_some();
    let report = Report { adapter: &opened.adapter, timestamps, walk: &walk, options: &options, rounds: &rounds };
    if options.json {
        println!("{:#}", report.json());
    } else {
        print!("{}", report.table());
    }
    Ok(ExitCode::SUCCESS)
}
