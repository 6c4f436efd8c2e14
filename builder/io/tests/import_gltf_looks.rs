//! How glTF files look and how they are packed: materials, textures, wrapping, compression, containers.

#![allow(clippy::unwrap_used, reason = "helpers of tests, too, end a test by panicking")]

mod gltf_support;
mod import_support;

use base64::Engine;
use capture_io::import::Imported;
use glam::Vec3;
use gltf_support::{body, read_glb, read_sample, refuse_glb, standing, uvs, volume, warning};
use import_support::{Gltf, png, read_plain, refusal, write, write_bytes};
use serde_json::{Value, json};

/// The body with texture coordinates, two images (0 red, 1 blue) as textures 0 and 1, and the material `material`.
fn dressed(material: Value) -> Gltf {
    let mut file = standing();
    let coordinates = file.floats("VEC2", uvs(0.01, 0.99).as_flattened());
    let views = [[200, 0, 0], [0, 0, 200]].map(|colour| file.view(&png(4, colour)));
    file.json["images"] = json!(views.map(|view| json!({"bufferView": view, "mimeType": "image/png"})));
    file.json["textures"] = json!([{"source": 0}, {"source": 1}]);
    file.json["materials"] = json!([material]);
    let primitive = &mut file.json["meshes"][0]["primitives"][0];
    primitive["attributes"]["TEXCOORD_0"] = json!(coordinates);
    primitive["material"] = json!(0);
    file
}

/// What the one material looks like: its colour, and the colour of its texture.
fn look(imported: &Imported) -> ([f32; 4], Option<[u8; 3]>) {
    let surface = &imported.capture.surface;
    let material = &surface.materials[0];
    let pixel = material.image.map(|image| {
        let image = image::load_from_memory(&surface.images[image as usize].bytes).unwrap().to_rgb8();
        image.get_pixel(1, 1).0
    });
    (material.base_colour, pixel)
}

const RED: Option<[u8; 3]> = Some([200, 0, 0]);
const BLUE: Option<[u8; 3]> = Some([0, 0, 200]);
const WHITE: [f32; 4] = [1.0; 4];

/// A material, the colour and the texture that stand for it, and the code of what is said about it.
type Case = (Value, [f32; 4], Option<[u8; 3]>, Option<&'static str>);

#[test]
fn every_kind_of_material_gives_its_colours() {
    let older = |inner: Value| json!({"extensions": {"KHR_materials_pbrSpecularGlossiness": inner}});
    let red = json!({"baseColorTexture": {"index": 0}});
    let black = json!({"baseColorFactor": [0, 0, 0, 1]});
    let glow = |surface: &Value, strength: f32| {
        json!({"pbrMetallicRoughness": surface, "emissiveTexture": {"index": 1}, "emissiveFactor": [1, 0.5, 0.25],
            "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": strength}}})
    };
    let mut both = older(json!({"diffuseFactor": [0.5, 0.5, 0.5, 1]}));
    both["pbrMetallicRoughness"] = red.clone();
    let mut bright = older(json!({"diffuseTexture": {"index": 1}}));
    bright["pbrMetallicRoughness"] = red.clone();
    let cases: [Case; 12] = [
        (json!({"pbrMetallicRoughness": red}), WHITE, RED, None),
        (json!({"pbrMetallicRoughness": red, "extensions": {"KHR_materials_unlit": {}}}), WHITE, RED, None),
        (older(json!({"diffuseTexture": {"index": 1}, "diffuseFactor": [1, 1, 1, 1]})), WHITE, BLUE, None),
        (older(json!({"diffuseFactor": [0.25, 0.5, 0.75, 1]})), [0.25, 0.5, 0.75, 1.0], None, None),
        (both, WHITE, RED, None),
        (bright, WHITE, BLUE, None),
        (glow(&black, 1.0), [1.0, 0.5, 0.25, 1.0], BLUE, None),
        (glow(&black, 4.0), [1.0, 0.5, 0.25, 1.0], BLUE, None),
        (glow(&json!({}), 1.0), [1.0, 0.5, 0.25, 1.0], BLUE, Some("W_GLTF_GLOW")),
        (glow(&red, 1.0), WHITE, RED, Some("W_GLTF_GLOW")),
        (json!({"pbrMetallicRoughness": black, "emissiveFactor": [0.5, 0.5, 0]}), [0.5, 0.5, 0.0, 1.0], None, None),
        (json!({"pbrMetallicRoughness": red, "alphaMode": "BLEND"}), WHITE, RED, Some("W_GLTF_ALPHA")),
    ];
    for (material, factor, pixel, said) in cases {
        let imported = read_glb(&dressed(material.clone()), 10.0);
        assert_eq!(look(&imported), (factor, pixel), "{material}");
        let codes: Vec<_> = imported.warnings.iter().map(|warning| warning.code).collect();
        assert_eq!(codes, said.into_iter().collect::<Vec<_>>(), "{material}");
    }
    let (code, message) = refuse_glb(&dressed(older(json!({"diffuseFactor": [1, 1]}))));
    assert!(code == "E_GLTF" && message.contains("diffuseFactor"), "{message}");
}

#[test]
fn extensions_that_are_not_read_are_named() {
    let plain = json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}});
    for name in ["VENDOR_strange", "KHR_materials_unheard_of", "EXT_mesh_gpu_instancing", "MSFT_texture_dds"] {
        let mut file = dressed(plain.clone());
        file.json["extensionsUsed"] = json!([name, "KHR_materials_clearcoat", "KHR_lights_punctual"]);
        let said = read_glb(&file, 10.0);
        let said = warning(&said, "W_GLTF_EXTENSION");
        assert!(said.contains(name) && !said.contains("clearcoat"), "{said}");
        file.json["extensionsRequired"] = json!([name]);
        let (code, message) = refuse_glb(&file);
        assert!(code == "E_GLTF_EXTENSION" && message.contains(name), "{message}");
    }
    // What is read may be required; glass is drawn, and said.
    for name in
        ["KHR_materials_pbrSpecularGlossiness", "KHR_materials_unlit", "KHR_texture_basisu", "KHR_mesh_quantization"]
    {
        let mut file = dressed(plain.clone());
        file.json["extensionsUsed"] = json!([name]);
        file.json["extensionsRequired"] = json!([name]);
        assert!(read_glb(&file, 10.0).warnings.is_empty());
    }
    let mut file = dressed(plain.clone());
    file.json["extensionsUsed"] = json!(["KHR_materials_transmission"]);
    assert!(warning(&read_glb(&file, 10.0), "W_GLTF_LOOKS").contains("transmission"));
    // A texture that only an unread extension fills.
    file.json["extensionsUsed"] = json!(["MSFT_texture_dds"]);
    file.json["textures"][0] = json!({"extensions": {"MSFT_texture_dds": {"source": 0}}});
    let imported = read_glb(&file, 10.0);
    assert!(warning(&imported, "W_GLTF_TEXTURE").contains("texture 0"));
    assert_eq!(look(&imported).1, None);
    // A texture without coordinates.
    let mut file = dressed(plain);
    file.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = json!(1);
    assert!(warning(&read_glb(&file, 10.0), "W_NO_UV").contains("mesh 0, primitive 0"));
}

/// Texture coordinates of the drawn corners, by where they are: file vertex of the body.
fn coordinates(imported: &Imported) -> Vec<(usize, [f32; 2])> {
    let corners = &imported.capture.surface.corners;
    corners.iter().map(|corner| (corner.vertex as usize, corner.uv)).collect()
}

#[test]
fn texture_transforms_are_written_into_the_coordinates() {
    let transform = json!({"offset": [0.25, -0.5], "rotation": 0.5, "scale": [2.0, -1.0]});
    let info = json!({"index": 0, "extensions": {"KHR_texture_transform": transform}});
    for material in [
        json!({"pbrMetallicRoughness": {"baseColorTexture": info}}),
        json!({"extensions": {"KHR_materials_pbrSpecularGlossiness": {"diffuseTexture": info}}}),
        json!({"pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1]}, "emissiveFactor": [1, 1, 1], "emissiveTexture": info}),
    ] {
        let imported = read_glb(&dressed(material), 10.0);
        assert!(imported.warnings.is_empty(), "{:?}", imported.warnings);
        let given = uvs(0.01, 0.99);
        // The matrix of the extension's text: translation times rotation times scale.
        let (sin, cos) = 0.5_f32.sin_cos();
        for (vertex, found) in coordinates(&imported) {
            let [u, v] = [2.0 * given[vertex][0], -given[vertex][1]];
            let expected = [cos * u + sin * v + 0.25, -sin * u + cos * v - 0.5];
            assert!((0..2).all(|k| (found[k] - expected[k]).abs() < 1e-5), "{found:?} {expected:?}");
        }
    }
}

#[test]
fn wrapping_is_written_into_the_coordinates_or_said() {
    let textured = json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}});
    let with = |wrap: u32, low: f32, high: f32| {
        let mut file = dressed(textured.clone());
        file.json["samplers"] = json!([{"wrapS": wrap, "wrapT": 10497}]);
        file.json["textures"][0]["sampler"] = json!(0);
        let coordinates = file.floats("VEC2", uvs(low, high).as_flattened());
        file.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = json!(coordinates);
        read_glb(&file, 10.0)
    };
    let (clamp, mirror, repeat) = (33071, 33648, 10497);
    for (wrap, low, high, said) in [
        (repeat, -0.4, 1.6, false),
        (clamp, 0.0, 1.0, false),
        (clamp, -0.09, 1.09, true),
        (clamp, 1.5, 1.9, false),
        (mirror, 0.1, 0.9, false),
        (mirror, 1.1, 1.9, false),
        (mirror, -0.9, -0.1, false),
        (mirror, -0.09, 1.09, true),
    ] {
        let imported = with(wrap, low, high);
        assert_eq!(imported.warnings.iter().any(|w| w.code == "W_GLTF_WRAP"), said, "{wrap} {low}..{high}");
        if said || wrap == repeat {
            continue;
        }
        let given = uvs(low, high);
        for (vertex, found) in coordinates(&imported) {
            let u = given[vertex][0];
            let expected = if wrap == clamp { u.clamp(0.0, 1.0) } else { 1.0 - (u.rem_euclid(2.0) - 1.0).abs() };
            // Half a pixel of the 4 that the texture has: the border's colour without what repeats beside it.
            assert!((found[0] - expected).abs() < 0.1251, "{wrap}: {u} became {}", found[0]);
            assert!(wrap == clamp || (found[0] - expected).abs() < 1e-5);
        }
    }
}

/// The vertices of `found` lie on those of `expected`, in every frame and to within `tolerance` metres.
fn same_motion(found: &Imported, expected: &Imported, tolerance: f32) {
    assert_eq!(found.capture.timeline, expected.capture.timeline);
    let (a, b) = (&found.capture.topology, &expected.capture.topology);
    assert_eq!((a.vertex_count(), a.triangles().len()), (b.vertex_count(), b.triangles().len()));
    let nearest = |p: Vec3, pose: &[Vec3]| pose.iter().map(|q| p.distance(*q)).fold(f32::INFINITY, f32::min);
    for k in 0..expected.capture.timeline.frame_count() {
        let (found, expected) = (found.capture.poses.frame(k), expected.capture.poses.frame(k));
        for &p in expected {
            assert!(nearest(p, found) < tolerance, "frame {k}: {p} is {} away", nearest(p, found));
        }
        assert!((volume(found, a.triangles()) - volume(expected, b.triangles())).abs() < 3.0 * tolerance);
    }
}

#[test]
fn compressed_files_are_those_that_were_compressed() {
    let body = read_sample("body.glb");
    let plain = read_sample("plain.glb");
    assert_eq!((body.capture.timeline.frame_count(), body.capture.topology.vertex_count()), (7, 66));
    // 1.7 m in 2^14 steps are 0.1 mm each; the encoders name no more bits.
    for (name, original) in [
        ("body-draco.glb", &body),
        ("body-meshopt.glb", &body),
        ("plain-draco.glb", &plain),
        ("plain-meshopt-medium.glb", &plain),
    ] {
        let found = read_sample(name);
        assert!(found.warnings.is_empty(), "{name}: {:?}", found.warnings);
        same_motion(&found, original, 1.2e-3);
        let worst = |k: u32| {
            let (found, expected) = (found.capture.poses.frame(k), original.capture.poses.frame(k));
            let nearest = |p: &Vec3| found.iter().map(|q| p.distance(*q)).fold(f32::INFINITY, f32::min);
            expected.iter().map(nearest).fold(0.0, f32::max)
        };
        assert!(worst(0) < 2e-4, "{name}: {} m at rest", worst(0));
        let uv = |imported: &Imported| {
            let mut all: Vec<[i32; 2]> =
                coordinates(imported).iter().map(|(_, uv)| uv.map(|c| (c * 200.0).round() as i32)).collect();
            all.sort_unstable();
            all
        };
        let (a, b) = (uv(&found), uv(original));
        assert_eq!(a.len(), b.len());
        assert!(a.iter().zip(&b).all(|(a, b)| (a[0] - b[0]).abs() <= 1), "{name}");
        assert_eq!(found.capture.surface.images, original.capture.surface.images);
    }
}

#[test]
fn basis_universal_textures_are_pictures() {
    let plain = read_sample("plain.glb");
    let picture = |imported: &Imported| {
        let surface = &imported.capture.surface;
        image::load_from_memory(&surface.images[surface.materials[0].image.unwrap() as usize].bytes).unwrap().to_rgb8()
    };
    let expected = picture(&plain);
    for (name, tolerance) in [("plain-etc1s.glb", 16.0), ("plain-uastc.glb", 2.0)] {
        let found = read_sample(name);
        assert!(found.warnings.is_empty(), "{name}: {:?}", found.warnings);
        assert_eq!(found.capture.poses, plain.capture.poses);
        let found = picture(&found);
        assert_eq!(found.dimensions(), expected.dimensions());
        let error: f64 = found.as_raw().iter().zip(expected.as_raw()).map(|(&a, &b)| f64::from(a.abs_diff(b))).sum();
        assert!(error / (expected.as_raw().len() as f64) < tolerance, "{name}: {error}");
    }
}

#[test]
fn damaged_compression_names_its_place() {
    let folder = std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/gltf"));
    let scratch = tempfile::tempdir().unwrap();
    for (name, place) in
        [("plain-draco.glb", "mesh 0, primitive 0"), ("body-meshopt.glb", "buffer view"), ("plain-uastc.glb", "KTX2")]
    {
        let bytes = std::fs::read(folder.join(name)).unwrap();
        let start = 20 + u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize + 8;
        let (mut refused, mut named) = (0, 0);
        for at in (start..bytes.len()).step_by(7) {
            let mut damaged = bytes.clone();
            damaged[at] ^= 0xff;
            write_bytes(scratch.path(), name, &damaged);
            let options = capture_io::import::ImportOptions::default();
            if let Err(error) = import_support::try_read(scratch.path(), &[name], &options) {
                refused += 1;
                named += usize::from(error.to_string().contains(place));
            }
        }
        assert!(refused > 0 && named > 0, "{name}: {refused} refused, {named} of them with \"{place}\"");
    }
}

#[test]
fn containers_are_read_as_exporters_write_them() {
    let file = standing();
    let folder = tempfile::tempdir().unwrap();
    write_bytes(folder.path(), "good.glb", &file.glb());
    let good = read_plain(folder.path(), &["good.glb"]).capture;
    let same = |name: &str| assert_eq!(read_plain(folder.path(), &[name]).capture.poses, good.poses, "{name}");

    // Zeros where the JSON chunk should be filled with spaces; a chunk of another kind; bytes behind the last chunk.
    let bytes = file.glb();
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let (json, rest) = (&bytes[20..20 + length], &bytes[20 + length..]);
    let glb = |json: &[u8], middle: &[u8], end: &[u8]| {
        let mut glb = b"glTF\x02\0\0\0".to_vec();
        let total = 20 + json.len() + middle.len() + rest.len();
        glb.extend((total as u32).to_le_bytes());
        glb.extend((json.len() as u32).to_le_bytes());
        glb.extend(b"JSON");
        [json, middle, rest, end].iter().for_each(|part| glb.extend_from_slice(part));
        glb
    };
    let mut zeros = json.trim_ascii_end().to_vec();
    zeros.resize(zeros.len().next_multiple_of(4) + 4, 0);
    write_bytes(folder.path(), "zeros.glb", &glb(&zeros, b"", b""));
    write_bytes(folder.path(), "chunks.glb", &glb(json, b"\x04\0\0\0XXXXabcd", b""));
    write_bytes(folder.path(), "behind.glb", &glb(json, b"", b"\0\0\0"));
    ["zeros.glb", "chunks.glb", "behind.glb"].into_iter().for_each(same);

    let mut bin = file.bin.clone();
    // 1 more than a multiple of 3, so that the text needs two "=".
    bin.resize(bin.len().next_multiple_of(3) + 1, 0);
    let text = base64::engine::general_purpose::STANDARD.encode(&bin);
    assert!(text.ends_with("=="));
    let wrapped: String = text.as_bytes().chunks(76).map(|line| String::from_utf8_lossy(line) + "\\r\\n").collect();
    for (name, uri) in [
        ("padded.gltf", format!("data:application/octet-stream;base64,{text}")),
        ("bare.gltf", format!("data:application/gltf-buffer;base64,{}", text.trim_end_matches('='))),
        ("wrapped.gltf", format!("data:;base64,{wrapped}")),
        ("letters.gltf", format!("DATA:application/octet-stream;base64,{}", text.replace('+', "-").replace('/', "_"))),
    ] {
        let json = file.gltf("URI").replace("URI", &uri);
        write(folder.path(), &[(name, &json)]);
        same(name);
        write(folder.path(), &[(name, &format!("\u{feff}{json}\0\0"))]);
        same(name);
    }
    // A file whose name has a percent sign in it.
    write(folder.path(), &[("percent.gltf", &file.gltf("a%20b.bin"))]);
    write_bytes(folder.path(), "a%20b.bin", &file.bin);
    same("percent.gltf");

    write_bytes(folder.path(), "one.glb", b"glTF\x01\0\0\0\x14\0\0\0\0\0\0\0\0\0\0\0");
    assert!(refusal(folder.path(), &["one.glb"]).1.contains("GLB version 1"));
    write_bytes(folder.path(), "empty.glb", b"glTF\x02\0\0\0\x0c\0\0\0");
    assert!(refusal(folder.path(), &["empty.glb"]).1.contains("no JSON chunk"));
    assert_eq!(body().0.len(), good.vertex_of_file_vertex.len());
}
