//! A take: one behaviour performed from its first frame to its last.

use glam::Vec3;

use super::figure::Figure;
use super::hair::Ponytail;
use super::motion::{self, BEHAVIOURS, Motion};
use super::skeleton::{BodyState, JOINT_COUNT, solve};
use kernels::random::mix;
use rig::Rigid;
use rig::Skin;

/// Seconds performed before the first frame, so that cloth and hair are in motion.
const LEAD_IN: f32 = 1.0;

/// One sequence to perform.
#[derive(Clone, Debug, PartialEq)]
pub struct Take {
    /// Name of the sequence, unique in the capture: `walk`, or `walk_2` for the second take of it.
    pub name: String,
    /// Index in [`BEHAVIOURS`].
    pub behaviour: usize,
    /// Its first frame, counted over the whole capture.
    pub first_frame: usize,
    /// Number of frames.
    pub frames: usize,
    /// Seed of this take.
    pub seed: u64,
}

/// One performed frame.
#[derive(Clone, Debug)]
pub struct PerformedFrame {
    /// Vertex positions in metres.
    pub positions: Vec<Vec3>,
    /// Joint transforms.
    pub joints: [Rigid; JOINT_COUNT],
    /// Controls, root and feet.
    pub state: BodyState,
    /// Whether the left and the right foot stand on the ground, rolled by less than 17 degrees.
    pub planted: [bool; 2],
}

/// The takes of a capture of `frames` frames: every behaviour, as many times as it takes for sequences of usual length.
#[must_use]
pub fn takes(frames: usize, fps: f32, seed: u64) -> Vec<Take> {
    let usual: f32 = BEHAVIOURS.iter().map(|b| b.1).sum::<f32>() * fps;
    let rounds = ((frames as f32 / usual).round() as usize).max(1);
    let total: f32 = BEHAVIOURS.iter().map(|b| b.1).sum::<f32>() * rounds as f32;
    let mut takes = Vec::new();
    let (mut seconds, mut first_frame) = (0.0, 0);
    for round in 0..rounds {
        for (behaviour, (name, length)) in BEHAVIOURS.iter().enumerate() {
            seconds += length;
            let end = (frames as f64 * f64::from(seconds) / f64::from(total)).round() as usize;
            let last = round + 1 == rounds && behaviour + 1 == BEHAVIOURS.len();
            let end = if last { frames } else { end.min(frames) };
            if end > first_frame {
                let name = if round == 0 { (*name).to_owned() } else { format!("{name}_{}", round + 1) };
                let seed = mix(seed, (round * 100 + behaviour) as u64);
                takes.push(Take { name, behaviour, first_frame, frames: end - first_frame, seed });
            }
            first_frame = end;
        }
    }
    takes
}

/// Performs `take` at `fps` frames a second.
#[must_use]
pub fn perform(figure: &Figure, take: &Take, fps: f32) -> Vec<PerformedFrame> {
    perform_motion(figure, &motion::make(take.behaviour, take.seed), take.frames, fps)
}

/// Performs `count` frames of any motion at `fps` frames a second.
#[must_use]
pub fn perform_motion(figure: &Figure, motion: &Motion, count: usize, fps: f32) -> Vec<PerformedFrame> {
    let dt = 1.0 / fps;
    // A sequence longer or shorter than usual gains or loses as much at its beginning as at its end.
    let start = 0.5 * (motion.seconds - count as f32 * dt);
    let lead_in = (LEAD_IN * fps).round() as i64;
    let time = |frame: i64| start + frame as f32 * dt;
    let kind = figure.build.kind();
    let first = solve(&kind.carried((motion.at)(time(-lead_in)).0));
    let mut tail = Ponytail::new(&first);
    let mut skirt = figure.skirt.start(&first);
    let mut frames = Vec::with_capacity(count);
    for index in -lead_in..count as i64 {
        let (state, planted) = (motion.at)(time(index));
        let state = kind.carried(state);
        let mut joints = solve(&state);
        tail.advance(&mut joints, dt);
        figure.skirt.advance(&figure.body, &mut skirt, &joints, dt);
        if index >= 0 {
            let joints = figure.build.joints(&state, &joints);
            let mut positions = figure.skinned(&Skin::new(figure.build.bind_inverse(), &joints));
            figure.skirt.apply(&skirt, &mut positions);
            frames.push(PerformedFrame { positions, joints, state, planted });
        }
    }
    frames
}
