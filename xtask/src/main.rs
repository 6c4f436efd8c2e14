//! Builds, serves and checks Reprise.
//!
//! ```text
//! cargo xtask demo         build the page, pack the built-in performer, serve it and say where
//! cargo xtask test         everything that continuous integration runs
//! cargo xtask bench        what is measured, each figure beside its mark
//! cargo xtask web          build the page alone into dist/
//! cargo xtask scripts      the page's scripts and styles alone, beside the WebAssembly that is in dist/
//! cargo xtask frameworks   the tests of the page in dist/ within React, Vue, Svelte and Angular, alone
//! cargo xtask serve        serve dist/ as it is
//! ```
#![allow(clippy::print_stdout, reason = "a task runner speaks to its terminal")]

mod adapter;
mod bench;
mod browser;
mod bundle;
mod command;
mod demo;
mod figures;
mod names;
mod serve;
mod size;
mod strip;
mod test;
mod web;

use std::process::ExitCode;

const HELP: &str = "\
usage: cargo xtask <command>

  demo [--port N] [--no-serve]   build the page, pack the built-in performer, serve it and say where
  test                           everything that continuous integration runs
  bench                          every measured figure beside its mark
  web                            build the page alone into dist/
  scripts                        its scripts and styles alone, beside the WebAssembly that is in dist/
  frameworks                     the tests of the page in dist/ within React, Vue, Svelte and Angular, alone
  serve [--port N]               serve dist/ as it is";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let result = match words.as_slice() {
        ["demo", rest @ ..] => demo::demo(rest),
        ["test"] => test::test(),
        ["bench"] => bench::bench(),
        ["web"] => web::build().map(|_| ()),
        ["scripts"] => web::scripts().and_then(|dist| size::check(&dist)),
        ["frameworks"] => browser::test_frameworks(&web::dist()),
        ["serve", rest @ ..] => serve::serve_command(rest),
        ["help" | "--help" | "-h"] => {
            println!("{HELP}");
            Ok(())
        }
        _ => {
            eprintln!("{HELP}");
            return ExitCode::from(2);
        }
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
