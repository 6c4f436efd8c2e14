//! Recorded frames as a body is told from them: where bones are, and how low and how flat its feet lie.

use editing::{Rig, Rigid};
use glam::Vec3;

use crate::bones::{BodyError, need};
use crate::smooth::quantile;

/// Frames that are looked at.
const SAMPLES: usize = 400;
/// The share of frames in which the body stands tallest.
const TALLEST: f32 = 0.25;
/// The share of standing frames in which a foot lies flattest.
const FLATTEST: f32 = 0.2;
/// A vertex so near to the lowest one lies on the floor, in metres.
const ON_FLOOR: f32 = 0.012;

/// A recorded frame.
#[derive(Clone, Debug)]
pub struct Seen {
    /// The rigid motions of the bones from the rest pose.
    pub motions: Vec<Rigid>,
    /// Where the joints are, in metres.
    pub joints: Vec<Vec3>,
    /// Of each foot: how low it is in metres, and how many of its vertices lie flat.
    pub feet: [(f32, usize); 2],
    /// How low the lowest point is, in metres.
    pub lowest: f32,
}

/// Looks at recorded frames.
#[derive(Clone, Debug)]
pub struct Looker {
    /// Vertices of the left foot and of the right one.
    feet: [Vec<u32>; 2],
}

impl Looker {
    /// The frames of a recording of so many that are looked at.
    pub fn samples(frame_count: usize) -> impl Iterator<Item = u32> {
        (0..frame_count as u32).step_by(frame_count.div_ceil(SAMPLES).max(1))
    }

    /// Looks at poses of `rig`.
    ///
    /// # Errors
    /// A rig without feet.
    pub fn new(rig: &Rig) -> Result<Self, BodyError> {
        let feet = [need(rig, "foot_l")?, need(rig, "foot_r")?];
        let own = |foot: usize| (0..rig.rest().len() as u32).filter(|&v| rig.bone_of(v) == foot).collect();
        Ok(Self { feet: feet.map(own) })
    }

    /// What is seen in `pose`, which has a point for each vertex of `rig`.
    #[must_use]
    pub fn see(&self, rig: &Rig, pose: &[Vec3]) -> Seen {
        let motions = rig.fit(pose);
        let lowest = pose.iter().map(|point| point.y).fold(f32::INFINITY, f32::min);
        let feet = self.feet.each_ref().map(|own| {
            let height = |&v: &u32| pose[v as usize].y;
            let low = own.iter().map(height).fold(f32::INFINITY, f32::min);
            (low, own.iter().filter(|v| height(v) < low + ON_FLOOR).count())
        });
        Seen { joints: rig.joints(&motions), motions, feet, lowest }
    }
}

/// The frames in which the joint `top` is highest over the feet.
pub(crate) fn tallest(seen: &[Seen], top: usize, feet: [usize; 2]) -> Vec<&Seen> {
    let height = |seen: &Seen| seen.joints[top].y - seen.joints[feet[0]].y.min(seen.joints[feet[1]].y);
    let least = quantile(seen.iter().map(height).collect(), 1.0 - TALLEST);
    seen.iter().filter(|seen| height(seen) >= least).collect()
}

/// The frames in which a foot stands and most of it lies flat.
pub(crate) fn flattest(seen: &[Seen], side: usize) -> Vec<&Seen> {
    let standing: Vec<&Seen> = seen.iter().filter(|seen| seen.feet[side].0 < seen.lowest + 0.02).collect();
    let least = quantile(standing.iter().map(|seen| seen.feet[side].1 as f32).collect(), 1.0 - FLATTEST);
    standing.into_iter().filter(|seen| seen.feet[side].1 as f32 >= least).collect()
}
