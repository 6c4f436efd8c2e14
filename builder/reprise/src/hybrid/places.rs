//! Places of the recording that a driven sequence resembles at one of its ends, by the paper's measure: distances of vertices and of
//! their velocities.

use std::ops::Range;

use actor::capture::Capture;
use actor::timeline::Sequence;
use glam::{Quat, Vec3};
use kernels::align::{Placement, align_heading, centre_of_mass};

/// Vertices that frames are held against each other by, at most.
const SAMPLES: usize = 500;
/// A velocity counts as what it comes to in this time, in seconds.
const AHEAD: f32 = 0.15;
/// The driven frame that is held against the recording is so many seconds from the end.
const INSIDE: f32 = 0.2;
/// Places that are looked at closely.
const PLACES: usize = 3;

/// A recorded frame that is like the driven one.
pub(super) struct Place {
    frame: u32,
    inwards: bool,
}

impl Place {
    /// The recorded frames around it, at most `around` to both sides.
    pub(super) fn stretch(&self, both: &Capture, around: u32) -> Range<u32> {
        let own = both.timeline.sequence_of(self.frame);
        let ends = own.map_or(self.frame..self.frame, |own| own.first_frame..own.end_frame());
        self.frame.saturating_sub(around).max(ends.start)..(self.frame + around).min(ends.end)
    }

    /// The driven frames from its end on, at most `around`.
    pub(super) fn of_driven(&self, both: &Capture, around: u32) -> Range<u32> {
        let Some(own) = driven(both) else { return 0..0 };
        let count = around.min(own.frame_count);
        if self.inwards { own.first_frame..own.first_frame + count } else { own.end_frame() - count..own.end_frame() }
    }
}

fn driven(both: &Capture) -> Option<&Sequence> {
    both.timeline.sequences().last()
}

/// The best place of each recorded sequence, the best of these first.
pub(super) fn places(both: &Capture, inwards: bool) -> Vec<Place> {
    let Some(own) = driven(both) else { return Vec::new() };
    let inside = ((INSIDE * both.timeline.fps()).round() as u32).min(own.frame_count - 1);
    let looked_at = if inwards { own.first_frame + inside } else { own.end_frame() - 1 - inside };
    let n = both.topology.vertex_count();
    let sampled: Vec<usize> = (0..n).step_by(n.div_ceil(SAMPLES).max(1)).collect();
    let of_driven = seen(both, own, looked_at, &sampled);
    let mut found: Vec<(f32, u32)> = Vec::new();
    for sequence in both.timeline.sequences().iter().filter(|sequence| sequence.name != own.name) {
        let apart = |frame: u32| {
            let turn = align_heading(both.poses.frame(looked_at), both.poses.frame(frame), both.topology.weights());
            apart(&of_driven, &seen(both, sequence, frame, &sampled), Quat::from_rotation_y(turn), both.timeline.fps())
        };
        let best = (sequence.first_frame..sequence.end_frame()).map(|frame| (apart(frame), frame));
        found.extend(best.reduce(|best, next| if next.0 < best.0 { next } else { best }));
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.into_iter().take(PLACES).map(|(_, frame)| Place { frame, inwards }).collect()
}

/// Some vertices of a frame about its centre over the ground, and how far each goes in a frame.
fn seen(both: &Capture, sequence: &Sequence, frame: u32, sampled: &[usize]) -> Vec<[Vec3; 2]> {
    let pose = both.poses.frame(frame);
    let centre = centre_of_mass(pose, both.topology.weights()).with_y(0.0);
    // Of the first frame the step that follows.
    let earlier = if frame > sequence.first_frame { frame - 1 } else { frame };
    let later = (earlier + 1).min(sequence.end_frame() - 1);
    let (before, after) = (both.poses.frame(earlier), both.poses.frame(later));
    sampled.iter().map(|&v| [pose[v] - centre, after[v] - before[v]]).collect()
}

/// d(M_i, M_j): the mean of squared distances, in square metres.
fn apart(a: &[[Vec3; 2]], b: &[[Vec3; 2]], turn: Quat, fps: f32) -> f32 {
    let ahead = AHEAD * fps;
    let of = |(a, b): (&[Vec3; 2], &[Vec3; 2])| {
        a[0].distance_squared(turn * b[0]) + ahead * ahead * a[1].distance_squared(turn * b[1])
    };
    a.iter().zip(b).map(of).sum::<f32>() / a.len().max(1) as f32
}

/// `pose` laid on `onto` over the ground.
pub(super) fn laid(onto: &[Vec3], pose: &[Vec3], weights: &[f32]) -> Vec<Vec3> {
    let ground = |pose: &[Vec3]| {
        let centre = centre_of_mass(pose, weights);
        glam::Vec2::new(centre.x, centre.z)
    };
    let placement = Placement::turning(align_heading(onto, pose, weights), ground(pose), ground(onto));
    pose.iter().map(|&point| placement.apply(point)).collect()
}
