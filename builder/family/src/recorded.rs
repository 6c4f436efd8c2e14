//! What families are made from: a capture's frames, and what stands in them.

use actor::capture::Poses;
use actor::feet::Feet;
use actor::ground::{PoseMemory, PosesOnGround, recorded_step};
use actor::pose_source::{PoseError, PoseSource};
use actor::timeline::Timeline;
use glam::{Vec2, Vec3, Vec3Swizzles};
use kernels::align::{Placement, centre_of_mass};
use kernels::topology::Topology;

/// A share of a sole that counts as the sole itself.
const SOLE: u8 = 128;

/// A capture, and what the builder has found of its feet.
#[derive(Clone, Copy, Debug)]
pub struct Recorded<'a> {
    /// Its mesh.
    pub topology: &'a Topology,
    /// Its sequences.
    pub timeline: &'a Timeline,
    /// Its poses, in metres, +Y up.
    pub poses: &'a Poses,
    /// Its feet, and when they stand.
    pub feet: &'a Feet,
    /// For each sequence the height of the ground in metres.
    pub floors: &'a [f32],
}

impl Recorded<'_> {
    /// Height of the body in the first frame, in metres.
    #[must_use]
    pub fn body(&self) -> f32 {
        let range = |(low, high): (f32, f32), point: &Vec3| (low.min(point.y), high.max(point.y));
        let (low, high) = self.poses.iter().next().unwrap_or_default().iter().fold((f32::MAX, f32::MIN), range);
        (high - low).max(f32::MIN_POSITIVE)
    }

    /// Where a pose's centre of mass is along (X, Z), in metres.
    #[must_use]
    pub fn centre(&self, pose: &[Vec3]) -> Vec2 {
        centre_of_mass(pose, self.topology.weights()).xz()
    }

    /// The vertices of a foot that are its sole.
    pub fn sole(&self, foot: usize) -> impl Iterator<Item = usize> {
        self.feet.vertices(foot).iter().filter(|vertex| vertex.sole >= SOLE).map(|vertex| vertex.vertex as usize)
    }

    /// The lowest height of a foot's sole in metres; infinite where it has none.
    #[must_use]
    pub fn lowest(&self, foot: usize, pose: &[Vec3]) -> f32 {
        self.sole(foot).map(|vertex| pose[vertex].y).fold(f32::INFINITY, f32::min)
    }

    /// So many frames as `seconds` take, at least one.
    #[must_use]
    pub fn frames(&self, seconds: f32) -> usize {
        ((seconds * self.timeline.fps()).round() as usize).max(1)
    }

    /// The frames of a sequence on one way over the ground.
    #[must_use]
    pub fn track(&self, sequence: usize) -> Track {
        let own = &self.timeline.sequences()[sequence];
        let once: Vec<u32> = (own.first_frame..own.end_frame()).collect();
        let all = |placement: Placement| once.iter().map(move |&frame| (frame, placement));
        if !own.cyclic {
            return Track { frames: all(Placement::IDENTITY).collect(), rounds: 1 };
        }
        let (mut memory, mut source) = (PoseMemory::default(), Borrowed(self.poses));
        let mut ground = PosesOnGround::new(&mut source, self.topology.weights(), &mut memory);
        // Poses in memory can all be read.
        let step = recorded_step(self.timeline, &mut ground, own.end_frame() - 1).ok().flatten();
        let wrap = step.map_or(Placement::IDENTITY, |(_, placement)| placement);
        let rounds = [wrap.inverse(), Placement::IDENTITY, wrap];
        Track { frames: rounds.into_iter().flat_map(all).collect(), rounds: 3 }
    }
}

/// The frames of a sequence one after the other; those of one that repeats three times over.
#[derive(Clone, Debug)]
pub struct Track {
    frames: Vec<(u32, Placement)>,
    /// How often the sequence was laid down.
    pub rounds: usize,
}

impl Track {
    /// Number of frames.
    #[must_use]
    pub fn len(&self) -> usize {
        self.frames.len()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.frames.is_empty()
    }

    /// The recorded frame at a place.
    #[must_use]
    pub fn frame(&self, at: usize) -> u32 {
        self.frames[at].0
    }

    /// The pose at a place, where the way has led to.
    #[must_use]
    pub fn pose(&self, recorded: &Recorded, at: usize) -> Vec<Vec3> {
        let (frame, placement) = self.frames[at];
        let mut pose = recorded.poses.frame(frame).to_vec();
        if placement != Placement::IDENTITY {
            placement.apply_all(&mut pose);
        }
        pose
    }

    /// Places of the sequence's own frames.
    #[must_use]
    pub fn own(&self) -> std::ops::Range<usize> {
        let count = self.frames.len() / self.rounds;
        let first = if self.rounds > 1 { count } else { 0 };
        first..first + count
    }

    /// When a foot stands: first and last place of each stance, gaps and stances shorter than `least` frames left out.
    #[must_use]
    pub fn stances(&self, feet: &Feet, foot: usize, least: usize) -> Vec<(usize, usize)> {
        let mut found: Vec<(usize, usize)> = Vec::new();
        for (at, &(frame, _)) in self.frames.iter().enumerate().filter(|(_, (frame, _))| feet.stands(*frame, foot)) {
            debug_assert!(feet.stands(frame, foot));
            match found.last_mut() {
                Some((_, last)) if at - *last <= least => *last = at,
                _ => found.push((at, at)),
            }
        }
        found.retain(|(first, last)| last - first + 1 >= least);
        found
    }
}

struct Borrowed<'a>(&'a Poses);

impl PoseSource for Borrowed<'_> {
    fn read(&mut self, frame: u32, pose: &mut [Vec3]) -> Result<(), PoseError> {
        if frame as usize >= self.0.len() {
            return Err(PoseError::OutOfRange(frame));
        }
        pose.copy_from_slice(self.0.frame(frame));
        Ok(())
    }
}
