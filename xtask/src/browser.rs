//! What the browser tests need: node with playwright-core, and a Chromium with WebGPU.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::command::{install_debian, root, run, succeeds, target};

/// Chromium, and the OpenGL vendor without which it loses its WebGPU device.
const PACKAGES: [&str; 6] = ["chromium", "fonts-dejavu-core", "libegl1", "libegl-mesa0", "libgles2", "libgl1-mesa-dri"];

/// Runs the browser tests on the page in `dist`, which holds the demo; fetches what they need first.
pub fn test(dist: &Path) -> Result<()> {
    let (walks, dressed) = (target().join("walks"), target().join("dressed"));
    let bundle = dist.join("demo.reprise");
    run("walks, natively", helper("native_walk")?.arg(&bundle).arg(&walks))?;
    run("textures, natively", helper("dress")?.arg(&bundle).arg(&dressed).arg("512"))?;
    let mut tests = node("run.mjs", dist)?;
    tests.env("REPRISE_NATIVE", walks).env("REPRISE_DRESSED", dressed).env("REPRISE_FRAMEWORKS", frameworks(dist)?);
    run("browser tests", &mut tests)
}

/// `cargo xtask frameworks`: the tests of the page in `dist` within frameworks' components, alone.
pub fn test_frameworks(dist: &Path) -> Result<()> {
    if !dist.join("demo.reprise").is_file() {
        bail!("{} holds no page with the demo; build it with: cargo xtask demo --no-serve", dist.display());
    }
    let pages = frameworks(dist)?;
    run("browser tests", node("run.mjs", dist)?.arg("framework:").env("REPRISE_FRAMEWORKS", pages))
}

/// Builds the pages of `tests/browser/frameworks`, with the player in `dist` as a package, and returns their folder. What
/// they are built with is installed in a folder of its own: nothing of it is part of the project.
fn frameworks(dist: &Path) -> Result<PathBuf> {
    let (pages, folder) = (root().join("tests/browser/frameworks"), target().join("frameworks"));
    fs::create_dir_all(&folder).with_context(|| format!("cannot create {}", folder.display()))?;
    for name in ["package.json", "package-lock.json", "build.mjs", "linker.mjs"] {
        fs::copy(pages.join(name), folder.join(name)).with_context(|| format!("cannot copy {name}"))?;
    }
    npm_ci("packages of the frameworks", &folder)?;
    let out = folder.join("out");
    let mut build = Command::new("node");
    build.arg("build.mjs").arg(&pages).arg(dist).arg(&out).current_dir(&folder);
    run("pages of the frameworks", &mut build)?;
    Ok(out)
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
    npm_ci("node packages", &folder)?;
    Ok(folder)
}

/// Installs what the lock file in `folder` says.
fn npm_ci(what: &str, folder: &Path) -> Result<()> {
    run(what, Command::new("npm").args(["ci", "--no-audit", "--no-fund"]).current_dir(folder))
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
