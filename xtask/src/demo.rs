//! `cargo xtask demo`: the built-in performer on the page, from nothing.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread;

use anyhow::{Context, Result, anyhow, bail};

use crate::command::{Beside, cargo, run, target};
use crate::{serve, web};

/// Builds the page, packs the built-in performer and serves both.
pub fn demo(arguments: &[&str]) -> Result<()> {
    let (mut port, mut serving) = (None, true);
    let mut words = arguments.iter();
    while let Some(word) = words.next() {
        match *word {
            "--port" => {
                let number = words.next().context("--port needs a number")?;
                port = Some(number.parse().with_context(|| format!("{number:?} is not a port"))?);
            }
            "--no-serve" => serving = false,
            other => bail!("demo knows no {other:?}; usage: cargo xtask demo [--port N] [--no-serve]"),
        }
    }
    // The page's last step optimises all of it as one, on one core: what the builder does takes the others meanwhile.
    let packed = thread::spawn(packed);
    let dist = web::build()?;
    let bundle = packed.join().map_err(|_| anyhow!("packing broke off"))??;
    let shown = dist.join("demo.reprise");
    fs::copy(&bundle, &shown).with_context(|| format!("cannot write {}", shown.display()))?;
    if serving { serve::serve(&dist, port) } else { Ok(()) }
}

/// Compiles the builder, and packs the built-in performer with it; the bundle.
fn packed() -> Result<PathBuf> {
    Beside::start("the builder", &mut small_builder("build"))?.finish()?;
    let builder = || {
        let mut builder = small_builder("run");
        builder.args(["--", "-q"]);
        Ok(builder)
    };
    let bundle = target().join("demo.reprise");
    pack(&bundle, &builder)?;
    Ok(bundle)
}

/// Makes the built-in performer's capture and packs it into `bundle`.
pub fn pack(bundle: &Path, builder: &dyn Fn() -> Result<Command>) -> Result<PathBuf> {
    let capture = target().join("performer");
    if capture.exists() {
        fs::remove_dir_all(&capture).with_context(|| format!("cannot clear {}", capture.display()))?;
    }
    run("the performer's capture", builder()?.arg("performer").arg("-o").arg(&capture))?;
    run("the performer's bundle", builder()?.args(["pack", "--rig"]).arg(&capture).arg("-o").arg(bundle))?;
    Ok(capture)
}

/// What cargo is to do (`build` or `run`) with the builder that the demo needs: without scans and evaluation, which are a third
/// of what a builder compiles.
fn small_builder(what: &str) -> Command {
    let mut command = cargo();
    command.args([what, "-q", "-p", "reprise-builder", "--no-default-features", "--release"]);
    command
}

/// The `builder` command of a profile.
pub fn builder(profile: &str) -> Command {
    let mut command = cargo();
    command.args(["run", "-q", "-p", "reprise-builder", "--profile", profile, "--"]);
    command
}
