//! `cargo xtask bench`: every figure of docs/performance.md, beside its mark.

use anyhow::Result;

use crate::command::{cargo, run};

/// Runs the native benchmarks.
pub fn bench() -> Result<()> {
    run("native benchmarks", cargo().args(["bench", "--workspace"]))
}
