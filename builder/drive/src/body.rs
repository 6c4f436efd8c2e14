//! The actor's body: which bones of its rig are which parts, and how they are where it stands upright.
//!
//! All of it is taken from the recording: up of each part is what is up in the frames in which the body stands tallest, a
//! hinge is what a limb's two bones were seen to bend about, and a sole is what lies flat where a foot stands.

use actor::capture::Poses;
use editing::{Rig, Rigid};
use glam::{Quat, Vec3};
use rayon::prelude::*;
use thiserror::Error;

use crate::foot::Foot;
use crate::frames::{angle, level, upright};
use crate::smooth::quantile;

/// Frames that are looked at.
const SAMPLES: usize = 400;
/// The share of frames in which the body stands tallest.
const TALLEST: f32 = 0.25;
/// The share of standing frames in which a foot lies flattest.
const FLATTEST: f32 = 0.2;
/// A vertex so near to the lowest one lies on the floor, in metres.
const ON_FLOOR: f32 = 0.012;
/// The least bend of a limb is the smallest that was recorded, leaving out so many frames.
const STRAIGHTEST: f32 = 0.02;
/// Bends below this are taken for none, so that a limb can always be stretched, in radians: 20 degrees.
const MOST_LEAST_BEND: f32 = 0.35;

/// Two bones of a limb.
#[derive(Clone, Debug, PartialEq)]
pub struct TwoBones {
    /// Their bones in the rig.
    pub bones: [usize; 2],
    /// Where the first begins, where they meet, where the second ends: in the rest pose, in metres.
    pub joints: [Vec3; 3],
    /// What they bend about, in the rest pose turned with the first bone.
    pub hinge: Vec3,
    /// The least angle between them that was recorded, in radians.
    pub least_bend: f32,
}

impl TwoBones {
    /// The first bone and the second as vectors in the rest pose.
    #[must_use]
    pub fn vectors(&self) -> [Vec3; 2] {
        [self.joints[1] - self.joints[0], self.joints[2] - self.joints[1]]
    }
}

/// A leg.
#[derive(Clone, Debug, PartialEq)]
pub struct Leg {
    /// Thigh and shin.
    pub bones: TwoBones,
    /// The foot.
    pub foot: Foot,
}

/// A part of the trunk, or the head.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// Its bone.
    pub bone: usize,
    /// Its axes in the rest pose: left, up, forwards where the body stands upright.
    pub axes: Quat,
}

/// A body.
#[derive(Clone, Debug)]
pub struct Body<'a> {
    /// The rig.
    pub rig: &'a Rig,
    /// The pelvis.
    pub pelvis: Part,
    /// Between the hips in the rest pose.
    pub middle: Vec3,
    /// The chest; the pelvis where the trunk is one bone.
    pub chest: Part,
    /// The head.
    pub head: Option<Part>,
    /// The left leg and the right one.
    pub legs: [Leg; 2],
    /// The left arm and the right one.
    pub arms: [Option<TwoBones>; 2],
    /// How high the floor is, in metres.
    pub floor: f32,
}

/// Why a rig is no body that a skeleton can drive.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum BodyError {
    /// A bone that must be there is not.
    #[error(
        "the actor's rig has no bone {0:?}: only a body with two legs can be driven; where it has, give its bones these names \
         with a rig file (builder rig --toml, then --rig)"
    )]
    NoBone(String),
    /// A foot without vertices, or a leg without length.
    #[error("the actor's {0} is too small to be driven")]
    Small(String),
}

/// A recorded frame: where bones are in it, and how far its points are from the floor.
struct Seen {
    motions: Vec<Rigid>,
    joints: Vec<Vec3>,
    /// Of each foot: how low it is, and how much of it lies flat.
    feet: [(f32, usize); 2],
    lowest: f32,
}

impl<'a> Body<'a> {
    /// The body of `rig`, as the recorded `poses` show it.
    ///
    /// # Errors
    /// A rig without the bones of two legs.
    pub fn new(rig: &'a Rig, poses: &Poses) -> Result<Self, BodyError> {
        let find = |name: &str| rig.bones().iter().position(|bone| bone.name == name);
        let need = |name: String| find(&name).ok_or(BodyError::NoBone(name));
        let feet = [need("foot_l".into())?, need("foot_r".into())?];
        let seen = look(rig, poses, feet);
        let joint = |bone: usize| rig.bones()[bone].joint;
        let thighs = [need("thigh_l".into())?, need("thigh_r".into())?];
        let top = find("head").or(find("chest")).unwrap_or(0);
        let tall = tallest(&seen, top, feet);
        let hips = |seen: &Seen| seen.joints[thighs[0]] - seen.joints[thighs[1]];
        let part = |bone: usize| Part { bone, axes: axes(bone, &tall, &hips) };
        let pelvis = part(0);
        let mut legs = Vec::new();
        for (side, letter) in ["l", "r"].into_iter().enumerate() {
            let shin = need(format!("shin_{letter}"))?;
            let joints = [joint(thighs[side]), joint(shin), joint(feet[side])];
            // Knees bend about the left: what is in front of the thigh comes nearer to the shin's back.
            let usual = pelvis.axes * Vec3::X;
            let bones = two_bones([thighs[side], shin], joints, usual, &seen);
            let flat = flattest(&seen, side);
            let up = flat.iter().map(|seen| seen.motions[feet[side]].rotation.conjugate() * Vec3::Y).sum::<Vec3>();
            let foot = Foot::new(rig, feet[side], joint(feet[side]), up.normalize_or(Vec3::Y));
            let small = || BodyError::Small(format!("foot_{letter}"));
            let foot = foot.filter(|foot| foot.sole().count() > 2).ok_or_else(small)?;
            if bones.vectors().iter().any(|bone| bone.length() < 1e-3) {
                return Err(BodyError::Small(format!("thigh_{letter}")));
            }
            legs.push(Leg { bones, foot });
        }
        let ends = rig.ends(&vec![Rigid { rotation: Quat::IDENTITY, translation: Vec3::ZERO }; rig.bones().len()]);
        let arm = |letter: &str| {
            let bones = [find(&format!("upper_arm_{letter}"))?, find(&format!("forearm_{letter}"))?];
            let joints = [joint(bones[0]), joint(bones[1]), ends[bones[1]]];
            Some(two_bones(bones, joints, pelvis.axes * -Vec3::X, &seen))
        };
        let [left, right] = <[Leg; 2]>::try_from(legs).map_err(|_| BodyError::NoBone("thigh_l".into()))?;
        let floors = [0, 1].into_iter().flat_map(|side| flattest(&seen, side)).map(|seen| seen.lowest).collect();
        Ok(Self {
            rig,
            pelvis,
            middle: 0.5 * (joint(thighs[0]) + joint(thighs[1])),
            chest: find("chest").map_or(pelvis, part),
            head: find("head").map(part),
            legs: [left, right],
            arms: [arm("l"), arm("r")],
            floor: quantile(floors, 0.5),
        })
    }

    /// Length of thigh and shin together, in metres, of both legs' mean.
    #[must_use]
    pub fn leg_length(&self) -> f32 {
        self.legs.iter().flat_map(|leg| leg.bones.vectors()).map(Vec3::length).sum::<f32>() / 2.0
    }
}

fn look(rig: &Rig, poses: &Poses, feet: [usize; 2]) -> Vec<Seen> {
    let own = feet.map(|foot| (0..rig.rest().len() as u32).filter(|&v| rig.bone_of(v) == foot).collect::<Vec<u32>>());
    let frames: Vec<usize> = (0..poses.len()).step_by(poses.len().div_ceil(SAMPLES).max(1)).collect();
    let one = |&frame: &usize| {
        let pose = poses.frame(frame as u32);
        let motions = rig.fit(pose);
        let lowest = pose.iter().map(|point| point.y).fold(f32::INFINITY, f32::min);
        let feet = own.each_ref().map(|own| {
            let height = |&v: &u32| pose[v as usize].y;
            let low = own.iter().map(height).fold(f32::INFINITY, f32::min);
            (low, own.iter().filter(|v| height(v) < low + ON_FLOOR).count())
        });
        Seen { joints: rig.joints(&motions), motions, feet, lowest }
    };
    frames.par_iter().map(one).collect()
}

/// The frames in which the joint `top` is highest over the feet.
fn tallest(seen: &[Seen], top: usize, feet: [usize; 2]) -> Vec<&Seen> {
    let height = |seen: &Seen| seen.joints[top].y - seen.joints[feet[0]].y.min(seen.joints[feet[1]].y);
    let least = quantile(seen.iter().map(height).collect(), 1.0 - TALLEST);
    seen.iter().filter(|seen| height(seen) >= least).collect()
}

/// The frames in which a foot stands and most of it lies flat.
fn flattest(seen: &[Seen], side: usize) -> Vec<&Seen> {
    let standing: Vec<&Seen> = seen.iter().filter(|seen| seen.feet[side].0 < seen.lowest + 0.02).collect();
    let least = quantile(standing.iter().map(|seen| seen.feet[side].1 as f32).collect(), 1.0 - FLATTEST);
    standing.into_iter().filter(|seen| seen.feet[side].1 as f32 >= least).collect()
}

/// Axes of a bone in the rest pose: what is up, and to the left of the hips, in these frames on average.
fn axes(bone: usize, frames: &[&Seen], hips: &dyn Fn(&Seen) -> Vec3) -> Quat {
    let back = |seen: &Seen, v: Vec3| seen.motions[bone].rotation.conjugate() * v;
    let up = frames.iter().map(|seen| back(seen, Vec3::Y)).sum();
    let left = frames.iter().map(|seen| back(seen, level(hips(seen)).normalize_or_zero())).sum();
    upright(up, left)
}

fn two_bones(bones: [usize; 2], joints: [Vec3; 3], usual: Vec3, seen: &[Seen]) -> TwoBones {
    let [first, second] = [joints[1] - joints[0], joints[2] - joints[1]].map(Vec3::normalize_or_zero);
    let (mut hinge, mut bends) = (Vec3::ZERO, Vec::new());
    for seen in seen {
        let [upper, lower] = bones.map(|bone| seen.motions[bone].rotation);
        let (first, second) = (upper * first, lower * second);
        hinge += upper.conjugate() * first.cross(second);
        bends.push(angle(first, second));
    }
    let is_clear = hinge.length() > 0.05 * seen.len() as f32;
    let hinge = if is_clear { hinge } else { usual }.reject_from_normalized(first.normalize_or(Vec3::Y));
    let least_bend = quantile(bends, STRAIGHTEST).min(MOST_LEAST_BEND);
    TwoBones { bones, joints, hinge: hinge.normalize_or(usual), least_bend }
}
