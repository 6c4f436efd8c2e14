//! An actor as transfer sees it: where its body is in each frame, and its shape in the body's own frame.

use crate::bones::Bones;
use crate::front::toes;
use actor::capture::Poses;
use actor::feet::Feet;
use actor::motion::Motion;
use actor::timeline::Timeline;
use glam::{Quat, Vec3};
use kernels::topology::Topology;
use motion::body::{BodyFrame, body_frames, body_size};
use parts::Parts;
use std::f32::consts::TAU;
use std::sync::OnceLock;

/// A body whose toes point farther than this from where it goes, in radians, goes aside or backwards: it faces as they do. Less is
/// how anybody stands.
const AWRY: f32 = 0.6;

/// An actor.
pub struct Subject<'a> {
    /// Its mesh.
    pub topology: &'a Topology,
    /// Its sequences.
    pub timeline: &'a Timeline,
    /// What was recorded.
    pub poses: &'a Poses,
    /// Its feet.
    pub feet: &'a Feet,
    /// Its parts.
    pub parts: Parts,
    /// How far it reaches at most along an axis, in metres.
    pub size: f32,
    /// Where the body is in each frame.
    pub(crate) roots: Vec<Root>,
    bones: OnceLock<Option<Bones>>,
}

/// Where a body is: it faces +Z of its own frame, and stands upright in it on average.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Root {
    /// Its turn about +Y in radians, which goes on from frame to frame.
    pub heading: f32,
    /// How it leans, as a rotation vector in the frame that is turned by the heading.
    pub tilt: Vec3,
    /// Its centre, in metres.
    pub centre: Vec3,
}

impl Root {
    pub fn body(&self) -> BodyFrame {
        let rotation = Quat::from_rotation_y(self.heading) * Quat::from_scaled_axis(self.tilt);
        BodyFrame { rotation, centre: self.centre }
    }

    pub fn lerp(&self, other: &Self, share: f32) -> Self {
        Self {
            heading: self.heading + (other.heading - self.heading) * share,
            tilt: self.tilt.lerp(other.tilt, share),
            centre: self.centre.lerp(other.centre, share),
        }
    }
}

impl<'a> Subject<'a> {
    /// The actor with this mesh and these poses; `motion` says which way it faces.
    #[must_use]
    pub fn new(
        (topology, timeline, poses): (&'a Topology, &'a Timeline, &'a Poses),
        motion: &Motion,
        feet: &'a Feet,
        parts: Parts,
    ) -> Self {
        let frames: Vec<u32> = (0..poses.len() as u32).collect();
        let areas = topology.weights();
        let size = body_size(poses, &frames);
        let bodies = body_frames(poses, &frames, areas, size);
        let mut roots = faced(&bodies, &motion.facings, timeline);
        let frames: Vec<BodyFrame> = roots.iter().map(Root::body).collect();
        let toes = toes(poses, &frames, &parts, size);
        if let Some(toes) = toes.filter(|toes| toes.abs() > AWRY) {
            let facings: Vec<f32> = motion.facings.iter().map(|facing| facing + toes).collect();
            roots = faced(&bodies, &facings, timeline);
        }
        Self { topology, timeline, poses, feet, parts, size, roots, bones: OnceLock::new() }
    }

    /// The shape of a frame in the body's own frame.
    #[must_use]
    pub fn own(&self, frame: u32) -> Vec<Vec3> {
        let body = self.roots[frame as usize].body();
        self.poses.frame(frame).iter().map(|&point| body.own(point)).collect()
    }

    /// The same actor, its body elsewhere.
    pub(crate) fn with_roots(&self, roots: Vec<Root>) -> Self {
        Self { parts: self.parts.clone(), roots, bones: self.bones.clone(), ..*self }
    }

    /// Its bones, looked for once; `None` where nothing like a human's skeleton is found.
    pub(crate) fn bones(&self) -> Option<&Bones> {
        self.bones.get_or_init(|| Bones::find(self.topology, self.poses)).as_ref()
    }

    /// The shape at a time between frames of one sequence.
    pub(crate) fn own_at(&self, time: f64) -> Vec<Vec3> {
        let before = (time.max(0.0) as u32).min(self.poses.len() as u32 - 1);
        let share = (time - f64::from(before)) as f32;
        let shape = self.own(before);
        let goes_on = self.timeline.sequence_index(before + 1) == self.timeline.sequence_index(before);
        if share < 1e-6 || !goes_on {
            return shape;
        }
        shape.iter().zip(self.own(before + 1)).map(|(a, b)| a.lerp(b, share)).collect()
    }

    /// Where the body is at a time between frames.
    pub(crate) fn root_at(&self, frame: f64) -> Root {
        let last = self.roots.len() - 1;
        let before = (frame.max(0.0) as usize).min(last);
        self.roots[before].lerp(&self.roots[(before + 1).min(last)], (frame - before as f64) as f32)
    }

    /// What it is all made of, that matters: areas about vertices.
    pub(crate) fn areas(&self) -> &'a [f32] {
        self.topology.weights()
    }
}

/// Bodies as roots: turned so that they face +Z and stand upright on average.
fn faced(bodies: &[BodyFrame], facings: &[f32], timeline: &Timeline) -> Vec<Root> {
    // From the frame that faces forwards to the body's own, averaged over all frames.
    let (mut sum, mut like) = (Quat::from_xyzw(0.0, 0.0, 0.0, 0.0), Quat::IDENTITY);
    for (frame, (body, &facing)) in bodies.iter().zip(facings).enumerate() {
        let turn = body.rotation.inverse() * Quat::from_rotation_y(facing);
        like = if frame == 0 { turn } else { like };
        sum += if turn.dot(like) < 0.0 { -turn } else { turn };
    }
    let upright = if sum.length() > 1e-3 { sum.normalize() } else { Quat::IDENTITY };
    let mut roots: Vec<Root> = Vec::with_capacity(bodies.len());
    for (frame, body) in bodies.iter().enumerate() {
        let rotation = (body.rotation * upright).normalize();
        let heading = 2.0 * rotation.y.atan2(rotation.w);
        let begins = frame == 0 || timeline.sequence_index(frame as u32) != timeline.sequence_index(frame as u32 - 1);
        let before = if begins { facings[frame] } else { roots[frame - 1].heading };
        let heading = heading - ((heading - before) / TAU).round() * TAU;
        let tilt = Quat::from_rotation_y(heading).inverse() * rotation;
        let tilt = if tilt.w < 0.0 { -tilt } else { tilt };
        roots.push(Root { heading, tilt: tilt.to_scaled_axis(), centre: body.centre });
    }
    roots
}
