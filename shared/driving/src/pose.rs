//! Bones of the actor for a posture: trunk, head and feet turn as the source's do, limbs point where they point.

use editing::Rigid;
use glam::{Quat, Vec3};

use crate::body::{Body, TwoBones};
use crate::frames::{arc, hinged};
use crate::posture::{Bent, Posture};

/// Bones of the actor in one frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// Where the middle between the hips is, in metres.
    pub root: Vec3,
    /// How each bone is turned against the rest pose, in the world.
    pub turns: Vec<Quat>,
}

impl Body {
    /// How the bones are turned where the body does what `posture` says.
    #[must_use]
    pub fn turns(&self, posture: &Posture) -> Vec<Quat> {
        let bones = self.rig.bones();
        let mut turns = vec![None; bones.len()];
        let pelvis = posture.pelvis * self.pelvis.axes.conjugate();
        let chest = posture.chest.map_or(pelvis, |chest| chest * self.chest.axes.conjugate());
        turns[self.pelvis.bone] = Some(pelvis);
        // Where the trunk is one bone it turns as the pelvis does.
        turns[self.chest.bone] = Some(if self.chest.bone == self.pelvis.bone { pelvis } else { chest });
        if let (Some(part), Some(head)) = (self.head, posture.head) {
            turns[part.bone] = Some(head * part.axes.conjugate());
        }
        let above = turns[self.chest.bone].unwrap_or(pelvis);
        for (leg, posture) in self.legs.iter().zip(&posture.legs) {
            let [thigh, shin] = limb(&leg.bones, &posture.bent, pelvis);
            turns[leg.bones.bones[0]] = Some(thigh);
            turns[leg.bones.bones[1]] = Some(shin);
            turns[leg.foot.bone] = Some(posture.foot * leg.foot.axes.conjugate());
        }
        for (arm, bent) in self.arms.iter().zip(&posture.arms) {
            if let (Some(arm), Some(bent)) = (arm, bent) {
                let [upper, lower] = limb(arm, bent, above);
                turns[arm.bones[0]] = Some(upper);
                turns[arm.bones[1]] = Some(lower);
            }
        }
        // What the source has nothing of stays against its parent as it is in the rest pose.
        let mut done: Vec<Quat> = Vec::with_capacity(bones.len());
        for (index, bone) in bones.iter().enumerate() {
            let parent = done.get(bone.parent).copied().unwrap_or(pelvis);
            done.push(turns[index].unwrap_or(parent));
        }
        done
    }

    /// The rigid motions of the bones from the rest pose.
    #[must_use]
    pub fn motions(&self, pose: &Pose) -> Vec<Rigid> {
        let mut motions: Vec<Rigid> = Vec::with_capacity(pose.turns.len());
        for (bone, &rotation) in self.rig.bones().iter().zip(&pose.turns) {
            let (joint, place) = match motions.get(bone.parent) {
                Some(parent) => (bone.joint, parent.apply(bone.joint)),
                None => (self.middle, pose.root),
            };
            motions.push(Rigid { rotation, translation: place - rotation * joint });
        }
        motions
    }
}

/// How both bones of a limb are turned; `parent` is how what they hang on is.
#[must_use]
pub fn limb(bones: &TwoBones, bent: &Bent, parent: Quat) -> [Quat; 2] {
    let [first, second] = bones.vectors();
    let Some(hinge) = bent.hinge else {
        let upper = arc(parent * first, bent.upper) * parent;
        return [upper, arc(upper * second, bent.lower) * upper];
    };
    let lower = no_straighter(bent, hinge, bones.least_bend);
    let turn = |bone: Vec3, to: Vec3| hinged(to, hinge) * hinged(bone, bones.hinge).conjugate();
    [turn(first, bent.upper), turn(second, lower)]
}

/// The direction of the second bone, which bends no less against the first than the actor was seen to.
fn no_straighter(bent: &Bent, hinge: Vec3, least: f32) -> Vec3 {
    let axis = hinge.reject_from_normalized(bent.upper).normalize_or(hinge);
    let ahead = axis.cross(bent.upper);
    let bend = kernels::scalar::atan2(bent.lower.dot(ahead), bent.lower.dot(bent.upper));
    if bend >= least || bend < -1.0 {
        return bent.lower;
    }
    let (sin, cos) = kernels::scalar::sin_cos(least);
    let aside = axis * bent.lower.dot(axis);
    (bent.upper * cos + ahead * sin + aside).normalize_or(bent.lower)
}

/// The thigh's and the shin's turns that bring the ankle to `ankle`, the hip being at `hip`, bent about `hinge`.
#[must_use]
pub fn reach(bones: &TwoBones, hip: Vec3, ankle: Vec3, hinge: Vec3) -> [Quat; 2] {
    let [first, second] = bones.vectors();
    let (a, b) = (first.length(), second.length());
    let along = (ankle - hip).normalize_or(Vec3::NEG_Y);
    let distance = (ankle - hip).length().clamp((a - b).abs() + 1e-3, farthest(bones));
    let cosine = ((a * a + distance * distance - b * b) / (2.0 * a * distance)).clamp(-1.0, 1.0);
    let hinge = hinge.reject_from_normalized(along).normalize_or(along.any_orthonormal_vector());
    // The first bone turns ahead of the way, the second back to it.
    let ahead = along.cross(hinge);
    let knee = hip + a * (along * cosine + ahead * (1.0 - cosine * cosine).max(0.0).sqrt());
    let end = hip + along * distance;
    let turn = |bone: Vec3, to: Vec3| hinged(to.normalize_or(along), hinge) * hinged(bone, bones.hinge).conjugate();
    [turn(first, knee - hip), turn(second, end - knee)]
}

/// How far from the first joint the end of a limb comes, in metres.
#[must_use]
pub fn farthest(bones: &TwoBones) -> f32 {
    let [a, b] = bones.vectors().map(Vec3::length);
    let (_, cos) = kernels::scalar::sin_cos(bones.least_bend.clamp(0.03, 0.2));
    (a * a + b * b + 2.0 * a * b * cos).sqrt()
}
