//! A closed body for the tests of glTF files, in poses that all differ.
#![allow(dead_code, reason = "each test binary uses its own part")]

use std::f32::consts::TAU;
use std::path::Path;

use capture_io::import::{ImportOptions, Imported};
use glam::Vec3;
use serde_json::{Value, json};

use super::import_support::{Gltf, read, refusal, write_bytes};

/// Rings of the body, and vertices of each.
const RINGS: usize = 4;
const SIDES: usize = 6;

/// A spindle of 1.7 m that stands on the origin, all triangles outwards.
pub fn body() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut positions = vec![Vec3::ZERO];
    for ring in 1..=RINGS {
        let part = ring as f32 / (RINGS + 1) as f32;
        let radius = 0.25 * (part * TAU / 2.0).sin();
        positions.extend((0..SIDES).map(|side| {
            let angle = TAU * side as f32 / SIDES as f32;
            Vec3::new(1.3 * radius * angle.cos(), 1.7 * part, radius * angle.sin())
        }));
    }
    positions.push(Vec3::new(0.0, 1.7, 0.0));
    let top = positions.len() as u32 - 1;
    let at = |ring: usize, side: usize| (1 + ring * SIDES + side % SIDES) as u32;
    let mut triangles = Vec::new();
    for side in 0..SIDES {
        triangles.push([0, at(0, side), at(0, side + 1)]);
        for ring in 0..RINGS - 1 {
            let [a, b, c, d] = [at(ring, side), at(ring, side + 1), at(ring + 1, side + 1), at(ring + 1, side)];
            triangles.extend([[a, d, c], [a, c, b]]);
        }
        triangles.push([top, at(RINGS - 1, side + 1), at(RINGS - 1, side)]);
    }
    assert!(volume(&positions, &triangles) > 0.05);
    (positions, triangles)
}

/// The body at pose `t`: bent, and a step aside.
pub fn moved(t: f32) -> Vec<Vec3> {
    let bent = |p: &Vec3| {
        let angle = 0.35 * (TAU * t / 24.0).sin() * p.y;
        Vec3::new(
            angle.cos() * p.x - 0.3 * angle.sin() * p.y,
            p.y,
            p.z + 0.03 * t + 0.05 * p.y * (TAU * t / 24.0).cos(),
        )
    };
    body().0.iter().map(bent).collect()
}

/// Texture coordinates of the body within `low..=high` along u.
pub fn uvs(low: f32, high: f32) -> Vec<[f32; 2]> {
    let around = |p: &Vec3| p.z.atan2(p.x) / TAU + 0.5;
    body().0.iter().map(|p| [low + (high - low) * around(p), p.y / 1.7]).collect()
}

/// Signed volume of a closed mesh: positive where the triangles face outwards.
pub fn volume(pose: &[Vec3], triangles: &[[u32; 3]]) -> f32 {
    let corner = |v: u32| pose[v as usize];
    triangles.iter().map(|&[a, b, c]| corner(a).cross(corner(b)).dot(corner(c))).sum::<f32>() / 6.0
}

/// Appends a mesh of `positions` over the body's triangles; its index.
pub fn mesh(file: &mut Gltf, positions: &[Vec3], triangles: &[[u32; 3]]) -> usize {
    let flat: Vec<f32> = positions.iter().flat_map(|p| p.to_array()).collect();
    let positions = file.floats("VEC3", &flat);
    let bytes: Vec<u8> = triangles.as_flattened().iter().flat_map(|&v| (v as u16).to_le_bytes()).collect();
    let view = file.view(&bytes);
    let count = 3 * triangles.len();
    let indices =
        file.push("accessors", json!({"bufferView": view, "componentType": 5123, "count": count, "type": "SCALAR"}));
    file.push("meshes", json!({"primitives": [{"attributes": {"POSITION": positions}, "indices": indices}]}))
}

/// A file whose node 0 draws the body.
pub fn standing() -> Gltf {
    let mut file = Gltf::new();
    let (positions, triangles) = body();
    mesh(&mut file, &positions, &triangles);
    file.scene_node(json!({"mesh": 0}));
    file
}

/// A channel: node, path, interpolation, times, values, and how many numbers a value has.
pub struct Moves<'a>(pub Value, pub &'a str, pub &'a [f32], pub Vec<f32>);

/// Appends a clip of several channels, each with its target.
pub fn clip(file: &mut Gltf, name: &str, channels: Vec<Moves<'_>>) {
    let (mut samplers, mut targets) = (Vec::new(), Vec::new());
    for (k, Moves(target, interpolation, times, values)) in channels.into_iter().enumerate() {
        let kind = match target["path"].as_str().unwrap() {
            "rotation" => "VEC4",
            "translation" | "scale" => "VEC3",
            "pointer" if values.len() == 4 * times.len() => "VEC4",
            "pointer" if values.len() == 3 * times.len() => "VEC3",
            _ => "SCALAR",
        };
        let (input, output) = (file.floats("SCALAR", times), file.floats(kind, &values));
        samplers.push(json!({"input": input, "output": output, "interpolation": interpolation}));
        targets.push(json!({"sampler": k, "target": target}));
    }
    file.push("animations", json!({"name": name, "samplers": samplers, "channels": targets}));
}

/// Reads the file at `fps`.
pub fn read_glb(file: &Gltf, fps: f32) -> Imported {
    let folder = tempfile::tempdir().unwrap();
    write_bytes(folder.path(), "a.glb", &file.glb());
    read(folder.path(), &["a.glb"], &ImportOptions { fps: Some(fps), ..ImportOptions::default() })
}

/// The code and the message with which the file is refused.
pub fn refuse_glb(file: &Gltf) -> (&'static str, String) {
    let folder = tempfile::tempdir().unwrap();
    write_bytes(folder.path(), "a.glb", &file.glb());
    refusal(folder.path(), &["a.glb"])
}

/// Reads a file of `tests/data/gltf`.
pub fn read_sample(name: &str) -> Imported {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/gltf"));
    read(folder, &[name], &ImportOptions { fps: Some(24.0), ..ImportOptions::default() })
}

/// The sentence with `code`, which there must be once.
#[track_caller]
pub fn warning<'a>(imported: &'a Imported, code: &str) -> &'a str {
    let mut found = imported.warnings.iter().filter(|warning| warning.code == code);
    let first = found.next().unwrap_or_else(|| panic!("no {code} in {:?}", imported.warnings));
    assert!(found.next().is_none(), "{code} twice in {:?}", imported.warnings);
    first
}

/// Checks that frame `frame` is `expected`, file vertex by file vertex.
#[track_caller]
pub fn assert_pose(imported: &Imported, frame: u32, expected: &[Vec3]) {
    let (pose, of_file) = (imported.capture.poses.frame(frame), &imported.capture.vertex_of_file_vertex);
    assert_eq!(of_file.len(), expected.len(), "vertices");
    for (v, (&welded, expected)) in of_file.iter().zip(expected).enumerate() {
        let found = pose[welded as usize];
        assert!(found.distance(*expected) < 1e-5, "frame {frame}, vertex {v}: {found}, not {expected}");
    }
}
