//! `builder inspect`.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use actor::timeline::Timeline;
use anyhow::{Context, anyhow};
use bundle::{BundleReader, MAGIC};
use capture_io::import::{ImportError, import};
use job::Job;
#[cfg(feature = "complete")]
use reprise::look::{is_scan, look};
use reprise::pack::{PackOptions, summary_of};
use reprise::preflight::preflight;
#[cfg(feature = "complete")]
use reprise::scans::ScanOptions;
use serde_json::{Value, json};

use super::args::InspectArguments;
use super::failure::Failure;
use super::output::{print_json, print_text};
use super::pack::import_options;
use super::terminal::Terminal;

/// Tells what a bundle or an input holds.
pub fn run(arguments: &InspectArguments, terminal: &Terminal) -> Result<(), Failure> {
    let mut refusal = None;
    let found = match arguments.inputs.as_slice() {
        [path] if is_bundle(Path::new(path)) => inspect_bundle(Path::new(path))?,
        inputs => {
            let mut options = PackOptions::default();
            options.import = import_options(&arguments.import);
            let report = |step| terminal.progress(step);
            let job = Job::new(&report);
            let imported = match import(inputs, &options.import, &job) {
                #[cfg(feature = "complete")]
                Err(error) if is_scan(&error) => return inspect_scan(arguments, options, &job),
                imported => imported.map_err(|error| match error {
                    ImportError::Stopped(_) => Failure::StoppedReading,
                    error => Failure::Input(error.into()),
                })?,
            };
            let found = preflight(&imported, &options, &job);
            refusal = found.refusal;
            let warnings: Vec<_> = imported.warnings.iter().chain(&found.warnings).collect();
            let capture = &imported.capture;
            json!({
                "kind": "input",
                "name": capture.name,
                "capture": summary_of(capture),
                "sequences": sequences(&capture.timeline),
                // Metres that were taken off all positions.
                "offset": imported.offset.to_array(),
                "materials": capture.surface.materials.iter().map(|m| m.name.as_str()).collect::<Vec<_>>(),
                "images": capture.surface.images.iter().map(|i| json!({
                    "media_type": i.format.media_type(), "width": i.width, "height": i.height, "bytes": i.bytes.len(),
                })).collect::<Vec<_>>(),
                "warnings": warnings,
            })
        }
    };
    if arguments.json { print_json(&found) } else { print_text(text(&found).trim_end()) }?;
    // What it holds is told all the same, but it cannot be packed.
    refusal.map_or(Ok(()), |error| Err(Failure::Input(error.into())))
}

/// Tells of frames that have meshes of their own.
#[cfg(feature = "complete")]
fn inspect_scan(arguments: &InspectArguments, options: PackOptions, job: &Job) -> Result<(), Failure> {
    let mut scan = ScanOptions::default();
    scan.import = options.import;
    let found = look(&arguments.inputs, &scan, job).map_err(|error| match error {
        error if error.is_stopped() => Failure::StoppedReading,
        error => Failure::Input(error.into()),
    })?;
    let sequences = found.sequences.iter().map(|(name, frames)| json!({ "name": name, "frames": frames }));
    let found = json!({
        "kind": "scan",
        "name": found.name,
        "fps": found.fps,
        "frames": found.frames,
        "meshes": found.meshes,
        "sequences": sequences.collect::<Vec<_>>(),
        // The frame whose mesh the others would get, and its area in square metres.
        "template": found.template,
        "area": found.area,
        "lost": found.lost,
        "warnings": found.warnings,
    });
    if arguments.json { print_json(&found) } else { print_text(text(&found).trim_end()) }
}

/// Whether a file begins as a bundle does.
pub fn is_bundle(path: &Path) -> bool {
    let mut start = [0; MAGIC.len()];
    let is_file = path.is_file();
    is_file && File::open(path).and_then(|mut file| file.read_exact(&mut start)).is_ok_and(|()| start == MAGIC)
}

fn inspect_bundle(path: &Path) -> Result<Value, Failure> {
    let bytes =
        std::fs::read(path).with_context(|| format!("cannot read {}", path.display())).map_err(Failure::Input)?;
    let reader =
        BundleReader::from_bytes(&bytes).with_context(|| path.display().to_string()).map_err(Failure::Input)?;
    let (Some(meta), Some(timeline), Some(topology)) = (reader.meta(), reader.timeline(), reader.topology()) else {
        return Err(Failure::Input(anyhow!("{} ends before its content is described", path.display())));
    };
    let sections_of = |start: &str| -> u64 {
        reader.sections().iter().filter(|section| section.name.starts_with(start)).map(|section| section.stored).sum()
    };
    let place = reader.file_place();
    let sections: Vec<Value> = reader
        .sections()
        .iter()
        .map(|s| json!({ "name": s.name, "ordinal": s.ordinal, "offset": s.offset, "stored": s.stored, "raw": s.raw }))
        .collect();
    Ok(json!({
        "kind": "bundle",
        "name": meta.name,
        "generator": meta.generator,
        "bytes": bytes.len(),
        "capture": {
            "frames": timeline.frame_count(),
            "sequences": timeline.sequences().len(),
            "vertices": topology.vertex_count(),
            "triangles": topology.triangles().len(),
            "components": topology.component_count(),
            "fps": timeline.fps(),
        },
        // What exports write: the files' vertices, at their place, in their unit and axes.
        "files": {
            "vertices": reader.file_vertices().map_or(topology.vertex_count(), <[u32]>::len),
            "metres_per_unit": place.unit,
            "up": if place.z_up { "z" } else { "y" },
        },
        // Metres that were taken off all positions.
        "offset": place.offset.to_array(),
        "sequences": sequences(timeline),
        "graph": reader.graph().map(|graph| json!({
            "transitions": graph.transitions().len(),
            "density": graph.density(timeline),
            "alpha": graph.alpha(),
        })),
        "max_error": meta.max_error,
        "appearance": reader.appearance().map(|appearance| json!({
            "material": appearance.material,
            "width": appearance.size[0],
            "height": appearance.size[1],
            "texture_modes": appearance.layers[0].mode_count(),
            "warp_modes": appearance.layers[1].mode_count(),
            "bytes_per_frame": sections_of("appearance") as f64 / f64::from(timeline.frame_count().max(1)),
        })),
        // Frames that are shown as they were scanned.
        "scanned": reader.scanned().map(|scanned| json!({
            "frames": scanned.frame_count(),
            "groups": scanned.groups.len(),
            "bytes": sections_of("scanned"),
            "bytes_per_frame": sections_of("scanned") as f64 / f64::from(scanned.frame_count().max(1)),
        })),
        "sections": sections,
    }))
}

fn sequences(timeline: &Timeline) -> Vec<Value> {
    let fps = timeline.fps();
    timeline
        .sequences()
        .iter()
        .map(|s| {
            json!({
                "name": s.name, "labels": s.labels, "first_frame": s.first_frame, "frames": s.frame_count,
                "seconds": f64::from(s.frame_count) / f64::from(fps), "cyclic": s.cyclic,
            })
        })
        .collect()
}

/// The same as indented text: one key a line.
fn text(value: &Value) -> String {
    let mut out = String::new();
    write(value, 0, &mut out);
    out
}

fn write(value: &Value, depth: usize, out: &mut String) {
    let indent = "  ".repeat(depth);
    match value {
        Value::Object(fields) => {
            for (name, field) in fields {
                if is_flat(field) {
                    out.push_str(&format!("{indent}{name}: {}\n", inline(field)));
                } else {
                    out.push_str(&format!("{indent}{name}:\n"));
                    write(field, depth + 1, out);
                }
            }
        }
        Value::Array(items) => {
            for item in items {
                out.push_str(&format!("{indent}- {}\n", inline(item)));
            }
        }
        other => out.push_str(&format!("{indent}{}\n", inline(other))),
    }
}

fn is_flat(value: &Value) -> bool {
    match value {
        Value::Object(_) => false,
        Value::Array(items) => items.iter().all(|item| !item.is_object()),
        _ => true,
    }
}

fn inline(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Array(items) => items.iter().map(inline).collect::<Vec<_>>().join(", "),
        Value::Object(fields) => {
            let pairs = fields.iter().map(|(name, field)| format!("{name} {}", inline(field)));
            pairs.collect::<Vec<_>>().join("  ")
        }
        other => other.to_string(),
    }
}
