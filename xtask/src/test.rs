//! `cargo xtask test`: format, lints, tests, the WebAssembly build and its weight, and the browser tests.

use std::path::Path;
use std::process::Command;

use anyhow::Result;

use crate::command::{Beside, cargo, run};
use crate::{adapter, browser, demo, size, web};

/// Everything that continuous integration runs, cheapest first.
pub fn test() -> Result<()> {
    run("format", cargo().args(["fmt", "--all", "--check"]))?;
    // A module is optimised as one, by one processor: the lints have the others meanwhile.
    let mut native = cargo();
    let native = Beside::start(
        "lints, native",
        native.args(["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"]),
    )?;
    let dist = web::build()?;
    native.finish()?;
    size::check(&dist)?;
    let mut small = cargo();
    small.args(["clippy", "-p", "reprise-builder", "--no-default-features", "--", "-D", "warnings"]);
    run("lints, the builder of the demo", &mut small)?;
    let mut wasm = cargo();
    // With all that it is made of.
    wasm.args(["clippy", "-p", "reprise-web", "--target", "wasm32-unknown-unknown", "--", "-D", "warnings"]);
    run("lints, WebAssembly", &mut wasm)?;
    for package in ["reprise-searcher", "reprise-editor", "reprise-driver", "reprise-scanner"] {
        let mut later = cargo();
        later.args(["clippy", "-p", package, "--features", "bindings", "--target", "wasm32-unknown-unknown"]);
        run("lints, WebAssembly that comes later", later.args(["--", "-D", "warnings"]))?;
    }
    let mut docs = cargo();
    docs.args(["doc", "--workspace", "--no-deps", "-q"]).env("RUSTDOCFLAGS", "-D warnings");
    run("documentation", &mut docs)?;
    // In the profile that it runs in: in another one all that it is made of would be compiled again.
    run("tests of the task runner", cargo().args(["test", "-q", "-p", "xtask", "--profile", "xtask"]))?;
    adapter::install();
    run("tests", &mut tests())?;
    demo::pack(&dist.join("demo.reprise"), &|| browser::helper("builder"))?;
    browser::test(&dist)
}

/// The tests, with those that read real captures where these are at hand: they lie beside the project. Where `CI` is set
/// they have to be.
fn tests() -> Command {
    let mut tests = cargo();
    // One that fails hides none of the others.
    tests.args(["test", "--workspace", "--exclude", "xtask", "--no-fail-fast"]);
    let captures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    if captures.is_dir() || std::env::var_os("CI").is_some() {
        tests.args(["--", "--include-ignored"]);
    }
    tests
}
