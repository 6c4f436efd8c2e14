//! Smooth synthetic input at the sizes of real captures.
#![allow(dead_code, reason = "each benchmark uses its own part")]

use actor::capture::Poses;
use actor::timeline::{Sequence, Timeline};
use glam::{Quat, Vec3};
use kernels::topology::{Topology, barycentric_areas};
use pipeline::distance::DistanceMatrix;

/// A tube of about `vertices` vertices and twice as many triangles that bends, twists and walks smoothly.
pub fn capture(frames: usize, vertices: usize) -> (Topology, Poses) {
    let sides = 50;
    let rings = vertices / sides;
    let mut triangles = Vec::new();
    for ring in 0..rings as u32 - 1 {
        for side in 0..sides as u32 {
            let (a, b) = (ring * sides as u32 + side, ring * sides as u32 + (side + 1) % sides as u32);
            triangles.extend([[a, a + sides as u32, b], [b, a + sides as u32, b + sides as u32]]);
        }
    }
    let mut poses = Poses::new(rings * sides);
    let mut pose = vec![Vec3::ZERO; rings * sides];
    for frame in 0..frames {
        let time = frame as f32 / 50.0;
        for (v, point) in pose.iter_mut().enumerate() {
            let (height, side) = ((v / sides) as f32 / rings as f32, (v % sides) as f32 / sides as f32);
            let angle = std::f32::consts::TAU * side + height * (1.1 * time).sin();
            let radius = 0.2 + 0.03 * (9.0 * height + 2.0 * time).sin() + 0.01 * (31.0 * side + 17.0 * height).sin();
            let local = Vec3::new(radius * angle.cos(), 1.8 * height, 0.7 * radius * angle.sin());
            let bend = Quat::from_rotation_x(height * (1.7 * time).sin()) * Quat::from_rotation_z(height * time.cos());
            *point = Quat::from_rotation_y(0.6 * time) * (bend * local) + Vec3::new(0.5 * time, 0.0, time.sin());
        }
        poses.push(&pose);
    }
    let weights = barycentric_areas(&triangles, poses.frame(0));
    (Topology::new((rings * sides) as u32, triangles, weights).unwrap(), poses)
}

/// A capture's frames in sequences of about 250.
pub fn timeline(frames: usize) -> Timeline {
    let count = frames.div_ceil(250);
    let bounds: Vec<u32> = (0..=count).map(|k| (k * frames / count) as u32).collect();
    let sequence = |k: usize| Sequence {
        name: format!("sequence {k}"),
        labels: vec![],
        first_frame: bounds[k],
        frame_count: bounds[k + 1] - bounds[k],
        cyclic: false,
    };
    Timeline::new(50.0, (0..count).map(sequence).collect()).unwrap()
}

/// Distances of a made-up motion: frames are points on smooth closed curves in several dimensions.
pub fn distances(frames: usize) -> DistanceMatrix {
    let features: Vec<[f32; 8]> = (0..frames)
        .map(|frame| {
            let time = frame as f32 / 50.0;
            std::array::from_fn(|k| (time * (0.9 + 0.37 * k as f32) + (k * k) as f32).sin() / (1.0 + k as f32).sqrt())
        })
        .collect();
    DistanceMatrix::from_fn(frames, |i, j| {
        let squared: f32 = features[i].iter().zip(&features[j]).map(|(a, b)| (a - b) * (a - b)).sum();
        0.25 * squared.sqrt()
    })
}
