//! What stays on what is found from how it moves.
#![allow(clippy::unwrap_used, reason = "helpers of tests may fail loudly")]

use actor::capture::Poses;
use glam::{Quat, Vec3};
use kernels::topology::Topology;
use pipeline::ties::ties;

/// A ball of a ring of points around each of some middles.
fn ball(middle: Vec3, radius: f32) -> Vec<Vec3> {
    let ring = |at: usize| {
        let angle = at as f32 * std::f32::consts::TAU / 12.0;
        middle + radius * Vec3::new(angle.cos(), angle.sin(), 0.0)
    };
    (0..12).map(ring).chain([middle + radius * Vec3::Z, middle - radius * Vec3::Z]).collect()
}

fn faces(count: u32) -> Vec<[u32; 3]> {
    let ball =
        |first: u32| (0..12).flat_map(move |at| [12, 13].map(|pole| [first + at, first + (at + 1) % 12, first + pole]));
    (0..count).flat_map(|index| ball(14 * index)).collect()
}

/// A head that turns, an eye on it, a ball that circles near it, a body, and a pebble on the ground far away.
fn poses() -> Poses {
    let mut poses = Poses::new(14 * 5);
    for frame in 0..50 {
        let time = frame as f32 * 0.1;
        let turn = Quat::from_rotation_y(time.sin());
        let head = Vec3::new(0.0, 1.6, 0.2 * time);
        let put = |points: Vec<Vec3>| points.into_iter().map(move |point| turn * point + head);
        let around = Quat::from_rotation_y(2.0 * time) * Vec3::new(0.0, 0.0, 0.16);
        let body = ball(Vec3::new(0.0, 0.7, 0.2 * time), 0.7);
        let pose: Vec<Vec3> = put(ball(Vec3::ZERO, 0.15))
            .chain(put(ball(Vec3::new(0.05, 0.05, 0.15), 0.02)))
            .chain(ball(head + around, 0.03))
            .chain(body)
            .chain(ball(Vec3::new(4.0, 0.05, 0.0), 0.05))
            .collect();
        poses.push(&pose);
    }
    poses
}

#[test]
fn an_eye_follows_its_head_and_what_circles_it_does_not() {
    let topology = Topology::new(14 * 5, faces(5), vec![1.0; 70]).unwrap();
    let found = ties(&topology, &poses());
    let component = |end: &[u32]| topology.component_of_vertex()[end[0] as usize];
    let pairs: Vec<(u32, u32)> =
        found.all().iter().map(|tie| (component(&tie.contact), component(&tie.patch))).collect();
    assert!(pairs.contains(&(1, 0)), "{pairs:?}");
    assert!(pairs.iter().all(|pair| pair.0 != 2 && pair.0 != 4), "{pairs:?}");
}

#[test]
fn one_component_has_no_ties() {
    let topology = Topology::new(14, faces(1), vec![1.0; 14]).unwrap();
    let mut poses = Poses::new(14);
    poses.push(&ball(Vec3::Y, 0.5));
    assert!(ties(&topology, &poses).all().is_empty());
}
