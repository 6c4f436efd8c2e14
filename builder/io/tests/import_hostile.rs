//! Damaged files: every truncation, and flips of every byte, are read or refused; nothing panics.

#![allow(clippy::unwrap_used, reason = "helpers of tests, too, end a test by panicking")]

mod import_support;

use job::Job;
use std::path::Path;

use capture_io::import::{ImportOptions, import};
use import_support::{Gltf, png, write, write_bytes};
use serde_json::json;

/// Imports `name` in `folder` with every truncation and several flips of every byte of `bytes`.
fn torment(folder: &Path, name: &str, bytes: &[u8], flips: &[u8]) {
    let input = vec![folder.join(name).to_str().unwrap().to_owned()];
    let options = ImportOptions::default();
    write_bytes(folder, name, bytes);
    if let Err(error) = import(&input, &options, &Job::silent()) {
        panic!("{name} must be sound at first: {error}");
    }
    let mut refused = 0;
    let mut attempt = |damaged: &[u8]| {
        write_bytes(folder, name, damaged);
        if let Err(error) = import(&input, &options, &Job::silent()) {
            assert!(error.code().starts_with("E_") && !error.to_string().is_empty());
            refused += 1;
        }
    };
    for length in 0..bytes.len() {
        attempt(&bytes[..length]);
    }
    let mut damaged = bytes.to_vec();
    for at in 0..bytes.len() {
        for flip in flips {
            damaged[at] ^= flip;
            attempt(&damaged);
            damaged[at] = bytes[at];
        }
    }
    assert!(refused > bytes.len() / 3, "{name}: only {refused} refused");
}

const OBJ: &str = "mtllib m.mtl\nv 0 0 0 1 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0.5\nusemtl a\n\
                   f 1/1 2/2 3/1\nf -4 -2 -1\n";

#[test]
fn obj_and_mtl() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    let mtl = "newmtl a\nKd 1 0.5 0\nmap_Kd -s 1 1 t.png\n";
    write(f, &[("m.mtl", mtl), ("a.obj", OBJ)]);
    write_bytes(f, "t.png", &png(1, [1, 2, 3]));
    torment(f, "a.obj", OBJ.as_bytes(), &[1, 0x10, 0x80]);
    write(f, &[("a.obj", OBJ)]);
    // The library itself: it may only make the capture fail by the image that it names.
    let input = vec![f.join("a.obj").to_str().unwrap().to_owned()];
    for length in 0..mtl.len() {
        write_bytes(f, "m.mtl", &mtl.as_bytes()[..length]);
        if let Err(error) = import(&input, &ImportOptions::default(), &Job::silent()) {
            assert!(["E_TEXTURE_MISSING", "E_SYNTAX", "E_IMAGE", "E_IO"].contains(&error.code()), "{error}");
        }
    }
}

#[test]
fn ply() {
    let folder = tempfile::tempdir().unwrap();
    let head = |format: &str| {
        format!(
            "ply\nformat {format} 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
             property uchar red\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
        )
    };
    let corners = [[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let faces: [&[i32]; 2] = [&[0, 1, 2], &[3, 2, 1, 0]];
    let text = "0 0 0 9\n1 0 0 9\n1 1 0 9\n0 1 0 9\n3 0 1 2\n4 3 2 1 0\n";
    torment(folder.path(), "a.ply", (head("ascii") + text).as_bytes(), &[1, 0x10, 0x80]);
    for big in [false, true] {
        let mut bytes = head(if big { "binary_big_endian" } else { "binary_little_endian" }).into_bytes();
        for corner in corners {
            for c in corner {
                bytes.extend(if big { c.to_be_bytes() } else { c.to_le_bytes() });
            }
            bytes.push(200);
        }
        for face in faces {
            bytes.push(face.len() as u8);
            for v in face {
                bytes.extend(if big { v.to_be_bytes() } else { v.to_le_bytes() });
            }
        }
        torment(folder.path(), "a.ply", &bytes, &[1, 0x10, 0x80, 0xff]);
    }
}

/// A skinned, morphing, textured, animated triangle.
fn glb() -> Vec<u8> {
    let mut file = Gltf::new();
    let positions = file.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    let uvs = file.floats("VEC2", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    let target = file.floats("VEC3", &[0.1; 9]);
    let view = file.view(&[0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
    let joints = file.push("accessors", json!({"bufferView": view, "componentType": 5121, "count": 3, "type": "VEC4"}));
    let weights = file.floats("VEC4", &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
    let view = file.view(&[0, 0, 1, 0, 2, 0]);
    let indices =
        file.push("accessors", json!({"bufferView": view, "componentType": 5123, "count": 3, "type": "SCALAR"}));
    let image = file.view(&png(1, [5, 6, 7]));
    file.json["images"] = json!([{"bufferView": image}]);
    file.json["textures"] = json!([{"source": 0}]);
    file.json["materials"] = json!([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]);
    file.push(
        "meshes",
        json!({"primitives": [{"attributes": {"POSITION": positions, "TEXCOORD_0": uvs, "JOINTS_0": joints,
            "WEIGHTS_0": weights}, "indices": indices, "material": 0, "targets": [{"POSITION": target}]}]}),
    );
    let joint = file.scene_node(json!({}));
    let body = file.scene_node(json!({"mesh": 0, "skin": 0}));
    file.json["skins"] = json!([{"joints": [joint]}]);
    let turns = file.floats("VEC4", &[0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0]);
    file.clip(Some("turn"), joint, "rotation", "LINEAR", &[0.0, 0.1], turns);
    let smile = file.floats("SCALAR", &[0.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    file.clip(Some("smile"), body, "weights", "CUBICSPLINE", &[0.0, 0.1], smile);
    file.glb()
}

#[test]
fn glb_files() {
    let folder = tempfile::tempdir().unwrap();
    torment(folder.path(), "a.glb", &glb(), &[1, 0x80]);
}

#[test]
fn manifests() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &[("f_1.obj", OBJ), ("f_2.obj", OBJ), ("m.mtl", ""), ("w.txt", "1 1 1 1")]);
    let toml = "name = \"a\"\nfps = 25\nup = \"z\"\nunit = 0.01\nweights = \"w.txt\"\n\
                [[sequence]]\nname = \"b\"\ninput = \"f_%d.obj:1:2:1\"\nlabels = [\"c\"]\ncyclic = true\n";
    torment(folder.path(), "capture.toml", toml.as_bytes(), &[1, 0x10, 0x80]);
}
