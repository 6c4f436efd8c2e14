//! What the built-in performer does for families: steady steps and jumps of which the one between is the truth.

use actor::capture::{Capture, Poses};
use actor::surface::Surface;
use actor::timeline::{Sequence, Timeline};
use kernels::random::mix;
use kernels::topology::{Topology, barycentric_areas};
use performer::Kind;
use performer::figure::Figure;
use performer::motion::{Motion, leap, steady};
use performer::perform::perform_motion;
use rayon::prelude::*;

/// Frames a second, and vertices.
const FPS: f32 = 50.0;
const VERTICES: usize = 2500;
/// Seconds of steady steps.
const STEADY: f32 = 3.0;
/// Degrees a second of the turns.
const TURN: f32 = 60.0;

/// The sequences: what families are made of, and what nobody learns from.
pub const WALK: &str = "walk 1.3 m/s";
pub const RUN: &str = "run 3.0 m/s";
pub const JOG: &str = "jog 2.1 m/s";
pub const LEFT: &str = "walk left";
pub const RIGHT: &str = "walk right";
pub const LOW: &str = "jump low, near";
pub const HIGH: &str = "jump high, far";
pub const MIDDLE: &str = "jump between";

/// The performance, in memory.
pub fn performed(kind: Kind, seed: u64) -> Capture {
    let figure = Figure::of(kind, VERTICES, 128);
    let seed = |k: u64| mix(seed, 700 + k);
    let motions: [(&str, Motion); 8] = [
        (WALK, steady(STEADY, seed(0), 1.3, 0.0)),
        (RUN, steady(STEADY, seed(1), 3.0, 0.0)),
        (JOG, steady(STEADY, seed(2), 2.1, 0.0)),
        (LEFT, steady(STEADY, seed(3), 1.2, TURN)),
        (RIGHT, steady(STEADY, seed(4), 1.2, -TURN)),
        (LOW, leap(seed(5), 0.35, 0.40)),
        (HIGH, leap(seed(6), 0.95, 0.56)),
        (MIDDLE, leap(seed(7), 0.65, 0.486)),
    ];
    let made: Vec<_> = motions
        .par_iter()
        .map(|(_, motion)| perform_motion(&figure, motion, (motion.seconds * FPS).round() as usize, FPS))
        .collect();
    let mut poses = Poses::new(figure.mesh.positions.len());
    let mut sequences = Vec::new();
    for ((name, _), frames) in motions.iter().zip(made) {
        let (first_frame, frame_count) = (poses.len() as u32, frames.len() as u32);
        sequences.push(Sequence { name: (*name).into(), labels: vec![], first_frame, frame_count, cyclic: false });
        frames.iter().for_each(|frame| poses.push(&frame.positions));
    }
    let triangles = figure.mesh.triangles;
    let weights = barycentric_areas(&triangles, poses.frame(0));
    // What the performer makes is whole.
    let topology = Topology::new(poses.vertex_count() as u32, triangles, weights).expect("the figure has a surface");
    let timeline = Timeline::new(FPS, sequences).expect("sequences follow each other");
    let surface = Surface::plain(&topology);
    Capture::new("performer", topology, surface, timeline, poses).expect("a whole capture")
}
