//! `cargo xtask test`: format, lints, tests, the WebAssembly build and its weight, and the browser tests.

use anyhow::Result;

use crate::command::{cargo, run};
use crate::{browser, demo, size, web};

/// Everything that continuous integration runs, cheapest first.
pub fn test() -> Result<()> {
    run("format", cargo().args(["fmt", "--all", "--check"]))?;
    let dist = web::build()?;
    size::check(&dist)?;
    run("lints, native", cargo().args(["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"]))?;
    let mut wasm = cargo();
    wasm.args(["clippy", "-p", "reprise-web", "-p", "reprise-shared", "--target", "wasm32-unknown-unknown"]);
    run("lints, WebAssembly", wasm.args(["--", "-D", "warnings"]))?;
    let mut docs = cargo();
    docs.args(["doc", "--workspace", "--no-deps", "-q"]).env("RUSTDOCFLAGS", "-D warnings");
    run("documentation", &mut docs)?;
    // In the profile that it runs in: in another one all that it is made of would be compiled again.
    run("tests of the task runner", cargo().args(["test", "-q", "-p", "xtask", "--profile", "xtask"]))?;
    run("tests", cargo().args(["test", "--workspace", "--exclude", "xtask"]))?;
    demo::pack(&dist.join("demo.reprise"), &|| browser::helper("builder"))?;
    browser::test(&dist)
}
