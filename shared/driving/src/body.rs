//! The actor's body: which bones of its rig are which parts, and how they are where it stands upright.
//!
//! All of it is taken from the recording: up of each part is what is up in the frames in which the body stands tallest, a
//! hinge is what a limb's two bones were seen to bend about, and a sole is what lies flat where a foot stands.

use editing::{Rig, Rigid};
use glam::{Quat, Vec3};

use crate::bones::{BodyError, need};
use crate::foot::Foot;
use crate::frames::{angle, level, upright};
use crate::seen::{Seen, flattest, tallest};
use crate::smooth::quantile;

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
pub struct Body {
    /// The rig.
    pub rig: Rig,
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

impl Body {
    /// The body of `rig`, as some frames of its recording show it: those that [`Looker`](crate::Looker) asks for.
    ///
    /// # Errors
    /// A rig without the bones of two legs.
    pub fn new(rig: Rig, seen: &[Seen]) -> Result<Self, BodyError> {
        let find = |name: &str| rig.bones().iter().position(|bone| bone.name == name);
        let need = |name: &str| need(&rig, name);
        let feet = [need("foot_l")?, need("foot_r")?];
        let joint = |bone: usize| rig.bones()[bone].joint;
        let thighs = [need("thigh_l")?, need("thigh_r")?];
        let top = find("head").or(find("chest")).unwrap_or(0);
        let tall = tallest(seen, top, feet);
        let hips = |seen: &Seen| seen.joints[thighs[0]] - seen.joints[thighs[1]];
        let part = |bone: usize| Part { bone, axes: axes(bone, &tall, &hips) };
        let pelvis = part(0);
        let mut legs = Vec::new();
        for (side, letter) in ["l", "r"].into_iter().enumerate() {
            let shin = need(&format!("shin_{letter}"))?;
            let joints = [joint(thighs[side]), joint(shin), joint(feet[side])];
            // Knees bend about the left: what is in front of the thigh comes nearer to the shin's back.
            let usual = pelvis.axes * Vec3::X;
            let bones = two_bones([thighs[side], shin], joints, usual, seen);
            let flat = flattest(seen, side);
            let up = flat.iter().map(|seen| seen.motions[feet[side]].rotation.conjugate() * Vec3::Y).sum::<Vec3>();
            let foot = Foot::new(&rig, feet[side], joint(feet[side]), up.normalize_or(Vec3::Y));
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
            Some(two_bones(bones, joints, pelvis.axes * -Vec3::X, seen))
        };
        let [left, right] = <[Leg; 2]>::try_from(legs).map_err(|_| BodyError::NoBone("thigh_l".into()))?;
        let floors = [0, 1].into_iter().flat_map(|side| flattest(seen, side)).map(|seen| seen.lowest).collect();
        let middle = 0.5 * (joint(thighs[0]) + joint(thighs[1]));
        let (chest, head) = (find("chest").map_or(pelvis, part), find("head").map(part));
        let arms = [arm("l"), arm("r")];
        Ok(Self { rig, pelvis, middle, chest, head, legs: [left, right], arms, floor: quantile(floors, 0.5) })
    }

    /// Length of thigh and shin together, in metres, of both legs' mean.
    #[must_use]
    pub fn leg_length(&self) -> f32 {
        self.legs.iter().flat_map(|leg| leg.bones.vectors()).map(Vec3::length).sum::<f32>() / 2.0
    }
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
