//! Where the actor is and which way it faces in every recorded frame: what walks over the ground need of the poses.

use glam::{Vec2, Vec3, Vec3Swizzles};

use crate::ground::{Ground, PoseMemory, PosesOnGround, recorded_step};
use crate::pose_source::{PoseError, PoseSource};
use crate::timeline::Timeline;
use kernels::align::{Placement, align_heading, centre_of_mass};

/// What is known about the motion of a capture without its poses. The builder measures it and stores it in the bundle; for
/// a bundle that has none, [`MotionMeter`] measures it from the poses, some frames at a time.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// Centre of mass of each frame as it was recorded, in metres.
    pub centres: Vec<Vec3>,
    /// Which way the body faces in each frame as it was recorded: radians about +Y from +Z, as in [`Placement::heading`].
    ///
    /// A body has no front that a program could see. Bodies are turned onto the first frame's, and the front is where they
    /// go when they go fastest; in a capture that goes nowhere it is +Z of the first frame.
    pub facings: Vec<f32>,
    /// For each sequence the step from its last frame to its first one ([`recorded_step`]); the identity where it is not
    /// cyclic.
    pub wraps: Vec<Placement>,
}

impl Motion {
    /// Measures all frames at once.
    ///
    /// # Errors
    /// A frame that cannot be read.
    pub fn measure(timeline: &Timeline, weights: &[f32], source: &mut dyn PoseSource) -> Result<Self, PoseError> {
        let mut meter = MotionMeter::new(weights);
        while !meter.advance(timeline, source, u32::MAX)? {}
        meter.finish(timeline, source)
    }

    /// Whether it fits a timeline and all numbers are finite.
    #[must_use]
    pub fn fits(&self, timeline: &Timeline) -> bool {
        let frames = timeline.frame_count() as usize;
        self.centres.len() == frames
            && self.facings.len() == frames
            && self.wraps.len() == timeline.sequences().len()
            && self.centres.iter().all(|centre| centre.is_finite())
            && self.facings.iter().all(|facing| facing.is_finite())
            && self.wraps.iter().all(|wrap| wrap.heading.is_finite() && wrap.translation.is_finite())
    }
}

/// Alignment from facings instead of poses: nearly what [`PosesOnGround`] says of frames that resemble each other.
impl Ground for &Motion {
    fn heading(&mut self, fixed: u32, moving: u32) -> Result<f32, PoseError> {
        let facing = |frame: u32| self.facings.get(frame as usize).copied().ok_or(PoseError::OutOfRange(frame));
        Ok(facing(fixed)? - facing(moving)?)
    }

    fn centre(&mut self, frame: u32) -> Result<Vec2, PoseError> {
        self.centres.get(frame as usize).map(|centre| centre.xz()).ok_or(PoseError::OutOfRange(frame))
    }
}

/// Measures [`Motion`] from poses, as many frames at a time as there is time for.
#[derive(Clone, Debug)]
pub struct MotionMeter {
    weights: Vec<f32>,
    reference: Vec<Vec3>,
    pose: Vec<Vec3>,
    centres: Vec<Vec3>,
    /// Angle by which each frame must be turned to lie on the first.
    onto_first: Vec<f32>,
}

impl MotionMeter {
    /// Nothing is measured yet; `weights` are the topology's.
    #[must_use]
    pub fn new(weights: &[f32]) -> Self {
        let pose = vec![Vec3::ZERO; weights.len()];
        let reference = pose.clone();
        Self { weights: weights.to_vec(), reference, pose, centres: Vec::new(), onto_first: Vec::new() }
    }

    /// Measures up to `frames` more frames; whether all are measured. After an error the same frame is tried again.
    ///
    /// # Errors
    /// A frame that cannot be read (yet).
    pub fn advance(
        &mut self,
        timeline: &Timeline,
        source: &mut dyn PoseSource,
        frames: u32,
    ) -> Result<bool, PoseError> {
        let end = (self.centres.len() as u32).saturating_add(frames).min(timeline.frame_count());
        for frame in self.centres.len() as u32..end {
            source.read(frame, &mut self.pose)?;
            if frame == 0 {
                self.reference.clone_from(&self.pose);
            }
            self.centres.push(centre_of_mass(&self.pose, &self.weights));
            self.onto_first.push(align_heading(&self.reference, &self.pose, &self.weights));
        }
        Ok(end == timeline.frame_count())
    }

    /// The motion, once all frames are measured.
    ///
    /// # Errors
    /// Frames that have not been measured, or that cannot be read at the wrap of a cyclic sequence.
    pub fn finish(self, timeline: &Timeline, source: &mut dyn PoseSource) -> Result<Motion, PoseError> {
        if self.centres.len() as u32 != timeline.frame_count() {
            return Err(PoseError::NotLoaded(self.centres.len() as u32));
        }
        let mut memory = PoseMemory::default();
        let mut ground = PosesOnGround::new(source, &self.weights, &mut memory);
        let mut wraps = Vec::with_capacity(timeline.sequences().len());
        for sequence in timeline.sequences() {
            let step = match sequence.cyclic {
                true => recorded_step(timeline, &mut ground, sequence.end_frame() - 1)?,
                false => None,
            };
            wraps.push(step.map_or(Placement::IDENTITY, |(_, placement)| placement));
        }
        let front = self.front(timeline);
        let facings = self.onto_first.iter().map(|angle| front - angle).collect();
        Ok(Motion { centres: self.centres, facings, wraps })
    }

    /// Which way the first frame faces: the mean direction of travel, turned as the body must be to lie on the first frame,
    /// faster steps counting more.
    fn front(&self, timeline: &Timeline) -> f32 {
        let mut sum = Vec2::ZERO;
        for frame in 1..self.centres.len() {
            if timeline.sequence_index(frame as u32) != timeline.sequence_index(frame as u32 - 1) {
                continue;
            }
            let step = (self.centres[frame] - self.centres[frame - 1]).xz();
            sum += step.length() * kernels::align::rotate(self.onto_first[frame], step);
        }
        // Less than a millimetre a frame is no travel.
        if sum.length() > 1e-6 * self.centres.len() as f32 { sum.x.atan2(sum.y) } else { 0.0 }
    }
}

/// Appends to `points` the mean position of `vertices` in up to `frames` more frames, in metres as they were recorded;
/// whether all frames are done. What a path is to be followed with, instead of the centre of mass.
///
/// # Errors
/// A frame that cannot be read (yet), or a vertex that does not exist.
pub fn measure_group(
    timeline: &Timeline,
    source: &mut dyn PoseSource,
    vertex_count: usize,
    vertices: &[u32],
    points: &mut Vec<Vec3>,
    frames: u32,
) -> Result<bool, PoseError> {
    let mut pose = vec![Vec3::ZERO; vertex_count];
    let end = (points.len() as u32).saturating_add(frames).min(timeline.frame_count());
    for frame in points.len() as u32..end {
        source.read(frame, &mut pose)?;
        let mut sum = glam::DVec3::ZERO;
        for &vertex in vertices {
            sum += pose.get(vertex as usize).ok_or(PoseError::OutOfRange(frame))?.as_dvec3();
        }
        points.push((sum / vertices.len().max(1) as f64).as_vec3());
    }
    Ok(end == timeline.frame_count())
}
