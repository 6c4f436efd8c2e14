//! Files as other programs and other machines write them: relatives of the cases that were reported, small enough to be
//! written here. Nothing is silently wrong: what is not read is told.

#![allow(clippy::unwrap_used, reason = "helpers of tests, too, end a test by panicking")]

mod import_support;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use capture_io::import::{Cyclic, ImportOptions, Imported};
use glam::DVec3;
use import_support::{Gltf, png, read, read_plain, refusal, write, write_bytes};
use serde_json::json;

/// A tetrahedron with texture coordinates, `frame` moved upwards.
fn obj(frame: usize) -> String {
    let y = frame as f32 * 0.25;
    format!(
        "v 0 {y} 0\nv 1 {y} 0\nv 0 {} 0\nv 0 {y} 1\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 3/3 2/2\nf 1/1 2/2 4/3\nf 2/2 3/3 4/1\nf 3/3 1/1 4/2\n",
        y + 1.0
    )
}

fn codes(imported: &Imported) -> Vec<&str> {
    imported.warnings.iter().map(|warning| warning.code).collect()
}

fn names(imported: &Imported) -> Vec<(&str, u32)> {
    imported.capture.timeline.sequences().iter().map(|s| (s.name.as_str(), s.frame_count)).collect()
}

fn heights(imported: &Imported) -> Vec<f32> {
    imported.capture.poses.iter().map(|pose| pose[0].y).collect()
}

fn worn(imported: &Imported) -> Vec<String> {
    let textures = imported.frame_textures.as_ref().unwrap_or_else(|| panic!("{:?}", imported.warnings));
    textures.iter().map(|path| path.file_name().unwrap().to_str().unwrap().to_owned()).collect()
}

#[test]
fn every_text_reader_takes_marks_and_line_ends() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    let mesh = format!("mtllib m.mtl\nusemtl a\n{}", obj(0));
    let library = "newmtl a\nmap_Kd t.png\n";
    let manifest = "fps = 25\nweights = \"w.txt\"\n[[sequence]]\ninput = \"a.obj\"\n";
    write_bytes(f, "t.png", &png(1, [1, 2, 3]));
    let expected = {
        write(f, &[("a.obj", &mesh), ("m.mtl", library), ("w.txt", "1 2 3 4"), ("capture.toml", manifest)]);
        read(f, &["capture.toml"], &ImportOptions::default())
    };
    assert_eq!(expected.capture.surface.images.len(), 1);
    let wide = |text: &str| {
        "\u{feff}".chars().chain(text.chars()).collect::<String>().encode_utf16().flat_map(u16::to_le_bytes).collect()
    };
    type Way<'a> = &'a dyn Fn(&str) -> Vec<u8>;
    let ways: [Way; 5] = [
        &|text| format!("\u{feff}{text}").into_bytes(),
        &|text| text.replace('\n', "\r").into_bytes(),
        &|text| text.replace('\n', "\r\n").into_bytes(),
        &|text| format!("\u{feff}{}", text.replace('\n', "\r")).into_bytes(),
        &wide,
    ];
    for (k, way) in ways.iter().enumerate() {
        for (name, text) in
            [("a.obj", mesh.as_str()), ("m.mtl", library), ("w.txt", "1 2 # two\n3 4"), ("capture.toml", manifest)]
        {
            write_bytes(f, name, &way(text));
        }
        assert_eq!(read(f, &["capture.toml"], &ImportOptions::default()), expected, "way {k}");
    }
}

#[test]
fn a_texture_of_another_machine_is_looked_for_beside() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    write(f, &[("a.obj", &format!("mtllib D:\\models\\Skin.MTL\nusemtl skin # the only one\n{}", obj(0)))]);
    write(f, &[("skin.mtl", "newmtl skin\nmap_Kd \\\\server\\share\\Haut.PNG\n")]);
    write_bytes(f, "haut.png", &png(1, [9, 8, 7]));
    let imported = read_plain(f, &["a.obj"]);
    assert_eq!(imported.capture.surface.images[0].bytes, png(1, [9, 8, 7]));
    assert_eq!(codes(&imported), ["W_FILE_MOVED"]);
    // Lost altogether: an error, unless another one is named.
    std::fs::rename(f.join("haut.png"), f.join("other.png")).unwrap();
    let (code, message) = refusal(f, &["a.obj"]);
    assert!(code == "E_TEXTURE_MISSING" && message.contains("a.obj") && message.contains("Haut.PNG"), "{message}");
    let texture = Some(f.join("other.png").to_str().unwrap().to_owned());
    let imported = read(f, &["a.obj"], &ImportOptions { texture, fps: Some(25.0), ..ImportOptions::default() });
    assert_eq!(imported.capture.surface.images[0].bytes, png(1, [9, 8, 7]));
}

#[test]
fn materials_that_are_lost_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    write(f, &[("a.obj", &format!("usemtl skin\n{}", obj(0)))]);
    assert_eq!(codes(&read_plain(f, &["a.obj"])), ["W_MATERIAL_MISSING"], "no library is named");
    write(f, &[("a.obj", &format!("mtllib m.mtl\nusemtl skin\n{}", obj(0))), ("m.mtl", "newmtl other\n")]);
    assert_eq!(codes(&read_plain(f, &["a.obj"])), ["W_MATERIAL_MISSING"], "the library lacks the name");
    // With a texture beside, nothing is lost.
    write(f, &[("b/a.obj", &format!("usemtl skin\n{}", obj(0)))]);
    write_bytes(f, "b/a.png", &png(1, [1; 3]));
    assert_eq!(codes(&read_plain(f, &["b/a.obj"])), Vec::<&str>::new());
}

#[test]
fn materials_that_change_beside_the_texture_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    for k in 0..3 {
        let text = obj(k).replacen("f 2/2", "usemtl eyes\nf 2/2", 1);
        write(f, &[(&format!("w/f{k}.obj"), &format!("mtllib all.mtl\nusemtl skin{k}\n{text}"))]);
        write_bytes(f, &format!("w/t{k}.png"), &png(1, [k as u8; 3]));
    }
    write_bytes(f, "w/eyes.png", &png(1, [200; 3]));
    let mut library = "newmtl eyes\nmap_Kd eyes.png\n".to_owned();
    (0..3).for_each(|k| writeln!(library, "newmtl skin{k}\nmap_Kd t{k}.png").unwrap());
    write(f, &[("w/all.mtl", &library)]);
    let same = read_plain(f, &["w"]);
    assert_eq!((worn(&same), codes(&same)), (vec!["t0.png".into(), "t1.png".into(), "t2.png".into()], vec![]));
    assert_eq!(same.capture.surface.images.len(), 2);
    // The eyes change, too, which is not followed.
    let text = std::fs::read_to_string(f.join("w/f1.obj")).unwrap();
    write(f, &[("w/f1.obj", &text.replace("usemtl eyes", "usemtl skin2"))]);
    let changed = read_plain(f, &["w"]);
    assert_eq!(codes(&changed), ["W_MATERIALS_DIFFER"]);
    assert!(changed.warnings[0].contains("f1.obj"), "{:?}", changed.warnings);
}

#[test]
fn textures_are_moved_as_their_statements_say() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    write(
        f,
        &[
            ("a.obj", &format!("mtllib m.mtl\nusemtl a\n{}", obj(0))),
            ("m.mtl", "newmtl a\nmap_Kd -s 2 3 -o 0.5 0 t.png\n"),
        ],
    );
    write_bytes(f, "t.png", &png(1, [1; 3]));
    let uvs: Vec<[f32; 2]> = read_plain(f, &["a.obj"]).capture.surface.corners.iter().map(|c| c.uv).collect();
    // (0, 0), (0, 1) and (1, 0) upwards.
    for uv in [[0.5, 1.0], [0.5, -2.0], [2.5, 1.0]] {
        assert!(uvs.contains(&uv), "{uvs:?}");
    }
}

#[test]
fn numbers_are_found_wherever_names_hold_them() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    for k in 1..=12 {
        let text = obj(k);
        let files = [
            format!("a/walk ({k}).obj"),
            format!("b/walk_{k:04}_x.obj"),
            format!("c/{k}.obj"),
            format!("d [x]/f[{k}].obj"),
            format!("e/frame_{k:03}/mesh.obj"),
            format!("g/take2_v3_{k}_final.obj"),
        ];
        files.iter().for_each(|name| write(f, &[(name, &text)]));
    }
    let rising: Vec<f32> = (1..=12).map(|k| 0.25 * k as f32).collect();
    for (input, name) in [
        ("a", "a"),
        ("a/*.obj", "walk"),
        ("b", "b"),
        ("b/walk*", "walk_x"),
        ("c", "c"),
        ("d [x]", "d [x]"),
        ("d [x]/f[*].obj", "d [x]"),
        ("d [x]/f[%d].obj", "d [x]"),
        ("d [x]/f[%d].obj:1:12", "d [x]"),
        ("e", "e"),
        ("e/*/mesh.obj", "e"),
        ("e/frame_%03d/mesh.obj:1:12", "e"),
        ("g", "g"),
        ("g/*", "take2_v3_final"),
    ] {
        let imported = read_plain(f, &[input]);
        assert_eq!((names(&imported), heights(&imported)), (vec![(name, 12)], rising.clone()), "{input}");
    }
    assert_eq!(codes(&read_plain(f, &["e"])), ["W_FOLDERS_JOINED"]);
}

#[test]
fn what_would_become_single_frames_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    for (k, name) in ["crouch", "jump", "stand", "turn"].iter().enumerate() {
        write(f, &[(&format!("poses/{name}.obj"), &obj(k))]);
    }
    let imported = read_plain(f, &["poses"]);
    assert_eq!(names(&imported).len(), 4);
    assert!(imported.warnings.iter().any(|w| w.code == "W_SINGLE_FRAMES" && w.contains("crouch.obj")));
    write(f, &[("doubles/f1.obj", &obj(0)), ("doubles/f01.obj", &obj(1)), ("doubles/f2.obj", &obj(2))]);
    assert!(codes(&read_plain(f, &["doubles"])).contains(&"W_FRAMES_DOUBLE"));
}

#[test]
fn what_a_folder_holds_beside_its_frames_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    (0..3).for_each(|k| write(f, &[(&format!("c/f{k}.obj"), &obj(k)), (&format!("c/run/f{k}.obj"), &obj(k))]));
    write(f, &[("c/notes/readme.txt", "")]);
    let imported = read_plain(f, &["c"]);
    assert!(
        imported.warnings.iter().any(|w| w.code == "W_INPUT_LEFT_OUT" && w.contains("run")),
        "{:?}",
        imported.warnings
    );
    // A manifest within a part of an input is not read, and told.
    write(f, &[("d/walk/f0.obj", &obj(0)), ("d/walk/f1.obj", &obj(1)), ("d/walk/capture.toml", "unit = 0.01")]);
    let imported = read_plain(f, &["d"]);
    assert!(codes(&imported).contains(&"W_MANIFEST_UNREAD"), "{:?}", imported.warnings);
}

#[test]
fn actors_of_several_folders_are_named_after_what_holds_them() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    (0..3)
        .for_each(|k| write(f, &[(&format!("anna/walk/f{k}.obj"), &obj(k)), (&format!("anna/run/f{k}.obj"), &obj(k))]));
    for inputs in [&["anna/walk", "anna/run"][..], &["anna/*/f*.obj"], &["anna"], &["anna/walk/f%d.obj", "anna/run"]] {
        assert_eq!(read_plain(f, inputs).capture.name, "anna", "{inputs:?}");
    }
    assert_eq!(read_plain(f, &["anna/walk"]).capture.name, "walk");
    write(f, &[("anna/capture.toml", "[[sequence]]\ninput = \"walk\"\n")]);
    assert_eq!(read_plain(f, &["anna/capture.toml"]).capture.name, "anna");
}

#[test]
fn textures_are_paired_by_number_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    (1..=4).for_each(|k| write(f, &[(&format!("m/f{k}.obj"), &obj(k))]));
    let with = |numbers: &[i32], texture: &str| {
        let _ = std::fs::remove_dir_all(f.join("t"));
        numbers.iter().for_each(|n| write_bytes(f, &format!("t/s{n}.png"), &png(1, [*n as u8; 3])));
        write(f, &[("c.toml", &format!("fps = 25\n[[sequence]]\ninput = \"m\"\ntexture = \"{texture}\"\n"))]);
    };
    let read = || read(f, &["c.toml"], &ImportOptions::default());
    with(&[1, 2, 3, 4], "t");
    assert_eq!(
        (worn(&read()), codes(&read())),
        (["s1", "s2", "s3", "s4"].map(|n| format!("{n}.png")).to_vec(), vec![])
    );
    // One more than frames, one less than frames.
    with(&[1, 2, 3, 4, 5], "t/*.png");
    assert_eq!((worn(&read()).len(), codes(&read())), (4, vec!["W_TEXTURES_UNUSED"]));
    with(&[2, 3, 4], "t/s%d.png");
    assert_eq!(worn(&read()), ["s2", "s2", "s3", "s4"].map(|n| format!("{n}.png")));
    assert_eq!(codes(&read()), ["W_TEXTURE_LOST"]);
    // Numbers that begin elsewhere may be meant in order or not.
    with(&[0, 1, 2, 3], "t");
    let (code, message) = refusal(f, &["c.toml"]);
    assert!(code == "E_TEXTURE_PAIRING" && message.contains("0 to 3") && message.contains("1 to 4"), "{message}");
    with(&[10, 11], "t");
    assert_eq!(refusal(f, &["c.toml"]).0, "E_TEXTURE_PAIRING");
    // A range says so.
    with(&[0, 1, 2, 3], "t/s%d.png:0:3");
    assert_eq!(worn(&read()), ["s0", "s1", "s2", "s3"].map(|n| format!("{n}.png")));
    assert_eq!(codes(&read()), ["W_TEXTURES_IN_ORDER"]);
    with(&[0, 1, 2], "t/s%d.png:0:2");
    assert_eq!(refusal(f, &["c.toml"]).0, "E_TEXTURE_COUNT");
    // Names without an order.
    with(&[], "t");
    ["a", "b", "c", "d"].iter().for_each(|n| write_bytes(f, &format!("t/{n}.png"), &png(1, [1; 3])));
    assert_eq!(refusal(f, &["c.toml"]).0, "E_TEXTURE_PAIRING");
}

#[test]
fn images_that_pair_with_no_frame_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    (0..4).for_each(|k| write(f, &[(&format!("w/f{k}.obj"), &obj(k))]));
    write_bytes(f, "w/front.png", &png(1, [1; 3]));
    write_bytes(f, "w/side.png", &png(1, [2; 3]));
    assert_eq!(codes(&read_plain(f, &["w"])), ["W_TEXTURES_UNPAIRED"]);
    // Runs of masks are no textures; one run of others is a guess.
    (0..4).for_each(|k| write_bytes(f, &format!("w/mask_{k}.png"), &png(1, [3; 3])));
    assert_eq!(codes(&read_plain(f, &["w"])), ["W_TEXTURES_UNPAIRED"]);
    (0..4).for_each(|k| write_bytes(f, &format!("w/tex_{k}.png"), &png(1, [k; 3])));
    let guessed = read_plain(f, &["w"]);
    assert_eq!((worn(&guessed)[3].as_str(), codes(&guessed)), ("tex_3.png", vec!["W_TEXTURES_GUESSED"]));
    // A folder a frame, with its own image.
    for k in 0..3 {
        write(f, &[(&format!("o/f_{k}/mesh.obj"), &obj(k))]);
        write_bytes(f, &format!("o/f_{k}/texture.png"), &png(1, [k as u8; 3]));
    }
    let own = read_plain(f, &["o"]).frame_textures.unwrap();
    assert_eq!(own, [0, 1, 2].map(|k| f.join(format!("o/f_{k}/texture.png"))));
}

#[test]
fn a_glb_a_frame_is_a_sequence_and_keeps_its_textures() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    let glb = |k: u8, colour: u8| {
        let mut file = Gltf::new();
        let y = f32::from(k) * 0.25;
        let positions = file.floats("VEC3", &[0.0, y, 0.0, 1.0, y, 0.0, 0.0, y + 1.0, 0.0, 0.0, y, 1.0]);
        let uvs = file.floats("VEC2", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
        let view = file.view(&[0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2]);
        let indices =
            file.push("accessors", json!({"bufferView": view, "componentType": 5121, "count": 12, "type": "SCALAR"}));
        let image = file.view(&png(2, [colour; 3]));
        file.json["images"] = json!([{"bufferView": image, "mimeType": "image/png"}]);
        file.json["textures"] = json!([{"source": 0}]);
        file.json["materials"] = json!([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]);
        file.push("meshes", json!({"primitives": [{"attributes": {"POSITION": positions, "TEXCOORD_0": uvs}, "indices": indices, "material": 0}]}));
        file.scene_node(json!({"mesh": 0}));
        file.glb()
    };
    for k in 0..6 {
        write_bytes(f, &format!("same/f{k}.glb"), &glb(k, 7));
        write_bytes(f, &format!("each/f{k}.glb"), &glb(k, if k == 3 { 0 } else { k }));
    }
    let rising: Vec<f32> = (0..6).map(|k| 0.25 * k as f32).collect();
    let same = read_plain(f, &["same"]);
    assert_eq!((names(&same), heights(&same), &same.frame_textures), (vec![("same", 6)], rising.clone(), &None));
    let each = read_plain(f, &["each/f%d.glb"]);
    assert_eq!((names(&each), heights(&each)), (vec![("each", 6)], rising));
    let paths = each.frame_textures.clone().unwrap();
    for (k, path) in paths.iter().enumerate() {
        assert_eq!(std::fs::read(path).unwrap(), png(2, [if k == 3 { 0 } else { k as u8 }; 3]), "{k}");
    }
    // They last as long as the import is held.
    drop(each);
    assert!(paths.iter().all(|path| !path.exists()));
    write_bytes(f, "each/f4.glb", &{
        let mut other = glb(4, 4);
        other.truncate(other.len() / 2);
        other
    });
    assert_eq!(refusal(f, &["each"]).0, "E_TRUNCATED");
}

#[test]
fn formats_that_are_not_read_are_named_with_a_way_to_go() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    for (ending, said) in [
        ("uvol", "version 2"),
        ("abc", "Alembic"),
        ("usdz", "USD"),
        ("fbx", "FBX2glTF"),
        ("4ds", "4DViews"),
        ("mp4", "ffmpeg"),
        ("stl", "Blender"),
        ("zip", "unpack"),
        ("ktx2", "ktx extract"),
    ] {
        for k in 0..2 {
            write(f, &[(&format!("{ending}/f{k}.{ending}"), "x")]);
        }
        for input in [format!("{ending}/f0.{ending}"), format!("{ending}/*.{ending}"), format!("{ending}/f%d.{ending}")]
        {
            let (code, message) = refusal(f, &[&input]);
            assert!(code == "E_FORMAT_UNKNOWN" && message.contains(said), "{input}: {message}");
        }
        let (code, message) = refusal(f, &[ending]);
        let is_image = ending == "ktx2";
        assert!(if is_image { code == "E_FOLDER_EMPTY" } else { message.contains(said) }, "{ending}: {message}");
    }
    // As textures, too.
    write(f, &[("m/a.obj", &obj(0)), ("c.toml", "[[sequence]]\ninput = \"m\"\ntexture = \"ktx2\"\n")]);
    let (code, message) = refusal(f, &["c.toml"]);
    assert!(code == "E_FORMAT_UNKNOWN" && message.contains("ktx extract"), "{message}");
    // Under another name.
    write(f, &[("x/a.obj", "glTF...."), ("x/b.obj", "version https://git-lfs.github.com/spec/v1\n")]);
    assert!(refusal(f, &["x/a.obj"]).1.contains("GLB"), "{}", refusal(f, &["x/a.obj"]).1);
    assert!(refusal(f, &["x/b.obj"]).1.contains("git lfs pull"));
    // No file matches, but one almost does.
    write(f, &[("y/A.OBJ", &obj(0))]);
    let (code, message) = refusal(f, &["y/*.obj"]);
    assert!(code == "E_NO_MATCH" && message.contains("A.OBJ almost does"), "{message}");
    assert_eq!(refusal(f, &["y/*.ply"]).1, format!("{}: no file matches", f.join("y/*.ply").display()));
}

#[test]
fn a_mesh_that_changes_is_told_with_its_frames() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    let other = |k: usize| obj(k).replacen("f 2/2 3/3 4/1\n", "", 1);
    (0..12)
        .for_each(|k| write(f, &[(&format!("parts/f{k}.obj"), &if (4..8).contains(&k) { other(k) } else { obj(k) })]));
    let (code, message) = refusal(f, &["parts"]);
    assert!(code == "E_FACE_LIST" && message.contains("frame 4") && message.contains("face 2 differs"), "{message}");
    assert!(message.contains("the mesh changes at frame 4, 8, and 8 of 12 frames have that of the first"), "{message}");
    (0..12).for_each(|k| write(f, &[(&format!("raw/f{k}.obj"), &(obj(k) + &"v 0 0 0\n".repeat(k)))]));
    let (code, message) = refusal(f, &["raw"]);
    assert!(code == "E_VERTEX_COUNT" && message.contains("almost every one of the 12 frames"), "{message}");
    write(f, &[("a/f0.obj", &obj(0)), ("b/f0.obj", &other(0))]);
    let (code, message) = refusal(f, &["a", "b"]);
    assert!(code == "E_FACE_LIST" && message.contains("sequence \"b\" has another mesh"), "{message}");
}

#[test]
fn places_and_sizes_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    // On a map with z up, in centimetres, to the tenth of a millimetre.
    let shifted = |k: usize, x: f64, y: f64, z: f64| {
        let corners = [[0.0, 0.0, 0.0], [100.0, 0.0, 0.0], [0.0, 100.0, 0.0], [0.0, 0.0, 100.0 + k as f64]];
        let mut text = String::new();
        corners.iter().for_each(|c| writeln!(text, "v {:.2} {:.2} {:.2}", x + c[0], y + c[1], z + c[2]).unwrap());
        text + "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
    };
    for k in 0..3 {
        write(f, &[(&format!("map/f{k}.obj"), &shifted(k, 58_000_012.34, 560_000_056.78, 43_012.34))]);
    }
    let options = ImportOptions {
        up: Some(capture_io::import::UpAxis::Z),
        unit: Some(0.01),
        fps: Some(25.0),
        ..ImportOptions::default()
    };
    let imported = read(f, &["map"], &options);
    assert_eq!(codes(&imported), ["W_RECENTRED"]);
    assert_eq!(imported.offset, DVec3::new(580_001.0, 430.0, -5_600_001.0));
    let recorded = imported.capture.poses.frame(2)[3].as_dvec3() + imported.offset;
    assert!(recorded.distance(DVec3::new(580_000.123_4, 431.1434, -5_600_000.567_8)) < 1e-6, "{recorded}");
    // 32-bit coordinates that have lost theirs.
    let mut ply = b"ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        .to_vec();
    for c in [4e5_f32, 0.0, 0.0, 4e5 + 1.0, 0.0, 0.0, 4e5, 1.0, 0.0] {
        ply.extend(c.to_le_bytes());
    }
    ply.extend([3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]);
    write_bytes(f, "coarse.ply", &ply);
    assert_eq!(codes(&read_plain(f, &["coarse.ply"])), ["W_COORDINATES_COARSE", "W_RECENTRED"]);
    // A frame, or a sequence, in another unit.
    let large = |k: usize| {
        let mut text = String::new();
        for line in obj(k).lines() {
            match line.strip_prefix("v ") {
                Some(rest) => {
                    let scaled: Vec<String> =
                        rest.split(' ').map(|w| (w.parse::<f32>().unwrap() * 100.0).to_string()).collect();
                    writeln!(text, "v {}", scaled.join(" ")).unwrap();
                }
                None => writeln!(text, "{line}").unwrap(),
            }
        }
        text
    };
    (0..5).for_each(|k| write(f, &[(&format!("m/f{k}.obj"), &if k == 3 { large(k) } else { obj(k) })]));
    let imported = read_plain(f, &["m"]);
    let told = imported.warnings.iter().find(|w| w.code == "W_SIZE_CHANGES").unwrap();
    assert!(told.contains("frame 3 of sequence \"m\""), "{told}");
    // A frame without extent.
    write(f, &[("m/f3.obj", &obj(0).replace("v 1", "v 0").replace("0 1 0", "0 0 0").replace("0 0 1", "0 0 0"))]);
    let (code, message) = refusal(f, &["m"]);
    assert!(code == "E_COLLAPSED" && message.contains("f3.obj, frame 3"), "{message}");
}

#[test]
fn welded_vertices_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 1 0 0\nv 1 1 0\nv 2 0 0\nf 1 2 3\nf 4 6 5\n";
    write(folder.path(), &[("a.obj", text)]);
    let imported = read_plain(folder.path(), &["a.obj"]);
    assert!(imported.warnings.iter().any(|w| w.code == "W_WELDED" && w.starts_with("6 vertices of the files are 4")));
}

#[test]
fn loops_are_found_named_or_left() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    // A tip that goes round once in 24 frames, while the whole walks on.
    let pose = |k: usize, turns: f32| {
        let (sin, cos) = (std::f32::consts::TAU * turns * k as f32 / 24.0).sin_cos();
        let x = 0.1 * k as f32;
        format!(
            "v {x} 0 0\nv {} 0 0\nv {} {} 0.3\nv {} 0.1 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n",
            x + 1.0,
            x + 0.3 * sin,
            1.0 + 0.3 * cos,
            x + 0.2
        )
    };
    (0..24).for_each(|k| write(f, &[(&format!("c/round/f{k}.obj"), &pose(k, 1.0))]));
    (0..25).for_each(|k| write(f, &[(&format!("c/closed/f{k}.obj"), &pose(k, 1.0))]));
    (0..24).for_each(|k| write(f, &[(&format!("c/half/f{k}.obj"), &pose(k, 0.5))]));
    let with = |cyclic: Cyclic, input: &str| {
        let imported = read(f, &[input], &ImportOptions { fps: Some(24.0), cyclic, ..ImportOptions::default() });
        let of = imported.capture.timeline.sequences().iter().map(|s| (s.name.clone(), s.frame_count, s.cyclic));
        let codes: Vec<String> = codes(&imported).into_iter().map(str::to_owned).collect();
        (of.collect::<Vec<_>>(), codes)
    };
    let expect = |closed: (u32, bool), half: bool, round: bool| {
        vec![("closed".to_owned(), closed.0, closed.1), ("half".to_owned(), 24, half), ("round".to_owned(), 24, round)]
    };
    assert_eq!(with(Cyclic::Auto, "c"), (expect((24, true), false, true), vec!["W_CYCLIC".to_owned()]));
    assert_eq!(with(Cyclic::None, "c"), (expect((25, false), false, false), vec![]));
    let named = with(Cyclic::Names(vec!["half".into()]), "c");
    assert_eq!(named, (expect((25, false), true, false), vec![]));
    // What a manifest says holds, but for --cyclic none.
    let toml = "fps = 24\n[[sequence]]\ninput = \"c/round\"\ncyclic = false\n[[sequence]]\ninput = \"c/half\"\ncyclic = true\n";
    write(f, &[("m.toml", toml)]);
    let loops = |cyclic: Cyclic| with(cyclic, "m.toml").0.into_iter().map(|(_, _, cyclic)| cyclic).collect::<Vec<_>>();
    assert_eq!(loops(Cyclic::Auto), [false, true]);
    assert_eq!(loops(Cyclic::Names(vec!["round".into()])), [true, true]);
    assert_eq!(loops(Cyclic::None), [false, false]);
}

#[test]
fn the_result_does_not_depend_on_threads() {
    let folder = tempfile::tempdir().unwrap();
    let f: &Path = folder.path();
    for k in 0..40 {
        write(f, &[(&format!("w/f{k}.obj"), &format!("mtllib m{}.mtl\nusemtl a\n{}", k % 3, obj(k)))]);
    }
    write(f, &[("w/m0.mtl", "newmtl a\nmap_Kd t0.png\n"), ("w/m1.mtl", "newmtl a\nmap_Kd t1.png\n")]);
    (0..2).for_each(|k| write_bytes(f, &format!("w/t{k}.png"), &png(1, [k; 3])));
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| read_plain(f, &["w"]))
    };
    let one = with(1);
    assert_eq!(one, with(4));
    assert_eq!(codes(&one), ["W_MATERIAL_MISSING", "W_TEXTURE_LOST"]);
    let _: Option<Vec<PathBuf>> = one.frame_textures;
}

#[test]
fn paths_may_be_written_as_on_another_system() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    (0..3).for_each(|k| write(f, &[(&format!("m/f{k}.obj"), &obj(k))]));
    (0..3).for_each(|k| write_bytes(f, &format!("t/s{k}.png"), &png(1, [k; 3])));
    write(f, &[("c.toml", "fps = 25\n[[sequence]]\ninput = 'm\\f%d.obj'\ntexture = 't\\s*.png'\n")]);
    assert_eq!(worn(&read(f, &["c.toml"], &ImportOptions::default())), ["s0.png", "s1.png", "s2.png"]);
    write(f, &[("c.toml", "[[sequence]]\ninput = \"m\\Users\"\n")]);
    let (code, message) = refusal(f, &["c.toml"]);
    assert!(code == "E_MANIFEST" && message.contains("write / for \\ in paths"), "{message}");
}
