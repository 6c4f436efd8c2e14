//! Writes the frames of a walk, synthesised natively, for the browser tests to compare theirs with.
//!
//! `native_walk BUNDLE FROM TO OUT`: three little-endian 32-bit floats per vertex, vertex after vertex, frame after frame.

use std::fs;

use anyhow::{Context, Result, bail};

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [bundle, from, to, out] = arguments.as_slice() else { bail!("usage: native_walk BUNDLE FROM TO OUT") };
    let bytes = fs::read(bundle).with_context(|| format!("cannot read {bundle}"))?;
    let frames = tests::synthesise(&bytes, from.parse()?, to.parse()?)?;
    let floats = frames.iter().flatten().flat_map(|point| point.to_array());
    let written: Vec<u8> = floats.flat_map(f32::to_le_bytes).collect();
    fs::write(out, written).with_context(|| format!("cannot write {out}"))
}
