//! What moves in glTF files: channels and clips, meshes in turn, mirrors and vanishing scales. Most of these files are
//! valid, or nearly so, and came out wrong without a word in one program or another.

#![allow(clippy::unwrap_used, reason = "helpers of tests, too, end a test by panicking")]

mod gltf_support;
mod import_support;

use capture_io::import::Imported;
use glam::{Mat4, Quat, Vec3};
use gltf_support::{Moves, assert_pose, body, clip, mesh, moved, read_glb, refuse_glb, standing, volume, warning};
use import_support::Gltf;
use serde_json::{Value, json};

/// Times of `count` keyframes at `fps`, the first of them frame `first`, rounded as files round them.
fn times(first: usize, count: usize, fps: f64) -> Vec<f32> {
    (0..count).map(|k| ((first + k) as f64 / fps) as f32).collect()
}

fn sequences(imported: &Imported) -> Vec<(&str, u32)> {
    imported.capture.timeline.sequences().iter().map(|s| (s.name.as_str(), s.frame_count)).collect()
}

fn shifted(by: Vec3) -> Vec<Vec3> {
    body().0.iter().map(|&p| p + by).collect()
}

#[test]
fn channels_that_move_no_node_are_left_out() {
    let moves =
        || Moves(json!({"node": 0, "path": "translation"}), "LINEAR", &[0.0, 1.0], vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
    let pointer =
        |pointer: &str| json!({"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": pointer}}});
    let colour = "/materials/0/pbrMetallicRoughness/baseColorFactor";
    for (target, said) in [
        (json!({"path": "translation"}), "no node"),
        (json!({"node": 0, "path": "colour"}), "colour"),
        (pointer(colour), colour),
        (pointer("/nodes/0/somewhere"), "/nodes/0/somewhere"),
    ] {
        let mut file = standing();
        file.json["materials"] = json!([{"name": "skin"}]);
        file.json["extensionsUsed"] = json!(["KHR_animation_pointer"]);
        let values = [[1.0; 4], [0.5; 4]].concat();
        clip(&mut file, "Walk", vec![moves(), Moves(target, "LINEAR", &[0.0, 1.0], values)]);
        let imported = read_glb(&file, 10.0);
        assert!(warning(&imported, "W_GLTF_CHANNEL").contains(said), "{:?}", imported.warnings);
        assert_eq!(sequences(&imported), [("Walk", 11)]);
        assert_pose(&imported, 10, &shifted(Vec3::X));
        if said.starts_with('/') {
            file.json["extensionsRequired"] = json!(["KHR_animation_pointer"]);
            let (code, message) = refuse_glb(&file);
            assert!(code == "E_GLTF_EXTENSION" && message.contains(said), "{message}");
        }
    }
    // A pointer to what a channel could move is that channel.
    let mut file = standing();
    file.json["extensionsRequired"] = json!(["KHR_animation_pointer"]);
    let Moves(_, mode, at, values) = moves();
    clip(&mut file, "Walk", vec![Moves(pointer("/nodes/0/translation"), mode, at, values)]);
    let imported = read_glb(&file, 10.0);
    assert!(imported.warnings.is_empty(), "{:?}", imported.warnings);
    assert_pose(&imported, 5, &shifted(0.5 * Vec3::X));
    // A node that does not exist is a fault.
    file.json["animations"][0]["channels"][0]["target"] = json!({"node": 7, "path": "scale"});
    assert_eq!(refuse_glb(&file).0, "E_GLTF");
}

#[test]
fn nodes_with_a_matrix_move() {
    let mut file = standing();
    let (turn, size) = (Quat::from_rotation_y(0.5), Vec3::new(1.0, 2.0, 3.0));
    let matrix = Mat4::from_scale_rotation_translation(size, turn, Vec3::new(0.2, 0.0, 0.0));
    file.json["nodes"][0] = json!({"mesh": 0, "matrix": matrix.to_cols_array()});
    clip(
        &mut file,
        "Walk",
        vec![Moves(
            json!({"node": 0, "path": "translation"}),
            "LINEAR",
            &[0.0, 1.0],
            vec![0.0, 0.0, 0.0, 0.0, 1.0, 0.0],
        )],
    );
    let imported = read_glb(&file, 10.0);
    assert!(imported.warnings.is_empty(), "{:?}", imported.warnings);
    let expected = |k: u32| body().0.iter().map(|&p| turn * (size * p) + 0.1 * k as f32 * Vec3::Y).collect::<Vec<_>>();
    [0, 4, 10].into_iter().for_each(|k| assert_pose(&imported, k, &expected(k)));
    // A shear cannot be kept, and that is said.
    file.json["nodes"][0]["matrix"] = json!([1, 0, 0, 0, 0.5, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
    assert!(warning(&read_glb(&file, 10.0), "W_GLTF_MATRIX").contains("node 0"));
    // It stays where nothing moves the node.
    file.json["animations"] = json!([]);
    let sheared: Vec<Vec3> = body().0.iter().map(|p| Vec3::new(p.x + 0.5 * p.y, p.y, p.z)).collect();
    assert_pose(&read_glb(&file, 10.0), 0, &sheared);
}

#[test]
fn frame_k_shows_keyframe_k() {
    // The beginning of the first keyframe, and times that add up a rounded step.
    for (first, fps) in
        [(0, 24.0), (1, 24.0), (5, 25.0), (1001, 24.0), (101, 30.0), (9, 60.0), (36_000, 30.0), (77, 29.97)]
    {
        let at = times(first, 97, fps);
        let mut summed = vec![0.0];
        (1..97).for_each(|k| summed.push(summed[k - 1] + (1.0 / fps) as f32));
        for at in [at, summed] {
            let mut file = standing();
            let values: Vec<f32> = (0..97).flat_map(|k| [0.0, 0.0, 0.01 * k as f32]).collect();
            clip(&mut file, "Walk", vec![Moves(json!({"node": 0, "path": "translation"}), "STEP", &at, values)]);
            let imported = read_glb(&file, fps as f32);
            assert_eq!(sequences(&imported), [("Walk", 97)], "from {first} at {fps}");
            assert!(imported.warnings.is_empty(), "{:?}", imported.warnings);
            (0..97).for_each(|k| assert_pose(&imported, k, &shifted(0.01 * k as f32 * Vec3::Z)));
        }
    }
}

#[test]
fn a_rate_that_misses_poses_is_said() {
    let mut file = standing();
    let values: Vec<f32> = (0..25).flat_map(|k| [0.0, 0.0, 0.01 * k as f32]).collect();
    clip(
        &mut file,
        "Walk",
        vec![Moves(json!({"node": 0, "path": "translation"}), "STEP", &times(0, 25, 24.0), values)],
    );
    for fps in [30.0, 12.0, 25.0] {
        assert!(warning(&read_glb(&file, fps), "W_GLTF_FPS").contains("--fps 24 "), "{fps}");
    }
    for fps in [24.0, 48.0] {
        assert!(read_glb(&file, fps).warnings.is_empty());
    }
    // Lines between the keyframes miss nothing.
    file.json["animations"][0]["samplers"][0]["interpolation"] = json!("LINEAR");
    assert!(read_glb(&file, 30.0).warnings.is_empty());
}

#[test]
fn clips_keep_their_end() {
    for (length, frames) in
        [(0.7083, 23), (0.7, 22), (0.6999, 22), (0.701, 22), (0.71, 23), (0.001, 1), (0.03, 2), (0.0, 1)]
    {
        let mut file = standing();
        let at = if length > 0.0 { vec![0.0, length] } else { vec![0.0] };
        let values = [vec![0.0; 3], vec![0.0, 0.0, 1.0]].concat()[6 - 3 * at.len()..].to_vec();
        clip(&mut file, "Walk", vec![Moves(json!({"node": 0, "path": "translation"}), "LINEAR", &at, values)]);
        let imported = read_glb(&file, 30.0);
        assert_eq!(sequences(&imported), [("Walk", frames)], "{length} s");
        assert_pose(&imported, frames - 1, &shifted(Vec3::Z));
        for k in 0..frames - 1 {
            assert_pose(&imported, k, &shifted(k as f32 / 30.0 / length * Vec3::Z));
        }
    }
}

#[test]
fn clips_that_move_nothing_drawn_are_left_out() {
    let mut file = standing();
    let camera = file.scene_node(json!({"camera": 0}));
    file.json["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}]);
    let moves = |node: usize| {
        Moves(json!({"node": node, "path": "translation"}), "LINEAR", &[0.0, 1.0], vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0])
    };
    clip(&mut file, "CameraAction", vec![moves(camera)]);
    clip(&mut file, "Take 001", vec![]);
    file.push("animations", json!({"name": "Take 002"}));
    let weights = Moves(json!({"node": 0, "path": "weights"}), "LINEAR", &[0.0, 1.0], vec![0.0, 1.0]);
    clip(&mut file, "Smile", vec![weights]);
    let still = read_glb(&file, 10.0);
    assert_eq!(sequences(&still), [("a", 1)]);
    assert_eq!(still.warnings.iter().filter(|w| w.code == "W_GLTF_CLIP_EMPTY").count(), 4, "{:?}", still.warnings);
    clip(&mut file, "Walk", vec![moves(0)]);
    let imported = read_glb(&file, 10.0);
    assert_eq!(sequences(&imported), [("Walk", 11)]);
    for name in ["CameraAction", "Take 001", "Take 002", "Smile"] {
        assert!(imported.warnings.iter().any(|w| w.contains(&format!("\"{name}\" moves nothing"))), "{name}");
    }
    // What is above a mesh moves it.
    file.json["nodes"][camera]["children"] = json!([0]);
    file.json["scenes"][0]["nodes"] = json!([camera]);
    assert_eq!(sequences(&read_glb(&file, 10.0)), [("CameraAction", 11), ("Walk", 11)]);
}

#[test]
fn clips_that_may_belong_together_are_said() {
    let mut file = standing();
    let offsets = file.floats("VEC3", &body().0.iter().flat_map(|p| [0.0, p.y, 0.0]).collect::<Vec<_>>());
    file.json["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": offsets}]);
    let walk =
        Moves(json!({"node": 0, "path": "translation"}), "LINEAR", &[0.0, 1.0], vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
    clip(&mut file, "Armature|Walk", vec![walk]);
    clip(
        &mut file,
        "Key|Walk",
        vec![Moves(json!({"node": 0, "path": "weights"}), "LINEAR", &[0.0, 1.0], vec![0.0, 1.0])],
    );
    let imported = read_glb(&file, 10.0);
    let said = warning(&imported, "W_GLTF_CLIPS_APART");
    assert!(said.contains("\"Armature|Walk\" and \"Key|Walk\""), "{said}");
    assert_eq!(sequences(&imported), [("Armature|Walk", 11), ("Key|Walk", 11)]);
    // Fewer weights than targets would leave some of them out.
    let both = json!([{"POSITION": offsets}, {"POSITION": offsets}]);
    file.json["meshes"][0]["primitives"][0]["targets"] = both;
    assert!(refuse_glb(&file).1.contains("1 weights for the 2 morph targets"));
}

/// The body on a skin of one joint, both under a node of `scale`, with the inverse bind matrix `bind`.
fn skinned(scale: Vec3, bind: Mat4) -> Gltf {
    let mut file = standing();
    let count = body().0.len();
    let view = file.view(&vec![0; 4 * count]);
    let joints =
        file.push("accessors", json!({"bufferView": view, "componentType": 5121, "count": count, "type": "VEC4"}));
    let weights = file.floats("VEC4", &[1.0, 0.0, 0.0, 0.0].repeat(count));
    let binds = file.floats("MAT4", &bind.to_cols_array());
    file.json["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"] = json!(joints);
    file.json["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] = json!(weights);
    file.json["nodes"] =
        json!([{"mesh": 0, "skin": 0}, {"name": "joint"}, {"children": [0, 1], "scale": scale.to_array()}]);
    file.json["scenes"][0]["nodes"] = json!([2]);
    file.json["skins"] = json!([{"joints": [1], "inverseBindMatrices": binds}]);
    file
}

#[test]
fn mirrored_meshes_keep_their_outside() {
    let outside = |file: &Gltf| {
        let imported = read_glb(file, 10.0);
        let found = volume(imported.capture.poses.frame(0), imported.capture.topology.triangles());
        (found, imported)
    };
    let expected = volume(&body().0, &body().1);
    let mirror = Vec3::new(-1.0, 1.0, 1.0);
    for (scale, bind) in [
        (Vec3::ONE, Mat4::IDENTITY),
        (mirror, Mat4::IDENTITY),
        (mirror, Mat4::from_scale(mirror)),
        (Vec3::ONE, Mat4::from_scale(mirror)),
        (-Vec3::ONE, Mat4::IDENTITY),
        (Vec3::new(-1.0, -1.0, 1.0), Mat4::IDENTITY),
    ] {
        let (found, imported) = outside(&skinned(scale, bind));
        assert!((found - expected).abs() < 1e-5, "{scale} {bind}: {found}");
        assert!(imported.warnings.is_empty(), "{:?}", imported.warnings);
    }
    // A node without a skin, mirrored at rest, by its clip, and by one half of its clip.
    let mut file = standing();
    file.json["nodes"][0]["scale"] = json!(mirror.to_array());
    assert!((outside(&file).0 - expected).abs() < 1e-5);
    let scales = |last: Vec3| {
        Moves(json!({"node": 0, "path": "scale"}), "STEP", &[0.0, 0.9], [mirror.to_array(), last.to_array()].concat())
    };
    file.json["nodes"][0]["scale"] = json!([1.0, 1.0, 1.0]);
    clip(&mut file, "Walk", vec![scales(mirror)]);
    let (found, imported) = outside(&file);
    assert!((found - expected).abs() < 1e-5 && imported.warnings.is_empty(), "{found} {:?}", imported.warnings);
    file.json["animations"] = json!([]);
    clip(&mut file, "Walk", vec![scales(Vec3::ONE)]);
    let (found, imported) = outside(&file);
    assert!((found - expected).abs() < 1e-5 && warning(&imported, "W_GLTF_MIRRORED").contains("node 0"));
}

#[test]
fn a_frame_without_size_is_named() {
    for (sizes, frame) in [([0.0, 0.5, 1.0], 0), ([1.0, 0.5, 0.0], 2), ([1.0, 0.0, 1.0], 1)] {
        let mut file = standing();
        let values = sizes.iter().flat_map(|&s| [s; 3]).collect();
        clip(&mut file, "Appear", vec![Moves(json!({"node": 0, "path": "scale"}), "LINEAR", &[0.0, 0.1, 0.2], values)]);
        let folder = tempfile::tempdir().unwrap();
        import_support::write_bytes(folder.path(), "a.glb", &file.glb());
        let options = capture_io::import::ImportOptions { fps: Some(10.0), ..Default::default() };
        let error = import_support::try_read(folder.path(), &["a.glb"], &options).unwrap_err();
        assert_eq!(error.code(), "E_COLLAPSED");
        assert!(error.to_string().contains(&format!("a.glb, frame {frame}:")), "{error}");
    }
}

/// How a flip-book turns its pages.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Turning {
    Scale(&'static str, f32),
    Visible,
}

/// A file of `pages` bodies, of which the clip "Walk" shows one a frame at 24 fps.
fn flip_book(pages: usize, turning: Turning) -> Gltf {
    let mut file = Gltf::new();
    let (_, triangles) = body();
    let all = times(0, pages, 24.0);
    let mut channels = Vec::new();
    for page in 0..pages {
        let index = mesh(&mut file, &moved(page as f32), &triangles);
        let hidden = |size: f32| json!([size, size, size]);
        let node = match turning {
            Turning::Scale(_, off) => json!({"mesh": index, "scale": hidden(if page == 0 { 1.0 } else { off })}),
            Turning::Visible => json!({"mesh": index, "extensions": {"KHR_node_visibility": {"visible": page == 0}}}),
        };
        let node = file.scene_node(node);
        let of_keys = |on: f32, off: f32| (0..pages).map(move |key| if key == page { on } else { off });
        channels.push(match turning {
            Turning::Scale(interpolation, off) => {
                let values = of_keys(1.0, off).flat_map(|s| [s; 3]).collect();
                Moves(json!({"node": node, "path": "scale"}), interpolation, &all, values)
            }
            Turning::Visible => {
                let pointer = format!("/nodes/{node}/extensions/KHR_node_visibility/visible");
                let target = json!({"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": pointer}}});
                Moves(target, "STEP", &all, of_keys(1.0, 0.0).collect())
            }
        });
    }
    clip(&mut file, "Walk", channels);
    file
}

#[test]
fn meshes_in_turn_are_one_that_moves() {
    let ways =
        [Turning::Scale("STEP", 0.0), Turning::Scale("LINEAR", 0.0), Turning::Scale("LINEAR", 1e-3), Turning::Visible];
    for turning in ways {
        let file = flip_book(12, turning);
        let imported = read_glb(&file, 24.0);
        assert_eq!(sequences(&imported), [("Walk", 12)], "{turning:?}");
        assert!(warning(&imported, "W_GLTF_FLIPBOOK").contains("12 meshes"));
        assert_eq!(imported.warnings.len(), 1, "{:?}", imported.warnings);
        for k in 0..12 {
            assert_pose(&imported, k, &moved(k as f32));
        }
        // Another rate shows whole pages only, and says that some come twice.
        let imported = read_glb(&file, 30.0);
        assert!(warning(&imported, "W_GLTF_FPS").contains("--fps 24 "));
        for k in 0..sequences(&imported)[0].1 {
            let whole = (0..12).any(|page| {
                let (pose, expected) = (imported.capture.poses.frame(k), moved(page as f32));
                imported
                    .capture
                    .vertex_of_file_vertex
                    .iter()
                    .zip(&expected)
                    .all(|(&v, e)| pose[v as usize].distance(*e) < 1e-5)
            });
            assert!(whole, "{turning:?} frame {k}");
        }
    }
}

#[test]
fn mirrored_pages_keep_their_outside() {
    let mut file = flip_book(6, Turning::Scale("STEP", 0.0));
    // The same pages, in a file that is mirrored as a whole by the very scales that turn them.
    for page in 0..6 {
        let positions: Vec<Vec3> = moved(page as f32).iter().map(|p| Vec3::new(-p.x, p.y, p.z)).collect();
        let inside_out: Vec<[u32; 3]> = body().1.iter().map(|&[a, b, c]| [a, c, b]).collect();
        let index = mesh(&mut file, &positions, &inside_out);
        file.json["nodes"][page]["mesh"] = json!(index);
        let values: Vec<f32> = (0..6).flat_map(|key| if key == page { [-1.0, 1.0, 1.0] } else { [0.0; 3] }).collect();
        let output = file.floats("VEC3", &values);
        file.json["animations"][0]["samplers"][page]["output"] = json!(output);
    }
    let imported = read_glb(&file, 24.0);
    assert_eq!(imported.warnings.len(), 1, "{:?}", imported.warnings);
    for k in 0..6 {
        assert_pose(&imported, k, &moved(k as f32));
        assert!(volume(imported.capture.poses.frame(k), imported.capture.topology.triangles()) > 0.05);
    }
}

#[test]
fn a_lasting_mesh_stands_beside_the_pages() {
    let mut file = flip_book(6, Turning::Scale("STEP", 0.0));
    let hat: Vec<Vec3> = body().0.iter().map(|&p| 0.2 * p + 2.0 * Vec3::Y).collect();
    // First in the file, as a hat that lasts.
    let index = mesh(&mut file, &hat, &body().1);
    let node = file.push("nodes", json!({"mesh": index, "name": "hat"}));
    file.json["scenes"][0]["nodes"].as_array_mut().unwrap().insert(0, json!(node));
    let imported = read_glb(&file, 24.0);
    assert_eq!(imported.capture.topology.component_count(), 2);
    for k in 0..6 {
        assert_pose(&imported, k, &[hat.clone(), moved(k as f32)].concat());
    }
    // A second figure whose pages have the same triangles: two of twelve are shown at a time.
    let mut file = flip_book(6, Turning::Scale("STEP", 0.0));
    let Value::Array(channels) = file.json["animations"][0]["channels"].clone() else { panic!() };
    for (page, channel) in channels.iter().enumerate() {
        let positions: Vec<Vec3> = moved(page as f32).iter().map(|&p| p + 3.0 * Vec3::X).collect();
        let index = mesh(&mut file, &positions, &body().1);
        let node = file.scene_node(json!({"mesh": index}));
        let mut channel = channel.clone();
        channel["target"]["node"] = json!(node);
        file.json["animations"][0]["channels"].as_array_mut().unwrap().push(channel);
    }
    let imported = read_glb(&file, 24.0);
    for k in 0..6 {
        let other = moved(k as f32).iter().map(|&p| p + 3.0 * Vec3::X).collect();
        assert_pose(&imported, k, &[moved(k as f32), other].concat());
    }
}

#[test]
fn meshes_in_turn_that_do_not_go_together_are_refused() {
    // One page has other triangles.
    let mut file = flip_book(5, Turning::Scale("STEP", 0.0));
    let (positions, mut triangles) = body();
    triangles.swap(0, 9);
    let other = mesh(&mut file, &positions, &triangles);
    file.json["nodes"][2]["mesh"] = json!(other);
    let (code, message) = refuse_glb(&file);
    assert!(
        code == "E_MESH_CHANGES" && message.contains("5 meshes are shown in turn, and their triangles differ"),
        "{message}"
    );
    // All have others.
    for page in 0..5 {
        triangles.truncate(30 - page);
        let other = mesh(&mut file, &positions, &triangles);
        file.json["nodes"][page]["mesh"] = json!(other);
    }
    let (code, message) = refuse_glb(&file);
    assert_eq!(code, "E_MESH_CHANGES");
    assert!(
        message.contains("node 0 has 30 triangles over 26 vertices, node 1 has 29")
            && message.contains("one mesh that moves"),
        "{message}"
    );
    // One page is never shown, so a frame shows none.
    let mut file = flip_book(5, Turning::Scale("STEP", 0.0));
    file.json["animations"][0]["channels"].as_array_mut().unwrap().remove(3);
    let (code, message) = refuse_glb(&file);
    assert!(code == "E_MESH_CHANGES" && message.contains("0.125 s of clip \"Walk\" 0 of them are shown"), "{message}");
}

#[test]
fn meshes_that_are_hidden_at_times_are_said() {
    for visible in [false, true] {
        let mut file = standing();
        let sword: Vec<Vec3> = body().0.iter().map(|&p| 0.3 * p + Vec3::X).collect();
        let index = mesh(&mut file, &sword, &body().1);
        let node = file.scene_node(json!({"mesh": index, "name": "sword"}));
        let walk =
            Moves(json!({"node": 0, "path": "translation"}), "LINEAR", &[0.0, 1.0], vec![0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
        let pointer = format!("/nodes/{node}/extensions/KHR_node_visibility/visible");
        let hides = if visible {
            let target = json!({"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": pointer}}});
            Moves(target, "STEP", &[0.0, 0.5], vec![0.0, 1.0])
        } else {
            Moves(json!({"node": node, "path": "scale"}), "STEP", &[0.0, 0.5], vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0])
        };
        clip(&mut file, "Draw", vec![walk, hides]);
        let imported = read_glb(&file, 10.0);
        assert!(warning(&imported, "W_GLTF_HIDDEN").contains("\"sword\""));
        assert_pose(&imported, 10, &[shifted(Vec3::Z), sword].concat());
    }
    // What is never shown is not drawn at all, however often.
    let mut file = standing();
    file.scene_node(json!({"mesh": 0, "extensions": {"KHR_node_visibility": {"visible": false}}}));
    for _ in 0..3 {
        file.scene_node(json!({"mesh": 0, "scale": [0.0, 0.0, 0.0]}));
    }
    clip(
        &mut file,
        "Walk",
        vec![Moves(json!({"node": 0, "path": "translation"}), "LINEAR", &[0.0, 1.0], vec![0.0; 6])],
    );
    file.json["extensionsUsed"] = json!(["KHR_node_visibility"]);
    let imported = read_glb(&file, 10.0);
    assert_pose(&imported, 0, &body().0);
    assert!(imported.warnings.is_empty(), "{:?}", imported.warnings);
}

#[test]
fn scenes_with_the_same_triangles_are_frames() {
    let mut file = Gltf::new();
    let (_, triangles) = body();
    let mut scenes = Vec::new();
    for k in 0..7 {
        let index = mesh(&mut file, &moved(k as f32), &triangles);
        let node = file.push("nodes", json!({"mesh": index}));
        scenes.push(json!({"nodes": [node]}));
    }
    file.json["scenes"] = json!(scenes);
    file.json["scene"] = json!(3);
    let imported = read_glb(&file, 24.0);
    assert_eq!(sequences(&imported), [("a", 7)]);
    assert!(warning(&imported, "W_GLTF_SCENES").contains("frames of one sequence"));
    (0..7).for_each(|k| assert_pose(&imported, k, &moved(k as f32)));
    // With other triangles in one of them, or with animations, only the file's own scene is read.
    clip(
        &mut file,
        "Walk",
        vec![Moves(json!({"node": 3, "path": "translation"}), "LINEAR", &[0.0, 1.0], vec![0.0; 6])],
    );
    let imported = read_glb(&file, 24.0);
    assert!(warning(&imported, "W_GLTF_SCENES").contains("only its own one"));
    assert_eq!(sequences(&imported), [("Walk", 25)]);
    file.json["animations"] = json!([]);
    let fewer = mesh(&mut file, &body().0, &triangles[1..]);
    file.json["nodes"][5]["mesh"] = json!(fewer);
    let imported = read_glb(&file, 24.0);
    assert!(warning(&imported, "W_GLTF_SCENES").contains("only its own one"));
    assert_pose(&imported, 0, &moved(3.0));
}
