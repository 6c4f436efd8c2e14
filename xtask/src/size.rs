//! What the page's code weighs, as a browser fetches it.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail};
use miniz_oxide::deflate::compress_to_vec;

/// What WebAssembly and JavaScript may weigh together at most, gzipped, in bytes. The mark is [`MARK`]: directing and
/// appearance brought more than that leaves room for.
const LIMIT: usize = 333_500;

/// What they should weigh.
pub const MARK: usize = 300_000;

/// Adds up all code in `dist` as gzip -9 would pack it, prints it and refuses more than the limit.
pub fn check(dist: &Path) -> Result<()> {
    let total = weigh(dist)?;
    println!("wasm + JavaScript: {:.1} KB gzip (mark {} KB, stretch 200 KB)", total as f32 / 1e3, MARK / 1000);
    if total > LIMIT {
        bail!("the page's code is over its limit of {} KB", LIMIT / 1000);
    }
    Ok(())
}

/// Bytes of all code in `dist`, gzipped; prints every file.
pub fn weigh(dist: &Path) -> Result<usize> {
    let mut total = 0;
    for file in code_files(dist)? {
        let bytes = fs::read(&file).with_context(|| format!("cannot read {}", file.display()))?;
        // gzip adds a header and a trailer of 18 bytes to the deflate stream.
        let packed = compress_to_vec(&bytes, 9).len() + 18;
        println!("{:>9} B {packed:>9} B gzip  {}", bytes.len(), file.strip_prefix(dist).unwrap_or(&file).display());
        total += packed;
    }
    Ok(total)
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
