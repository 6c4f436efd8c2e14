//! The manifest of a capture of nothing but new sequences, with all that is true of the target's files: name, unit, axes, painted parts,
//! weights. The frames that are written are in the same coordinates, and have the same vertices.

use std::fmt::Display;
use std::path::Path;

use anyhow::Result;
use capture_io::export::Actor;
use kernels::topology::barycentric_areas;
use toml::{Table, Value};

use super::drive_actor::ReadActor;
use super::drive_capture::{NewSequence, described_sequence};
use super::output::write_whole;

/// Weights that differ from areas by more than this share of the largest one were given.
const GIVEN: f32 = 1e-3;

/// The manifest of `new` sequences at `fps` frames a second; what it names of single vertices is written beside it.
pub fn manifest(
    folder: &Path,
    (target, exported): (&ReadActor, &Actor),
    fps: f32,
    new: &[NewSequence],
) -> Result<String> {
    let mut table = Table::new();
    table.insert("name".into(), exported.name.clone().into());
    table.insert("fps".into(), Value::Float(fps.into()));
    let place = exported.place();
    if place.unit != 1.0 {
        table.insert("unit".into(), Value::Float(place.unit));
    }
    if place.z_up {
        table.insert("up".into(), "z".into());
    }
    let vertices = exported.file_vertices();
    if let Some(parts) = &target.parts {
        numbers(&folder.join("parts.txt"), vertices.iter().map(|&vertex| parts[vertex as usize]))?;
        table.insert("parts".into(), "parts.txt".into());
    }
    if let Some(weights) = given_weights(target) {
        numbers(&folder.join("weights.txt"), vertices.iter().map(|&vertex| weights[vertex as usize]))?;
        table.insert("weights".into(), "weights.txt".into());
    }
    let sequences: Result<Vec<Value>> =
        new.iter().map(|new| described_sequence(folder, new).map(Value::Table)).collect();
    table.insert("sequence".into(), Value::Array(sequences?));
    Ok(toml::to_string(&table)?)
}

/// The weights of vertices, where they are not the areas about them.
fn given_weights(target: &ReadActor) -> Option<&[f32]> {
    let weights = target.topology.weights();
    let areas = barycentric_areas(target.topology.triangles(), target.poses.frame(0));
    let most = areas.iter().copied().fold(0.0, f32::max);
    let differ = weights.iter().zip(&areas).any(|(weight, area)| (weight - area).abs() > GIVEN * most);
    differ.then_some(weights)
}

/// Writes a number a line.
fn numbers<T: Display>(path: &Path, numbers: impl Iterator<Item = T>) -> Result<()> {
    let text: String = numbers.map(|number| format!("{number}\n")).collect();
    write_whole(path, text.as_bytes())
}
