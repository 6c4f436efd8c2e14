//! Every input of `../shared/data/cases` through `inspect`, `validate`, `pack` and `direct`, as a new user would type it: all say
//! the same, and what comes out is what went in.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use capture_io::import::{Cyclic, ImportOptions, Imported, import};
use fixtures::data;
use job::Job;
use serde_json::Value;

/// What is right for an input.
struct Row {
    /// The input, within the folder of all cases.
    input: &'static str,
    /// Frames a second.
    fps: u32,
    /// Frames of each sequence; none where the input is refused.
    frames: &'static [u32],
    /// Codes of the warnings in alphabetical order, or that of the refusal.
    codes: &'static [&'static str],
}

const fn row(input: &'static str, fps: u32, frames: &'static [u32], codes: &'static [&'static str]) -> Row {
    Row { input, fps, frames, codes }
}

const ROWS: &[Row] = &[
    row("00-control", 24, &[24], &["W_CYCLIC"]),
    row("01-comment-backslash/a-before-v", 24, &[24], &["W_CYCLIC"]),
    row("01-comment-backslash/b-before-mtllib", 24, &[24], &["W_CYCLIC"]),
    row("01-comment-backslash/c-loose-last-vertex", 24, &[24], &["W_CYCLIC", "W_LOOSE_VERTICES"]),
    row("01-comment-backslash/d-before-faces", 24, &[24], &["W_CYCLIC"]),
    row("01-comment-backslash/e-before-mtllib-two-images", 24, &[24], &["W_CYCLIC"]),
    row("02-bom/a-mtllib-first", 24, &[24], &["W_CYCLIC"]),
    row("02-bom/b-vertex-first", 24, &[24], &["W_CYCLIC"]),
    row("02-bom/c-vertex-first-loose-last", 24, &[24], &["W_CYCLIC", "W_LOOSE_VERTICES"]),
    row("02-bom/d-bom-in-mtl", 24, &[24], &["W_CYCLIC"]),
    row("03-vertex-rgba", 24, &[24], &["W_CYCLIC", "W_VERTEX_NUMBERS"]),
    row("03-vertex-rgba-rgb", 24, &[24], &["W_CYCLIC"]),
    row("03-vertex-rgba-rgb-brown-255", 24, &[24], &["W_COLOUR_RANGE", "W_CYCLIC"]),
    row("04-trailing-comments/f", 24, &[24], &["W_CYCLIC"]),
    row("04-trailing-comments/v", 24, &[24], &["W_CYCLIC"]),
    row("05-texture-per-frame/mtl-missing", 24, &[24], &["W_CYCLIC", "W_MATERIAL_MISSING", "W_TEXTURE_LOST"]),
    row("05-texture-per-frame/one-mtl", 24, &[24], &["W_CYCLIC"]),
    row("05-texture-per-frame/own-mtl", 24, &[24], &["W_CYCLIC"]),
    row("05-texture-per-frame/png-missing", 24, &[24], &["W_CYCLIC", "W_TEXTURE_LOST"]),
    row("05-texture-per-frame/usemtl-first", 24, &[24], &["W_CYCLIC"]),
    row("06-texture-gaps", 24, &[23], &["W_CYCLIC", "W_FRAMES_MISSING", "W_TEXTURES_UNUSED", "W_TEXTURE_LOST"]),
    row("07-negative-numbers", 24, &[24], &["W_CYCLIC"]),
    row("08-number-inside-windows", 24, &[24], &["W_CYCLIC"]),
    row("09-channel-without-node/no-node.glb", 24, &[24], &["W_GLTF_CHANNEL"]),
    row("09-channel-without-node/pointer.glb", 24, &[24], &["W_GLTF_CHANNEL"]),
    row("10-specular-glossiness/required.glb", 24, &[24], &[]),
    row("10-specular-glossiness/used.glb", 24, &[24], &[]),
    row("11-scale-flipbook/LINEAR.glb", 24, &[24], &["W_CYCLIC", "W_GLTF_FLIPBOOK"]),
    row("11-scale-flipbook/STEP.glb", 24, &[24], &["W_CYCLIC", "W_GLTF_FLIPBOOK"]),
    row("11-scale-flipbook/with-hat.glb", 24, &[24], &["W_GLTF_FLIPBOOK"]),
    row("12-two-named-parts/two.glb", 24, &[24, 24], &["W_CYCLIC_PERHAPS", "W_GLTF_CLIPS_APART"]),
    row("13-matrix-node-animated/matrix.glb", 24, &[24], &[]),
    row("14-step-keys-frame-1/accumulated-30.glb", 30, &[96], &[]),
    row("14-step-keys-frame-1/accumulated-60.glb", 60, &[96], &[]),
    row("14-step-keys-frame-1/morph-1001-24-LINEAR.glb", 24, &[48], &["W_CYCLIC"]),
    row("14-step-keys-frame-1/morph-1001-24-STEP.glb", 24, &[48], &["W_CYCLIC"]),
    row("14-step-keys-frame-1/morph-101-30-LINEAR.glb", 30, &[48], &["W_CYCLIC"]),
    row("14-step-keys-frame-1/morph-101-30-STEP.glb", 30, &[48], &["W_CYCLIC"]),
    row("14-step-keys-frame-1/morph-5-24-LINEAR.glb", 24, &[48], &["W_CYCLIC"]),
    row("14-step-keys-frame-1/morph-5-24-STEP.glb", 24, &[48], &["W_CYCLIC"]),
    row("14-step-keys-frame-1/morph-LINEAR.glb", 24, &[24], &["W_CYCLIC"]),
    row("14-step-keys-frame-1/morph-STEP.glb", 24, &[24], &["W_CYCLIC"]),
    row("14-step-keys-frame-1/step-24.glb", 24, &[96], &[]),
    row("14-step-keys-frame-1/step-25.glb", 25, &[96], &[]),
    row("14-step-keys-frame-1/step-30.glb", 30, &[96], &[]),
    row("14-step-keys-frame-1/step-60.glb", 60, &[96], &[]),
    row("15-glb-per-frame", 24, &[24], &["W_CYCLIC"]),
    row("15-glb-scenes-as-frames/walk.glb", 24, &[24], &["W_CYCLIC", "W_GLTF_SCENES"]),
    row("16-far-from-origin/1000", 24, &[24], &["W_CYCLIC", "W_RECENTRED"]),
    row("16-far-from-origin/10000", 24, &[24], &["W_CYCLIC", "W_RECENTRED"]),
    row("16-far-from-origin/100000", 24, &[24], &["W_CYCLIC", "W_RECENTRED"]),
    row("16-far-from-origin/200000", 24, &[24], &["W_CYCLIC", "W_RECENTRED"]),
    row("16-far-from-origin/50000", 24, &[24], &["W_CYCLIC", "W_RECENTRED"]),
    row("16-utm-obj", 24, &[24], &["W_CYCLIC", "W_RECENTRED"]),
    row("17-glb-null-padding/nul.glb", 24, &[24], &[]),
    row("17-glb-null-padding/space.glb", 24, &[24], &[]),
    row("18-data-uri/gltfbuffer.gltf", 24, &[24], &[]),
    row("18-data-uri/nopad.gltf", 24, &[24], &[]),
    row("18-data-uri/pad.gltf", 24, &[24], &[]),
    row("18-data-uri/wrapped.gltf", 24, &[24], &[]),
    row("19-ply-line-ends/blank-line-after-header", 24, &[24], &["W_CYCLIC"]),
    row("19-ply-line-ends/cr-ascii", 24, &[24], &["W_CYCLIC"]),
    row("19-ply-line-ends/cr-binary", 24, &[24], &["W_CYCLIC"]),
    row("19-ply-line-ends/cr-obj", 24, &[24], &["W_CYCLIC"]),
    row("19-ply-line-ends/crlf-ascii", 24, &[24], &["W_CYCLIC"]),
    row("19-ply-line-ends/crlf-binary", 24, &[24], &["W_CYCLIC"]),
    row("19-ply-line-ends/lf-ascii", 24, &[24], &["W_CYCLIC"]),
    row("19-ply-line-ends/lf-binary", 24, &[24], &["W_CYCLIC"]),
    row("20-ply-properties/face-colour", 24, &[24], &["W_CYCLIC", "W_FACE_COLOURS"]),
    row("20-ply-properties/face-first", 24, &[24], &["W_CYCLIC"]),
    row("20-ply-properties/scalar-first", 24, &[24], &["W_CYCLIC"]),
    row("20-ply-properties/ushort", 24, &[24], &["W_CYCLIC"]),
    row("20-ply-properties/vertex-list", 24, &[24], &["W_CYCLIC"]),
    row("21-empty-animation/camera.glb", 24, &[24], &["W_GLTF_CLIP_EMPTY"]),
    row("21-empty-animation/empty.glb", 24, &[24], &["W_GLTF_CLIP_EMPTY"]),
    row("21-empty-animation/missing.glb", 24, &[24], &["W_GLTF_CLIP_EMPTY"]),
    row("22-brackets/capture [final]", 24, &[24], &["W_CYCLIC"]),
    row("22-brackets/capture [final]/walk", 24, &[24], &["W_CYCLIC"]),
    row("23-absolute-map", 24, &[24], &["W_CYCLIC", "W_FILE_MOVED"]),
    row("24-mirrored-skin/mirror0-ibm0.glb", 24, &[24], &["W_CYCLIC"]),
    row("24-mirrored-skin/mirror1-ibm0.glb", 24, &[24], &["W_CYCLIC"]),
    row("24-mirrored-skin/mirror1-ibm1.glb", 24, &[24], &["W_CYCLIC"]),
    row("24-mirrored-skin/plain.glb", 24, &[24], &[]),
    row("25-clamp/clamp.glb", 24, &[24], &["W_GLTF_WRAP"]),
    row("26-emissive-only/emissive.glb", 24, &[24], &[]),
    row("27-images-beside/one-missing", 24, &[24], &["W_CYCLIC", "W_TEXTURE_LOST"]),
    row("27-images-beside/other-name", 24, &[24], &["W_CYCLIC", "W_TEXTURES_GUESSED"]),
    row("27-images-beside/other-padding", 24, &[24], &["W_CYCLIC"]),
    row("27-images-beside/same-stem", 24, &[24], &["W_CYCLIC"]),
    row("28-nan/big", 24, &[], &["E_NOT_FINITE"]),
    row("28-nan/comma", 24, &[], &["E_SYNTAX"]),
    row("28-nan/inf", 24, &[], &["E_NOT_FINITE"]),
    row("28-nan/msvc", 24, &[], &["E_SYNTAX"]),
    row("28-nan/nan", 24, &[], &["E_NOT_FINITE"]),
    row("28-nan/neg", 24, &[], &["E_SYNTAX"]),
    row("29-scale-from-zero/appear.glb", 24, &[], &["E_COLLAPSED"]),
    row("29-scale-from-zero/vanish.glb", 24, &[], &["E_COLLAPSED"]),
    row("30-names/Tänzerin 走る é", 24, &[24], &["W_CYCLIC"]),
    row("30-names-latin1", 24, &[24], &["W_CYCLIC"]),
];

fn builder(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_builder")).args(arguments).output().unwrap()
}

/// What one input gave.
#[derive(Debug, Default, PartialEq)]
struct Found {
    frames: Vec<u32>,
    codes: Vec<String>,
    /// What does not fit together.
    wrong: Vec<String>,
}

fn codes_of(list: &Value) -> Vec<String> {
    let mut codes: Vec<String> =
        list.as_array().into_iter().flatten().map(|entry| entry["code"].as_str().unwrap().to_owned()).collect();
    codes.sort();
    codes
}

/// The code and the sentence of a refusal that `validate` prints.
fn refusal(list: &Value) -> Option<(String, String)> {
    let errors = list.as_array().into_iter().flatten().filter(|entry| entry["severity"] == "error");
    let word = |entry: &Value, key: &str| entry[key].as_str().unwrap().to_owned();
    errors.map(|entry| (word(entry, "code"), word(entry, "message"))).next()
}

fn look(row: &Row, folder: &Path, scratch: &Path) -> Found {
    let mut found = Found::default();
    let input = folder.join(row.input).to_str().unwrap().to_owned();
    let fps = row.fps.to_string();
    let bundle = scratch.join("actor.reprise").to_str().unwrap().to_owned();
    let _ = fs::remove_file(&bundle);
    let inspected = builder(&["inspect", &input, "--fps", &fps, "--json"]);
    let validated = builder(&["validate", &input, "--fps", &fps, "--json"]);
    let packed = builder(&["pack", &input, "--fps", &fps, "-o", &bundle, "--json"]);
    let outputs = [("inspect", &inspected), ("validate", &validated), ("pack", &packed)];
    for (name, output) in outputs {
        if !matches!(output.status.code(), Some(0 | 1)) {
            found.wrong.push(format!("{name}: {:?}", output.status));
        }
    }
    let list: Value = serde_json::from_slice(&validated.stdout).unwrap_or_default();
    if let Some((code, message)) = refusal(&list) {
        found.codes = vec![code];
        // All three name the same place.
        for (name, output) in outputs {
            let said = String::from_utf8_lossy(&output.stderr);
            let head = message.split(':').next().unwrap();
            if output.status.code() != Some(1) || (name != "validate" && !said.contains(head)) {
                found.wrong.push(format!("{name} does not refuse it with {message:?}: {said}"));
            }
        }
        if Path::new(&bundle).exists() {
            found.wrong.push("a bundle was written".into());
        }
        return found;
    }
    let inspected: Value = serde_json::from_slice(&inspected.stdout).unwrap_or_default();
    let report: Value = serde_json::from_slice(&packed.stdout).unwrap_or_default();
    found.codes = codes_of(&list);
    let frames = inspected["sequences"].as_array().into_iter().flatten();
    found.frames = frames.map(|sequence| sequence["frames"].as_u64().unwrap() as u32).collect();
    for (name, codes) in [("inspect", codes_of(&inspected["warnings"])), ("pack", codes_of(&report["warnings"]))] {
        // What only the long stages find is said by pack alone.
        let same = codes.iter().filter(|code| *code != "W_UNREACHABLE");
        if !same.eq(found.codes.iter()) {
            found.wrong.push(format!("{name} says {codes:?}"));
        }
    }
    if packed.status.code() != Some(0) {
        found.wrong.push(String::from_utf8_lossy(&packed.stderr).into_owned());
        return found;
    }
    let options = ImportOptions { fps: Some(row.fps as f32), ..ImportOptions::default() };
    let wanted = import(&[input], &options, &Job::silent()).unwrap();
    let sequences: Vec<(String, u32, u32)> = wanted
        .capture
        .timeline
        .sequences()
        .iter()
        .map(|sequence| (sequence.name.clone(), sequence.first_frame, sequence.frame_count))
        .collect();
    let most = report["bundle"]["max_error"].as_f64().unwrap() as f32;
    for (k, (name, first, count)) in sequences.into_iter().enumerate() {
        let out = scratch.join(format!("out{k}"));
        let pattern = out.join("f_%04d.obj");
        let written = builder(&["direct", &bundle, "--sequence", &name, "-q", "-o", pattern.to_str().unwrap()]);
        if written.status.code() != Some(0) {
            found.wrong.push(format!("direct: {}", String::from_utf8_lossy(&written.stderr)));
            continue;
        }
        let read = import(
            &[out.to_str().unwrap().to_owned()],
            &ImportOptions { cyclic: Cyclic::None, ..options.clone() },
            &Job::silent(),
        );
        match read {
            Ok(read) => found.wrong.extend(differences(&read, &wanted, first, count, most)),
            Err(error) => found.wrong.push(format!("what was written is refused: {error}")),
        }
        fs::remove_dir_all(out).unwrap();
    }
    found
}

/// How `read`, which was exported, differs from `count` frames from `first` on of `wanted`, of which it was packed within
/// `most` metres.
fn differences(read: &Imported, wanted: &Imported, first: u32, count: u32, most: f32) -> Vec<String> {
    let mut wrong = Vec::new();
    let (a, b) = (&read.capture, &wanted.capture);
    if a.poses.len() != count as usize || a.vertex_of_file_vertex.len() != b.vertex_of_file_vertex.len() {
        let (poses, vertices) = (a.poses.len(), a.vertex_of_file_vertex.len());
        return vec![format!("{poses} frames of {vertices} vertices come out")];
    }
    let shift = read.offset - wanted.offset;
    // 32 bits do not hold a large number exactly.
    let most = f64::from(most) * 1.01 + 2e-6;
    let mut worst = 0.0_f64;
    for frame in 0..count {
        let (pose, own) = (a.poses.frame(frame), b.poses.frame(first + frame));
        for (&x, &y) in a.vertex_of_file_vertex.iter().zip(&b.vertex_of_file_vertex) {
            worst = worst.max((pose[x as usize].as_dvec3() + shift).distance(own[y as usize].as_dvec3()));
        }
    }
    if worst > most {
        wrong.push(format!("vertices are {worst} m off, of at most {most}"));
    }
    let (x, y) = (&a.surface, &b.surface);
    if (x.triangles.len(), x.parts.len()) != (y.triangles.len(), y.parts.len()) {
        wrong.push(format!("{} triangles in {} parts come out", x.triangles.len(), x.parts.len()));
        return wrong;
    }
    for (x_corner, y_corner) in x.triangles.iter().flatten().zip(y.triangles.iter().flatten()) {
        let (p, q) = (&x.corners[*x_corner as usize], &y.corners[*y_corner as usize]);
        let apart = (0..2).map(|axis| (p.uv[axis] - q.uv[axis]).abs()).fold(0.0, f32::max);
        if apart > 5e-5 || p.colour != q.colour {
            wrong.push(format!("corner {x_corner}: {p:?} instead of {q:?}"));
            break;
        }
    }
    // Materials that nothing wears do not come out.
    let colour = |surface: &actor::surface::Surface, part: usize| {
        let material = &surface.materials[surface.parts[part].material as usize];
        (material.base_colour, material.image.is_some())
    };
    for part in 0..x.parts.len() {
        let ((p, image), (q, own)) = (colour(x, part), colour(y, part));
        // OBJ has no colour beside a texture.
        if image != own || (!image && (0..4).any(|k| (p[k] - q[k]).abs() > 1e-4)) {
            wrong.push(format!("part {part} has {p:?} instead of {q:?}"));
        }
    }
    if read.frame_textures.as_ref().map(Vec::len) != wanted.frame_textures.as_ref().map(|_| count as usize) {
        wrong.push("other frames have textures of their own".into());
    }
    wrong
}

#[test]
#[ignore = "reads ../shared/data"]
fn every_case_is_right_or_a_clear_error() {
    let folder = tempfile::tempdir().unwrap();
    let archive = data().join("cases/cases.tar.xz");
    let status = Command::new("tar").arg("-xJf").arg(&archive).arg("-C").arg(folder.path()).status().unwrap();
    assert!(status.success(), "tar could not unpack {}", archive.display());
    let scratch = tempfile::tempdir().unwrap();
    let mut wrong = Vec::new();
    for row in ROWS {
        let found = look(row, folder.path(), scratch.path());
        println!("{}: {:?} {:?} {:?}", row.input, found.frames, found.codes, found.wrong);
        if found.frames != row.frames || found.codes != row.codes || !found.wrong.is_empty() {
            wrong.push(format!("{}: {found:?}", row.input));
        }
    }
    assert!(wrong.is_empty(), "{} of {} inputs:\n{}", wrong.len(), ROWS.len(), wrong.join("\n"));
}
