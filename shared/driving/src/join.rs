//! Where a driven clip joins the recording: the recorded frame that its end resembles most, and how long the blend has to be.
//!
//! Not in the paper, which cuts. Postures are held against each other as seen from the body: joints about the middle of the hips,
//! turned so that the hips face one way. What moves alike is preferred: postures a moment before count as well.

use editing::Rigid;
use editing::rotation::turn_by;
use glam::Vec3;
use kernels::scalar::{atan2, half_turn};

use crate::body::Body;

/// The shortest blend and the longest, in seconds.
const SHORTEST: f32 = 0.4;
const LONGEST: f32 = 1.2;
/// How much longer it is for each metre by which joints are apart, in seconds.
const LONGER: f32 = 3.0;
/// A difference in speed counts as what it comes to in this time, in seconds.
const AHEAD: f32 = 0.15;

/// A body in one frame, as seen from itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    joints: Vec<Vec3>,
    /// Where the middle of the hips is over the ground, and the way that they face about +Y, in radians.
    place: Vec3,
    heading: f32,
}

/// How far two postures are from each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Apart {
    /// Root of the mean square over the joints, in metres.
    pub metres: f32,
}

impl Apart {
    /// How long a blend between them has to be, in frames at `fps`.
    #[must_use]
    pub fn blend(&self, fps: f32) -> usize {
        ((SHORTEST + LONGER * self.metres).min(LONGEST) * fps).round() as usize
    }
}

impl Look {
    /// Of `body`, whose bones have moved from the rest pose by `motions`.
    #[must_use]
    pub fn new(body: &Body, motions: &[Rigid]) -> Self {
        let left = motions[0].rotation * (body.pelvis.axes * Vec3::X);
        let heading = atan2(-left.z, left.x);
        let back = turn_by(Vec3::Y * -heading);
        let place = motions[0].apply(body.middle).with_y(0.0);
        Self {
            joints: body.rig.joints(motions).into_iter().map(|joint| back * (joint - place)).collect(),
            place,
            heading,
        }
    }

    /// How far joints and hips go until `later`, as seen from here.
    fn step(&self, later: &Self) -> (Vec<Vec3>, Vec3, f32) {
        let back = turn_by(Vec3::Y * -self.heading);
        let joints = self.joints.iter().zip(&later.joints).map(|(a, b)| *b - *a).collect();
        (joints, back * (later.place - self.place), half_turn(later.heading - self.heading))
    }
}

/// How far two postures are from each other, each given as it is and as it was `seconds` before.
#[must_use]
pub fn apart([a, b]: [[&Look; 2]; 2], seconds: f32) -> Apart {
    let ahead = AHEAD / seconds.max(1e-3);
    let (before, now) = (a[0].step(a[1]), b[0].step(b[1]));
    let place = (before.1 - now.1).length_squared();
    let turn = (before.2 - now.2) * (before.2 - now.2);
    let mut sum = ahead * ahead * (place + 0.1 * turn);
    for joint in 0..a[1].joints.len() {
        let off = a[1].joints[joint].distance_squared(b[1].joints[joint]);
        let speed = before.0[joint].distance_squared(now.0[joint]);
        sum += (off + ahead * ahead * speed) / a[1].joints.len() as f32;
    }
    Apart { metres: sum.sqrt() }
}
