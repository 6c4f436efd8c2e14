//! Writes walks, synthesised natively, for the browser tests to compare theirs with.
//!
//! `native_walk BUNDLE FOLDER`: `walks.json` lists them as objects with `from`, `to`, `transitions` and `file`; a file
//! holds three little-endian 32-bit floats per vertex, vertex after vertex, frame after frame.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail};
use bundle::BundleReader;
use search::cheapest_walk;
use serde_json::json;

/// Walks written.
const WALKS: usize = 4;

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [bundle, folder] = arguments.as_slice() else { bail!("usage: native_walk BUNDLE FOLDER") };
    let bytes = fs::read(bundle).with_context(|| format!("cannot read {bundle}"))?;
    let folder = Path::new(folder);
    fs::create_dir_all(folder).with_context(|| format!("cannot create {}", folder.display()))?;
    let mut walks = Vec::new();
    for (from, to, transitions) in choose(&bytes)? {
        let file = format!("{from}-{to}.f32");
        let frames = tests::synthesise(&bytes, from, to)?;
        let floats = frames.iter().flatten().flat_map(|point| point.to_array());
        write(&folder.join(&file), &floats.flat_map(f32::to_le_bytes).collect::<Vec<_>>())?;
        walks.push(json!({ "from": from, "to": to, "transitions": transitions, "file": file }));
    }
    write(&folder.join("walks.json"), json!(walks).to_string().as_bytes())
}

/// Walks between the quarters of sequences, each to another frame: those with most transitions.
fn choose(bundle: &[u8]) -> Result<Vec<(u32, u32, usize)>> {
    let reader = BundleReader::from_bytes(bundle)?;
    let (Some(timeline), Some(graph)) = (reader.timeline(), reader.graph()) else {
        bail!("the bundle is not complete")
    };
    let sequences = timeline.sequences().iter();
    let frames: Vec<u32> =
        sequences.flat_map(|s| [1, 2, 3].map(|quarter| s.first_frame + s.frame_count * quarter / 4)).collect();
    let pairs = frames.iter().flat_map(|&from| frames.iter().map(move |&to| (from, to)));
    let walks = pairs.filter_map(|(from, to)| {
        let walk = cheapest_walk(graph, timeline, from, to)?;
        Some((from, to, walk.transition_count()))
    });
    let mut walks: Vec<_> = walks.collect();
    walks.sort_by_key(|&(from, to, transitions)| (std::cmp::Reverse(transitions), from, to));
    let mut chosen: Vec<(u32, u32, usize)> = Vec::new();
    for walk in walks {
        if chosen.len() < WALKS && chosen.iter().all(|other| other.1 != walk.1) {
            chosen.push(walk);
        }
    }
    Ok(chosen)
}

fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    fs::write(path, bytes).with_context(|| format!("cannot write {}", path.display()))
}
