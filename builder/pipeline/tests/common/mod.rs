//! Inputs that the oracle tests share.
#![allow(dead_code, reason = "each test file uses its own part")]

use actor::capture::Poses;
use actor::timeline::{Sequence, Timeline};
use fixtures::Random;
use glam::{Quat, Vec3};
use kernels::topology::{Topology, barycentric_areas};

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
