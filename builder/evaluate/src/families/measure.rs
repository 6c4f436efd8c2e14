//! What is measured of a sample and of what it is made of, without what the sample knows of itself.

use family::{Recorded, Sample};
use glam::{Vec3, Vec3Swizzles};
use kernels::align::Placement;

/// A vertex this close to the ground touches it, in metres.
const TOUCHES: f32 = 0.02;
/// A sole that moves slower than this stands, in metres a second.
const STANDS: f32 = 0.25;

/// Frames in a row on a ground.
pub struct Motion {
    pub poses: Vec<Vec<Vec3>>,
    pub floor: f32,
    /// Where the first frame comes again, for what repeats.
    pub end: Option<Placement>,
}

/// What was measured of it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Measures {
    /// How far vertices of soles slide while they stand, in millimetres per fiftieth of a second.
    pub slide: f64,
    /// The share of the steps in which a sole touches the ground that are too fast to be standing, in percent.
    pub fast: f64,
    /// The lowest point of a sole above the ground in millimetres.
    pub lowest: f64,
    /// Mean and largest mean acceleration of a vertex in a frame, in m/s^2.
    pub acceleration: [f64; 2],
    /// Mean volume in cubic metres.
    pub volume: f64,
}

impl Motion {
    /// The frames of a sample.
    pub fn of_sample(sample: &Sample) -> Self {
        Self { poses: sample.poses.clone(), floor: sample.floor, end: sample.cyclic.then_some(sample.end) }
    }

    /// Recorded frames.
    pub fn recorded(recorded: &Recorded, sequence: usize, frames: &[u32]) -> Self {
        let poses = frames.iter().map(|&frame| recorded.poses.frame(frame).to_vec()).collect();
        Self { poses, floor: recorded.floors.get(sequence).copied().unwrap_or(0.0), end: None }
    }

    /// The pose at a place, beyond the end where it comes again.
    fn at(&self, k: usize) -> Option<Vec<Vec3>> {
        let count = self.poses.len();
        match self.end {
            _ if k < count => Some(self.poses[k].clone()),
            Some(end) if k < 2 * count => {
                let mut pose = self.poses[k - count].clone();
                end.apply_all(&mut pose);
                Some(pose)
            }
            _ => None,
        }
    }

    /// Measures it.
    pub fn measures(&self, recorded: &Recorded) -> Measures {
        let fps = recorded.timeline.fps();
        let (mut slid, mut stood, mut fast, mut touched) = (0.0, 0.0, 0.0, 0.0);
        let mut accelerations = Vec::new();
        for k in 0..self.poses.len() {
            let here = &self.poses[k];
            let Some(next) = self.at(k + 1) else { continue };
            for foot in 0..recorded.feet.count() {
                let touches = |point: Vec3| point.y - self.floor < TOUCHES;
                let on: Vec<f32> = recorded
                    .sole(foot)
                    .filter(|&vertex| touches(here[vertex]) && touches(next[vertex]))
                    .map(|vertex| here[vertex].xz().distance(next[vertex].xz()))
                    .collect();
                if on.is_empty() {
                    continue;
                }
                let mean = on.iter().sum::<f32>() / on.len() as f32;
                touched += 1.0;
                if mean * fps < STANDS {
                    slid += f64::from(mean) * on.len() as f64;
                    stood += on.len() as f64;
                } else {
                    fast += 1.0;
                }
            }
            if let Some(after) = self.at(k + 2) {
                let bend = |v: usize| f64::from((here[v] + after[v] - 2.0 * next[v]).length());
                let mean = (0..here.len()).map(bend).sum::<f64>() / here.len() as f64;
                accelerations.push(mean * f64::from(fps * fps));
            }
        }
        let lowest = self.poses.iter().flat_map(|pose| {
            (0..recorded.feet.count()).map(move |foot| f64::from(recorded.lowest(foot, pose) - self.floor))
        });
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
        let volumes: Vec<f64> = self.poses.iter().map(|pose| volume(pose, recorded.topology.triangles())).collect();
        Measures {
            slide: slid / f64::max(stood, 1.0) * f64::from(fps) / 50.0 * 1e3,
            fast: 100.0 * fast / f64::max(touched, 1.0),
            lowest: lowest.fold(f64::INFINITY, f64::min) * 1e3,
            acceleration: [mean(&accelerations), accelerations.iter().copied().fold(0.0, f64::max)],
            volume: mean(&volumes),
        }
    }
}

/// The volume that a closed surface encloses.
fn volume(pose: &[Vec3], triangles: &[[u32; 3]]) -> f64 {
    let of = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|vertex| pose[vertex as usize].as_dvec3());
        a.dot(b.cross(c))
    };
    triangles.iter().map(of).sum::<f64>().abs() / 6.0
}
