//! How a performer is built and dressed, and how it carries itself: the one that is modelled is the woman, others are she with
//! other bones and other clothes.
//!
//! Every bone has a scale along it and about it. The modelled surface is put from her bones onto those of another build in the bind
//! pose, by its own skin weights. Motions are hers: joints turn as hers do, but for the habits of a figure; ways along the ground and heights are those of her legs
//! times the ratio of the legs, and legs reach for their feet anew.

use glam::{Quat, Vec3};
use rig::{Influences, Rigid, Skin, two_bones};

use super::skeleton::{BodyState, Channel, JOINT_COUNT, NEUTRAL, PARENTS, bind_pose, joint};

/// Who performs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// In a skirt, with a ponytail.
    #[default]
    Woman,
    /// Taller and broader, in trousers.
    Man,
    /// Small, with a large head and short limbs, in shorts.
    Child,
}

/// What covers the legs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Dress {
    /// A skirt that swings.
    #[default]
    Skirt,
    /// Trousers down to the shoes.
    Trousers,
    /// Trousers down to the knees.
    Shorts,
}

impl Kind {
    /// What covers the legs.
    #[must_use]
    pub fn dress(self) -> Dress {
        match self {
            Self::Woman => Dress::Skirt,
            Self::Man => Dress::Trousers,
            Self::Child => Dress::Shorts,
        }
    }

    /// Scales of the bone of a joint in the joint's frame, beside the woman's.
    fn scale(self, index: usize) -> Vec3 {
        let along = |girth: f32, length: f32| Vec3::new(girth, length, girth);
        let is = |first: [usize; 2], offset: usize| first.iter().any(|&side| side + offset == index);
        match self {
            Self::Woman => Vec3::ONE,
            Self::Man => match index {
                joint::PELVIS | joint::SPINE => Vec3::new(1.16, 1.04, 1.12),
                joint::CHEST => Vec3::new(1.2, 1.06, 1.1),
                joint::NECK => along(1.18, 1.05),
                _ if is(joint::ARM, 0) => Vec3::new(1.22, 1.06, 1.12),
                _ if is(joint::ARM, 1) || is(joint::ARM, 2) => along(1.24, 1.08),
                _ if is(joint::ARM, 3) => Vec3::splat(1.14),
                _ if is(joint::LEG, 0) || is(joint::LEG, 1) => along(1.06, 1.05),
                _ if is(joint::LEG, 2) || is(joint::LEG, 3) => Vec3::splat(1.1),
                _ => Vec3::ONE,
            },
            Self::Child => match index {
                joint::PELVIS | joint::SPINE => Vec3::new(0.72, 0.66, 0.78),
                joint::CHEST => Vec3::new(0.68, 0.66, 0.76),
                joint::NECK => along(0.74, 0.6),
                joint::HEAD => Vec3::splat(0.88),
                _ if is(joint::ARM, 0) => Vec3::new(0.66, 0.66, 0.76),
                _ if is(joint::ARM, 1) || is(joint::ARM, 2) => along(0.76, 0.62),
                _ if is(joint::ARM, 3) => Vec3::splat(0.68),
                _ if is(joint::LEG, 0) || is(joint::LEG, 1) => along(0.74, 0.6),
                _ if is(joint::LEG, 2) || is(joint::LEG, 3) => Vec3::splat(0.7),
                _ => Vec3::ONE,
            },
        }
    }

    /// The state as this figure carries itself: arms and trunk have habits of their own.
    #[must_use]
    pub fn carried(self, mut state: BodyState) -> BodyState {
        // How far a figure swings its arms, how far it spreads them, how it bends elbows, how it leans.
        let (swing, spread, elbow, lean) = match self {
            Self::Woman => return state,
            Self::Man => (0.8, 5.0, 0.85, 0.9),
            Self::Child => (1.15, 7.0, 1.1, 1.08),
        };
        let controls = &mut state.controls;
        for [flex, out, bend] in
            [[Channel::FlexL, Channel::SpreadL, Channel::ElbowL], [Channel::FlexR, Channel::SpreadR, Channel::ElbowR]]
        {
            // What is lifted far is lifted as far: habits are of what hangs.
            let hangs = 1.0 / (1.0 + (controls[flex] / 70.0).powi(2));
            controls[flex] *= 1.0 + (swing - 1.0) * hangs;
            controls[out] += spread * hangs;
            controls[bend] *= elbow + 0.002 * controls[bend] * (1.0 - elbow);
        }
        controls[Channel::TrunkPitch] *= lean;
        controls[Channel::TrunkRoll] *= lean;
        state
    }
}

/// Bones of a build.
#[derive(Clone, Debug)]
pub struct Build {
    kind: Kind,
    /// From each joint's parent to it, in the neutral pose.
    offsets: [Vec3; JOINT_COUNT],
    /// Her legs times this are its legs.
    legs: f32,
    /// Inverse joint transforms of the bind pose.
    bind_inverse: [Rigid; JOINT_COUNT],
}

impl Build {
    /// The bones of a figure.
    #[must_use]
    pub fn new(kind: Kind) -> Self {
        let mut offsets = [Vec3::ZERO; JOINT_COUNT];
        for index in 1..JOINT_COUNT {
            let parent = PARENTS[index];
            offsets[index] = kind.scale(parent) * (NEUTRAL[index] - NEUTRAL[parent]);
        }
        let mut build = Self { kind, offsets, legs: 1.0, bind_inverse: bind_pose().map(|own| own.inverse()) };
        if kind == Kind::Woman {
            return build;
        }
        let hip = joint::LEG[0];
        let down = |of: &dyn Fn(usize) -> Vec3| -(of(hip) + of(hip + 1) + of(hip + 2)).y;
        let hers = |index: usize| NEUTRAL[index] - NEUTRAL[PARENTS[index]];
        let sole = NEUTRAL[hip + 2].y;
        build.legs = (down(&|index| build.offsets[index]) + sole * kind.scale(hip + 2).y) / (down(&hers) + sole);
        build.bind_inverse = build.bind().map(|own| own.inverse());
        build
    }

    /// Whose they are.
    #[must_use]
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// Inverse joint transforms of the bind pose.
    #[must_use]
    pub fn bind_inverse(&self) -> &[Rigid; JOINT_COUNT] {
        &self.bind_inverse
    }

    /// The bind pose: joints turned as hers, apart from her legs, too.
    fn bind(&self) -> [Rigid; JOINT_COUNT] {
        self.chained(&bind_pose())
    }

    /// Joints turned as `hers` on these bones, the pelvis as high and as far as the legs say.
    fn chained(&self, hers: &[Rigid; JOINT_COUNT]) -> [Rigid; JOINT_COUNT] {
        let mut own = *hers;
        own[joint::PELVIS].translation = hers[joint::PELVIS].translation * self.legs;
        for index in 1..JOINT_COUNT {
            own[index].translation = own[PARENTS[index]].apply(self.offsets[index]);
        }
        own
    }

    /// The surface in this build's bind pose, from hers.
    #[must_use]
    pub fn shaped(&self, positions: &[Vec3], influences: &[Influences]) -> Vec<Vec3> {
        if self.kind == Kind::Woman {
            return positions.to_vec();
        }
        let (hers, own) = (bind_pose().map(|bone| bone.inverse()), self.bind());
        let scales: [Vec3; JOINT_COUNT] = std::array::from_fn(|index| self.kind.scale(index));
        let shape = |(&point, influences): (&Vec3, &Influences)| -> Vec3 {
            let bones = influences.joints.iter().zip(&influences.weights);
            bones
                .map(|(&index, &weight)| {
                    let index = index as usize;
                    own[index].apply(scales[index] * hers[index].apply(point)) * weight
                })
                .sum()
        };
        positions.iter().zip(influences).map(shape).collect()
    }

    /// Joints of this build in a state, from hers.
    #[must_use]
    pub fn joints(&self, state: &BodyState, hers: &[Rigid; JOINT_COUNT]) -> [Rigid; JOINT_COUNT] {
        if self.kind == Kind::Woman {
            return *hers;
        }
        let mut own = self.chained(hers);
        for (side, first) in joint::LEG.into_iter().enumerate() {
            let ankle = self.ankle(hers[first + 2], self.kind.scale(first + 2).y);
            // The knee points where hers does.
            let straight = (hers[first + 2].translation - hers[first].translation).normalize_or_zero();
            let knee = hers[first + 1].translation - hers[first].translation;
            let facing = Quat::from_rotation_y(state.feet[side].yaw) * Vec3::Z;
            let forward = knee.reject_from_normalized(straight) + 0.02 * facing;
            let leg =
                two_bones(own[first].translation, ankle, forward, &self.offsets[first + 1], &self.offsets[first + 2]);
            own[first].rotation = leg.upper;
            own[first + 1] = Rigid { rotation: leg.lower, translation: leg.middle };
            own[first + 2] = Rigid { rotation: hers[first + 2].rotation, translation: leg.end };
            own[first + 3].translation = own[first + 2].apply(self.offsets[first + 3]);
        }
        own
    }

    /// Where an ankle is: the ball of the foot goes as far as the legs say, the foot above it is as large as it is.
    fn ankle(&self, hers: Rigid, foot: f32) -> Vec3 {
        // A point of the sole below the ball: where a foot stands and rolls.
        let sole = Vec3::new(0.0, -NEUTRAL[joint::LEG[0] + 2].y, 0.06);
        hers.apply(sole) * self.legs - hers.rotation * (sole * foot)
    }
}

/// Skinned positions of `rest`, the surface of a build in its bind pose.
#[must_use]
pub fn skinned(rest: &[Vec3], influences: &[Influences], skin: &Skin) -> Vec<Vec3> {
    rest.iter().zip(influences).map(|(&p, influences)| skin.motion(influences).apply(p)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::solve;

    #[test]
    fn every_build_stands_on_the_ground_with_bones_of_its_own() {
        let hers = bind_pose();
        for kind in [Kind::Woman, Kind::Man, Kind::Child] {
            let build = Build::new(kind);
            let motion = crate::motion::make(1, 3);
            for k in 0..20 {
                let (state, _) = (motion.at)(0.15 * k as f32);
                let state = kind.carried(state);
                let joints = build.joints(&state, &solve(&state));
                for index in 1..JOINT_COUNT {
                    let length = joints[index].translation.distance(joints[PARENTS[index]].translation);
                    let stretched = (length - build.offsets[index].length()).abs();
                    assert!(stretched < 2e-3, "{kind:?} {index}: {stretched}");
                }
                let lowest =
                    joint::LEG.map(|first| joints[first + 2].translation.y).into_iter().fold(f32::MAX, f32::min);
                let flat = hers[joint::LEG[0] + 2].translation.y * kind.scale(joint::LEG[0] + 2).y;
                assert!((lowest - flat).abs() < 0.06, "{kind:?}: {lowest} {flat}");
            }
        }
        let [man, child] = [Kind::Man, Kind::Child].map(|kind| Build::new(kind).legs);
        assert!((1.03..1.09).contains(&man) && (0.55..0.7).contains(&child), "{man} {child}");
    }
}
