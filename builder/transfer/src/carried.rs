//! The pose as the bones alone carry it: each bone of the target turned as the source's, on the target's own lengths.
//!
//! It is what the Gaussian processes take for granted (their mean function): they learn what it leaves over, and far from what was
//! learned they say nothing, so that a motion that was never seen is the source's on the target's bones instead of the mean pose.

use editing::Rigid;
use glam::{Quat, Vec3};
use rayon::prelude::*;

use crate::bones::{Bones, Pose, mean};
use crate::pair::Pair;
use crate::subject::Subject;

/// Poses of a source on the bones of a target.
pub struct Carried {
    source: Bones,
    target: Bones,
    joints: Vec<Joint>,
    /// How large the target is beside the source.
    scale: f32,
}

/// A bone of the target.
struct Joint {
    /// The source's bone that it is turned as.
    like: usize,
    /// From the target's rest pose to the source's.
    rest: Quat,
    /// How far it is from where its parent has it, beside what it is in the source, on average: in metres in the parent's rest
    /// frame; of the first bone in the body's own.
    slip: Vec3,
}

impl Carried {
    /// From pairs of frames; `None` where either has no human's bones.
    pub fn learn(source: &Subject, target: &Subject, pairs: &[Pair]) -> Option<Self> {
        let (source_bones, target_bones) = (source.bones()?.clone(), target.bones()?.clone());
        let like = target_bones.like(&source_bones);
        let motions: Vec<[Vec<Rigid>; 2]> = pairs
            .par_iter()
            .map(|pair| [source_bones.at(&source.own_at(pair.source)), target_bones.at(&target.own(pair.target))])
            .collect();
        let scale = target.size / source.size.max(f32::MIN_POSITIVE);
        let joint = |(bone, &like): (usize, &usize)| {
            let rest = mean(motions.iter().map(|[own, other]| own[like].rotation.inverse() * other[bone].rotation));
            let slip = |[own, other]: &[Vec<Rigid>; 2]| {
                let off = target_bones.slip(other, bone) - source_bones.slip(own, like) * scale;
                if bone == 0 { off } else { other[target_bones.parent(bone)].rotation.inverse() * off }
            };
            Joint { like, rest, slip: motions.iter().map(slip).sum::<Vec3>() / motions.len().max(1) as f32 }
        };
        let joints = like.iter().enumerate().map(joint).collect();
        Some(Self { source: source_bones, target: target_bones, joints, scale })
    }

    /// What a pair leaves over: how far the target's vertices are from where the bones carry them, turned back as these turn them.
    pub fn rest(&self, source: &Subject, target: &Subject, pair: &Pair) -> Vec<Vec3> {
        let (pose, truth) = (self.pose(&source.own_at(pair.source)), target.own(pair.target));
        let off = |((truth, point), turn): ((&Vec3, &Vec3), &Quat)| turn.inverse() * (*truth - *point);
        truth.iter().zip(&pose.shape).zip(&pose.turns).map(off).collect()
    }

    /// The target's surface as the source's bones would have it in the shape `own` of the source.
    pub fn pose(&self, own: &[Vec3]) -> Pose {
        let from = self.source.at(own);
        let mut motions: Vec<Rigid> = Vec::with_capacity(self.joints.len());
        for (bone, joint) in self.joints.iter().enumerate() {
            let at = self.target.rig.bones()[bone].joint;
            let slip = self.source.slip(&from, joint.like) * self.scale;
            let rotation = (from[joint.like].rotation * joint.rest).normalize();
            let place = match bone {
                0 => slip + joint.slip,
                _ => {
                    let parent = motions[self.target.parent(bone)];
                    parent.apply(at) + slip + parent.rotation * joint.slip
                }
            };
            motions.push(Rigid { rotation, translation: place - rotation * at });
        }
        self.target.carry(&motions)
    }
}
