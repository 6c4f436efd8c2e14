//! Distances, transitions and the essential graph of a long capture of a small mesh, with their times and memory.
//!
//! `cargo run --release -p reprise-pipeline --example long_capture -- [FRAMES] [WORK FOLDER]`
#![allow(clippy::print_stdout, reason = "an example that prints")]

use std::f32::consts::TAU;
use std::path::Path;
use std::time::Instant;

use actor::capture::{Capture, Poses};
use actor::surface::Surface;
use actor::timeline::{Sequence, Timeline};
use glam::{Quat, Vec3};
use job::work::WorkFolder;
use job::{Job, memory};
use kernels::random::noise1;
use kernels::topology::{Topology, barycentric_areas};
use pipeline::distance::{DistanceOptions, measure};
use pipeline::graph::{GraphOptions, essential_graph};

/// Rings of the tube and vertices of a ring.
const RINGS: u32 = 14;
const SIDES: u32 = 12;
/// Frames of a sequence.
const SEQUENCE: u32 = 500;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut words = std::env::args().skip(1);
    let frames: u32 = words.next().map_or(Ok(20_000), |word| word.parse())?;
    let work = words.next().map(|folder| WorkFolder::open(Path::new(&folder))).transpose()?;
    let job = Job::silent().with_work(work.as_ref());
    let capture = tube(frames)?;
    println!(
        "{frames} frames in {} sequences, {} vertices, {} triangles",
        capture.timeline.sequences().len(),
        capture.topology.vertex_count(),
        capture.topology.triangles().len()
    );
    let start = Instant::now();
    let measured = measure(&capture.topology, &capture.poses, &DistanceOptions::default(), &job)?;
    told("distances", start);
    let start = Instant::now();
    let graphed = essential_graph(&capture, &measured, &GraphOptions::default(), &job)?;
    told("transitions and essential graph", start);
    println!("{} transitions stay, {} dead ends", graphed.graph.transitions().len(), graphed.dead_ends.len());
    Ok(())
}

fn told(stage: &str, start: Instant) {
    let peak = memory::peak_bytes().map_or(f64::NAN, |bytes| bytes as f64 / 1e9);
    println!("{stage}: {:.1} s, peak memory so far {peak:.2} GB", start.elapsed().as_secs_f64());
}

/// A tube that bends, twists and walks, now one way, now another: 25 frames a second.
fn tube(frames: u32) -> Result<Capture, Box<dyn std::error::Error>> {
    let mut poses = Poses::new((RINGS * SIDES) as usize);
    let mut sequences = Vec::new();
    for first_frame in (0..frames).step_by(SEQUENCE as usize) {
        let frame_count = SEQUENCE.min(frames - first_frame);
        for frame in 0..frame_count {
            poses.push(&pose(u64::from(first_frame), frame as f32 / 25.0));
        }
        sequences.push(Sequence {
            name: first_frame.to_string(),
            labels: vec![],
            first_frame,
            frame_count,
            cyclic: false,
        });
    }
    let mut triangles = Vec::new();
    for (ring, side) in (0..RINGS - 1).flat_map(|ring| (0..SIDES).map(move |side| (ring, side))) {
        let (a, b) = (ring * SIDES + side, ring * SIDES + (side + 1) % SIDES);
        triangles.extend([[a, a + SIDES, b], [b, a + SIDES, b + SIDES]]);
    }
    let weights = barycentric_areas(&triangles, poses.frame(0));
    let topology = Topology::new(RINGS * SIDES, triangles, weights)?;
    let surface = Surface::plain(&topology);
    Ok(Capture::new("tube", topology, surface, Timeline::new(25.0, sequences)?, poses)?)
}

fn pose(seed: u64, time: f32) -> Vec<Vec3> {
    let slow = |channel: u64, rate: f32| noise1(seed * 8 + channel, rate * time);
    let (bend, lean, twist) = (1.4 * slow(0, 0.9), 0.8 * slow(1, 0.7), 1.2 * slow(2, 0.8));
    let gait = 0.35 * (TAU * time * (1.0 + 0.3 * slow(3, 0.2))).sin();
    let heading = Quat::from_rotation_y(2.0 * slow(4, 0.3));
    let walked = Vec3::new(0.4 * time, 0.0, 0.6 * slow(5, 0.5));
    let mut pose = Vec::with_capacity((RINGS * SIDES) as usize);
    for ring in 0..RINGS {
        let height = ring as f32 / (RINGS - 1) as f32;
        let spine = Quat::from_rotation_x((bend + gait) * height) * Quat::from_rotation_z(lean * height);
        for side in 0..SIDES {
            let angle = TAU * side as f32 / SIDES as f32 + twist * height;
            let around = Vec3::new(0.2 * angle.cos(), 1.8 * height, 0.14 * angle.sin());
            pose.push(heading * (spine * around) + walked);
        }
    }
    pose
}
