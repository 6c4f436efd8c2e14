//! What the page's code weighs, as a browser fetches it.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail};
use miniz_oxide::deflate::compress_to_vec;

use crate::web::{is_keys, is_later};

/// What a page may fetch at most before anybody takes a tool: WebAssembly and JavaScript, gzipped, in bytes. It is below
/// [`MARK`], so that what is new shows here first.
const LIMIT: usize = 298_000;
/// The same with the script of the tools and the modules that search, edit, drive and read scanned frames.
const LIMIT_WITH_TOOLS: usize = 825_000;

/// What the page of key poses may weigh, which fetches the player as well.
const LIMIT_OF_KEYS: usize = 25_000;

/// What they should weigh.
pub const MARK: usize = 300_000;

/// Bytes of code, gzipped.
pub struct Weight {
    /// What every page fetches.
    pub at_once: usize,
    /// What a page fetches when the first tool is needed.
    pub later: usize,
    /// What the page of key poses fetches besides.
    pub keys: usize,
}

/// Adds up all code in `dist` as gzip -9 would pack it, prints it and refuses more than the limits.
pub fn check(dist: &Path) -> Result<()> {
    let Weight { at_once, later, keys } = weigh(dist)?;
    let all = at_once + later;
    println!(
        "wasm + JavaScript: {:.1} KB gzip (mark {} KB, stretch 200 KB), {:.1} KB with tools, search, edits and motion capture; \
         page of key poses: {:.1} KB",
        at_once as f32 / 1e3,
        MARK / 1000,
        all as f32 / 1e3,
        keys as f32 / 1e3
    );
    if at_once > LIMIT || all > LIMIT_WITH_TOOLS {
        bail!("the page's code is over its limit of {LIMIT} bytes, or of {LIMIT_WITH_TOOLS} with the tools");
    }
    if keys > LIMIT_OF_KEYS {
        bail!("the code of the page of key poses is over its limit of {LIMIT_OF_KEYS} bytes");
    }
    Ok(())
}

/// Bytes of all code in `dist`, gzipped; prints every file.
pub fn weigh(dist: &Path) -> Result<Weight> {
    let mut weight = Weight { at_once: 0, later: 0, keys: 0 };
    for file in code_files(dist)? {
        let bytes = fs::read(&file).with_context(|| format!("cannot read {}", file.display()))?;
        // gzip adds a header and a trailer of 18 bytes to the deflate stream.
        let packed = compress_to_vec(&bytes, 9).len() + 18;
        let name = file.strip_prefix(dist).unwrap_or(&file);
        println!("{:>9} B {packed:>9} B gzip  {}", bytes.len(), name.display());
        if is_keys(name) {
            weight.keys += packed;
        } else if is_later(name) {
            weight.later += packed;
        } else {
            weight.at_once += packed;
        }
    }
    Ok(weight)
}

fn code_files(folder: &Path) -> Result<Vec<std::path::PathBuf>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).with_context(|| format!("cannot read {}", folder.display()))? {
        let path = entry?.path();
        if path.is_dir() {
            files.extend(code_files(&path)?);
        } else if path.extension().is_some_and(|extension| extension == "js" || extension == "wasm") {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}
