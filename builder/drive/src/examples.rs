//! What the recording knows of shapes: how far its poses are from skinned ones, joint by joint.
//!
//! A few recorded frames that differ most are examples. What skinning misses in each is kept in the rest pose; a driven frame
//! takes of it, bone by bone, by how alike the joints about the bone are turned. So knees, shoulders and cloth look as they
//! were recorded where the recording has shown something like it, and as skinned elsewhere. This is pose space deformation
//! (J. P. Lewis, M. Cordner and N. Fong, "Pose space deformation", 2000) with bones for regions.

use actor::capture::Poses;
use editing::reach::logarithm;
use editing::{Rig, Rigid, Skin};
use glam::{Quat, Vec3};
use rayon::prelude::*;

/// Examples at most.
const EXAMPLES: usize = 40;
/// Recorded frames that they are chosen from.
const SAMPLES: usize = 400;
/// Joints that are turned so far apart are no more alike, in radians.
const ALIKE: f32 = 0.35;
/// How alike an example must be to count as much as having none does, in the same measure.
const UNLIKE: f32 = 0.8;

/// Examples of one recording.
pub struct Examples {
    /// Local rotations of the bones in each example.
    turns: Vec<Vec<Quat>>,
    /// What skinning misses in each, in the rest pose, in metres.
    missed: Vec<Vec<Vec3>>,
    /// Bones whose joints lie about each bone: itself and those that hang on it.
    about: Vec<Vec<usize>>,
    /// Bones that take nothing: they are held elsewhere.
    left_out: Vec<bool>,
    /// Frame and local rotations of all that were looked at.
    seen: Vec<(u32, Vec<Quat>)>,
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

impl Examples {
    /// Examples from the recorded `poses`; bones in `left_out` take nothing.
    #[must_use]
    pub fn new(rig: &Rig, poses: &Poses, left_out: &[usize]) -> Self {
        let frames: Vec<usize> = (0..poses.len()).step_by(poses.len().div_ceil(SAMPLES).max(1)).collect();
        let fits: Vec<Vec<Rigid>> = frames.par_iter().map(|&frame| rig.fit(poses.frame(frame as u32))).collect();
        let turns: Vec<Vec<Quat>> = fits.iter().map(|fit| local(rig, fit)).collect();
        let chosen = choose(&turns);
        let still = vec![Rigid { rotation: Quat::IDENTITY, translation: Vec3::ZERO }; rig.bones().len()];
        let missed = |&example: &usize| {
            let (skin, pose) = (Skin::new(&still, &fits[example]), poses.frame(frames[example] as u32));
            let off = |v: usize| skin.motion(&rig.influences()[v]).inverse().apply(pose[v]) - rig.rest()[v];
            (0..pose.len()).map(off).collect()
        };
        let about =
            |bone: usize| (1..rig.bones().len()).filter(|&b| b == bone || rig.bones()[b].parent == bone).collect();
        Self {
            missed: chosen.par_iter().map(missed).collect(),
            turns: chosen.iter().map(|&example| turns[example].clone()).collect(),
            about: (0..rig.bones().len()).map(about).collect(),
            left_out: (0..rig.bones().len()).map(|bone| left_out.contains(&bone)).collect(),
            seen: frames.iter().map(|&frame| frame as u32).zip(turns).collect(),
        }
    }

    /// The rest pose as the examples have it where the bones are at `motions`.
    #[must_use]
    pub fn rest(&self, rig: &Rig, motions: &[Rigid]) -> Vec<Vec3> {
        let turns = local(rig, motions);
        let weights: Vec<Vec<f32>> = (0..turns.len()).map(|bone| self.weights(bone, &turns)).collect();
        let mut own = vec![0.0; self.turns.len()];
        let point = |(v, rest): (usize, &Vec3)| {
            own.fill(0.0);
            let influences = &rig.influences()[v];
            for (&bone, &share) in influences.joints.iter().zip(&influences.weights).filter(|(_, share)| **share > 0.0)
            {
                own.iter_mut().zip(&weights[bone as usize]).for_each(|(own, weight)| *own += share * weight);
            }
            let missed = own.iter().zip(&self.missed).filter(|(weight, _)| **weight > 1e-4);
            *rest + missed.map(|(&weight, missed)| missed[v] * weight).sum::<Vec3>()
        };
        rig.rest().iter().enumerate().map(point).collect()
    }

    /// How much each example counts for a bone.
    fn weights(&self, bone: usize, turns: &[Quat]) -> Vec<f32> {
        if self.left_out[bone] {
            return vec![0.0; self.turns.len()];
        }
        let like = |square: f32| (-0.5 * square / (ALIKE * ALIKE)).exp();
        let square = |example: &Vec<Quat>| self.about[bone].iter().map(|&b| apart(example[b], turns[b])).sum::<f32>();
        let mut weights: Vec<f32> = self.turns.iter().map(|example| like(square(example))).collect();
        let all = weights.iter().sum::<f32>() + like(UNLIKE * UNLIKE);
        weights.iter_mut().for_each(|weight| *weight /= all);
        weights
    }

    /// The recorded frame whose bones are turned most as those of `frames` are, on average.
    #[must_use]
    pub fn nearest(&self, rig: &Rig, frames: &[Vec<Rigid>]) -> u32 {
        let turns: Vec<Vec<Quat>> =
            frames.iter().step_by(frames.len().div_ceil(50).max(1)).map(|motions| local(rig, motions)).collect();
        let off = |seen: &[Quat]| -> f32 {
            turns.iter().map(|own| own.iter().zip(seen).map(|(a, b)| apart(*a, *b)).sum::<f32>()).sum()
        };
        let sums: Vec<f32> = self.seen.par_iter().map(|(_, seen)| off(seen)).collect();
        let best = (1..sums.len()).fold(0, |best, k| if sums[k] < sums[best] { k } else { best });
        self.seen.get(best).map_or(0, |(frame, _)| *frame)
    }
}

/// Frames that differ most, one after another: each is the farthest from those before.
fn choose(turns: &[Vec<Quat>]) -> Vec<usize> {
    let off = |a: usize, b: usize| turns[a].iter().zip(&turns[b]).map(|(a, b)| apart(*a, *b)).sum::<f32>();
    let mut chosen = vec![0];
    let mut least: Vec<f32> = (0..turns.len()).map(|frame| off(0, frame)).collect();
    while chosen.len() < EXAMPLES.min(turns.len()) {
        let next = (1..least.len()).fold(0, |best, k| if least[k] > least[best] { k } else { best });
        if least[next] <= 1e-4 {
            break;
        }
        chosen.push(next);
        (0..turns.len()).for_each(|frame| least[frame] = least[frame].min(off(next, frame)));
    }
    chosen
}
