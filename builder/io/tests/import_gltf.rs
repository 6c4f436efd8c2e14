//! Import of glTF files made here, each for one feature of the format.

#![allow(clippy::unwrap_used, reason = "helpers of tests, too, end a test by panicking")]

mod import_support;

use base64::Engine;
use capture_io::import::ImportOptions;
use glam::{Quat, Vec3};
use import_support::{Gltf, check, png, read, read_plain, refusal, try_read, write, write_bytes};
use serde_json::json;

/// A tetrahedron's corners.
const CORNERS: [f32; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
const FACES: [u8; 12] = [0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2];

/// A file with one tetrahedron; node 0 draws mesh 0.
fn tetrahedron() -> Gltf {
    let mut file = Gltf::new();
    let positions = file.floats("VEC3", &CORNERS);
    let view = file.view(&FACES);
    let indices =
        file.push("accessors", json!({"bufferView": view, "componentType": 5121, "count": 12, "type": "SCALAR"}));
    file.push("meshes", json!({"primitives": [{"attributes": {"POSITION": positions}, "indices": indices}]}));
    file.scene_node(json!({"mesh": 0}));
    file
}

fn read_glb(file: &Gltf, fps: f32) -> capture_io::import::Imported {
    let folder = tempfile::tempdir().unwrap();
    write_bytes(folder.path(), "a.glb", &file.glb());
    read(folder.path(), &["a.glb"], &ImportOptions { fps: Some(fps), ..ImportOptions::default() })
}

fn refuse_glb(file: &Gltf) -> (&'static str, String) {
    let folder = tempfile::tempdir().unwrap();
    write_bytes(folder.path(), "a.glb", &file.glb());
    refusal(folder.path(), &["a.glb"])
}

fn corner(k: usize) -> Vec3 {
    Vec3::from_slice(&CORNERS[3 * k..])
}

#[test]
fn nodes_move_by_step_line_and_spline() {
    let mut file = tetrahedron();
    let steps = file.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 5.0, 0.0, 0.0]);
    file.clip(Some("step"), 0, "translation", "STEP", &[1.0, 2.0, 3.0], steps);
    let (a, b) = (Quat::IDENTITY, Quat::from_rotation_y(2.0));
    let turns = file.floats("VEC4", &[a.to_array(), b.to_array()].concat());
    file.clip(Some("line"), 0, "rotation", "LINEAR", &[0.0, 1.0], turns);
    // x = t^3: slopes 0 at 0 and 12 at 2.
    let keys = [[0.0; 3], [0.0; 3], [0.0; 3], [12.0, 0.0, 0.0], [8.0, 0.0, 0.0], [0.0; 3]];
    let spline = file.floats("VEC3", &keys.concat());
    file.clip(Some("spline"), 0, "translation", "CUBICSPLINE", &[0.0, 2.0], spline);
    let scales = file.floats("VEC3", &[2.0, 2.0, 2.0]);
    file.clip(Some("still"), 0, "scale", "LINEAR", &[0.5], scales);

    let capture = read_glb(&file, 10.0).capture;
    let counts: Vec<_> = capture.timeline.sequences().iter().map(|s| (s.name.as_str(), s.frame_count)).collect();
    assert_eq!(counts, [("step", 21), ("line", 11), ("spline", 21), ("still", 1)]);
    for k in 0..21 {
        let x = [0.0, 1.0, 5.0][(k / 10) as usize];
        assert_eq!(capture.poses.frame(k)[0], Vec3::new(x, 0.0, 0.0), "step {k}");
    }
    for k in 0..11 {
        let expected = Quat::from_rotation_y(0.2 * k as f32) * corner(1);
        assert!(capture.poses.frame(21 + k)[1].distance(expected) < 1e-6, "line {k}");
    }
    for k in 0..21 {
        let t = 0.1 * k as f32;
        assert!((capture.poses.frame(32 + k)[0].x - t * t * t).abs() < 1e-5, "spline {k}");
    }
    assert_eq!(capture.poses.frame(53)[2], 2.0 * corner(2));
}

#[test]
fn morph_targets_follow_their_weights_also_when_sparse() {
    let mut file = tetrahedron();
    let whole = file.floats("VEC3", &[[1.0, 0.0, 0.0]; 4].concat());
    // The second target moves corner 3 only, and has no base values.
    let places = file.view(&[3]);
    let values: Vec<u8> = [0.0_f32, 0.5, 0.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    let values = file.view(&values);
    let sparse = file.push(
        "accessors",
        json!({"componentType": 5126, "count": 4, "type": "VEC3", "sparse": {"count": 1,
            "indices": {"bufferView": places, "componentType": 5121}, "values": {"bufferView": values}}}),
    );
    file.json["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": whole}, {"POSITION": sparse}]);
    file.json["meshes"][0]["weights"] = json!([0.25, 0.0]);
    let rest = read_glb(&file, 10.0).capture;
    assert_eq!(rest.poses.frame(0)[1], corner(1) + 0.25 * Vec3::X);

    let weights = file.floats("SCALAR", &[0.0, 0.0, 1.0, 2.0]);
    file.clip(Some("smile"), 0, "weights", "LINEAR", &[0.0, 1.0], weights);
    let capture = read_glb(&file, 4.0).capture;
    assert_eq!(capture.timeline.frame_count(), 5);
    for k in 0..5 {
        let w = 0.25 * k as f32;
        let pose = capture.poses.frame(k);
        assert!(pose[0].distance(Vec3::X * w) < 1e-6);
        assert!(pose[3].distance(corner(3) + Vec3::X * w + Vec3::Y * w) < 1e-6);
    }
    // A sparse index beyond the end.
    file.json["accessors"][sparse]["count"] = json!(3);
    file.json["accessors"][whole]["count"] = json!(4);
    assert_eq!(refuse_glb(&file).0, "E_GLTF");
}

#[test]
fn quantised_and_interleaved_positions_are_read() {
    let mut file = tetrahedron();
    // Normalised shorts, 8 bytes apart.
    let mut bytes = Vec::new();
    for k in 0..4 {
        for c in corner(k).to_array() {
            bytes.extend(((c * 32767.0) as i16).to_le_bytes());
        }
        bytes.extend([0xee, 0xee]);
    }
    let view = file.view(&bytes);
    file.json["bufferViews"][view]["byteStride"] = json!(8);
    let shorts = file.push(
        "accessors",
        json!({"bufferView": view, "componentType": 5122, "normalized": true, "count": 4, "type": "VEC3"}),
    );
    file.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(shorts);
    file.json["nodes"][0]["scale"] = json!([3.0, 3.0, 3.0]);
    file.json["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
    file.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let capture = read_glb(&file, 10.0).capture;
    for k in 0..4 {
        assert!(capture.poses.frame(0)[k].distance(3.0 * corner(k)) < 1e-6);
    }
    // Not normalised: the numbers themselves.
    file.json["accessors"][shorts]["normalized"] = json!(false);
    file.json["nodes"][0]["scale"] = json!([1e-4, 1e-4, 1e-4]);
    assert!((read_glb(&file, 10.0).capture.poses.frame(0)[1].x - 3.2767).abs() < 1e-5);
}

#[test]
fn skins_blend_their_joints() {
    let mut file = tetrahedron();
    let root = file.push("nodes", json!({"translation": [0.0, 0.0, 7.0]}));
    let tip = file.push("nodes", json!({"translation": [0.0, 1.0, 0.0]}));
    file.json["nodes"][root]["children"] = json!([tip]);
    file.json["scenes"][0]["nodes"].as_array_mut().unwrap().push(json!(root));
    let back = |x: f32, y: f32, z: f32| glam::Mat4::from_translation(-Vec3::new(x, y, z)).to_cols_array();
    let binds = file.floats("MAT4", &[back(0.0, 0.0, 7.0), back(0.0, 1.0, 7.0)].concat());
    file.json["skins"] = json!([{"joints": [root, tip], "inverseBindMatrices": binds}]);
    let view = file.view(&[0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 9, 9, 9]);
    let joints = file.push("accessors", json!({"bufferView": view, "componentType": 5121, "count": 4, "type": "VEC4"}));
    // Byte weights, normalised; the last vertex names joints that do not exist with weight 0.
    let view = file.view(&[255, 0, 0, 0, 128, 127, 0, 0, 0, 255, 0, 0, 200, 0, 0, 0]);
    let weights = file.push(
        "accessors",
        json!({"bufferView": view, "componentType": 5121, "normalized": true, "count": 4, "type": "VEC4"}),
    );
    let attributes = &mut file.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = json!(joints);
    attributes["WEIGHTS_0"] = json!(weights);
    file.json["nodes"][0]["skin"] = json!(0);
    // A skinned mesh ignores its own node.
    file.json["nodes"][0]["translation"] = json!([100.0, 0.0, 0.0]);
    let turn = Quat::from_rotation_z(1.0);
    let turns = file.floats("VEC4", &[Quat::IDENTITY.to_array(), turn.to_array()].concat());
    file.clip(Some("bend"), tip, "rotation", "LINEAR", &[0.0, 1.0], turns);
    let capture = read_glb(&file, 1.0).capture;
    for k in 0..4 {
        assert!(capture.poses.frame(0)[k].distance(corner(k)) < 1e-5, "bind pose");
    }
    // Joint 1 turns about (0, 1, 7).
    let bent = |p: Vec3| turn * (p - Vec3::new(0.0, 1.0, 7.0)) + Vec3::new(0.0, 1.0, 7.0);
    let found = capture.poses.frame(1);
    assert!(found[0].distance(corner(0)) < 1e-5);
    assert!(found[1].distance(corner(1) * (128.0 / 255.0) + bent(corner(1)) * (127.0 / 255.0)) < 1e-5);
    assert!(found[2].distance(bent(corner(2))) < 1e-5);
    assert!(found[3].distance(bent(corner(3))) < 1e-5);

    // Weights where the joints were: joint 9 now pulls.
    file.json["accessors"][weights]["bufferView"] = json!(file.json["accessors"][joints]["bufferView"]);
    assert_eq!(refuse_glb(&file).0, "E_INDEX_RANGE");
}

#[test]
fn several_meshes_and_materials_are_one_surface() {
    let mut file = tetrahedron();
    let uvs = file.floats("VEC2", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
    let colours = file.floats("VEC3", &[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.2, 0.2, 0.2], [0.0, 0.0, 1.0]].concat());
    let image = file.view(&png(2, [9, 9, 9]));
    file.json["images"] = json!([{"bufferView": image, "mimeType": "image/png"}]);
    file.json["textures"] = json!([{"source": 0}]);
    file.json["materials"] = json!([
        {"name": "unused"},
        {"name": "cloth", "doubleSided": true, "pbrMetallicRoughness": {"baseColorTexture": {"index": 0,
            "extensions": {"KHR_texture_transform": {"offset": [0.5, 0.0], "scale": [0.5, 1.0]}}}}},
        {"name": "skin", "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 0.125, 1.0]}}
    ]);
    let first = file.json["meshes"][0]["primitives"][0].clone();
    let mut cloth = first.clone();
    cloth["attributes"]["TEXCOORD_0"] = json!(uvs);
    cloth["material"] = json!(1);
    let mut skin = first.clone();
    skin["attributes"]["COLOR_0"] = json!(colours);
    skin["material"] = json!(2);
    let mut points = first.clone();
    points["mode"] = json!(0);
    file.json["meshes"][0]["primitives"] = json!([skin, cloth, points, first]);
    // The same mesh once more, mirrored and elsewhere.
    file.scene_node(json!({"mesh": 0, "scale": [-1.0, 1.0, 1.0], "translation": [5.0, 0.0, 0.0]}));
    let imported = read_glb(&file, 10.0);
    let (topology, surface) = (&imported.capture.topology, &imported.capture.surface);
    assert!(imported.warnings.iter().any(|w| w.contains("primitive 2 is no triangles")));
    assert_eq!(imported.capture.vertex_of_file_vertex.len(), 24);
    assert_eq!(topology.vertex_count(), 8);
    assert_eq!(topology.component_count(), 2);
    let names: Vec<_> = surface.materials.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["skin", "cloth", ""]);
    assert_eq!(surface.materials[0].base_colour, [0.5, 0.25, 0.125, 1.0]);
    assert_eq!(surface.materials[1].image, Some(0));
    assert!(surface.materials[1].double_sided && !surface.materials[0].double_sided);
    assert_eq!(surface.parts.iter().map(|p| p.triangle_count).collect::<Vec<_>>(), [8, 8, 8]);
    // Texture coordinates moved into the right half; colours from linear light to sRGB.
    let of_part = |part: usize| {
        let part = surface.parts[part];
        let range = part.first_triangle as usize..(part.first_triangle + part.triangle_count) as usize;
        surface.triangles[range].iter().flatten().map(|&c| surface.corners[c as usize]).collect::<Vec<_>>()
    };
    assert!(of_part(1).iter().any(|c| c.uv == [0.5, 1.0]) && of_part(1).iter().all(|c| c.uv[0] >= 0.5));
    assert!(of_part(0).iter().any(|c| c.colour == [124, 124, 124, 255]));
    // Both copies face outwards: equal signed volumes.
    let pose = imported.capture.poses.frame(0);
    let volume = |first: usize| -> f32 {
        let triangles = topology.triangles().iter().filter(|t| (t[0] as usize / 4) == first);
        triangles
            .map(|t| {
                let [a, b, c] = t.map(|v| pose[v as usize]);
                a.cross(b).dot(c)
            })
            .sum()
    };
    assert!((volume(0) - volume(1)).abs() < 1e-4 && volume(0) > 0.1, "{} {}", volume(0), volume(1));
}

#[test]
fn strips_and_fans_are_triangles() {
    for (mode, expected) in [(5, [[0, 1, 2], [2, 1, 3]]), (6, [[0, 1, 2], [0, 2, 3]])] {
        let mut file = tetrahedron();
        let primitive = &mut file.json["meshes"][0]["primitives"][0];
        primitive.as_object_mut().unwrap().remove("indices");
        primitive["mode"] = json!(mode);
        assert_eq!(read_glb(&file, 10.0).capture.topology.triangles(), expected);
    }
}

#[test]
fn buffers_lie_in_data_uris_and_in_files() {
    let folder = tempfile::tempdir().unwrap();
    let mut file = tetrahedron();
    file.json["images"] = json!([{"uri": "my%20tex.png"}]);
    file.json["textures"] = json!([{"source": 0}]);
    file.json["materials"] = json!([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]);
    file.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    let text = base64::engine::general_purpose::STANDARD.encode(&file.bin);
    write(
        folder.path(),
        &[
            ("inline.gltf", &file.gltf(&format!("data:application/octet-stream;base64,{text}"))),
            ("outside.gltf", &file.gltf("sub/my%20buffer.bin")),
            ("far.gltf", &file.gltf("https://example.org/buffer.bin")),
            ("broken.gltf", &file.gltf("data:application/octet-stream;base64,###")),
            ("short.gltf", &file.gltf("data:application/octet-stream;base64,AAAA")),
        ],
    );
    write_bytes(folder.path(), "my tex.png", &png(4, [1, 2, 3]));
    assert_eq!(refusal(folder.path(), &["outside.gltf"]).0, "E_NOT_FOUND");
    write_bytes(folder.path(), "sub/my buffer.bin", &file.bin);
    let inline = read_plain(folder.path(), &["inline.gltf"]);
    let outside = read_plain(folder.path(), &["outside.gltf"]);
    assert_eq!(inline.capture.poses, outside.capture.poses);
    assert_eq!(inline.capture.surface.images[0].width, 4);
    assert_eq!(inline.capture.surface.images[0].bytes, png(4, [1, 2, 3]));
    assert_eq!(refusal(folder.path(), &["far.gltf"]).0, "E_GLTF");
    assert_eq!(refusal(folder.path(), &["broken.gltf"]).0, "E_GLTF");
    assert_eq!(refusal(folder.path(), &["short.gltf"]).0, "E_TRUNCATED");
    write_bytes(folder.path(), "my tex.png", &png(4, [1, 2, 3])[..40]);
    let (code, message) = refusal(folder.path(), &["outside.gltf"]);
    assert!(code == "E_IMAGE" && message.contains("my tex.png"), "{message}");
}

#[test]
fn clips_of_unnamed_animations() {
    let mut file = tetrahedron();
    let moves = file.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
    let sizes = file.floats("VEC3", &[1.0, 1.0, 1.0, 2.0, 2.0, 2.0]);
    file.clip(None, 0, "translation", "LINEAR", &[0.0, 1.0], moves);
    file.clip(None, 0, "scale", "LINEAR", &[0.0, 1.0], sizes);
    let together = read_glb(&file, 10.0);
    assert_eq!(together.capture.timeline.sequences().len(), 1);
    assert!(together.warnings.iter().any(|w| w.contains("read as one clip")));
    assert!(together.capture.poses.frame(10)[1].distance(Vec3::X * 3.0) < 1e-6);
    // Two that move the same thing are two clips.
    file.clip(None, 0, "translation", "LINEAR", &[0.0, 1.0], moves);
    let apart = read_glb(&file, 10.0);
    let names: Vec<_> = apart.capture.timeline.sequences().iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, ["a 0", "a 1", "a 2"]);
}

#[test]
fn broken_structures_are_refused() {
    let cases: [(&str, serde_json::Value, &str); 14] = [
        ("/nodes/0/mesh", json!(7), "E_GLTF"),
        ("/meshes/0/primitives/0/attributes/POSITION", json!(70), "E_GLTF"),
        ("/meshes/0/primitives/0/attributes/POSITION", json!(1), "E_GLTF"),
        ("/meshes/0/primitives/0/indices", json!(0), "E_GLTF"),
        ("/meshes/0/primitives/0/material", json!(3), "E_GLTF"),
        ("/accessors/0/count", json!(5), "E_TRUNCATED"),
        ("/accessors/0/count", json!(3), "E_INDEX_RANGE"),
        ("/accessors/0/count", json!(4_000_000_000_000_u64), "E_TRUNCATED"),
        ("/accessors/0/byteOffset", json!(u64::MAX), "E_TRUNCATED"),
        ("/bufferViews/0/byteOffset", json!(u64::MAX), "E_TRUNCATED"),
        ("/bufferViews/0/buffer", json!(2), "E_GLTF"),
        ("/scene", json!(2), "E_GLTF"),
        ("/nodes/0/children", json!([0]), "E_GLTF"),
        ("/asset/version", json!("1.0"), "E_GLTF"),
    ];
    for (pointer, value, code) in cases {
        let mut file = tetrahedron();
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        file.json.pointer_mut(parent).unwrap()[key] = value.clone();
        let (found, message) = refuse_glb(&file);
        assert_eq!(found, code, "{pointer} = {value}: {message}");
    }
    // A count without bytes behind it.
    let mut file = tetrahedron();
    file.json["accessors"][0] = json!({"componentType": 5126, "count": 4_000_000_000_u64, "type": "VEC3"});
    assert_eq!(refuse_glb(&file).0, "E_GLTF");
    // A clip of a year.
    let mut file = tetrahedron();
    let moves = file.floats("VEC3", &[0.0; 6]);
    file.clip(Some("long"), 0, "translation", "LINEAR", &[0.0, 3e7], moves);
    let (code, message) = refuse_glb(&file);
    assert!(code == "E_TOO_LARGE" && message.contains("\"long\""), "{message}");
    // Positions that are no numbers, with the vertex.
    let mut file = tetrahedron();
    file.bin[16..20].copy_from_slice(&f32::NAN.to_le_bytes());
    let (code, message) = refuse_glb(&file);
    assert!(code == "E_NOT_FINITE" && message.contains("vertex 1"), "{message}");
}

#[test]
fn several_files_make_one_capture_only_with_one_mesh() {
    let folder = tempfile::tempdir().unwrap();
    let mut a = tetrahedron();
    let moves = a.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
    a.clip(Some("walk"), 0, "translation", "LINEAR", &[0.0, 1.0], moves);
    write_bytes(folder.path(), "a.glb", &a.glb());
    write_bytes(folder.path(), "b.glb", &a.glb());
    let both = read_plain(folder.path(), &["a.glb", "b.glb"]);
    let names: Vec<_> = both.capture.timeline.sequences().iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, ["walk", "walk 2"]);
    assert_eq!(read_plain(folder.path(), &[""]).capture.timeline, both.capture.timeline);
    a.json["accessors"][1]["count"] = json!(9);
    write_bytes(folder.path(), "b.glb", &a.glb());
    let options = ImportOptions::default();
    let error = try_read(folder.path(), &["a.glb", "b.glb"], &options).unwrap_err();
    assert_eq!(error.code(), "E_FACE_LIST");
    check(&both);
}
