//! A clip of motion capture: a skeleton's joints, frame after frame.

use editing::rotation::between;
use glam::{Quat, Vec3};
use thiserror::Error;

/// Joints at most.
pub const MOST_JOINTS: usize = 1000;
/// Frames at most.
pub const MOST_FRAMES: usize = 1 << 20;
/// Positions at most, of all joints in all frames.
pub const MOST_POSITIONS: usize = 1 << 24;

/// A joint, or the end of a chain of joints.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ClipJoint {
    /// Its name, as the file has it.
    pub name: String,
    /// The joint that it hangs on, before it in the list; none of the root.
    pub parent: Option<usize>,
}

/// Joints of a skeleton in every frame, in metres, +Y up.
#[derive(Clone, Debug, PartialEq)]
pub struct Clip {
    joints: Vec<ClipJoint>,
    rate: f32,
    /// Frame after frame.
    positions: Vec<Vec3>,
    rotations: Vec<Quat>,
    /// The skeleton before it moves, where the file has it.
    rest: Option<Stance>,
}

/// Where the joints of a skeleton are in one frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Stance {
    /// Positions in metres.
    pub positions: Vec<Vec3>,
    /// Rotations against the world.
    pub rotations: Vec<Quat>,
}

/// Why a clip is none.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ClipError {
    /// It has no frame, or no joint.
    #[error("it has no {0}")]
    Empty(&'static str),
    /// It has more than can be handled.
    #[error("it has {count} {what}, more than {most}")]
    TooMany {
        /// What there is too much of.
        what: &'static str,
        /// How many.
        count: usize,
        /// How many there may be.
        most: usize,
    },
    /// The rate is not a positive number.
    #[error("its rate of {0} frames a second is none")]
    Rate(f32),
    /// A joint is nowhere.
    #[error("frame {frame}: joint {joint:?} is nowhere: a number is not finite, or thousands of kilometres off")]
    Position {
        /// The frame, from 0.
        frame: usize,
        /// The joint's name.
        joint: String,
    },
    /// The parts do not fit together.
    #[error("its joints do not fit its frames")]
    Parts,
}

/// Farther than this from the origin no joint is, in the file's unit or in metres.
const FARTHEST: f32 = 1e7;

impl Clip {
    /// A clip of `frames`, `rate` a second. Parents come before their children.
    ///
    /// # Errors
    /// [`ClipError`]; so is every number that is not finite.
    pub fn new(
        joints: Vec<ClipJoint>,
        rate: f32,
        frames: Vec<Stance>,
        rest: Option<Stance>,
    ) -> Result<Self, ClipError> {
        let check =
            |what, count, most| if count > most { Err(ClipError::TooMany { what, count, most }) } else { Ok(()) };
        check("joints", joints.len(), MOST_JOINTS)?;
        check("frames", frames.len(), MOST_FRAMES)?;
        check("positions", frames.len().saturating_mul(joints.len()), MOST_POSITIONS)?;
        if joints.is_empty() || frames.is_empty() {
            return Err(ClipError::Empty(if joints.is_empty() { "joint" } else { "frame" }));
        }
        if !(rate.is_finite() && rate > 0.0) {
            return Err(ClipError::Rate(rate));
        }
        let fits = |stance: &Stance| stance.positions.len() == joints.len() && stance.rotations.len() == joints.len();
        let parents = joints.iter().enumerate().all(|(index, joint)| joint.parent.is_none_or(|parent| parent < index));
        if !parents || !frames.iter().chain(&rest).all(fits) {
            return Err(ClipError::Parts);
        }
        for (frame, stance) in frames.iter().enumerate() {
            let is_wrong = |k: &usize| {
                let far = !stance.positions[*k].is_finite() || stance.positions[*k].abs().max_element() > FARTHEST;
                far || !stance.rotations[*k].is_finite() || stance.rotations[*k].length_squared() < 0.5
            };
            if let Some(joint) = (0..joints.len()).find(is_wrong) {
                return Err(ClipError::Position { frame, joint: joints[joint].name.clone() });
            }
        }
        let positions = frames.iter().flat_map(|stance| stance.positions.iter().copied()).collect();
        let rotations = frames.iter().flat_map(|stance| stance.rotations.iter().copied()).collect();
        Ok(Self { joints, rate, positions, rotations, rest })
    }

    /// The joints, parents first.
    #[must_use]
    pub fn joints(&self) -> &[ClipJoint] {
        &self.joints
    }

    /// Frames a second.
    #[must_use]
    pub fn rate(&self) -> f32 {
        self.rate
    }

    /// Number of frames, at least 1.
    #[must_use]
    pub fn len(&self) -> usize {
        self.positions.len() / self.joints.len()
    }

    /// Never: a clip has a frame.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Positions of all joints in `frame`, which must exist, in metres.
    #[must_use]
    pub fn positions(&self, frame: usize) -> &[Vec3] {
        &self.positions[frame * self.joints.len()..][..self.joints.len()]
    }

    /// Rotations of all joints against the world in `frame`, which must exist.
    #[must_use]
    pub fn rotations(&self, frame: usize) -> &[Quat] {
        &self.rotations[frame * self.joints.len()..][..self.joints.len()]
    }

    /// The skeleton before it moves, where the file has it.
    #[must_use]
    pub fn rest(&self) -> Option<&Stance> {
        self.rest.as_ref()
    }

    /// How tall the skeleton stands: the middle one of its frames' heights, in metres.
    #[must_use]
    pub fn height(&self) -> f32 {
        let tall = |frame: usize| {
            let heights = || self.positions(frame).iter().map(|position| position.y);
            heights().fold(f32::NEG_INFINITY, f32::max) - heights().fold(f32::INFINITY, f32::min)
        };
        let mut heights: Vec<f32> = (0..self.len()).map(tall).collect();
        heights.sort_by(f32::total_cmp);
        heights[heights.len() / 2]
    }

    /// The same with all lengths times `factor`.
    #[must_use]
    pub fn scaled(mut self, factor: f32) -> Self {
        self.positions.iter_mut().for_each(|position| *position *= factor);
        self.rest.iter_mut().flat_map(|rest| &mut rest.positions).for_each(|position| *position *= factor);
        self
    }

    /// The same at another rate: it takes longer or shorter.
    ///
    /// # Errors
    /// A rate that is no positive number.
    pub fn with_rate(mut self, rate: f32) -> Result<Self, ClipError> {
        if !(rate.is_finite() && rate > 0.0) {
            return Err(ClipError::Rate(rate));
        }
        self.rate = rate;
        Ok(self)
    }

    /// The same, of a file in which +Z points up: (x, y, z) becomes (x, z, -y).
    #[must_use]
    pub fn z_upright(mut self) -> Self {
        let upright = |position: &mut Vec3| *position = Vec3::new(position.x, position.z, -position.y);
        // The same turn of positions and of the axes that rotations are about.
        let turned = |turn: &mut Quat| *turn = Quat::from_xyzw(turn.x, turn.z, -turn.y, turn.w);
        self.positions.iter_mut().for_each(upright);
        self.rotations.iter_mut().for_each(turned);
        if let Some(rest) = &mut self.rest {
            rest.positions.iter_mut().for_each(upright);
            rest.rotations.iter_mut().for_each(turned);
        }
        self
    }

    /// Whether the first frame belongs to no motion: files often begin with a pose that says how the skeleton was bound. The
    /// step out of it is several times as long as any other.
    #[must_use]
    pub fn begins_with_pose(&self) -> bool {
        if self.len() < 4 {
            return false;
        }
        let step = |frame: usize| {
            let [now, next] = [frame, frame + 1].map(|frame| self.positions(frame));
            let apart = now.iter().zip(next).map(|(a, b)| ((*a - now[0]) - (*b - next[0])).length()).sum::<f32>();
            apart / self.joints.len() as f32
        };
        let others = (1..self.len() - 1).map(step).fold(0.0_f32, f32::max);
        step(0) > (3.0 * others).max(0.03 * self.height())
    }

    /// The same without its first frame; the same where that is all there is.
    #[must_use]
    pub fn without_first(mut self) -> Self {
        if self.len() > 1 {
            self.positions.drain(..self.joints.len());
            self.rotations.drain(..self.joints.len());
        }
        self
    }

    /// The same motion at `rate` frames a second: positions between frames are on the line, rotations on the shorter way.
    ///
    /// # Errors
    /// A rate at which there were too many frames, or that is no number.
    pub fn resampled(&self, rate: f32) -> Result<Self, ClipError> {
        if !(rate.is_finite() && rate > 0.0) {
            return Err(ClipError::Rate(rate));
        }
        let seconds = (self.len() - 1) as f64 / f64::from(self.rate);
        // A saturating cast; an end that lies on a frame is not missed by a rounding.
        let count = (seconds * f64::from(rate) + 1e-3) as usize + 1;
        if count > MOST_FRAMES || count.saturating_mul(self.joints.len()) > MOST_POSITIONS {
            return Err(ClipError::TooMany { what: "frames", count, most: MOST_FRAMES });
        }
        let at = |frame: usize| {
            let time = frame as f64 / f64::from(rate) * f64::from(self.rate);
            let first = (time as usize).min(self.len() - 1);
            (first, (first + 1).min(self.len() - 1), (time - first as f64).clamp(0.0, 1.0) as f32)
        };
        let (mut positions, mut rotations) = (Vec::new(), Vec::new());
        for (from, to, share) in (0..count).map(at) {
            let pairs = self.positions(from).iter().zip(self.positions(to));
            positions.extend(pairs.map(|(a, b)| a.lerp(*b, share)));
            let pairs = self.rotations(from).iter().zip(self.rotations(to));
            rotations.extend(pairs.map(|(a, b)| between(*a, *b, share)));
        }
        Ok(Self { joints: self.joints.clone(), rate, positions, rotations, rest: self.rest.clone() })
    }
}

#[cfg(test)]
mod tests;
