//! Runs other programs from the workspace's root.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Instant;

use anyhow::{Context, Result, bail};

/// The workspace's root folder.
pub fn root() -> PathBuf {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR"));
    manifest.parent().unwrap_or(manifest).to_path_buf()
}

/// The folder that cargo builds into.
pub fn target() -> PathBuf {
    match std::env::var_os("CARGO_TARGET_DIR") {
        Some(folder) => root().join(folder),
        None => root().join("target"),
    }
}

/// The cargo that runs this task.
pub fn cargo() -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(root());
    if std::env::var_os("CI").is_some() {
        // What is compiled once and never again: nothing is kept for the next time, and no debugger looks at it.
        command.env("CARGO_INCREMENTAL", "0").env("CARGO_PROFILE_DEV_DEBUG", "0");
    }
    command
}

/// Runs `command` to its end, with a line that says what and how long.
pub fn run(what: &str, command: &mut Command) -> Result<()> {
    println!("== {what}");
    let start = Instant::now();
    let status = command.status().with_context(|| format!("{what}: cannot start {:?}", command.get_program()))?;
    if !status.success() {
        bail!("{what} failed ({status})");
    }
    println!("== {what}: {:.1} s", start.elapsed().as_secs_f32());
    Ok(())
}

/// A command that runs while others do; it says nothing but what is wrong. Ended where it is dropped unfinished.
pub struct Beside {
    what: &'static str,
    child: Child,
    start: Instant,
}

impl Beside {
    /// Starts `command`.
    pub fn start(what: &'static str, command: &mut Command) -> Result<Self> {
        println!("== {what}, beside what follows");
        let child = command.stdout(Stdio::null()).spawn();
        let child = child.with_context(|| format!("{what}: cannot start {:?}", command.get_program()))?;
        Ok(Self { what, child, start: Instant::now() })
    }

    /// Waits for its end.
    pub fn finish(mut self) -> Result<()> {
        let status = self.child.wait().with_context(|| format!("{}: lost sight of it", self.what))?;
        if !status.success() {
            bail!("{} failed ({status})", self.what);
        }
        println!("== {}: {:.1} s since it was begun", self.what, self.start.elapsed().as_secs_f32());
        Ok(())
    }
}

impl Drop for Beside {
    fn drop(&mut self) {
        // One that has ended already cannot be ended again, and that is as well.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Whether `program arguments` can be run and succeeds.
pub fn succeeds(program: &str, arguments: &[&str]) -> bool {
    let quiet = Command::new(program).args(arguments).stdout(Stdio::null()).stderr(Stdio::null()).status();
    quiet.is_ok_and(|status| status.success())
}

/// Installs `packages`, which are `what`, where this is a Debian; elsewhere it does nothing.
pub fn install_debian(what: &str, packages: &[&str]) -> Result<()> {
    if !succeeds("apt-get", &["--version"]) {
        return Ok(());
    }
    run("list of Debian packages", Command::new("apt-get").args(["update", "-qq"]))?;
    let mut install = Command::new("apt-get");
    install.args(["install", "-y", "-qq", "--no-install-recommends"]).args(packages);
    run(what, install.env("DEBIAN_FRONTEND", "noninteractive"))
}
