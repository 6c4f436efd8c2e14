//! Performers who do the same: the woman, and another figure of which the truth is known.

use actor::capture::Poses;
use actor::feet::Feet;
use actor::motion::Motion;
use actor::timeline::{Sequence, Timeline};
use glam::{Vec3, Vec3Swizzles};
use kernels::align::{align_heading, centre_of_mass, rotate};
use kernels::topology::{Topology, barycentric_areas};
use parts::Parts;
use performer::Kind;
use performer::figure::Figure;
use performer::motion::BEHAVIOURS;
use performer::perform::{Take, perform};
use rayon::prelude::*;
use transfer::Subject;

/// Frames a second.
pub const FPS: f32 = 25.0;
/// As many times as many are performed of those whose time is warped.
const FINER: usize = 4;

/// What is learned from, and what is not.
pub const LEARNED: [&str; 5] = ["walk", "run", "jump", "kick", "duck"];

/// A sequence to perform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wanted {
    /// Its behaviour, by its number.
    pub behaviour: usize,
    /// The take.
    pub seed: u64,
    /// How far its time is warped, in seconds: 0 for not at all.
    pub warp: f64,
}

/// A performance in memory.
pub struct Performed {
    pub topology: Topology,
    pub timeline: Timeline,
    pub poses: Poses,
    feet: Feet,
    motion: Motion,
    pub parts: Parts,
    /// Where each frame is in the sequence as it is without a warp, in frames of that sequence.
    pub times: Vec<f64>,
}

/// Sequences of all behaviours that are learned from, or of the others.
pub fn takes(learned: bool, seed: u64, warp: f64) -> Vec<Wanted> {
    let own = |behaviour: &usize| LEARNED.contains(&BEHAVIOURS[*behaviour].0) == learned;
    (0..BEHAVIOURS.len()).filter(own).map(|behaviour| Wanted { behaviour, seed, warp }).collect()
}

impl Performed {
    /// What `kind` does.
    pub fn new(kind: Kind, vertices: usize, wanted: &[Wanted]) -> Self {
        let figure = Figure::of(kind, vertices, 128);
        let made: Vec<(Vec<Vec<Vec3>>, Vec<f64>)> = wanted.par_iter().map(|wanted| sequence(&figure, wanted)).collect();
        let mut poses = Poses::new(figure.mesh.positions.len());
        let (mut sequences, mut times) = (Vec::new(), Vec::new());
        for (wanted, (frames, own)) in wanted.iter().zip(made) {
            let label = BEHAVIOURS[wanted.behaviour].0.to_owned();
            let (first_frame, frame_count) = (poses.len() as u32, frames.len() as u32);
            let name = format!("{label} {} {}", wanted.seed, wanted.warp);
            sequences.push(Sequence { name, labels: vec![label], first_frame, frame_count, cyclic: false });
            frames.iter().for_each(|frame| poses.push(frame));
            times.extend(own);
        }
        let triangles = figure.mesh.triangles;
        let weights = barycentric_areas(&triangles, poses.frame(0));
        // What the performer makes is whole.
        let (topology, timeline) = (
            Topology::new(poses.vertex_count() as u32, triangles, weights).expect("the figure has a surface"),
            Timeline::new(FPS, sequences).expect("sequences follow each other"),
        );
        let feet = pipeline::feet::feet(&topology, &timeline, &poses);
        let motion = Motion::measure(&timeline, topology.weights(), &mut poses.clone()).expect("poses are there");
        let parts = Parts::find(&topology, &poses);
        Self { topology, timeline, poses, feet, motion, parts, times }
    }

    /// It as transfer sees it.
    pub fn subject(&self) -> Subject<'_> {
        Subject::new((&self.topology, &self.timeline, &self.poses), &self.motion, &self.feet, self.parts.clone())
    }

    /// Root of the mean square of how far the vertices of `pose` lie from those of a frame, in metres, once it is turned about +Y
    /// and moved along the ground onto it: what is seen, but for where it is.
    pub fn off(&self, frame: u32, pose: &[Vec3]) -> f64 {
        let offs = self.offs(frame, pose);
        (offs.iter().sum::<f64>() / offs.len() as f64).sqrt()
    }

    /// The squares of how far the vertices of `pose` are off, likewise.
    pub fn offs(&self, frame: u32, pose: &[Vec3]) -> Vec<f64> {
        let (weights, truth) = (self.topology.weights(), self.poses.frame(frame));
        let turn = align_heading(truth, pose, weights);
        let to = centre_of_mass(truth, weights).xz() - rotate(turn, centre_of_mass(pose, weights).xz());
        let apart = |(point, truth): (&Vec3, &Vec3)| {
            let ground = rotate(turn, point.xz()) + to;
            f64::from(Vec3::new(ground.x, point.y, ground.y).distance_squared(*truth))
        };
        pose.iter().zip(truth).map(apart).collect()
    }
}

/// The frames of a sequence, and where they are without its warp.
fn sequence(figure: &Figure, wanted: &Wanted) -> (Vec<Vec<Vec3>>, Vec<f64>) {
    let (name, seconds) = BEHAVIOURS[wanted.behaviour];
    let count = (seconds * FPS).round() as usize;
    let finer = if wanted.warp == 0.0 { 1 } else { FINER };
    let seed = kernels::random::mix(wanted.seed, wanted.behaviour as u64);
    let take = Take { name: name.into(), behaviour: wanted.behaviour, first_frame: 0, frames: count * finer, seed };
    let frames = perform(figure, &take, FPS * finer as f32);
    let length = (count - 1) as f64 / f64::from(FPS);
    let at = |frame: usize| {
        let time = frame as f64 / f64::from(FPS);
        // Two waves, at rest at both ends: from about half as fast to twice as fast.
        let wave = (std::f64::consts::TAU * 1.5 * time / length).sin() * (std::f64::consts::PI * time / length).sin();
        let time = (time + wanted.warp * wave).clamp(0.0, length);
        (time * f64::from(FPS) * finer as f64).round() / finer as f64
    };
    let times: Vec<f64> = (0..count).map(at).collect();
    let frame = |time: &f64| frames[((time * finer as f64) as usize).min(frames.len() - 1)].positions.clone();
    (times.iter().map(frame).collect(), times)
}
