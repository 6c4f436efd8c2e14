//! What the browser tests need: node with playwright-core, and a Chromium with WebGPU.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Result, bail};

use crate::command::{install_debian, root, run, succeeds, target};

/// Chromium, and the OpenGL vendor without which it loses its WebGPU device.
const PACKAGES: [&str; 6] = ["chromium", "fonts-dejavu-core", "libegl1", "libegl-mesa0", "libgles2", "libgl1-mesa-dri"];

/// Runs the browser tests on the page in `dist`, which holds the demo; fetches what they need first.
pub fn test(dist: &Path) -> Result<()> {
    let (walks, dressed) = (target().join("walks"), target().join("dressed"));
    let bundle = dist.join("demo.reprise");
    run("walks, natively", helper("native_walk")?.arg(&bundle).arg(&walks))?;
    run("textures, natively", helper("dress")?.arg(&bundle).arg(&dressed).arg("512"))?;
    run("browser tests", node("run.mjs", dist)?.env("REPRISE_NATIVE", walks).env("REPRISE_DRESSED", dressed))
}

/// A program that was built along with the tests: to ask cargo for it alone would build its dependencies anew, with other
/// features.
pub fn helper(name: &str) -> Result<Command> {
    let path = target().join("debug").join(name).with_extension(std::env::consts::EXE_EXTENSION);
    if !path.is_file() {
        bail!("{} is missing; build it with: cargo test --workspace --no-run", path.display());
    }
    Ok(Command::new(path))
}

/// A script of the browser tests' folder, for the page in `dist`.
pub fn node(script: &str, dist: &Path) -> Result<Command> {
    let chromium = chromium()?;
    let mut command = Command::new("node");
    command.arg(script).current_dir(node_packages()?).env("REPRISE_DIST", dist).env("CHROMIUM", chromium);
    Ok(command)
}

/// Installs the tests' own node packages and returns their folder.
pub fn node_packages() -> Result<PathBuf> {
    if !succeeds("node", &["--version"]) || !succeeds("npm", &["--version"]) {
        bail!("the browser tests need node 20 or newer with npm; get it from nodejs.org or your package manager");
    }
    let folder = root().join("tests/browser");
    let mut install = Command::new("npm");
    install.args(["ci", "--no-audit", "--no-fund"]).current_dir(&folder);
    run("node packages", &mut install)?;
    Ok(folder)
}

/// The Chromium to test in: `CHROMIUM`, an installed one, or Debian's package where that can be installed.
pub fn chromium() -> Result<PathBuf> {
    if let Some(path) = std::env::var_os("CHROMIUM") {
        return Ok(path.into());
    }
    if let Some(path) = installed() {
        return Ok(path);
    }
    install_debian("Chromium and its OpenGL vendor", &PACKAGES)?;
    match installed() {
        Some(path) => Ok(path),
        None => bail!(
            "the browser tests need Chromium: install it (Debian: apt-get install {}), or name one in CHROMIUM",
            PACKAGES.join(" ")
        ),
    }
}

fn installed() -> Option<PathBuf> {
    let names = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];
    names.iter().map(PathBuf::from).find(|path| path.is_file())
}
