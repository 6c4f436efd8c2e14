//! Where recorded frames stand on the ground, and how recorded playback goes on from one to the next.

use glam::{Vec2, Vec3, Vec3Swizzles};

use crate::pose_source::{PoseError, PoseSource};
use crate::timeline::Timeline;
use kernels::align::{Placement, align_heading, centre_of_mass, rotate};
use kernels::lru::LruCache;

/// What placing frames needs to know about their poses. The builder answers from its table of all pairs, the player
/// from the poses themselves ([`PosesOnGround`]).
pub trait Ground {
    /// The angle in radians by which frame `moving` must be turned about +Y to lie best on frame `fixed`, both as they
    /// were recorded ([`align_heading`]).
    ///
    /// # Errors
    /// A frame that cannot be read.
    fn heading(&mut self, fixed: u32, moving: u32) -> Result<f32, PoseError>;

    /// Centre of mass of `frame` as it was recorded, in metres along (X, Z).
    ///
    /// # Errors
    /// A frame that cannot be read.
    fn centre(&mut self, frame: u32) -> Result<Vec2, PoseError>;
}

/// The frame that was recorded after `from`, and its placement once `from` stands as it was recorded.
///
/// Within a sequence that is the identity. Where a cyclic sequence wraps, the step from its last frame to its first one is
/// not in the data: it is taken to be the mean of the two steps beside it, in the body's own heading.
/// `None` after the end of a sequence that is not cyclic.
///
/// # Errors
/// A frame that cannot be read, at a wrap.
pub fn recorded_step(
    timeline: &Timeline,
    ground: &mut impl Ground,
    from: u32,
) -> Result<Option<(u32, Placement)>, PoseError> {
    let Some(to) = timeline.next(from) else { return Ok(None) };
    if to == from + 1 {
        return Ok(Some((to, Placement::IDENTITY)));
    }
    let (Some(before), Some(after)) = (timeline.offset(from, -1), timeline.next(to)) else {
        return Ok(Some((to, Placement::IDENTITY)));
    };
    if timeline.sequence_of(from).is_some_and(|sequence| sequence.frame_count < 2) {
        return Ok(Some((to, Placement::IDENTITY)));
    }
    // Turning the first frame onto the last leaves out the turn that the body makes in a step.
    let turn = (ground.heading(before, from)? + ground.heading(to, after)?) / 2.0;
    let heading = ground.heading(from, to)? - turn;
    let (last, first) = (ground.centre(from)?, ground.centre(to)?);
    let arriving = last - ground.centre(before)?;
    let leaving = rotate(heading, ground.centre(after)? - first);
    Ok(Some((to, Placement::turning(heading, first, last + (arriving + leaving) / 2.0))))
}

/// The frame after a recorded one, and how much of the step to it is done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Next {
    /// The frame.
    pub frame: u32,
    /// Its placement once the frame before stands as it was recorded ([`recorded_step`]).
    pub step: Placement,
    /// From 0 to 1; 0 where no next frame is looked at.
    pub share: f32,
}

impl Next {
    /// Moves `out`, the frame before as it was recorded, towards `pose`, the next one as it was recorded, vertex by vertex.
    ///
    /// A straight line is no arc: half way, what turns by an angle a in the step is short by 1 - cos(a / 2) of its length. On
    /// captures that is a thousandth to a two-hundredth of an edge on average (`docs/results/2026-11-28-motion.md`).
    pub fn approach(&self, pose: &[Vec3], out: &mut [Vec3]) {
        for (out, &point) in out.iter_mut().zip(pose) {
            let point = if self.step == Placement::IDENTITY { point } else { self.step.apply(point) };
            *out += (point - *out) * self.share;
        }
    }
}

/// Recorded poses read last.
pub struct PoseMemory {
    kept: LruCache<ReadPose>,
}

#[derive(Default)]
struct ReadPose {
    pose: Vec<Vec3>,
    centre: Vec2,
}

/// Poses kept: on both sides of a node the two frames that it lies between, and their neighbours at a wrap.
const KEPT_POSES: usize = 8;

impl Default for PoseMemory {
    fn default() -> Self {
        Self { kept: LruCache::new(KEPT_POSES) }
    }
}

/// [`Ground`] from the poses themselves.
pub struct PosesOnGround<'a> {
    source: &'a mut dyn PoseSource,
    weights: &'a [f32],
    memory: &'a mut PoseMemory,
}

impl<'a> PosesOnGround<'a> {
    /// Reads from `source` what `memory` does not hold; `weights` are the topology's.
    pub fn new(source: &'a mut dyn PoseSource, weights: &'a [f32], memory: &'a mut PoseMemory) -> Self {
        Self { source, weights, memory }
    }

    /// Writes `frame` into `out`, placed.
    pub fn place(&mut self, frame: u32, placement: Placement, out: &mut [Vec3]) -> Result<(), PoseError> {
        let slot = self.read(frame)?;
        out.copy_from_slice(&self.memory.kept.get(slot).pose);
        if placement != Placement::IDENTITY {
            placement.apply_all(out);
        }
        Ok(())
    }

    /// Moves `out`, which holds a frame as it was recorded, on towards the next one.
    pub fn approach(&mut self, next: &Next, out: &mut [Vec3]) -> Result<(), PoseError> {
        let slot = self.read(next.frame)?;
        next.approach(&self.memory.kept.get(slot).pose, out);
        Ok(())
    }

    fn read(&mut self, frame: u32) -> Result<usize, PoseError> {
        if let Some(slot) = self.memory.kept.find(frame) {
            return Ok(slot);
        }
        let slot = self.memory.kept.claim(frame);
        let read = self.memory.kept.get_mut(slot);
        read.pose.resize(self.weights.len(), Vec3::ZERO);
        if let Err(error) = self.source.read(frame, &mut read.pose) {
            self.memory.kept.forget(slot);
            return Err(error);
        }
        read.centre = centre_of_mass(&read.pose, self.weights).xz();
        Ok(slot)
    }
}

impl Ground for PosesOnGround<'_> {
    fn heading(&mut self, fixed: u32, moving: u32) -> Result<f32, PoseError> {
        self.read(fixed)?;
        let moving = self.read(moving)?;
        let fixed = self.read(fixed)?;
        let kept = &self.memory.kept;
        Ok(align_heading(&kept.get(fixed).pose, &kept.get(moving).pose, self.weights))
    }

    fn centre(&mut self, frame: u32) -> Result<Vec2, PoseError> {
        let slot = self.read(frame)?;
        Ok(self.memory.kept.get(slot).centre)
    }
}
