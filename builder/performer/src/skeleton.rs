//! The performer's joints, and how controls become joint transforms.
//!
//! Facing +Z, up +Y, so the left side is +X. In the neutral pose all joint frames are parallel to the world's, the arms
//! hang down and the legs are straight; segment lengths follow Drillis and Contini (1966) for a height of 1.75 m, with
//! a slightly larger head and shorter arms because the figure is stylised.

use std::ops::{Index, IndexMut};

use glam::{Quat, Vec3};
use rig::{Rigid, two_bones};

/// Number of joints.
pub const JOINT_COUNT: usize = 24;

/// A joint, by its index in every array of joints. `L` is the figure's left side, +X.
#[allow(missing_docs)]
pub mod joint {
    pub const PELVIS: usize = 0;
    pub const SPINE: usize = 1;
    pub const CHEST: usize = 2;
    pub const NECK: usize = 3;
    pub const HEAD: usize = 4;
    /// Clavicle, upper arm, forearm, hand of the left and of the right side.
    pub const ARM: [usize; 2] = [5, 9];
    /// Thigh, shin, foot, toes of the left and of the right side.
    pub const LEG: [usize; 2] = [13, 17];
    /// Three joints of the ponytail.
    pub const TAIL: usize = 21;
}

/// Names of the joints, as the truth files give them.
pub const JOINT_NAMES: [&str; JOINT_COUNT] = [
    "pelvis",
    "spine",
    "chest",
    "neck",
    "head",
    "clavicle_l",
    "upper_arm_l",
    "forearm_l",
    "hand_l",
    "clavicle_r",
    "upper_arm_r",
    "forearm_r",
    "hand_r",
    "thigh_l",
    "shin_l",
    "foot_l",
    "toes_l",
    "thigh_r",
    "shin_r",
    "foot_r",
    "toes_r",
    "tail_1",
    "tail_2",
    "tail_3",
];

/// Parent of each joint; the pelvis is its own.
pub const PARENTS: [usize; JOINT_COUNT] =
    [0, 0, 1, 2, 3, 2, 5, 6, 7, 2, 9, 10, 11, 0, 13, 14, 15, 0, 17, 18, 19, 4, 21, 22];

/// Joint positions in the neutral pose, in metres, standing on the ground at the origin.
pub const NEUTRAL: [Vec3; JOINT_COUNT] = [
    Vec3::new(0.0, 0.955, 0.0),
    Vec3::new(0.0, 1.055, -0.01),
    Vec3::new(0.0, 1.205, -0.015),
    Vec3::new(0.0, 1.445, -0.02),
    Vec3::new(0.0, 1.535, -0.005),
    Vec3::new(0.03, 1.405, -0.005),
    Vec3::new(0.165, 1.405, -0.012),
    Vec3::new(0.165, 1.12, -0.012),
    Vec3::new(0.165, 0.875, -0.012),
    Vec3::new(-0.03, 1.405, -0.005),
    Vec3::new(-0.165, 1.405, -0.012),
    Vec3::new(-0.165, 1.12, -0.012),
    Vec3::new(-0.165, 0.875, -0.012),
    Vec3::new(0.088, 0.925, 0.0),
    Vec3::new(0.088, 0.5, 0.004),
    Vec3::new(0.088, 0.085, -0.012),
    Vec3::new(0.088, 0.022, 0.1),
    Vec3::new(-0.088, 0.925, 0.0),
    Vec3::new(-0.088, 0.5, 0.004),
    Vec3::new(-0.088, 0.085, -0.012),
    Vec3::new(-0.088, 0.022, 0.1),
    Vec3::new(0.0, 1.735, -0.132),
    Vec3::new(0.0, 1.685, -0.218),
    Vec3::new(0.0, 1.58, -0.246),
];

/// Where the sole touches behind the ankle, seen from the ankle joint in the neutral pose.
pub const HEEL_FROM_ANKLE: Vec3 = Vec3::new(0.0, -0.085, -0.05);
/// The toe joint, about which the heel rises while the toes stay, seen from the ankle joint in the neutral pose.
pub const BALL_FROM_ANKLE: Vec3 = Vec3::new(0.0, -0.063, 0.112);
/// Height of the ankle joint above the ground where the sole is flat.
const ANKLE_HEIGHT: f32 = 0.085;

/// One animated quantity. Angles in degrees, lengths in metres.
#[allow(missing_docs)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// Pelvis offset to the left, up and forwards in the heading's frame.
    Left,
    Up,
    Forward,
    /// Pelvis: yaw to the left, pitch forwards (bowing), roll (left hip up).
    PelvisYaw,
    PelvisPitch,
    PelvisRoll,
    /// Trunk against the pelvis, shared by spine and chest.
    TrunkYaw,
    TrunkPitch,
    TrunkRoll,
    /// Head against the chest, shared by neck and head.
    HeadYaw,
    HeadPitch,
    HeadRoll,
    /// Shoulder raise; flexion forwards, abduction, twist inwards; elbow flexion; hand flexion. Left, then right.
    ShrugL,
    FlexL,
    SpreadL,
    TwistL,
    ElbowL,
    HandL,
    ShrugR,
    FlexR,
    SpreadR,
    TwistR,
    ElbowR,
    HandR,
    /// Knees outwards.
    KneeL,
    KneeR,
}

/// Number of channels.
pub const CHANNEL_COUNT: usize = Channel::KneeR as usize + 1;

/// A value for every channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controls(pub [f32; CHANNEL_COUNT]);

impl Index<Channel> for Controls {
    type Output = f32;
    fn index(&self, channel: Channel) -> &f32 {
        &self.0[channel as usize]
    }
}

impl IndexMut<Channel> for Controls {
    fn index_mut(&mut self, channel: Channel) -> &mut f32 {
        &mut self.0[channel as usize]
    }
}

impl Default for Controls {
    /// Standing at ease.
    fn default() -> Self {
        let mut controls = Self([0.0; CHANNEL_COUNT]);
        for (side, _) in joint::ARM.iter().enumerate() {
            let arm = |channel: Channel| channel as usize + side * 6;
            controls.0[arm(Channel::SpreadL)] = 20.0;
            controls.0[arm(Channel::FlexL)] = 1.0;
            controls.0[arm(Channel::TwistL)] = 12.0;
            controls.0[arm(Channel::ElbowL)] = 16.0;
            controls.0[arm(Channel::HandL)] = 6.0;
        }
        controls[Channel::Up] = -0.012;
        controls
    }
}

/// A foot: where its ankle would stand if the sole lay flat on the ground, and how it is lifted from there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot {
    /// Point of the ground below the ankle when flat, world; y is the height of the sole's pivot above the ground.
    pub place: Vec3,
    /// Heading of the foot, radians about +Y, 0 faces +Z.
    pub yaw: f32,
    /// Heel up (positive, about the ball) or toes up (negative, about the heel), in radians.
    pub pitch: f32,
    /// How far the toes stay level when the heel is up: 1 on the ground, 0 in the air.
    pub toes_level: f32,
}

/// All that determines one pose: where the body is, its controls and its feet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyState {
    /// Point of the ground under the body, world.
    pub root: Vec3,
    /// Heading in radians about +Y; 0 faces +Z.
    pub heading: f32,
    /// Controls.
    pub controls: Controls,
    /// Left and right foot.
    pub feet: [Foot; 2],
}

/// World transforms of all joints. The ponytail hangs rigidly on the head until [`super::hair`] moves it.
#[must_use]
pub fn solve(state: &BodyState) -> [Rigid; JOINT_COUNT] {
    let c = |channel: Channel| state.controls[channel];
    let heading = Quat::from_rotation_y(state.heading);
    let offset = Vec3::new(c(Channel::Left), NEUTRAL[joint::PELVIS].y + c(Channel::Up), c(Channel::Forward));
    let mut world = [Rigid { rotation: Quat::IDENTITY, translation: Vec3::ZERO }; JOINT_COUNT];
    world[joint::PELVIS] = Rigid {
        rotation: heading * turn(c(Channel::PelvisYaw), c(Channel::PelvisPitch), c(Channel::PelvisRoll)),
        translation: state.root + heading * offset,
    };
    let trunk = turn(c(Channel::TrunkYaw) * 0.5, c(Channel::TrunkPitch) * 0.5, c(Channel::TrunkRoll) * 0.5);
    let head = turn(c(Channel::HeadYaw) * 0.5, c(Channel::HeadPitch) * 0.5, c(Channel::HeadRoll) * 0.5);
    attach(&mut world, joint::SPINE, trunk);
    attach(&mut world, joint::CHEST, trunk);
    attach(&mut world, joint::NECK, head);
    attach(&mut world, joint::HEAD, head);
    for side in 0..2 {
        place_arm(&mut world, &state.controls, side);
        place_leg(&mut world, &state.feet[side], c(if side == 0 { Channel::KneeL } else { Channel::KneeR }), side);
    }
    for index in joint::TAIL..JOINT_COUNT {
        attach(&mut world, index, Quat::IDENTITY);
    }
    world
}

/// The pose in which the surface is modelled: arms 42 degrees out, feet slightly apart.
#[must_use]
pub fn bind_pose() -> [Rigid; JOINT_COUNT] {
    let mut controls = Controls([0.0; CHANNEL_COUNT]);
    controls[Channel::SpreadL] = 46.0;
    controls[Channel::SpreadR] = 46.0;
    controls[Channel::ElbowL] = 8.0;
    controls[Channel::ElbowR] = 8.0;
    controls[Channel::Up] = -0.002;
    let foot = |x: f32| Foot { place: Vec3::new(x, 0.0, -0.012), yaw: x, pitch: 0.0, toes_level: 1.0 };
    solve(&BodyState { root: Vec3::ZERO, heading: 0.0, controls, feet: [foot(0.105), foot(-0.105)] })
}

/// Where the ankle is, and how the foot is turned.
#[must_use]
pub fn ankle_of(foot: &Foot) -> Rigid {
    let yaw = Quat::from_rotation_y(foot.yaw);
    let rotation = yaw * Quat::from_rotation_x(foot.pitch);
    let pivot = if foot.pitch > 0.0 { BALL_FROM_ANKLE } else { HEEL_FROM_ANKLE };
    let flat_ankle = foot.place + Vec3::Y * ANKLE_HEIGHT;
    Rigid { rotation, translation: flat_ankle + yaw * pivot - rotation * pivot }
}

/// Yaw about +Y, then pitch about the turned +X, then roll about +Z, all in degrees.
fn turn(yaw: f32, pitch: f32, roll: f32) -> Quat {
    Quat::from_rotation_y(yaw.to_radians())
        * Quat::from_rotation_x(pitch.to_radians())
        * Quat::from_rotation_z(roll.to_radians())
}

fn attach(world: &mut [Rigid; JOINT_COUNT], index: usize, local: Quat) {
    let parent = PARENTS[index];
    let offset = NEUTRAL[index] - NEUTRAL[parent];
    world[index] = world[parent].after(&Rigid { rotation: local, translation: offset });
}

fn place_arm(world: &mut [Rigid; JOINT_COUNT], controls: &Controls, side: usize) {
    let c = |channel: Channel| controls.0[channel as usize + side * 6].to_radians();
    let outwards = if side == 0 { 1.0 } else { -1.0 };
    let first = joint::ARM[side];
    // The shoulder girdle follows the arm when it is raised.
    let raised = (c(Channel::SpreadL).max(c(Channel::FlexL)) - 1.0).clamp(0.0, 1.6) * 0.32;
    attach(world, first, Quat::from_rotation_z(outwards * (c(Channel::ShrugL) + raised)));
    let spread = c(Channel::SpreadL) - raised;
    let upper = Quat::from_rotation_x(-c(Channel::FlexL))
        * Quat::from_rotation_z(outwards * spread)
        * Quat::from_rotation_y(-outwards * c(Channel::TwistL));
    attach(world, first + 1, upper);
    attach(world, first + 2, Quat::from_rotation_x(-c(Channel::ElbowL)));
    attach(world, first + 3, Quat::from_rotation_z(-outwards * c(Channel::HandL)));
}

fn place_leg(world: &mut [Rigid; JOINT_COUNT], foot: &Foot, knee_out: f32, side: usize) {
    let first = joint::LEG[side];
    let outwards = if side == 0 { 1.0 } else { -1.0 };
    attach(world, first, Quat::IDENTITY);
    let hip = world[first].translation;
    let pelvis = world[joint::PELVIS].rotation;
    let ankle = ankle_of(foot);
    // The knee points where hip and foot agree, a little outwards.
    let foot_forward = Quat::from_rotation_y(foot.yaw) * Vec3::Z;
    let out = Quat::from_rotation_y(outwards * knee_out.to_radians());
    let forward = out * (pelvis * Vec3::Z * 0.45 + foot_forward * 0.55);
    let leg = two_bones(hip, ankle.translation, forward, &segment(first), &segment(first + 1));
    world[first].rotation = leg.upper;
    world[first + 1] = Rigid { rotation: leg.lower, translation: leg.middle };
    world[first + 2] = Rigid { rotation: ankle.rotation, translation: leg.end };
    attach(world, first + 3, Quat::from_rotation_x(-foot.pitch.max(0.0) * foot.toes_level));
}

/// From a joint to its first child, in the neutral pose.
fn segment(index: usize) -> Vec3 {
    NEUTRAL[index + 1] - NEUTRAL[index]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_foot_pivots_about_ball_or_heel() {
        for (pitch, pivot) in [(0.6, BALL_FROM_ANKLE), (-0.3, HEEL_FROM_ANKLE)] {
            let flat = Foot { place: Vec3::new(0.3, 0.0, 1.0), yaw: 0.7, pitch: 0.0, toes_level: 1.0 };
            let raised = Foot { pitch, ..flat };
            assert!(ankle_of(&flat).apply(pivot).distance(ankle_of(&raised).apply(pivot)) < 1e-6);
        }
    }

    #[test]
    fn bones_keep_their_lengths() {
        let world = bind_pose();
        for index in 1..JOINT_COUNT {
            let length = world[index].translation.distance(world[PARENTS[index]].translation);
            let neutral = NEUTRAL[index].distance(NEUTRAL[PARENTS[index]]);
            assert!((length - neutral).abs() < 1e-4, "{} is {length}, not {neutral}", JOINT_NAMES[index]);
        }
    }
}
