//! Which recorded frame a driven clip resembles: the one whose bones are turned against each other as the clip's are.

use editing::reach::logarithm;
use editing::{Rig, Rigid};
use glam::Quat;

/// Recorded frames that are looked at, and driven ones.
const RECORDED: usize = 200;
const DRIVEN: usize = 50;

/// A driven clip, as recorded frames are held against it.
pub struct Likeness {
    turns: Vec<Vec<Quat>>,
}

/// How bones are turned against their parents.
fn local(rig: &Rig, motions: &[Rigid]) -> Vec<Quat> {
    let turn = |(index, bone): (usize, &editing::Bone)| match index {
        // What way the body faces shapes nothing.
        0 => Quat::IDENTITY,
        _ => motions[bone.parent].rotation.conjugate() * motions[index].rotation,
    };
    rig.bones().iter().enumerate().map(turn).collect()
}

fn apart(a: Quat, b: Quat) -> f32 {
    logarithm(a.conjugate() * b).length_squared()
}

impl Likeness {
    /// Of a clip whose frames are these motions of the bones of `rig`.
    #[must_use]
    pub fn new(rig: &Rig, frames: &[Vec<Rigid>]) -> Self {
        let every = frames.len().div_ceil(DRIVEN).max(1);
        Self { turns: frames.iter().step_by(every).map(|motions| local(rig, motions)).collect() }
    }

    /// The frames of a recording of so many that are held against it.
    pub fn samples(frame_count: usize) -> impl Iterator<Item = u32> {
        (0..frame_count as u32).step_by(frame_count.div_ceil(RECORDED).max(1))
    }

    /// How far a frame, in which the bones of `rig` have these `motions`, is from the clip: in radians squared, summed over
    /// bones and frames.
    #[must_use]
    pub fn apart(&self, rig: &Rig, motions: &[Rigid]) -> f32 {
        let own = local(rig, motions);
        self.turns.iter().map(|turns| turns.iter().zip(&own).map(|(a, b)| apart(*a, *b)).sum::<f32>()).sum()
    }
}
