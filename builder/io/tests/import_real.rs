//! Import of real captures and characters, where the folder with them is at hand.

#![allow(clippy::unwrap_used, reason = "helpers of tests, too, end a test by panicking")]

mod import_support;

use job::Job;
use std::path::Path;

use capture_io::import::{Cyclic, ImportOptions, Imported, import};
use fixtures::{data, unpacked};
use glam::{Mat4, Quat, Vec3};
use import_support::check;
use serde_json::Value;

fn read(inputs: &[&Path], options: &ImportOptions) -> Imported {
    let inputs: Vec<String> = inputs.iter().map(|p| p.to_str().unwrap().to_owned()).collect();
    let imported = import(&inputs, options, &Job::silent()).unwrap_or_else(|e| panic!("{e}"));
    check(&imported);
    imported
}

#[test]
#[ignore = "reads ../shared/data"]
fn crane_and_jumping_are_one_capture() {
    let folder = tempfile::tempdir().unwrap();
    for (name, frames) in [("crane", ["0000", "0001", "0040"]), ("jumping", ["0001", "0002", "0003"])] {
        std::fs::create_dir(folder.path().join(name)).unwrap();
        for file in unpacked(name) {
            let file_name = file.file_name().unwrap();
            if frames.iter().any(|number| file_name.to_str().unwrap() == format!("mesh_{number}.obj")) {
                std::fs::copy(&file, folder.path().join(name).join(file_name)).unwrap();
            }
        }
    }
    let options = ImportOptions { fps: Some(25.0), ..ImportOptions::default() };
    let imported = read(&[&folder.path().join("crane"), &folder.path().join("jumping")], &options);
    let capture = &imported.capture;
    assert_eq!(capture.topology.vertex_count(), 10_002);
    assert_eq!(capture.topology.triangles().len(), 20_000);
    assert_eq!(capture.surface.corners.len(), 10_002);
    let sequences: Vec<_> = capture.timeline.sequences().iter().map(|s| (s.name.as_str(), s.frame_count)).collect();
    assert_eq!(sequences, [("crane", 3), ("jumping", 3)]);
    assert!(imported.warnings.iter().any(|w| w.contains("between 1 and 40")), "{:?}", imported.warnings);

    // Against a plain reading of one file.
    let text = std::fs::read_to_string(folder.path().join("jumping/mesh_0002.obj")).unwrap();
    let numbers = |line: &str| line.split(' ').skip(1).map(|w| w.parse::<f32>().unwrap()).collect::<Vec<_>>();
    let vertices: Vec<Vec3> =
        text.lines().filter(|l| l.starts_with("v ")).map(|l| Vec3::from_slice(&numbers(l))).collect();
    let faces: Vec<[u32; 3]> = text
        .lines()
        .filter(|l| l.starts_with("f "))
        .map(|l| {
            let corners: Vec<u32> = l[2..].split_whitespace().map(|w| w.parse::<u32>().unwrap() - 1).collect();
            corners.try_into().unwrap()
        })
        .collect();
    assert_eq!(capture.poses.frame(4), vertices);
    assert_eq!(capture.topology.triangles(), faces);

    // A folder of such folders is the same capture.
    let again = read(&[folder.path()], &options);
    assert_eq!(again.capture.poses, capture.poses);
    assert_eq!(again.capture.timeline, capture.timeline);
}

/// No frame is left out of a loop.
fn plain() -> ImportOptions {
    ImportOptions { cyclic: Cyclic::None, ..ImportOptions::default() }
}

#[test]
#[ignore = "reads ../shared/data"]
fn fox_has_three_clips() {
    let data = data();
    let path = data.join("gltf/fox/Fox.glb");
    let options = ImportOptions { unit: Some(0.01), ..plain() };
    let imported = read(&[&path], &options);
    let capture = &imported.capture;
    let sequences: Vec<_> = capture.timeline.sequences().iter().map(|s| (s.name.as_str(), s.frame_count)).collect();
    assert_eq!(sequences, [("Survey", 104), ("Walk", 23), ("Run", 36)]);
    assert_eq!(capture.vertex_of_file_vertex.len(), 1728);
    assert_eq!(capture.topology.vertex_count(), 290);
    assert_eq!(capture.topology.triangles().len(), 576);
    assert_eq!((capture.surface.images[0].width, capture.surface.images[0].height), (1024, 1024));
    compare_with_plain_skinning(&path, &imported, 0.01, &[("Survey", 0), ("Survey", 102), ("Walk", 13), ("Run", 34)]);
}

#[test]
#[ignore = "reads ../shared/data"]
fn knight_has_76_clips_and_15_meshes() {
    let data = data();
    let path = data.join("gltf/kaykit-knight/Knight.glb");
    let imported = read(&[&path], &ImportOptions { fps: Some(12.0), ..plain() });
    let capture = &imported.capture;
    assert_eq!(capture.timeline.sequences().len(), 76);
    assert!(capture.timeline.sequences().iter().any(|s| s.frame_count == 1));
    assert_eq!(capture.vertex_of_file_vertex.len(), 7024);
    assert_eq!(capture.surface.parts.len(), 1);
    assert!(capture.topology.component_count() >= 15);
    compare_with_plain_skinning(&path, &imported, 1.0, &[("1H_Melee_Attack_Chop", 5), ("Idle", 9), ("Walking_A", 7)]);
}

#[test]
#[ignore = "reads ../shared/data"]
fn lumberjack_and_cesium_man_are_read() {
    let data = data();
    let path = data.join("gltf/lumberjack/lumberjack.glb");
    let imported = read(&[&path], &plain());
    let counts: Vec<_> =
        imported.capture.timeline.sequences().iter().map(|s| (s.name.as_str(), s.frame_count)).collect();
    assert_eq!(counts[0], ("Walk", 31));
    assert_eq!(imported.capture.vertex_of_file_vertex.len(), 3068);
    compare_with_plain_skinning(&path, &imported, 1.0, &[("Walk", 11), ("Poses", 100)]);

    let path = data.join("gltf/cesium-man/CesiumMan.glb");
    let imported = read(&[&path], &plain());
    assert_eq!(imported.capture.timeline.sequences().len(), 1);
    assert!(imported.warnings.iter().any(|w| w.contains("19 unnamed animations")), "{:?}", imported.warnings);
    compare_with_plain_skinning(&path, &imported, 1.0, &[("CesiumMan", 0), ("CesiumMan", 31)]);
}

#[test]
#[ignore = "reads ../shared/data"]
fn thread_counts_do_not_matter() {
    let data = data();
    let path = data.join("gltf/fox/Fox.glb");
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| read(&[&path], &ImportOptions::default()))
    };
    assert_eq!(with(1), with(3));
}

// A plain reading of GLB with serde_json, written apart from the importer: float accessors without stride or sparse
// parts, LINEAR and STEP channels, in double precision where glam has it for free.

struct Plain {
    json: Value,
    bin: Vec<u8>,
}

impl Plain {
    fn open(path: &Path) -> Self {
        let bytes = std::fs::read(path).unwrap();
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
        let json_length = word(12);
        let json = serde_json::from_slice(&bytes[20..20 + json_length]).unwrap();
        Self { json, bin: bytes[20 + json_length + 8..].to_vec() }
    }

    fn numbers(&self, accessor: &Value) -> Vec<Vec<f32>> {
        let accessor = &self.json["accessors"][accessor.as_u64().unwrap() as usize];
        let view = &self.json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
        let width = match accessor["type"].as_str().unwrap() {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            "MAT4" => 16,
            other => panic!("{other}"),
        };
        let size = match accessor["componentType"].as_u64().unwrap() {
            5121 => 1,
            5123 => 2,
            5125 | 5126 => 4,
            other => panic!("{other}"),
        };
        let number = |bytes: &[u8]| match (size, accessor["componentType"].as_u64()) {
            (1, _) => f32::from(bytes[0]),
            (2, _) => f32::from(u16::from_le_bytes([bytes[0], bytes[1]])),
            (_, Some(5126)) => f32::from_le_bytes(bytes.try_into().unwrap()),
            _ => u32::from_le_bytes(bytes.try_into().unwrap()) as f32,
        };
        let stride = view["byteStride"].as_u64().map_or(width * size, |s| s as usize);
        let offset = |v: &Value| v["byteOffset"].as_u64().unwrap_or(0) as usize;
        let start = offset(view) + offset(accessor);
        (0..accessor["count"].as_u64().unwrap() as usize)
            .map(|k| {
                let at = start + k * stride;
                (0..width).map(|c| number(&self.bin[at + c * size..at + (c + 1) * size])).collect()
            })
            .collect()
    }

    fn local(&self, node: usize, clip: &[&Value], time: f32) -> Mat4 {
        let n = &self.json["nodes"][node];
        let list = |v: &Value| v.as_array().map(|a| a.iter().map(|x| x.as_f64().unwrap() as f32).collect::<Vec<_>>());
        if let Some(matrix) = list(&n["matrix"]) {
            return Mat4::from_cols_slice(&matrix);
        }
        let mut parts = [
            list(&n["translation"]).unwrap_or(vec![0.0; 3]),
            list(&n["rotation"]).unwrap_or(vec![0.0, 0.0, 0.0, 1.0]),
            list(&n["scale"]).unwrap_or(vec![1.0; 3]),
        ];
        for animation in clip {
            for channel in animation["channels"].as_array().unwrap() {
                if channel["target"]["node"].as_u64() != Some(node as u64) {
                    continue;
                }
                let slot = ["translation", "rotation", "scale"].iter().position(|p| channel["target"]["path"] == *p);
                let sampler = &animation["samplers"][channel["sampler"].as_u64().unwrap() as usize];
                let times: Vec<f32> = self.numbers(&sampler["input"]).concat();
                let values = self.numbers(&sampler["output"]);
                let next = times.iter().position(|&t| t > time);
                parts[slot.unwrap()] = match next {
                    Some(0) => values[0].clone(),
                    None => values[times.len() - 1].clone(),
                    Some(k) if sampler["interpolation"] == "STEP" => values[k - 1].clone(),
                    Some(k) => {
                        let s = (time - times[k - 1]) / (times[k] - times[k - 1]);
                        let (a, b) = (&values[k - 1], &values[k]);
                        if slot == Some(1) {
                            Quat::from_slice(a).slerp(Quat::from_slice(b), s).to_array().to_vec()
                        } else {
                            a.iter().zip(b).map(|(a, b)| a * (1.0 - s) + b * s).collect()
                        }
                    }
                };
            }
        }
        Mat4::from_scale_rotation_translation(
            Vec3::from_slice(&parts[2]),
            Quat::from_slice(&parts[1]).normalize(),
            Vec3::from_slice(&parts[0]),
        )
    }

    fn world(&self, node: usize, clip: &[&Value], time: f32) -> Mat4 {
        let nodes = self.json["nodes"].as_array().unwrap();
        let is_parent = |n: &Value| n["children"].as_array().is_some_and(|c| c.iter().any(|c| c == node as u64));
        let local = self.local(node, clip, time);
        match nodes.iter().position(is_parent) {
            Some(parent) => self.world(parent, clip, time) * local,
            None => local,
        }
    }

    /// Every vertex of every mesh, nodes in the order in which a walk from the scene's roots meets them.
    fn pose(&self, clip: &[&Value], time: f32) -> Vec<Vec3> {
        let mut pose = Vec::new();
        let mut stack: Vec<usize> = Vec::new();
        let scene = &self.json["scenes"][0]["nodes"];
        stack.extend(scene.as_array().unwrap().iter().rev().map(|n| n.as_u64().unwrap() as usize));
        while let Some(node) = stack.pop() {
            let n = &self.json["nodes"][node];
            for child in n["children"].as_array().into_iter().flatten().rev() {
                stack.push(child.as_u64().unwrap() as usize);
            }
            let Some(mesh) = n["mesh"].as_u64() else { continue };
            let joints: Option<Vec<Mat4>> = n["skin"].as_u64().map(|skin| {
                let skin = &self.json["skins"][skin as usize];
                let binds = self.numbers(&skin["inverseBindMatrices"]);
                let joints = skin["joints"].as_array().unwrap().iter().zip(binds);
                joints
                    .map(|(j, bind)| {
                        self.world(j.as_u64().unwrap() as usize, clip, time) * Mat4::from_cols_slice(&bind)
                    })
                    .collect()
            });
            let world = self.world(node, clip, time);
            for primitive in self.json["meshes"][mesh as usize]["primitives"].as_array().unwrap() {
                let attributes = &primitive["attributes"];
                let positions = self.numbers(&attributes["POSITION"]);
                let skin = joints.as_ref().map(|joints| {
                    (joints, self.numbers(&attributes["JOINTS_0"]), self.numbers(&attributes["WEIGHTS_0"]))
                });
                for (v, p) in positions.iter().enumerate() {
                    let p = Vec3::from_slice(p);
                    pose.push(match &skin {
                        None => world.transform_point3(p),
                        Some((joints, which, weights)) => {
                            let total: f32 = weights[v].iter().sum();
                            let blended = (0..4).fold(Mat4::ZERO, |sum, k| {
                                sum + joints[which[v][k] as usize] * (weights[v][k] / total)
                            });
                            blended.transform_point3(p)
                        }
                    });
                }
            }
        }
        pose
    }
}

fn compare_with_plain_skinning(path: &Path, imported: &Imported, unit: f32, samples: &[(&str, u32)]) {
    let plain = Plain::open(path);
    let capture = &imported.capture;
    let animations = plain.json["animations"].as_array().unwrap();
    for &(name, local) in samples {
        let clip: Vec<&Value> = match animations.iter().find(|a| a["name"] == name) {
            Some(animation) => vec![animation],
            None => animations.iter().collect(),
        };
        let samplers = clip.iter().flat_map(|a| a["samplers"].as_array().unwrap());
        let start = samplers.map(|s| plain.numbers(&s["input"])[0][0]).fold(f32::INFINITY, f32::min);
        let sequence = capture.timeline.sequences().iter().find(|s| s.name == name).expect(name);
        assert!(local < sequence.frame_count, "{name} has {} frames", sequence.frame_count);
        let expected = plain.pose(&clip, start + local as f32 / capture.timeline.fps());
        let found = capture.poses.frame(sequence.first_frame + local);
        assert_eq!(expected.len(), capture.vertex_of_file_vertex.len());
        for (v, (&p, &welded)) in expected.iter().zip(&capture.vertex_of_file_vertex).enumerate() {
            let error = found[welded as usize].distance(p * unit);
            assert!(error < 5e-5, "{name} frame {local} vertex {v}: {error} m");
        }
    }
}
