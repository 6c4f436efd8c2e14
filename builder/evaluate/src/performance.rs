//! The frames of a transition as the player would make them, any of them at will.

use actor::blend::Blend;
use actor::capture::{Capture, Poses};
use actor::contacts::Contacts;
use actor::graph::Transition;
use actor::ground::Ground;
use actor::pose_source::PoseError;
use actor::timeline::Timeline;
use glam::{Vec2, Vec3};
use kernels::align::{Placement, align_heading};
use kernels::cholesky::CholeskyError;
use kernels::poisson::{KeyedPose, PoissonInterpolator};
use kernels::topology::Topology;

use super::EvaluateError;
use pipeline::distance::HeadingMatrix;

/// What a stage stands on.
#[derive(Clone, Copy)]
pub struct Recordings<'a> {
    /// Connectivity.
    pub topology: &'a Topology,
    /// Sequences.
    pub timeline: &'a Timeline,
    /// All recorded poses.
    pub poses: &'a Poses,
    /// Planar alignment of all pairs, where it is known already.
    pub headings: Option<&'a HeadingMatrix>,
    /// Centres of mass of all frames along (X, Z).
    pub centres: &'a [Vec2],
    /// What transitions keep still.
    pub contacts: &'a Contacts,
}

impl<'a> Recordings<'a> {
    pub(super) fn of(
        capture: &'a Capture,
        headings: &'a HeadingMatrix,
        centres: &'a [Vec2],
        contacts: &'a Contacts,
    ) -> Self {
        Self {
            topology: &capture.topology,
            timeline: &capture.timeline,
            poses: &capture.poses,
            headings: Some(headings),
            centres,
            contacts,
        }
    }

    /// Where both sides of a transition stand at each node, its source as it was recorded.
    ///
    /// # Errors
    /// A transition of another capture.
    pub fn blends(&self, transition: &Transition) -> Result<Vec<Blend>, PoseError> {
        let mut blend = Blend::of(self.timeline, &mut { *self }, transition, Placement::IDENTITY, self.contacts)?;
        let mut blends = vec![blend];
        while let Some(next) = blend.next(self.timeline, &mut { *self }, &transition.warp, self.contacts)? {
            blend = next;
            blends.push(blend);
        }
        Ok(blends)
    }

    /// A side of a node, placed.
    #[must_use]
    pub fn side(&self, blend: &Blend, side: usize) -> Vec<Vec3> {
        let next = &blend.next[side];
        let mut pose = self.poses.frame(blend.frames[side]).to_vec();
        if next.share > 0.0 {
            next.approach(self.poses.frame(next.frame), &mut pose);
        }
        blend.placements[side].apply_all(&mut pose);
        pose
    }

    /// A recorded frame, placed.
    #[must_use]
    pub fn placed(&self, frame: u32, placement: Placement) -> Vec<Vec3> {
        let mut pose = self.poses.frame(frame).to_vec();
        if placement != Placement::IDENTITY {
            placement.apply_all(&mut pose);
        }
        pose
    }
}

impl Ground for Recordings<'_> {
    fn heading(&mut self, fixed: u32, moving: u32) -> Result<f32, PoseError> {
        Ok(match self.headings {
            Some(known) => known.get(fixed as usize, moving as usize),
            None => align_heading(self.poses.frame(fixed), self.poses.frame(moving), self.topology.weights()),
        })
    }

    fn centre(&mut self, frame: u32) -> Result<Vec2, PoseError> {
        self.centres.get(frame as usize).copied().ok_or(PoseError::OutOfRange(frame))
    }
}

/// Makes frames of transitions.
pub struct Performance<'a> {
    /// What it stands on.
    pub recordings: Recordings<'a>,
    interpolator: PoissonInterpolator,
}

impl<'a> Performance<'a> {
    /// A stage; `order` is the order of elimination, which all stages share.
    ///
    /// # Errors
    /// A mesh too large to factorise.
    pub fn new(recordings: Recordings<'a>, order: &[u32]) -> Result<Self, CholeskyError> {
        Ok(Self { recordings, interpolator: PoissonInterpolator::new(recordings.topology, Some(order))? })
    }

    /// The pose of a node, with the weight `lambda` of the destination.
    ///
    /// # Errors
    /// Poses that are not finite.
    pub fn pose(&mut self, blend: &Blend, lambda: f32) -> Result<Vec<Vec3>, EvaluateError> {
        let [source, destination] = blend.frames;
        if lambda <= 0.0 {
            return Ok(self.recordings.placed(source, blend.placements[0]));
        }
        if lambda >= 1.0 {
            return Ok(self.recordings.placed(destination, blend.placements[1]));
        }
        for frame in blend.frames {
            self.interpolator.weigh(KeyedPose { frame, pose: self.recordings.poses.frame(frame) });
        }
        let poses = [0, 1].map(|side| self.recordings.side(blend, side));
        self.between((source, &poses[0]), (destination, &poses[1]), lambda)
    }

    /// The in-between of two frames that are placed.
    ///
    /// # Errors
    /// Poses that are not finite.
    pub fn between(
        &mut self,
        source: (u32, &[Vec3]),
        destination: (u32, &[Vec3]),
        lambda: f32,
    ) -> Result<Vec<Vec3>, EvaluateError> {
        let mut out = vec![Vec3::ZERO; self.recordings.topology.vertex_count()];
        // A frame's guess must not depend on which frame was made before.
        self.interpolator.restart();
        let keyed = |(frame, pose)| KeyedPose { frame, pose };
        self.interpolator.interpolate(keyed(source), keyed(destination), lambda, &mut out)?;
        Ok(out)
    }
}
