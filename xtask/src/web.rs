//! Builds the page into `dist/`: WebAssembly, its JavaScript bindings, and everything in `www/`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};
use wasm_bindgen_cli_support::Bindgen;

use crate::bundle::{Script, bundle};
use crate::command::{cargo, root, run, succeeds, target};
use crate::names::shorten;
use crate::strip::strip;

const TARGET: &str = "wasm32-unknown-unknown";
/// The script that a page imports, and the folder of the modules that are joined into it and into those beside it.
const PLAYER: &str = "reprise-player.js";
const PARTS: &str = "player";
/// What a page fetches only when the first tool is needed.
const LATER: &str = "reprise-tools.js";

/// A WebAssembly module: the crate that it is made of, its features, and the name of its files.
struct Module {
    package: &'static str,
    features: &'static str,
    name: &'static str,
}

const MODULE: Module = Module { package: "reprise-web", features: "", name: "web" };
/// The modules that a page fetches only when something is first searched for, when something is first edited,
/// when motion capture is first dropped, and where there are frames as they were scanned.
const LATER_MODULES: [Module; 4] = [
    Module { package: "reprise-searcher", features: "bindings", name: "searcher" },
    Module { package: "reprise-editor", features: "bindings", name: "editor" },
    Module { package: "reprise-driver", features: "bindings", name: "driver" },
    Module { package: "reprise-scanner", features: "bindings", name: "scanner" },
];

/// Whether a page fetches a file of the build only when it is needed; `name` is its path in the folder.
pub fn is_later(name: &Path) -> bool {
    let stem = name.file_stem().and_then(|stem| stem.to_str()).unwrap_or_default();
    name == Path::new(LATER)
        || name.starts_with("pkg") && LATER_MODULES.iter().any(|module| stem.starts_with(module.name))
}

/// Whether a file of the build is one of the page of key poses; `name` is its path in the folder.
pub fn is_keys(name: &Path) -> bool {
    name == Path::new("keys.js") || name.starts_with("keys")
}

/// Builds the page and returns the folder that holds it.
pub fn build() -> Result<PathBuf> {
    build_player(&MODULE)
}

/// Builds the page with the player's own benchmark in it.
pub fn build_to_measure() -> Result<PathBuf> {
    build_player(&Module { features: "bench", ..MODULE })
}

fn build_player(player: &Module) -> Result<PathBuf> {
    add_wasm_target()?;
    let package = dist().join("pkg");
    fs::create_dir_all(&package).with_context(|| format!("cannot create {}", package.display()))?;
    for module in std::iter::once(player).chain(&LATER_MODULES) {
        compile(module)?;
        let wasm = target().join(TARGET).join(format!("wasm/{}.wasm", module.name));
        bind(&wasm, &package, module.name)
            .with_context(|| format!("cannot write the bindings of {}", wasm.display()))?;
    }
    scripts()
}

fn compile(module: &Module) -> Result<()> {
    let mut command = cargo();
    command.args(["rustc", "-p", module.package, "--lib", "--target", TARGET, "--profile", "wasm"]);
    // The library for native tests, beside it, would keep the crates from being optimised as one.
    command.args(["--crate-type", "cdylib", "--features", module.features]);
    // Flags from the environment would replace the ones in .cargo/config.toml, and with them SIMD.
    command.env_remove("RUSTFLAGS").env_remove("CARGO_ENCODED_RUSTFLAGS");
    run(&format!("{} to WebAssembly", module.name), &mut command)
}

/// Copies the page into the folder and joins its scripts; WebAssembly and bindings stay what they are.
pub fn scripts() -> Result<PathBuf> {
    let (www, dist) = (root().join("www"), dist());
    copy_folder(&www, &dist)?;
    // Modules of a build before this one.
    let parts = dist.join(PARTS);
    if parts.is_dir() {
        fs::remove_dir_all(&parts).with_context(|| format!("cannot remove {}", parts.display()))?;
    }
    for Script { name, text } in bundle(&www, PLAYER)? {
        if name != PLAYER && name != LATER {
            bail!("{name} is neither {PLAYER} nor {LATER}: www/package.json and the page's weight do not know it");
        }
        let path = dist.join(name);
        fs::write(&path, text).with_context(|| format!("cannot write {}", path.display()))?;
    }
    Ok(dist)
}

/// The folder that the page is built into.
pub fn dist() -> PathBuf {
    root().join("dist")
}

/// Writes the WebAssembly that browsers load and its bindings.
fn bind(wasm: &Path, package: &Path, name: &str) -> Result<()> {
    let mut output = Bindgen::new()
        .input_path(wasm)
        .web(true)?
        .typescript(true)
        .remove_name_section(true)
        .remove_producers_section(true)
        .generate_output()?;
    let script = output.js().to_owned();
    let names = output.wasm_mut().imports.iter_mut().map(|import| &mut import.name);
    let script = shorten(names, &strip(&script));
    output.emit(package)?;
    let bindings = package.join(format!("{name}.js"));
    fs::write(&bindings, script).with_context(|| format!("cannot write {}", bindings.display()))
}

/// Adds the WebAssembly target to the toolchain where it is missing.
fn add_wasm_target() -> Result<()> {
    let sysroot = Command::new("rustc").args(["--print", "sysroot"]).current_dir(root()).output();
    let sysroot = sysroot.context("cannot run rustc; install Rust with rustup")?;
    let sysroot = PathBuf::from(String::from_utf8_lossy(&sysroot.stdout).trim());
    if sysroot.join("lib/rustlib").join(TARGET).join("lib").is_dir() {
        return Ok(());
    }
    if succeeds("rustup", &["target", "add", TARGET]) {
        return Ok(());
    }
    bail!("the WebAssembly target is missing; add it with: rustup target add {TARGET}")
}

fn copy_folder(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from).with_context(|| format!("cannot read {}", from.display()))? {
        let entry = entry?;
        let (source, destination) = (entry.path(), to.join(entry.file_name()));
        if source.file_name().is_some_and(|name| name == PARTS) {
            continue;
        } else if source.is_dir() {
            copy_folder(&source, &destination)?;
        } else if source.extension().is_some_and(|extension| extension == "js") {
            strip_file(&source, &destination)?;
        } else {
            fs::copy(&source, &destination).with_context(|| format!("cannot copy {}", source.display()))?;
        }
    }
    Ok(())
}

/// Writes a script without its comments.
fn strip_file(from: &Path, to: &Path) -> Result<()> {
    let source = fs::read_to_string(from).with_context(|| format!("cannot read {}", from.display()))?;
    fs::write(to, strip(&source)).with_context(|| format!("cannot write {}", to.display()))
}
