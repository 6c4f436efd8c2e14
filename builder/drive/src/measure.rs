//! How good driven frames are: soles on the floor, sliding, volume.

use actor::capture::Poses;
use driving::Body;
use driving::plant::{Planted, Standing};
use glam::Vec3;
use kernels::topology::Topology;
use serde::Serialize;

/// Recorded frames that are measured.
const SAMPLES: usize = 200;

/// What was measured over all frames.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Measures {
    /// Frames.
    pub frames: usize,
    /// The share of them in which a foot stands.
    pub standing: f32,
    /// How far soles that stand are from the floor, in millimetres: on average, and at most.
    pub sole_off_mm: [f32; 2],
    /// How far soles that stand slide from frame to frame, in millimetres: on average, and at most.
    pub slide_mm: [f32; 2],
    /// How far anything is below the floor at most, in millimetres.
    pub below_mm: f32,
    /// Volume beside the mean one of the recorded frames: the least, and the mean.
    pub volume: [f32; 2],
    /// The same of the recorded frames: the least, and the largest.
    pub recorded_volume: [f32; 2],
    /// Largest mean acceleration of a frame's vertices beside the mean one of all: how much a frame jerks.
    pub jerk: f32,
}

/// Measures `poses`, whose feet stand as `planted` says.
#[must_use]
pub fn measure(body: &Body, topology: &Topology, recorded: &Poses, poses: &[Vec<Vec3>], planted: &Planted) -> Measures {
    let (mut off, mut slide) = (Mean::default(), Mean::default());
    let mut standing = 0;
    let mut below = 0.0_f32;
    for (frame, pose) in poses.iter().enumerate() {
        let feet = &planted.frames[frame].feet;
        standing += usize::from(feet.iter().any(|foot| foot.flat.is_some()));
        below = pose.iter().map(|point| body.floor - point.y).fold(below, f32::max);
        for (side, leg) in body.legs.iter().enumerate() {
            for (is_heel, patch) in [(true, &leg.foot.heel_patch), (false, &leg.foot.fore_patch)] {
                let stands = |foot: &Standing| foot.flat.is_some() && if is_heel { foot.heel } else { foot.ball };
                if !stands(&feet[side]) || patch.is_empty() {
                    continue;
                }
                let over = |of: &dyn Fn(u32) -> f32| patch.iter().map(|&v| of(v)).sum::<f32>() / patch.len() as f32;
                off.add(over(&|v| (pose[v as usize].y - body.floor).abs()));
                if frame > 0 && stands(&planted.frames[frame - 1].feet[side]) && same(planted, frame, side) {
                    let before = &poses[frame - 1];
                    slide.add(over(&|v| (pose[v as usize] - before[v as usize]).length()));
                }
            }
        }
    }
    let seen = volumes(topology, recorded.iter().step_by(recorded.len().div_ceil(SAMPLES).max(1)));
    let whole = mean(&seen).max(f32::MIN_POSITIVE);
    let driven = volumes(topology, poses.iter().map(Vec::as_slice));
    let least = |volumes: &[f32]| volumes.iter().copied().fold(f32::INFINITY, f32::min) / whole;
    Measures {
        frames: poses.len(),
        standing: standing as f32 / poses.len().max(1) as f32,
        sole_off_mm: off.told(),
        slide_mm: slide.told(),
        below_mm: 1000.0 * below,
        volume: [least(&driven), mean(&driven) / whole],
        recorded_volume: [least(&seen), seen.iter().copied().fold(0.0, f32::max) / whole],
        jerk: jerk(poses),
    }
}

/// Whether a foot stands in the same place as in the frame before.
fn same(planted: &Planted, frame: usize, side: usize) -> bool {
    planted.frames[frame].feet[side].flat == planted.frames[frame - 1].feet[side].flat
}

fn mean(values: &[f32]) -> f32 {
    values.iter().sum::<f32>() / values.len().max(1) as f32
}

fn volumes<'a>(topology: &Topology, poses: impl Iterator<Item = &'a [Vec3]>) -> Vec<f32> {
    poses.map(|pose| volume(topology, pose) as f32).collect()
}

fn volume(topology: &Topology, pose: &[Vec3]) -> f64 {
    let of = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|v| pose[v as usize].as_dvec3());
        a.dot(b.cross(c)) / 6.0
    };
    topology.triangles().iter().map(of).sum()
}

fn jerk(poses: &[Vec<Vec3>]) -> f32 {
    let bends: Vec<f32> = poses
        .windows(3)
        .map(|three| {
            let bend = |v: usize| (three[0][v] + three[2][v] - 2.0 * three[1][v]).length();
            (0..three[0].len()).map(bend).sum::<f32>()
        })
        .collect();
    let mean = bends.iter().sum::<f32>() / bends.len().max(1) as f32;
    if mean > 0.0 { bends.iter().copied().fold(0.0, f32::max) / mean } else { 0.0 }
}

#[derive(Default)]
struct Mean {
    sum: f32,
    count: usize,
    most: f32,
}

impl Mean {
    fn add(&mut self, value: f32) {
        self.sum += value;
        self.count += 1;
        self.most = self.most.max(value);
    }

    /// Mean and maximum in millimetres.
    fn told(&self) -> [f32; 2] {
        [1000.0 * self.sum / self.count.max(1) as f32, 1000.0 * self.most]
    }
}
