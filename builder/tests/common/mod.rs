//! Inputs that the oracle tests share.
#![allow(dead_code, reason = "each test file uses its own part")]

use std::path::Path;
use std::process::Command;

use glam::{Quat, Vec3};
use shared::capture::Poses;
use shared::timeline::{Sequence, Timeline};
use shared::topology::{Topology, barycentric_areas};

/// A small deterministic source of numbers (SplitMix64).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub fn next_u64(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f32 {
        (self.next_u64() >> 40) as f32 / (1_u64 << 24) as f32
    }

    /// Uniform in [low, high).
    pub fn range(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    /// Uniform in 0..count.
    pub fn below(&mut self, count: usize) -> usize {
        (self.next_u64() % count as u64) as usize
    }
}

/// Triangles of an open tube of `rings` x `sides` vertices.
pub fn tube_triangles(rings: u32, sides: u32) -> Vec<[u32; 3]> {
    let mut triangles = Vec::new();
    for ring in 0..rings - 1 {
        for side in 0..sides {
            let next = (side + 1) % sides;
            let (a, b) = (ring * sides + side, ring * sides + next);
            let (c, d) = (a + sides, b + sides);
            triangles.extend([[a, c, b], [b, c, d]]);
        }
    }
    triangles
}

/// A tube that bends, twists, turns and walks, with noise: `frames` poses in random order of smoothness.
pub fn random_tube(rings: u32, sides: u32, frames: usize, noise: f32, seed: u64) -> (Topology, Poses) {
    let mut random = Random::new(seed);
    let mut poses = Poses::new((rings * sides) as usize);
    for _ in 0..frames {
        let (bend, twist, heading) = (random.range(-2.0, 2.0), random.range(-2.0, 2.0), random.range(-3.0, 3.0));
        let walked = Vec3::new(random.range(-3.0, 3.0), 0.0, random.range(-3.0, 3.0));
        let mut pose = Vec::new();
        for ring in 0..rings {
            let height = ring as f32 / (rings - 1) as f32;
            for side in 0..sides {
                let angle = std::f32::consts::TAU * side as f32 / sides as f32 + twist * height;
                let radius = 0.2 + 0.1 * (5.0 * height + bend).sin();
                let local = Vec3::new(radius * angle.cos(), 0.0, 0.6 * radius * angle.sin());
                let spine = Quat::from_rotation_x(bend * height);
                let jitter = Vec3::new(random.unit(), random.unit(), random.unit()) * noise;
                let point = spine * (local + Vec3::Y * (1.8 * height)) + jitter;
                pose.push(Quat::from_rotation_y(heading) * point + walked);
            }
        }
        poses.push(&pose);
    }
    let triangles = tube_triangles(rings, sides);
    let weights = barycentric_areas(&triangles, poses.frame(0));
    (Topology::new(rings * sides, triangles, weights).unwrap(), poses)
}

/// A timeline of sequences of the given lengths; `true` for a cyclic one.
pub fn timeline(fps: f32, lengths: &[(u32, bool)]) -> Timeline {
    let mut first_frame = 0;
    let sequences = lengths.iter().enumerate().map(|(index, &(frame_count, cyclic))| {
        first_frame += frame_count;
        let name = format!("sequence {index}");
        Sequence { name, labels: vec![], first_frame: first_frame - frame_count, frame_count, cyclic }
    });
    Timeline::new(fps, sequences.collect()).unwrap()
}

/// Every `step`-th frame of crane and of jumping, or nothing (with a sentence) where the captures are not there.
pub fn real_capture(step: usize) -> Option<(Topology, Poses, Timeline)> {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data/captured"));
    if !folder.exists() {
        assert!(std::env::var("CI").as_deref() != Ok("true"), "{} is required in CI", folder.display());
        println!("skipped: no captures in {}", folder.display());
        return None;
    }
    let scratch = tempfile::tempdir().unwrap();
    let (mut triangles, mut poses, mut lengths) = (Vec::new(), Poses::default(), Vec::new());
    for name in ["crane", "jumping"] {
        let target = scratch.path().join(name);
        std::fs::create_dir(&target).unwrap();
        let archive = folder.join(format!("{name}.tar.xz"));
        let status = Command::new("tar").arg("-xJf").arg(&archive).arg("-C").arg(&target).status().unwrap();
        assert!(status.success(), "tar could not read {}", archive.display());
        let mut files = obj_files(&target);
        files.sort();
        let mut count = 0;
        for file in files.iter().step_by(step) {
            let (pose, faces) = read_obj(file);
            if triangles.is_empty() {
                (triangles, poses) = (faces, Poses::new(pose.len()));
            }
            poses.push(&pose);
            count += 1;
        }
        lengths.push((count, false));
    }
    let weights = barycentric_areas(&triangles, poses.frame(0));
    let topology = Topology::new(poses.vertex_count() as u32, triangles, weights).unwrap();
    Some((topology, poses, timeline(25.0 / step as f32, &lengths)))
}

fn obj_files(folder: &Path) -> Vec<std::path::PathBuf> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(obj_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "obj") {
            files.push(path);
        }
    }
    files
}

fn read_obj(file: &Path) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let (mut pose, mut faces) = (Vec::new(), Vec::new());
    for line in std::fs::read_to_string(file).unwrap().lines() {
        let mut words = line.split_ascii_whitespace();
        let keyword = words.next();
        if keyword == Some("v") {
            let mut next = || words.next().unwrap().parse().unwrap();
            pose.push(Vec3::new(next(), next(), next()));
        } else if keyword == Some("f") {
            let mut next = || words.next().unwrap().split('/').next().unwrap().parse::<u32>().unwrap() - 1;
            faces.push([next(), next(), next()]);
        }
    }
    (pose, faces)
}
