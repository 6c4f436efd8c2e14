//! What goes out is what came in: a capture is packed, its frames are exported and read again, and compared with the files that
//! it was packed from: vertices, faces, normals, materials, colours, and the texture of every frame.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::collections::HashMap;
use std::f32::consts::TAU;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use actor::walk::Walk;
use bundle::{BundleReader, ModeDecoder};
use capture_io::import::{Cyclic, ImportOptions, Imported, import};
use glam::{DVec3, Vec3};
use image::RgbImage;
use job::Job;
use kernels::align::Placement;
use serde_json::Value;
use synthesis::{FrameKind, Synthesiser};
use texture::dealign::Aligned;
use texture::mask::ACTIVE;
use texture::quality::Similarity;

/// Quads around the barrel, and rows of them.
const AROUND: usize = 12;
const ROWS: usize = 6;
/// Texels along a side of its texture.
const TEXELS: u32 = 64;

fn builder(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_builder")).args(arguments).output().unwrap()
}

fn run(arguments: &[&str]) -> Value {
    let output = builder(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap_or(Value::Null)
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Vertices of a barrel that bends and turns: rings with a seam of two vertices at one place, the ring of a lid, which has
/// normals of its own, and a vertex of no face.
fn barrel(phase: f32) -> Vec<Vec3> {
    let bend = |p: Vec3| {
        let lean = 0.4 * (TAU * phase).sin() * p.y;
        glam::Quat::from_rotation_y(0.8 * phase) * glam::Quat::from_rotation_z(lean) * p + Vec3::X * 0.5 * phase
    };
    let ring = |height: f32, count: usize| {
        (0..count).map(move |k| {
            let (sin, cos) = (TAU * (k % AROUND) as f32 / AROUND as f32).sin_cos();
            let wide = 0.3 + 0.06 * (3.0 * height).sin();
            Vec3::new(wide * cos, height, 0.7 * wide * sin)
        })
    };
    let mut vertices: Vec<Vec3> =
        (0..=ROWS).flat_map(|row| ring(1.7 * row as f32 / ROWS as f32, AROUND + 1)).map(bend).collect();
    vertices.extend(ring(1.7, AROUND).map(bend));
    vertices.push(Vec3::new(0.1, 2.0, 0.1) + Vec3::X * 0.5 * phase);
    vertices
}

/// Everything behind the positions of an OBJ frame: two materials by turns, quads and a lid of twelve corners, texture
/// coordinates beyond 0 to 1 on what has no texture.
fn faces() -> String {
    let mut text = String::new();
    for row in 0..=ROWS {
        for k in 0..=AROUND {
            writeln!(text, "vt {} {}", 0.05 + 0.9 * k as f32 / AROUND as f32, 0.05 + 0.9 * row as f32 / ROWS as f32)
                .unwrap();
        }
    }
    let at = |row: usize, k: usize| row * (AROUND + 1) + k + 1;
    let uvs = (ROWS + 1) * (AROUND + 1);
    for k in 0..AROUND {
        writeln!(text, "vt {} {}", -1.5 + 4.0 * k as f32 / AROUND as f32, 0.3 * k as f32).unwrap();
        let (sin, cos) = (TAU * k as f32 / AROUND as f32).sin_cos();
        writeln!(text, "vn {cos} 0 {sin}").unwrap();
    }
    writeln!(text, "vn 0 1 0").unwrap();
    for row in 0..ROWS {
        for k in 0..AROUND {
            // Rows one and four have no texture.
            let skin = row % 3 == 1;
            writeln!(text, "usemtl {}", if skin { "skin tone" } else { "cloth" }).unwrap();
            text.push('f');
            for (row, k) in [(row, k), (row + 1, k), (row + 1, k + 1), (row, k + 1)] {
                let uv = if skin { uvs + k % AROUND + 1 } else { at(row, k) };
                write!(text, " {}/{uv}/{}", at(row, k), k % AROUND + 1).unwrap();
            }
            text.push('\n');
        }
    }
    text.push_str("usemtl skin tone\nf");
    let lid = (ROWS + 1) * (AROUND + 1);
    (0..AROUND).rev().for_each(|k| write!(text, " {}/{}/{}", lid + k + 1, uvs + k + 1, AROUND + 1).unwrap());
    text.push('\n');
    text
}

/// The texture of a frame: a pattern that slides, under a light that goes round.
fn paint(phase: f32) -> RgbImage {
    RgbImage::from_fn(TEXELS, TEXELS, |x, y| {
        let [u, v] = [x, y].map(|at| at as f32 / TEXELS as f32);
        let slid = u + 0.02 * (TAU * phase).sin();
        let check = ((slid * 25.0).sin() * (v * 31.0).sin() * 4.0).clamp(-1.0, 1.0);
        let light = 0.75 + 0.25 * (TAU * (u - phase)).cos();
        image::Rgb([0.55 + 0.3 * check, 0.5 - 0.2 * check, 0.3 + 0.4 * v].map(|c| (255.0 * light * c) as u8))
    })
}

/// Where the files' coordinates are: what they are multiplied with and moved by, and whether +Z points up.
#[derive(Clone, Copy)]
struct Site {
    scale: f64,
    offset: DVec3,
    z_up: bool,
}

const HERE: Site = Site { scale: 1.0, offset: DVec3::ZERO, z_up: false };

/// A take of the barrel as OBJ files, with a library and a texture each where `textured`.
fn write_take(folder: &Path, frames: usize, from: f32, textured: bool, site: Site) {
    fs::create_dir_all(folder).unwrap();
    let faces = faces();
    for frame in 0..frames {
        let phase = from + frame as f32 / 30.0;
        let name = format!("f_{frame:03}");
        let library = if textured { format!("{name}.mtl") } else { "all.mtl".into() };
        let mut text = format!("mtllib {library}\n");
        for (k, point) in barrel(phase).into_iter().enumerate() {
            let p = point.as_dvec3();
            let turned = if site.z_up { DVec3::new(p.x, -p.z, p.y) } else { p };
            let [x, y, z] = (turned * site.scale + site.offset).to_array();
            writeln!(text, "v {x:.6} {y:.6} {z:.6} {} {} 0.2", (k % 5) as f32 / 5.0, (k % 3) as f32 / 5.0).unwrap();
        }
        text.push_str(&faces);
        fs::write(folder.join(format!("{name}.obj")), text).unwrap();
        let texture = if textured { format!("map_Kd {name}.png\n") } else { "Kd 0.8 0.3 0.2\n".into() };
        let materials = format!("newmtl cloth\n{texture}newmtl skin tone\nKd 0.9 0.6 0.5\nd 0.75\n");
        fs::write(folder.join(library), materials).unwrap();
        if textured {
            paint(phase).save(folder.join(format!("{name}.png"))).unwrap();
        }
    }
}

fn read(input: &Path, options: &ImportOptions) -> Imported {
    let options = ImportOptions { fps: Some(30.0), cyclic: Cyclic::None, ..options.clone() };
    import(&[input.to_str().unwrap().to_owned()], &options, &Job::silent()).unwrap()
}

/// Every file vertex of every frame where it was, within `most` metres; the same faces over them.
fn same_shape(read: &Imported, wanted: &Imported, first: u32, most: f32) {
    let (a, b) = (&read.capture, &wanted.capture);
    assert_eq!(a.vertex_of_file_vertex.len(), b.vertex_of_file_vertex.len());
    for frame in 0..a.poses.len() as u32 {
        let (pose, own) = (a.poses.frame(frame), b.poses.frame(first + frame));
        for (v, (&x, &y)) in a.vertex_of_file_vertex.iter().zip(&b.vertex_of_file_vertex).enumerate() {
            let moved = (read.offset - wanted.offset).as_vec3();
            let gap = (pose[x as usize] + moved).distance(own[y as usize]);
            assert!(gap <= most, "frame {frame}, vertex {v}: {gap} m");
        }
    }
    assert_eq!(a.surface.parts, b.surface.parts);
    assert_eq!(a.surface.triangles.len(), b.surface.triangles.len());
}

/// Texture coordinates, colours and materials of every corner.
fn same_looks(read: &Imported, wanted: &Imported) {
    let (a, b) = (&read.capture.surface, &wanted.capture.surface);
    let uvs = || b.corners.iter().map(|corner| corner.uv);
    let range = [0, 1].map(|axis| {
        let low = uvs().map(|uv| uv[axis]).fold(f32::MAX, f32::min);
        uvs().map(|uv| uv[axis]).fold(f32::MIN, f32::max) - low
    });
    for (x, y) in a.triangles.iter().flatten().zip(b.triangles.iter().flatten()) {
        let (x, y) = (&a.corners[*x as usize], &b.corners[*y as usize]);
        (0..2).for_each(|axis| assert!((x.uv[axis] - y.uv[axis]).abs() <= 1.01 * range[axis] / 131_070.0 + 1e-6));
        assert_eq!(x.colour, y.colour);
    }
    assert_eq!(a.materials.len(), b.materials.len());
    for (x, y) in a.materials.iter().zip(&b.materials) {
        assert_eq!(x.name, y.name);
        (0..4).for_each(|k| assert!((x.base_colour[k] - y.base_colour[k]).abs() < 1e-5, "{x:?} {y:?}"));
    }
}

/// Colours of the texels that show the actor.
fn active_texels(image: &RgbImage, active: &[bool]) -> Vec<f32> {
    let shown = image.pixels().zip(active).filter(|(_, active)| **active);
    shown.flat_map(|(pixel, _)| pixel.0.map(|byte| f32::from(byte) / 255.0)).collect()
}

fn mask_of(bundle: &Path) -> Vec<bool> {
    let reader = BundleReader::from_bytes(&fs::read(bundle).unwrap()).unwrap();
    reader.appearance().unwrap().mask.full().flags.iter().map(|flags| flags & ACTIVE != 0).collect()
}

/// Two textured takes that lead to each other, packed.
fn textured() -> (tempfile::TempDir, PathBuf, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let capture = folder.path().join("barrel");
    write_take(&capture.join("sway"), 30, 0.0, true, HERE);
    write_take(&capture.join("turn"), 24, 0.3, true, HERE);
    let bundle = folder.path().join("barrel.reprise");
    let (input, out) = (capture.to_str().unwrap(), bundle.to_str().unwrap());
    run(&[
        "pack",
        input,
        "-o",
        out,
        "--fps",
        "30",
        "--cyclic",
        "none",
        "--max-error",
        "0.0002",
        "--shortest",
        "0.15",
        "-q",
    ]);
    (folder, capture, bundle)
}

#[test]
fn recorded_frames_come_out_as_they_went_in() {
    let (folder, capture, bundle) = textured();
    let wanted = read(&capture, &ImportOptions::default());
    let own_textures = wanted.frame_textures.clone().unwrap();
    let active = mask_of(&bundle);
    let similarity = Similarity::new(TEXELS, &active);
    let path = bundle.to_str().unwrap();
    for (name, first, frames) in [("sway", 0, 30), ("turn", 30, 24)] {
        let out = folder.path().join(name);
        let pattern = out.join("w_%04d.obj");
        let report = run(&["direct", path, "--sequence", name, "--json", "-q", "-o", pattern.to_str().unwrap()]);
        assert_eq!((&report["frames"], &report["warnings"]), (&frames.into(), &Value::Array(vec![])));
        // One OBJ, one MTL and one texture a frame, named by its number, and nothing else.
        assert_eq!(fs::read_dir(&out).unwrap().count(), 3 * frames as usize);
        assert!(["w_0007.obj", "w_0007.mtl", "w_0007_texture.png"].iter().all(|file| out.join(file).is_file()));

        let again = read(&out, &ImportOptions::default());
        let codes = |imported: &Imported| imported.warnings.iter().map(|warning| warning.code).collect::<Vec<_>>();
        assert_eq!(codes(&again), ["W_WELDED", "W_LOOSE_VERTICES"]);
        assert_eq!(codes(&again), codes(&wanted));
        assert_eq!(again.capture.poses.len(), frames as usize);
        // The bundle's bound, and what welding may have moved.
        same_shape(&again, &wanted, first, 0.0002 + 3e-5);
        same_looks(&again, &wanted);
        // The same polygons in the same order over the same vertices, which share the same normals.
        assert_eq!(again.files, wanted.files);
        assert!(wanted.files.faces.as_ref().unwrap().joined.contains(&true));
        for (frame, file) in again.frame_textures.unwrap().iter().enumerate() {
            let shown = active_texels(&image::open(file).unwrap().to_rgb8(), &active);
            let alike = |other: usize| {
                let texture = image::open(&own_textures[other]).unwrap().to_rgb8();
                similarity.of(&active_texels(&texture, &active), &shown)
            };
            let own = alike(first as usize + frame);
            assert!(own > 0.93, "{name}, frame {frame}: {own}");
            let far = (first as usize + frame + 15) % 54;
            assert!(own > alike(far), "{name}, frame {frame} is more like frame {far}");
        }
    }

    // PLY has the same vertices, faces and textures, but no materials.
    let out = folder.path().join("plys");
    run(&["direct", path, "--sequence", "turn", "-q", "-o", out.join("%03d.ply").to_str().unwrap()]);
    assert_eq!(fs::read_dir(&out).unwrap().count(), 48);
    let again = read(&out, &ImportOptions::default());
    assert_eq!(again.capture.vertex_of_file_vertex.len(), wanted.capture.vertex_of_file_vertex.len());
    for frame in 0..24 {
        let (a, b) = (again.capture.poses.frame(frame), wanted.capture.poses.frame(30 + frame));
        let pairs = again.capture.vertex_of_file_vertex.iter().zip(&wanted.capture.vertex_of_file_vertex);
        pairs.for_each(|(&x, &y)| assert!(a[x as usize].distance(b[y as usize]) < 0.00023));
    }
    assert_eq!(again.files.faces.unwrap().joined.iter().filter(|&&joined| joined).count(), ROWS * AROUND + AROUND - 3);
    assert_eq!(again.frame_textures.unwrap().len(), 24);
}

/// Kinds and poses of the frames of a reported walk, made here.
fn kinds(bundle: &Path, report: &Value) -> Vec<FrameKind> {
    let mut reader = BundleReader::from_bytes(&fs::read(bundle).unwrap()).unwrap();
    let (graph, timeline) = (reader.graph().unwrap().clone(), reader.timeline().unwrap().clone());
    let walk: Walk = serde_json::from_value(report["answer"]["walk"].clone()).unwrap();
    let mut synthesiser = Synthesiser::new(reader.topology().unwrap(), reader.order()).unwrap();
    let start = report["answer"]["start_frame"].as_u64().unwrap() as u32;
    synthesiser.begin_walk(&graph, &timeline, (start, Placement::IDENTITY), &walk).unwrap();
    let mut pose = vec![Vec3::ZERO; reader.topology().unwrap().vertex_count()];
    let mut kinds = Vec::new();
    while let Some(info) = synthesiser.next_frame(&graph, &timeline, &mut reader, &mut pose).unwrap() {
        kinds.push(info.kind);
    }
    kinds
}

/// The texture between two frames, straight from the bundle's models: values of the texels that show the actor.
fn rebuilt(bundle: &Path, from: u32, to: u32, lambda: f32) -> Vec<f32> {
    let reader = BundleReader::from_bytes(&fs::read(bundle).unwrap()).unwrap();
    let appearance = reader.appearance().unwrap();
    let (mut modes, mut decoder) = ([Vec::new(), Vec::new()], ModeDecoder::default());
    for ordinal in 0..appearance.section_count() {
        let (layer, _) = appearance.place(ordinal).unwrap();
        let bytes = reader.mode_bytes(ordinal).unwrap();
        modes[layer].push(decoder.advance(bytes, appearance, layer, usize::MAX).unwrap().unwrap());
    }
    let field = |layer: usize| {
        let own = &appearance.layers[layer];
        own.rebuild(&appearance.mask, &modes[layer], &own.weights(from, to, lambda), 16)
    };
    let cell = (1 << appearance.layers[1].level) as f32;
    let aligned = Aligned { texture: field(0), warp: field(1), texel: 1.0, cell, fill: [0.5; 3] };
    let colours = aligned.dealign(&appearance.mask, 1);
    let flags = &appearance.mask.full().flags;
    colours.into_iter().zip(flags).filter(|(_, flags)| **flags & ACTIVE != 0).flat_map(|(colour, _)| colour).collect()
}

#[test]
fn transitions_wear_textures_between_those_of_their_sides() {
    let (folder, _, bundle) = textured();
    let path = bundle.to_str().unwrap();
    let out = folder.path().join("walk");
    let pattern = out.join("%d.obj");
    let walk = ["direct", path, "--start", "sway:0", "--to", "turn:0.7", "--json", "-q", "-o"];
    let report = run(&[&walk[..], &[pattern.to_str().unwrap()]].concat());
    let kinds = kinds(&bundle, &report);
    let active = mask_of(&bundle);
    let mut between = 0;
    for (number, kind) in kinds.iter().enumerate() {
        let (from, to, lambda) = match *kind {
            FrameKind::Recorded { frame } => (frame, frame, 0.0),
            FrameKind::Synthetic { lambda, source_frame, destination_frame, .. } => {
                between += 1;
                (source_frame, destination_frame, lambda)
            }
        };
        let texture = image::open(out.join(format!("{number}_texture.png"))).unwrap().to_rgb8();
        let wanted = rebuilt(&bundle, from, to, lambda);
        for (a, b) in active_texels(&texture, &active).iter().zip(&wanted) {
            assert!((a - b.clamp(0.0, 1.0)).abs() < 0.5001 / 255.0, "frame {number}: {a} {b}");
        }
    }
    assert!(between > 2, "{kinds:?}");

    // Pictures show the frames' textures: a frame is not drawn in that of another.
    let pictures = |bundle: &Path, name: &str| -> Vec<RgbImage> {
        let pattern = folder.path().join(name).join("%d.png");
        let turn =
            ["--sequence", "sway", "--size", "96x96", "--turn", "100000s", "-q", "-o", pattern.to_str().unwrap()];
        run(&[&["direct", bundle.to_str().unwrap()], &turn[..]].concat());
        (0..30).map(|k| image::open(folder.path().join(format!("{name}/{k}.png"))).unwrap().to_rgb8()).collect()
    };
    let still = folder.path().join("static.reprise");
    let input = folder.path().join("barrel");
    let pack = ["--fps", "30", "--cyclic", "none", "--appearance", "static", "--shortest", "0.15", "-q"];
    run(&[&["pack", input.to_str().unwrap(), "-o", still.to_str().unwrap()], &pack[..]].concat());
    let (changing, still) = (pictures(&bundle, "changing"), pictures(&still, "still"));
    let apart = |k: usize| {
        let values = changing[k].as_raw().iter().zip(still[k].as_raw());
        values.map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>() / changing[k].as_raw().len() as f64
    };
    assert!(apart(15) > 2.0 * apart(0) + 0.5, "{} {}", apart(15), apart(0));
}

#[test]
fn a_glb_shows_each_frame_in_its_texture() {
    let (folder, capture, bundle) = textured();
    let wanted = read(&capture, &ImportOptions::default());
    let path = bundle.to_str().unwrap();
    let out = folder.path().join("turn.glb");
    let report = run(&["direct", path, "--sequence", "turn", "--json", "-q", "-o", out.to_str().unwrap()]);
    assert_eq!(report["warnings"], Value::Array(vec![]));
    let again = read(&out, &ImportOptions::default());
    assert_eq!(again.capture.poses.len(), 24);
    let codes: Vec<&str> = again.warnings.iter().map(|warning| warning.code).collect();
    assert!(codes.contains(&"W_GLTF_FLIPBOOK") && codes.contains(&"W_ATTRIBUTES_DIFFER"), "{codes:?}");
    // The files' vertices come first, in their order.
    let own = wanted.capture.vertex_of_file_vertex.len();
    assert!(again.capture.vertex_of_file_vertex.len() >= own);
    for frame in 0..24 {
        let (a, b) = (again.capture.poses.frame(frame), wanted.capture.poses.frame(30 + frame));
        let pairs = again.capture.vertex_of_file_vertex.iter().zip(&wanted.capture.vertex_of_file_vertex);
        pairs.for_each(|(&x, &y)| assert!(a[x as usize].distance(b[y as usize]) < 0.00025));
    }
    // A material and an image a frame, and no static texture beside them.
    let (document, binary) = glb(&out);
    assert_eq!(document["images"].as_array().unwrap().len(), 24);
    assert_eq!(document["materials"].as_array().unwrap().len(), 2 + 23);
    let active = mask_of(&bundle);
    for frame in [0, 9, 23] {
        let primitives = document["meshes"][frame]["primitives"].as_array().unwrap();
        let worn: Vec<u64> = primitives
            .iter()
            .filter_map(|primitive| {
                let material = &document["materials"][primitive["material"].as_u64().unwrap() as usize];
                material["pbrMetallicRoughness"]["baseColorTexture"]["index"].as_u64()
            })
            .collect();
        assert_eq!(worn.len(), 1);
        let source = document["textures"][worn[0] as usize]["source"].as_u64().unwrap();
        let view =
            &document["bufferViews"][document["images"][source as usize]["bufferView"].as_u64().unwrap() as usize];
        let start = view["byteOffset"].as_u64().unwrap() as usize;
        let bytes = &binary[start..start + view["byteLength"].as_u64().unwrap() as usize];
        let texture = active_texels(&image::load_from_memory(bytes).unwrap().to_rgb8(), &active);
        let wanted = rebuilt(&bundle, 30 + frame as u32, 30 + frame as u32, 0.0);
        assert!(texture.iter().zip(&wanted).all(|(a, b)| (a - b.clamp(0.0, 1.0)).abs() < 0.5001 / 255.0));
    }
}

/// Characters as game studios make them: vertices split for texture coordinates and for normals, several parts.
#[test]
#[ignore = "reads ../shared/data"]
fn characters_come_out_as_they_went_in() {
    for (file, sequence) in [("lumberjack/lumberjack.glb", "Walk"), ("cesium-man/CesiumMan.glb", "CesiumMan")] {
        let input = fixtures::data().join("gltf").join(file);
        let folder = tempfile::tempdir().unwrap();
        let bundle = folder.path().join("a.reprise");
        let path = bundle.to_str().unwrap();
        run(&["pack", input.to_str().unwrap(), "-o", path, "--fps", "30", "--cyclic", "none", "-q"]);
        let most = run(&["inspect", path, "--json"])["max_error"].as_f64().unwrap() as f32 + 2e-5;
        let wanted = read(&input, &ImportOptions::default());
        let own = wanted.capture.timeline.sequences().iter().find(|own| own.name == sequence).unwrap();
        for out in ["walk.glb", "objs/f_%03d.obj", "plys/f_%03d.ply"] {
            let out = folder.path().join(out);
            run(&["direct", path, "--sequence", sequence, "-q", "-o", out.to_str().unwrap()]);
            let is_glb = out.extension().unwrap() == "glb";
            let again = read(if is_glb { &out } else { out.parent().unwrap() }, &ImportOptions::default());
            assert_eq!(again.capture.poses.len(), own.frame_count as usize, "{file}");
            same_shape(&again, &wanted, own.first_frame, most);
            let (a, b) = (&again.files.faces, &wanted.files.faces);
            assert_eq!(a.as_ref().map(|faces| &faces.corners), b.as_ref().map(|faces| &faces.corners), "{file}");
            // PLY has no materials.
            if out.extension().unwrap() != "ply" {
                same_looks(&again, &wanted);
            }
            assert_eq!(again.capture.surface.images.len(), wanted.capture.surface.images.len());
        }
    }
}

#[test]
fn a_glb_of_too_many_textures_wears_the_first_and_says_so() {
    let (folder, _, bundle) = textured();
    let out = folder.path().join("turn.glb");
    let sequence =
        ["direct", bundle.to_str().unwrap(), "--sequence", "turn", "--json", "-q", "-o", out.to_str().unwrap()];
    let report = run(&[&sequence[..], &["--glb-textures", "0"]].concat());
    assert_eq!(report["warnings"][0]["code"], "W_TEXTURE_STATIC");
    assert_eq!(report["warnings"].as_array().unwrap().len(), 1);
    let (document, _) = glb(&out);
    assert_eq!(document["images"].as_array().unwrap().len(), 1);
    assert_eq!(document["meshes"].as_array().unwrap().len(), 1);
    let again = read(&out, &ImportOptions::default());
    assert_eq!(again.capture.poses.len(), 24);
    let image = &again.capture.surface.images[0];
    let active = mask_of(&bundle);
    let texture = active_texels(&image::load_from_memory(&image.bytes).unwrap().to_rgb8(), &active);
    let wanted = rebuilt(&bundle, 30, 30, 0.0);
    assert!(texture.iter().zip(&wanted).all(|(a, b)| (a - b.clamp(0.0, 1.0)).abs() < 0.5001 / 255.0));
}

/// The document and the binary chunk of a GLB.
fn glb(path: &Path) -> (Value, Vec<u8>) {
    let bytes = fs::read(path).unwrap();
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    (serde_json::from_slice(&bytes[20..20 + length]).unwrap(), bytes[28 + length..].to_vec())
}

#[test]
fn exports_are_at_the_place_of_the_files_in_their_unit_and_axes() {
    // A map's millimetres with +Z up, and metres.
    let sites = [
        Site { scale: 1000.0, offset: DVec3::new(432_187_250.0, -5_839_921_500.0, 68_125.0), z_up: true },
        Site { scale: 1.0, offset: DVec3::new(432_187.25, 12.5, 5_839_921.75), z_up: false },
        HERE,
    ];
    for site in sites {
        let folder = tempfile::tempdir().unwrap();
        let capture = folder.path().join("barrel");
        write_take(&capture, 24, 0.0, false, site);
        let unit = (1.0 / site.scale).to_string();
        let up = if site.z_up { "z" } else { "y" };
        let bundle = folder.path().join("a.reprise");
        let (input, path) = (capture.to_str().unwrap(), bundle.to_str().unwrap());
        let axes = ["--unit", &unit, "--up", up];
        let pack = ["pack", input, "-o", path, "--fps", "30", "--cyclic", "none", "--max-error", "0.0005", "-q"];
        run(&[&pack[..], &axes[..]].concat());

        let far = site.offset != DVec3::ZERO;
        let found = run(&["inspect", path, "--json"]);
        let of_input = run(&[&["inspect", input, "--json"], &axes[..]].concat());
        assert_eq!(found["offset"], of_input["offset"]);
        assert_eq!((&found["files"]["up"], &found["files"]["vertices"]), (&up.into(), &104.into()));
        assert!((found["files"]["metres_per_unit"].as_f64().unwrap() * site.scale - 1.0).abs() < 1e-12);
        let sections = found["sections"].as_array().unwrap().iter().filter(|section| section["name"] == "file-place");
        assert_eq!(sections.count(), usize::from(far));

        // Line by line what the files have, within the bundle's bound.
        let pattern = folder.path().join("out/f_%03d.obj");
        run(&["direct", path, "--sequence", "barrel", "-q", "-o", pattern.to_str().unwrap()]);
        for frame in [0, 11, 23] {
            let name = format!("f_{frame:03}.obj");
            let own = positions(&fs::read_to_string(capture.join(&name)).unwrap());
            let written = positions(&fs::read_to_string(folder.path().join("out").join(&name)).unwrap());
            assert_eq!(own.len(), written.len());
            for (a, b) in own.iter().zip(&written) {
                assert!(a.distance(*b) < 0.0006 * site.scale, "frame {frame}: {a} {b}");
            }
        }
        let options = ImportOptions {
            unit: Some((1.0 / site.scale) as f32),
            up: site.z_up.then_some(capture_io::import::UpAxis::Z),
            ..ImportOptions::default()
        };
        let wanted = read(&capture, &options);
        let pattern = folder.path().join("plys/f_%03d.ply");
        run(&["direct", path, "--sequence", "barrel", "-q", "-o", pattern.to_str().unwrap()]);
        let again = read(&folder.path().join("plys"), &options);
        same_vertices(&again, &wanted, 0.0006);
        let out = folder.path().join("a.glb");
        run(&["direct", path, "--sequence", "barrel", "-q", "-o", out.to_str().unwrap()]);
        let (document, _) = glb(&out);
        let moved: Option<[f64; 3]> = serde_json::from_value(document["nodes"][0]["translation"].clone()).unwrap();
        assert_eq!(moved.map(DVec3::from), far.then_some(wanted.offset));
    }
}

fn same_vertices(read: &Imported, wanted: &Imported, most: f32) {
    let (a, b) = (&read.capture, &wanted.capture);
    let moved = (read.offset - wanted.offset).as_vec3();
    assert_eq!(a.vertex_of_file_vertex.len(), b.vertex_of_file_vertex.len());
    for frame in 0..a.poses.len() as u32 {
        let (pose, own) = (a.poses.frame(frame), b.poses.frame(frame));
        for (&x, &y) in a.vertex_of_file_vertex.iter().zip(&b.vertex_of_file_vertex) {
            let gap = (pose[x as usize] + moved).distance(own[y as usize]);
            assert!(gap < most, "frame {frame}: {gap}");
        }
    }
}

fn positions(text: &str) -> Vec<DVec3> {
    let vertices = text.lines().filter_map(|line| line.strip_prefix("v "));
    vertices
        .map(|line| {
            let numbers: Vec<f64> = line.split_whitespace().take(3).map(|word| word.parse().unwrap()).collect();
            DVec3::from_slice(&numbers)
        })
        .collect()
}

#[test]
fn paths_that_cannot_be_written_and_files_from_before_are_said() {
    let folder = tempfile::tempdir().unwrap();
    let capture = folder.path().join("barrel");
    write_take(&capture, 24, 0.0, false, HERE);
    let bundle = folder.path().join("a.reprise");
    let path = bundle.to_str().unwrap();
    run(&["pack", capture.to_str().unwrap(), "-o", path, "--fps", "30", "--cyclic", "none", "-q"]);
    let refused = |out: &Path, code: i32, words: &str| {
        let output = builder(&["direct", path, "--sequence", "barrel", "-o", out.to_str().unwrap()]);
        assert_eq!(output.status.code(), Some(code), "{}", said(&output));
        assert!(said(&output).contains(words), "{}", said(&output));
    };
    // Many files, one name.
    for name in ["walk.obj", "walk.ply", "walk.png", "walk%.obj", "walk_%d_%d.obj"] {
        refused(&folder.path().join(name), 2, "say where its number goes");
    }
    refused(&folder.path().join("%d.fbx"), 2, "says no format");
    // A folder that is a file.
    fs::write(folder.path().join("taken"), "mine").unwrap();
    for name in ["taken/%d.obj", "taken/%d.ply", "taken/%d.png", "taken/a.glb"] {
        refused(&folder.path().join(name), 1, "cannot write");
    }
    assert_eq!(fs::read(folder.path().join("taken")).unwrap(), b"mine");
    // A file's name that is a folder; nothing else is left beside it but what was complete.
    fs::create_dir_all(folder.path().join("out/3.obj")).unwrap();
    refused(&folder.path().join("out/%d.obj"), 1, "cannot write");
    let left = fs::read_dir(folder.path().join("out")).unwrap().map(|entry| entry.unwrap().file_name());
    assert!(left.into_iter().all(|name| !name.to_string_lossy().starts_with(".partial")));
    let unknown = builder(&["direct", path, "--sequence", "fly", "-o", "o.glb"]);
    assert!(said(&unknown).contains("no sequence \"fly\"; there are: barrel"), "{}", said(&unknown));

    // Files of an earlier, longer export stay, and are said; others are replaced.
    let pattern = folder.path().join("again/w%02d.obj");
    let export = |every: &str| {
        let output = builder(&[
            "direct",
            path,
            "--sequence",
            "barrel",
            "--every",
            every,
            "--json",
            "-o",
            pattern.to_str().unwrap(),
        ]);
        assert!(output.status.success(), "{}", said(&output));
        let report: Value = serde_json::from_slice(&output.stdout).unwrap();
        report["warnings"]
            .as_array()
            .unwrap()
            .iter()
            .map(|w| w["code"].as_str().unwrap().to_owned())
            .collect::<Vec<_>>()
    };
    assert_eq!(export("1"), [""; 0]);
    let second = fs::read(folder.path().join("again/w01.obj")).unwrap();
    assert_eq!(export("1"), [""; 0]);
    assert_eq!(fs::read(folder.path().join("again/w01.obj")).unwrap(), second);
    assert_eq!(export("4"), ["W_FRAMES_REMAIN"]);
    assert_ne!(fs::read(folder.path().join("again/w01.obj")).unwrap(), second);
    // Another walk into the same folder has its own library.
    let names: HashMap<String, u64> = fs::read_dir(folder.path().join("again"))
        .unwrap()
        .map(|entry| entry.unwrap())
        .map(|entry| (entry.file_name().into_string().unwrap(), entry.metadata().unwrap().len()))
        .collect();
    assert!(names.contains_key("w_materials.mtl") && names.len() == 25, "{names:?}");
}
