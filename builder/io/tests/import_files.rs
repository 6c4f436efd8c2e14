//! Import of OBJ and PLY sequences, patterns, manifests and textures.

#![allow(clippy::unwrap_used, reason = "helpers of tests, too, end a test by panicking")]

mod import_support;

use std::fmt::Write as _;
use std::path::Path;

use capture_io::import::{Cyclic, ImportOptions, UpAxis};
use glam::Vec3;
use import_support::{png, read, read_plain, refusal, try_read, write, write_bytes};
use proptest::prelude::*;

/// A quad and a triangle on a grid, `frame` moved upwards; with texture coordinates.
fn obj(frame: usize) -> String {
    let y = frame as f32 * 0.25;
    format!(
        "v 0 {y} 0\nv 1 {y} 0\nv 1 {y} 1\nv 0 {y} 1\nv 2 {y} 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
         f 4/4 3/3 2/2 1/1\nf 2/2 3/3 5/1\n"
    )
}

fn sequence(folder: &Path, prefix: &str, numbers: impl IntoIterator<Item = usize>) {
    for number in numbers {
        write(folder, &[(&format!("{prefix}{number}.obj"), &obj(number))]);
    }
}

fn names(imported: &capture_io::import::Imported) -> Vec<(&str, u32)> {
    imported.capture.timeline.sequences().iter().map(|s| (s.name.as_str(), s.frame_count)).collect()
}

#[test]
fn folders_globs_and_patterns_name_sequences() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    sequence(f, "walk/frame_", [8, 9, 10, 11]);
    sequence(f, "both/jump_", [1, 2]);
    sequence(f, "both/kick_", [1, 2, 3]);
    write(f, &[("walk/._frame_8.obj", "junk"), ("walk/notes.txt", "junk")]);

    let walk = read_plain(f, &["walk"]);
    assert_eq!(names(&walk), [("walk", 4)]);
    let heights: Vec<f32> = walk.capture.poses.iter().map(|pose| pose[0].y).collect();
    assert_eq!(heights, [2.0, 2.25, 2.5, 2.75]);
    assert_eq!(walk.warnings, []);
    assert_eq!(names(&read_plain(f, &["both"])), [("jump", 2), ("kick", 3)]);
    assert_eq!(names(&read_plain(f, &["both/kick_*.obj"])), [("kick", 3)]);
    assert_eq!(names(&read_plain(f, &["both/k*.obj", "walk"])), [("kick", 3), ("walk", 4)]);
    assert_eq!(names(&read_plain(f, &["*/*.obj"])), [("jump", 2), ("kick", 3), ("walk", 4)]);
    assert_eq!(names(&read_plain(f, &["walk/frame_%d.obj"])), [("walk", 4)]);
    assert_eq!(names(&read_plain(f, &["walk/frame_%d.obj:8:11:2"])), [("walk", 2)]);
    assert_eq!(names(&read_plain(f, &["walk/frame_9.obj"])), [("frame_9", 1)]);
    assert_eq!(refusal(f, &["walk/frame_%d.obj:8:12"]).0, "E_FRAME_MISSING");
    assert_eq!(refusal(f, &["nothing_*.obj"]).0, "E_NO_MATCH");
    assert_eq!(refusal(f, &["absent"]).0, "E_NOT_FOUND");
    assert_eq!(refusal(f, &["walk/notes.txt"]).0, "E_FORMAT_UNKNOWN");
    assert_eq!(refusal(f, &[]).0, "E_NO_INPUT");
    std::fs::create_dir(f.join("empty")).unwrap();
    assert_eq!(refusal(f, &["empty"]).0, "E_FOLDER_EMPTY");

    std::fs::remove_file(f.join("walk/frame_10.obj")).unwrap();
    let gap = read_plain(f, &["walk"]);
    assert_eq!(names(&gap), [("walk", 3)]);
    assert!(gap.warnings[0].contains("between 9 and 11"), "{:?}", gap.warnings);
    write(f, &[("walk/frame_12.ply", "ply")]);
    assert_eq!(refusal(f, &["walk"]).0, "E_FORMAT_MIXED");
}

#[test]
fn frames_must_have_the_same_mesh() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    sequence(f, "a_", 0..4);
    let with_third = |text: String| {
        write(f, &[("a_2.obj", &text)]);
        refusal(f, &["a_%d.obj"])
    };
    let (code, message) = with_third(obj(2) + "v 0 0 0\n");
    assert_eq!(code, "E_VERTEX_COUNT");
    assert!(message.contains("a_2.obj, frame 2: 6 vertices, but") && message.contains("a_0.obj has 5"), "{message}");
    let (code, message) = with_third(obj(2).replace("f 2/2 3/3 5/1", "f 3/3 2/2 5/1"));
    assert_eq!(code, "E_FACE_LIST");
    assert!(message.contains("frame 2: face 1"), "{message}");
    let (code, message) = with_third(obj(2).replace("v 2 0.5 0", "v 2 nan 0"));
    assert_eq!(code, "E_NOT_FINITE");
    assert!(message.contains("a_2.obj, frame 2: vertex 4"), "{message}");
    assert_eq!(with_third(obj(2).replace("5/1", "6/1")).0, "E_INDEX_RANGE");
    assert_eq!(with_third(String::new()).0, "E_VERTEX_COUNT");
    // Texture coordinates may differ: the first frame's are used.
    write(f, &[("a_2.obj", &obj(2).replace("vt 0 0", "vt 0.5 0"))]);
    let imported = read_plain(f, &["a_%d.obj"]);
    let differ = "a_2.obj: texture coordinates or colours differ";
    assert!(imported.warnings.iter().any(|w| w.contains(differ)), "{:?}", imported.warnings);
    write(f, &[("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"), ("points.obj", "v 0 0 0\n")]);
    assert_eq!(refusal(f, &["flat.obj"]).0, "E_COLLAPSED");
    assert_eq!(refusal(f, &["points.obj"]).0, "E_NO_TRIANGLES");
}

#[test]
fn seams_are_welded_and_collapsed_triangles_left_out() {
    let folder = tempfile::tempdir().unwrap();
    // Vertices 4 and 5 repeat 2 and 3; the last face has two corners at one place.
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 1 0 0\nv 1 1 0\nv 2 0 0\nf 1 2 3\nf 4 6 5\nf 2 4 3\nv 9 9 9\n";
    write(folder.path(), &[("a.obj", text)]);
    let imported = read_plain(folder.path(), &["a.obj"]);
    assert_eq!(imported.capture.vertex_of_file_vertex, [0, 1, 2, 1, 2, 3, 4]);
    assert_eq!(imported.capture.topology.triangles(), [[0, 1, 2], [1, 3, 2]]);
    assert!(imported.warnings.iter().any(|w| w.starts_with("1 of 3 triangles")), "{:?}", imported.warnings);
    assert!(imported.warnings.iter().any(|w| w.starts_with("1 of 5 vertices belong to no")), "{:?}", imported.warnings);
    let weights = imported.capture.topology.weights();
    assert!((weights[0] - 1.0 / 6.0).abs() < 1e-6 && (weights[1] - 1.0 / 3.0).abs() < 1e-6 && weights[4] == 0.0);
}

#[test]
fn axes_units_and_texture_origin() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &[("a.obj", "v 0 0 0\nv 100 0 0\nv 0 200 300\nvt 0.25 0.125\nf 1/1 2/1 3/1\n")]);
    let options = ImportOptions {
        fps: Some(50.0),
        up: Some(UpAxis::Z),
        unit: Some(0.01),
        name: Some("Ann".into()),
        ..ImportOptions::default()
    };
    let capture = read(folder.path(), &["a.obj"], &options).capture;
    assert!(capture.poses.frame(0)[2].distance(Vec3::new(0.0, 3.0, -2.0)) < 1e-6);
    assert_eq!(capture.surface.corners[0].uv, [0.25, 0.875]);
    assert_eq!((capture.name.as_str(), capture.timeline.fps()), ("Ann", 50.0));
    for options in [
        ImportOptions { fps: Some(0.0), ..ImportOptions::default() },
        ImportOptions { unit: Some(f32::NAN), ..ImportOptions::default() },
        ImportOptions { weld: Some(-1.0), ..ImportOptions::default() },
    ] {
        assert_eq!(try_read(folder.path(), &["a.obj"], &options).unwrap_err().code(), "E_OPTION");
    }
}

#[test]
fn materials_and_textures_of_libraries() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    let text = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl b\nf 1/1 2/1 3/1\nusemtl a\nf 1/1 3/1 2/1\n\
                usemtl b\nf 2/1 3/1 1/1\n";
    write(f, &[("x.obj", text), ("m.mtl", "newmtl a\nKd 1 0 0\nnewmtl b\nmap_Kd t/b.png\n")]);
    write_bytes(f, "t/b.png", &png(8, [0, 0, 255]));
    let surface = read_plain(f, &["x.obj"]).capture.surface;
    assert_eq!(surface.materials.iter().map(|m| m.name.as_str()).collect::<Vec<_>>(), ["b", "a"]);
    assert_eq!(surface.materials[0].image, Some(0));
    assert_eq!(surface.materials[1].base_colour, [1.0, 0.0, 0.0, 1.0]);
    assert_eq!(surface.parts.iter().map(|p| p.triangle_count).collect::<Vec<_>>(), [2, 1]);
    write_bytes(f, "t/b.png", b"no image");
    assert_eq!(refusal(f, &["x.obj"]).0, "E_IMAGE");
    std::fs::remove_file(f.join("m.mtl")).unwrap();
    let imported = read_plain(f, &["x.obj"]);
    assert!(imported.warnings.iter().any(|w| w.contains("m.mtl is missing")));
}

#[test]
fn textures_are_one_for_all_or_one_a_frame() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    sequence(f, "w/f", 0..3);
    sequence(f, "k/f", 0..2);
    // The only image of the folder.
    write_bytes(f, "w/atlas.png", &png(2, [1, 1, 1]));
    let one = read_plain(f, &["w"]);
    assert_eq!(one.capture.surface.images[0].bytes, png(2, [1, 1, 1]));
    assert_eq!(one.frame_textures, None);
    // One named like each frame.
    for k in 0..3 {
        write_bytes(f, &format!("w/f{k}.png"), &png(2, [k, 0, 0]));
    }
    let each = read_plain(f, &["w"]);
    let expected: Vec<_> = (0..3).map(|k| f.join(format!("w/f{k}.png"))).collect();
    assert_eq!(each.frame_textures.as_ref(), Some(&expected));
    assert_eq!(each.capture.surface.images[0].bytes, png(2, [0, 0, 0]));
    assert_eq!(each.capture.surface.materials[0].image, Some(0));
    // A sequence without: one for all, with a warning.
    let mixed = read_plain(f, &["w", "k"]);
    assert_eq!(mixed.frame_textures, None);
    assert!(mixed.warnings.iter().any(|w| w.contains("sequence \"k\" has none")), "{:?}", mixed.warnings);
    // A manifest gives that sequence one.
    let toml = "[[sequence]]\ninput = \"w\"\ntexture = \"w/f%d.png:0:2\"\n[[sequence]]\ninput = \"k\"\n\
                texture = \"w/atlas.png\"\n";
    write(f, &[("c.toml", toml), ("bad.toml", &toml.replace("0:2", "0:1"))]);
    let textures = read_plain(f, &["c.toml"]).frame_textures.unwrap();
    assert_eq!(textures[..3], expected);
    assert_eq!(textures[3..], [f.join("w/atlas.png"), f.join("w/atlas.png")]);
    assert_eq!(refusal(f, &["bad.toml"]).0, "E_TEXTURE_COUNT");
    // The option wins.
    let atlas = f.join("w/atlas.png").to_str().unwrap().to_owned();
    let options = ImportOptions { texture: Some(atlas), ..ImportOptions::default() };
    let forced = read(f, &["c.toml"], &options);
    assert_eq!((forced.frame_textures, forced.capture.surface.images[0].bytes.clone()), (None, png(2, [1, 1, 1])));
    write_bytes(f, "w/f1.png", &png(4, [1, 0, 0]));
    assert_eq!(refusal(f, &["w"]).0, "E_IMAGE");
    // Libraries that change from frame to frame.
    for k in 0..2 {
        let text = format!("mtllib f{k}.mtl\nusemtl skin\n{}", obj(k));
        write(
            f,
            &[(&format!("m/f{k}.obj"), &text), (&format!("m/f{k}.mtl"), &format!("newmtl skin\nmap_Kd t{k}.png"))],
        );
        write_bytes(f, &format!("m/t{k}.png"), &png(2, [0, k as u8, 0]));
    }
    let own = read_plain(f, &["m"]);
    assert_eq!(own.frame_textures, Some(vec![f.join("m/t0.png"), f.join("m/t1.png")]));
}

#[test]
fn masks_belong_to_the_textures_of_their_number() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    sequence(f, "w/f", 0..3);
    sequence(f, "k/f", 0..2);
    for k in 0..3 {
        write_bytes(f, &format!("w/f{k}.png"), &png(2, [k, 0, 0]));
        write_bytes(f, &format!("k/f{k}.png"), &png(2, [k, 0, 0]));
    }
    write_bytes(f, "seen/hidden_1.png", &png(2, [255; 3]));
    let toml =
        "[[sequence]]\ninput = \"w\"\nmask = \"seen\"\n[[sequence]]\ninput = \"k\"\ntexture = \"k/f%d.png:0:1\"\n";
    write(f, &[("c.toml", toml)]);
    let read = read_plain(f, &["c.toml"]);
    assert_eq!(read.frame_masks, [None, Some(f.join("seen/hidden_1.png")), None, None, None]);
    assert_eq!(read_plain(f, &["w"]).frame_masks, Vec::<Option<std::path::PathBuf>>::new());
    let refused = |name: &str, image: &[u8], said: &str| {
        write_bytes(f, &format!("seen/{name}"), image);
        let (code, message) = refusal(f, &["c.toml"]);
        assert!(code == "E_MASK" && message.contains(name) && message.contains(said), "{message}");
        std::fs::remove_file(f.join("seen").join(name)).unwrap();
    };
    refused("hidden_7.png", &png(2, [0; 3]), "has the number 7");
    refused("hidden.png", &png(2, [0; 3]), "holds no frame's number");
    refused("hidden_2.png", &png(4, [0; 3]), "frame 2 of sequence \"w\"");
    refused("other_01.png", &png(2, [0; 3]), "frame 1 of sequence \"w\" has a mask already");
    // One texture for all: masks say nothing.
    write(
        f,
        &[(
            "c.toml",
            &toml.replace("\"seen\"", "\"seen\"\ntexture = \"w/f0.png\"").replace("k/f%d.png:0:1", "w/f0.png"),
        )],
    );
    let still = read_plain(f, &["c.toml"]);
    assert!(still.frame_masks.is_empty() && still.warnings.iter().any(|w| w.contains("masks are ignored")));
}

/// What may be wrong with textures of frames, each refused with the file, and the frame where there is one.
#[test]
fn textures_that_are_missing_or_differ_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    sequence(f, "w/f", 0..4);
    for k in [0, 1, 3] {
        write_bytes(f, &format!("t/t_{k:02}.png"), &png(2, [k, 0, 0]));
    }
    let named = |texture: &str| {
        write(f, &[("c.toml", &format!("[[sequence]]\nname = \"walk\"\ninput = \"w\"\ntexture = \"{texture}\"\n"))]);
    };
    let with = |texture: &str| {
        named(texture);
        refusal(f, &["c.toml"])
    };
    let (code, message) = with("t/t_%02d.png:0:3");
    assert!(code == "E_FRAME_MISSING" && message.contains("t_02.png"), "{code} {message}");
    // By number: frame 2 has none, and is told.
    named("t");
    let lost = read_plain(f, &["c.toml"]);
    assert_eq!(lost.frame_textures.unwrap(), [0, 1, 1, 3].map(|k| f.join(format!("t/t_{k:02}.png"))));
    assert!(lost.warnings.iter().any(|w| w.code == "W_TEXTURE_LOST" && w.contains("1 of 4 frames (f2.obj)")));
    write_bytes(f, "t/t_02.png", &png(4, [2, 0, 0]));
    let (code, message) = with("t");
    assert!(code == "E_IMAGE" && message.contains("t_02.png") && message.contains("frame 2"), "{message}");
    write_bytes(f, "t/t_02.png", b"no image");
    let (code, message) = with("t");
    assert!(code == "E_IMAGE" && message.contains("t_02.png"), "{message}");
}

#[test]
fn parts_of_the_body_may_be_painted() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    sequence(f, "data/walk/f_", 0..3);
    write(f, &[("data/capture.toml", "parts = \"parts.txt\"\n[[sequence]]\ninput = \"walk\"\n")]);
    let painted = |text: &str| write(f, &[("data/parts.txt", text)]);
    painted("0 7\n# an arm\n255 0\n7\n");
    assert_eq!(read_plain(f, &["data"]).parts, Some(vec![0, 7, 255, 0, 7]));
    assert_eq!(read_plain(f, &["data/walk"]).parts, None);
    for (text, told) in [
        ("0 1 2", "3 numbers for 5 vertices"),
        ("0 1 2 3 4 5", "6 numbers for 5 vertices"),
        ("0 1\n2.5 3 4", "line 2: a part of the number 2.5"),
        ("0 1 2 3 256", "number 256"),
        ("0 1 2 3 -1", "number -1"),
        ("0 1 2 3 NaN", "number NaN"),
    ] {
        painted(text);
        let (code, message) = refusal(f, &["data"]);
        assert!(code == "E_PARTS" && message.contains(told) && message.contains("parts.txt"), "{code} {message}");
    }
    painted("0 1 left 3 4");
    assert!(refusal(f, &["data"]).1.contains("left"));
    std::fs::remove_file(f.join("data/parts.txt")).unwrap();
    assert_eq!(refusal(f, &["data"]).0, "E_NOT_FOUND");
}

#[test]
fn manifests_describe_captures() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    sequence(f, "data/walk/f_", 0..5);
    sequence(f, "data/hop_", 0..2);
    let toml = "name = \"Ann\"\nfps = 12.5\nup = \"y\"\nunit = 0.5\nweights = \"w.txt\"\n\
        [[sequence]]\nname = \"stroll\"\ninput = \"walk\"\nlabels = [\"walk\", \"slow\"]\n\
        [[sequence]]\ninput = \"hop_%d.obj:1:1\"\nbehaviours = [\"hop\"]\ncyclic = true\n";
    write(f, &[("data/capture.toml", toml), ("data/w.txt", "1 2\n# all\n0 0\n5\n")]);
    let capture = read(f, &["data"], &ImportOptions::default()).capture;
    assert_eq!((capture.name.as_str(), capture.timeline.fps()), ("Ann", 12.5));
    let [stroll, hop] = capture.timeline.sequences() else { panic!() };
    assert_eq!((stroll.name.as_str(), stroll.labels.join("+"), stroll.cyclic), ("stroll", "walk+slow".into(), false));
    assert_eq!((hop.name.as_str(), hop.labels.join("+"), hop.cyclic), ("hop", "hop".into(), true));
    assert_eq!((stroll.frame_count, hop.frame_count), (5, 1));
    assert_eq!(capture.poses.frame(0)[4], Vec3::X);
    let weights = capture.topology.weights();
    assert!((weights[4] - 5.0 / 8.0).abs() < 1e-6 && weights[2] == 0.0);
    // The option wins.
    let options = ImportOptions { fps: Some(99.0), ..ImportOptions::default() };
    assert_eq!(read(f, &["data/capture.toml"], &options).capture.timeline.fps(), 99.0);

    let refuse = |from: &str, to: &str| {
        assert!(toml.contains(from));
        write(f, &[("data/capture.toml", &toml.replace(from, to))]);
        refusal(f, &["data"])
    };
    let (code, message) = refuse("fps =", "fsp =");
    assert!(code == "E_MANIFEST" && message.contains("fsp") && message.contains("line 2"), "{message}");
    let (code, message) = refuse("cyclic =", "loop =");
    assert!(code == "E_MANIFEST" && message.contains("loop"), "{message}");
    assert_eq!(refuse("up = \"y\"", "up = \"x\"").0, "E_MANIFEST");
    assert_eq!(refuse("fps = 12.5", "fps = -1.0").0, "E_OPTION");
    assert_eq!(refuse("input = \"walk\"", "input = \"run\"").0, "E_NOT_FOUND");
    assert_eq!(refuse("input = \"walk\"", "clip = \"x\"\ninput = \"walk\"").0, "E_MANIFEST");
    assert_eq!(refuse("input = \"hop", "name = \"stroll\"\ninput = \"hop").0, "E_MANIFEST");
    assert_eq!(refuse("w.txt", "none.txt").0, "E_NOT_FOUND");
    write(f, &[("data/w.txt", "1 2 3")]);
    assert_eq!(refuse("Ann", "Bob").0, "E_WEIGHTS");
    write(f, &[("none.toml", "name = \"x\"\n")]);
    assert_eq!(refusal(f, &["none.toml"]).0, "E_MANIFEST");
}

#[test]
fn a_frame_that_closes_a_cycle_is_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    // A triangle that turns, rises and comes back, moving through the room.
    let pose = |k: usize, turn: f32, x: f32| {
        let (sin, cos) = turn.sin_cos();
        let lift = [0.0, 0.5, 0.25, 0.0][k % 4];
        let mut text = String::new();
        for [px, py, pz] in [[0.0, 0.0, 0.0], [1.0, 0.2, 0.1], [0.2, 1.0 + lift, 0.6]] {
            writeln!(text, "v {} {} {}", cos * px + sin * pz + x, py, cos * pz - sin * px).unwrap();
        }
        text + "vt 0 0\nf 1/1 2/1 3/1\n"
    };
    for k in 0..4 {
        write(f, &[(&format!("c/f{k}.obj"), &pose(k, 0.3 * k as f32, 2.0 * k as f32))]);
        write_bytes(f, &format!("c/f{k}.png"), &png(1, [k as u8, 0, 0]));
    }
    let cyclic = ImportOptions { fps: Some(25.0), cyclic: Cyclic::Names(vec!["c".into()]), ..ImportOptions::default() };
    let closed = read(f, &["c"], &cyclic);
    assert_eq!(names(&closed), [("c", 3)]);
    assert!(closed.warnings.iter().any(|w| w.contains("last frame repeats the first")));
    assert!(closed.capture.timeline.sequences()[0].cyclic);
    assert_eq!(closed.frame_textures.unwrap(), [0, 1, 2].map(|k| f.join(format!("c/f{k}.png"))));

    assert_eq!(names(&read_plain(f, &["c"])), [("c", 4)]);
    write(f, &[("c/f3.obj", &pose(2, 0.9, 6.0))]);
    assert_eq!(names(&read(f, &["c"], &cyclic)), [("c", 4)]);
    let unknown = ImportOptions { cyclic: Cyclic::Names(vec!["d".into()]), ..ImportOptions::default() };
    assert_eq!(try_read(f, &["c"], &unknown).unwrap_err().code(), "E_SEQUENCE_UNKNOWN");
}

/// A random mesh: positions far enough apart not to be welded, triangles, a texture coordinate per corner.
#[derive(Clone, Debug)]
struct Mesh {
    positions: Vec<Vec3>,
    colours: Vec<[u8; 3]>,
    triangles: Vec<[usize; 3]>,
    uvs: Vec<[f32; 2]>,
}

fn meshes() -> impl Strategy<Value = Mesh> {
    (3_usize..20, 1_usize..30).prop_flat_map(|(vertices, triangles)| {
        let jitter = prop::collection::vec(prop::array::uniform3(-0.4_f32..0.4), vertices);
        let colours = prop::collection::vec(prop::array::uniform3(any::<u8>()), vertices);
        // Three different corners.
        let triangle = (0..vertices, 1..vertices, 1..vertices - 1).prop_map(move |(a, b, c)| {
            let b = (a + b) % vertices;
            let c = (0..vertices).filter(|&k| k != a && k != b).nth((c - 1) % (vertices - 2)).unwrap();
            [a, b, c]
        });
        let triangles = prop::collection::vec(triangle, triangles);
        (jitter, colours, triangles).prop_flat_map(|(jitter, colours, triangles)| {
            let positions: Vec<Vec3> = jitter
                .iter()
                .enumerate()
                .map(|(k, j)| Vec3::new((k % 3) as f32, (k / 3 % 3) as f32, (k / 9) as f32) + Vec3::from_array(*j))
                .collect();
            let uvs = prop::collection::vec(prop::array::uniform2(0.0_f32..1.0), 3 * triangles.len());
            uvs.prop_map(move |uvs| Mesh {
                positions: positions.clone(),
                colours: colours.clone(),
                triangles: triangles.clone(),
                uvs,
            })
        })
    })
}

fn write_obj(mesh: &Mesh) -> String {
    let mut text = String::new();
    for (p, c) in mesh.positions.iter().zip(&mesh.colours) {
        let [r, g, b] = c.map(|c| f32::from(c) / 255.0);
        writeln!(text, "v {} {} {} {r} {g} {b}", p.x, p.y, p.z).unwrap();
    }
    for uv in &mesh.uvs {
        writeln!(text, "vt {} {}", uv[0], 1.0 - uv[1]).unwrap();
    }
    for (t, [a, b, c]) in mesh.triangles.iter().enumerate() {
        let uv = 3 * t + 1;
        let back = *c as i64 - mesh.positions.len() as i64;
        writeln!(text, "f {}/{uv} {}/{}/9 {back}/{}", a + 1, b + 1, uv + 1, uv + 2).unwrap();
    }
    text
}

fn write_ply(mesh: &Mesh, encoding: &str) -> Vec<u8> {
    let head = format!(
        "ply\nformat {encoding} 1.0\nelement vertex {}\nproperty float x\nproperty double y\nproperty float z\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\nproperty list uchar short extra\n\
         element face {}\nproperty list uchar uint vertex_indices\nproperty int flag\n\
         property list ushort float texcoord\nend_header\n",
        mesh.positions.len(),
        mesh.triangles.len()
    );
    let mut bytes = head.into_bytes();
    let mut put = |little: &[u8], text: String| match encoding {
        "ascii" => {
            bytes.extend(text.as_bytes());
            bytes.push(b' ');
        }
        "binary_little_endian" => bytes.extend(little),
        _ => bytes.extend(little.iter().rev()),
    };
    for (p, c) in mesh.positions.iter().zip(&mesh.colours) {
        put(&p.x.to_le_bytes(), p.x.to_string());
        put(&f64::from(p.y).to_le_bytes(), p.y.to_string());
        put(&p.z.to_le_bytes(), p.z.to_string());
        c.iter().for_each(|c| put(&[*c], c.to_string()));
        put(&[2], "2".into());
        put(&(-5_i16).to_le_bytes(), "-5".into());
        put(&7_i16.to_le_bytes(), "7\n".into());
    }
    for (t, corners) in mesh.triangles.iter().enumerate() {
        put(&[3], "3".into());
        corners.iter().for_each(|&v| put(&(v as u32).to_le_bytes(), v.to_string()));
        put(&(-1_i32).to_le_bytes(), "-1".into());
        put(&6_u16.to_le_bytes(), "6".into());
        for [u, v] in &mesh.uvs[3 * t..3 * t + 3] {
            put(&u.to_le_bytes(), u.to_string());
            put(&(1.0 - v).to_le_bytes(), format!("{}\n", 1.0 - v));
        }
    }
    bytes
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn what_is_written_is_read(mesh in meshes()) {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), &[("a.obj", &write_obj(&mesh))]);
        let mut inputs = vec!["a.obj".to_owned()];
        for encoding in ["ascii", "binary_little_endian", "binary_big_endian"] {
            write_bytes(folder.path(), &format!("{encoding}.ply"), &write_ply(&mesh, encoding));
            inputs.push(format!("{encoding}.ply"));
        }
        for input in inputs {
            let options = ImportOptions { fps: Some(25.0), weld: Some(0.0), ..ImportOptions::default() };
            let capture = read(folder.path(), &[&input], &options).capture;
            prop_assert_eq!(capture.poses.frame(0), &mesh.positions[..]);
            prop_assert_eq!(capture.topology.triangles().len(), mesh.triangles.len());
            for (t, (drawn, expected)) in capture.surface.triangles.iter().zip(&mesh.triangles).enumerate() {
                for k in 0..3 {
                    let corner = capture.surface.corners[drawn[k] as usize];
                    prop_assert_eq!(corner.vertex as usize, expected[k]);
                    let [r, g, b] = mesh.colours[expected[k]];
                    prop_assert_eq!(corner.colour, [r, g, b, 255]);
                    let uv = mesh.uvs[3 * t + k];
                    prop_assert!((corner.uv[0] - uv[0]).abs() < 1e-6 && (corner.uv[1] - uv[1]).abs() < 1e-6);
                }
            }
        }
    }
}
