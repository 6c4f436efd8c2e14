//! Which recorded frame a driven clip resembles: the one whose bones are turned against each other as the clip's are.

use actor::capture::Poses;
use editing::reach::logarithm;
use editing::{Rig, Rigid};
use glam::Quat;
use rayon::prelude::*;

/// Recorded frames that are looked at, and driven ones.
const RECORDED: usize = 200;
const DRIVEN: usize = 50;

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

/// The recorded frame of `poses` that resembles `frames`, the motions of the bones of `rig`, most on average.
#[must_use]
pub fn nearest(rig: &Rig, poses: &Poses, frames: &[Vec<Rigid>]) -> u32 {
    let turns: Vec<Vec<Quat>> =
        frames.iter().step_by(frames.len().div_ceil(DRIVEN).max(1)).map(|motions| local(rig, motions)).collect();
    let seen: Vec<u32> = (0..poses.len() as u32).step_by(poses.len().div_ceil(RECORDED).max(1)).collect();
    let off = |&frame: &u32| -> f32 {
        let own = local(rig, &rig.fit(poses.frame(frame)));
        turns.iter().map(|turns| turns.iter().zip(&own).map(|(a, b)| apart(*a, *b)).sum::<f32>()).sum()
    };
    let sums: Vec<f32> = seen.par_iter().map(off).collect();
    let best = (1..sums.len()).fold(0, |best, k| if sums[k] < sums[best] { k } else { best });
    seen.get(best).copied().unwrap_or(0)
}
