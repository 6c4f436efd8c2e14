//! Writes walks, synthesised natively, for the browser tests to compare theirs with.
//!
//! `native_walk BUNDLE FOLDER`: `walks.json` lists them as objects with `from`, `to`, `transitions` and `file`; a file
//! holds three little-endian 32-bit floats per vertex, vertex after vertex, frame after frame. `edited.json` is the same for edits
//! (`document`): some of the `frames` that they reach, and a walk that passes them. `driven.json` is a clip (`clip.bvh`) that the actor
//! performs, where it has the bones of a human: some of its `frames`, as they are driven and as they are where the actor goes into it `from` a
//! frame (`aimed`).

use std::fs;
use std::path::Path;

use actor::pose_source::PoseSource;
use anyhow::{Context, Result, bail};
use bundle::BundleReader;
use editing::{EditDocument, EditedPoses, Editor};
use glam::Vec3;
use kernels::align::Placement;
use search::cheapest_walk;
use serde_json::json;
use synthesis::Synthesiser;

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
    write(&folder.join("walks.json"), json!(walks).to_string().as_bytes())?;
    if let Some(&(from, to, _)) = choose(&bytes)?.first() {
        edited(&bytes, (from, to), folder)?;
    }
    driven(&bytes, folder)
}

/// The frame from which the actor goes into the clip whose ends are edited.
const FROM: u32 = 20;

/// Every fifth frame of what the actor does where a stick figure squats: as it is driven, and with its ends edited towards the recording.
fn driven(bundle: &[u8], folder: &Path) -> Result<()> {
    let clip = fixtures::squat();
    write(&folder.join("clip.bvh"), clip.as_bytes())?;
    let Some(driven) = tests::drive(bundle, &clip)? else { return Ok(()) };
    let frames: Vec<usize> = (0..driven.poses.len()).step_by(5).collect();
    let floats = frames.iter().flat_map(|&frame| &driven.poses[frame]).flat_map(|point| point.to_array());
    write(&folder.join("driven.f32"), &floats.flat_map(f32::to_le_bytes).collect::<Vec<_>>())?;
    let aimed = tests::aimed(bundle, &clip, FROM)?;
    let floats = frames.iter().flat_map(|&frame| &aimed[frame]).flat_map(|point| point.to_array());
    write(&folder.join("aimed.f32"), &floats.flat_map(f32::to_le_bytes).collect::<Vec<_>>())?;
    let about = json!({
        "count": driven.poses.len(), "frames": frames, "like": driven.nearest, "file": "driven.f32",
        "from": FROM, "aimed": "aimed.f32",
    });
    write(&folder.join("driven.json"), about.to_string().as_bytes())
}

/// Three edits around the beginning of a walk, and what becomes of it.
fn edited(bundle: &[u8], (from, to): (u32, u32), folder: &Path) -> Result<()> {
    let mut reader = BundleReader::from_bytes(bundle)?;
    let (Some(timeline), Some(graph), Some(topology), order) = (
        reader.timeline().cloned(),
        reader.graph().cloned(),
        reader.topology().cloned(),
        reader.order().map(<[u32]>::to_vec),
    ) else {
        bail!("the bundle is not complete")
    };
    let sequence = timeline.sequence_of(from).context("the walk begins nowhere")?;
    let local = from - sequence.first_frame;
    let mut pose = vec![Vec3::ZERO; topology.vertex_count()];
    reader.read(from, &mut pose)?;
    let farthest = |axis: Vec3| {
        let along = |vertex: &usize| pose[*vertex].dot(axis);
        (0..pose.len()).max_by(|a, b| along(a).total_cmp(&along(b))).unwrap_or_default()
    };
    let edit = |frame: u32, axis: Vec3, by: Vec3| {
        let vertex = farthest(axis);
        let to = (pose[vertex] + by).to_array();
        json!({ "sequence": sequence.name, "frame": frame, "handles": [{ "vertex": vertex, "to": to }] })
    };
    let mut document = json!({ "version": 1, "edits": [
        edit(local, Vec3::X, Vec3::new(0.05, 0.12, 0.04)),
        edit(local, Vec3::Y, Vec3::new(0.05, -0.08, 0.0)),
        edit(local, Vec3::NEG_X, Vec3::new(-0.03, 0.05, 0.02)),
    ]});
    document["edits"][1]["propagate"] = json!("constraint");
    document["edits"][2]["scope"] = json!({ "radius": 0.2 });
    let rest = reader.rig()?;
    let rig = match rest {
        Some(stored) => {
            let mut rest = vec![Vec3::ZERO; topology.vertex_count()];
            reader.read(stored.rest_frame, &mut rest)?;
            Some(stored.rig(rest)?)
        }
        None => None,
    };
    let editor = Editor::new(&topology, order.as_deref(), rig)?;
    let edits = EditDocument::from_json(&document.to_string())?;
    let mut poses = EditedPoses::new(&mut reader, (&timeline, graph.feet()), topology.weights(), editor, edits)?;
    let frames: Vec<u32> = (-6..=6).filter_map(|steps| timeline.offset(from, 3 * steps)).collect();
    let mut floats = Vec::new();
    for &frame in &frames {
        poses.read(frame, &mut pose)?;
        floats.extend(pose.iter().flat_map(|point| point.to_array()));
    }
    let walk = cheapest_walk(&graph, &timeline, from, to).context("the walk is gone")?;
    let mut synthesiser = Synthesiser::new(&topology, order.as_deref())?;
    synthesiser.begin_walk(&graph, &timeline, (from, Placement::IDENTITY), &walk)?;
    while synthesiser.next_frame(&graph, &timeline, &mut poses, &mut pose)?.is_some() {
        floats.extend(pose.iter().flat_map(|point| point.to_array()));
    }
    write(&folder.join("edited.f32"), &floats.into_iter().flat_map(f32::to_le_bytes).collect::<Vec<_>>())?;
    let about = json!({ "document": document, "frames": frames, "from": from, "to": to, "file": "edited.f32" });
    write(&folder.join("edited.json"), about.to_string().as_bytes())
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
