//! What a skeleton does in one frame, body part by body part: the common language of clips and actors.

use glam::{Quat, Vec3};

/// Two bones of a limb in one frame, in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bent {
    /// Direction of the first bone, of length 1.
    pub upper: Vec3,
    /// Direction of the second.
    pub lower: Vec3,
    /// What the joint between them bends about, about at right angles to both; `None` where it never bends.
    pub hinge: Option<Vec3>,
}

/// A leg in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LegPosture {
    /// Thigh and shin.
    pub bent: Bent,
    /// Axes of the foot: left, up, forwards where it stands.
    pub foot: Quat,
    /// Where the ankle is, in the actor's metres over the source's floor.
    pub ankle: Vec3,
    /// Where the ball of the foot is.
    pub ball: Vec3,
}

/// A body in one frame. Axes of parts are left, up, forwards where the body stands upright.
#[derive(Clone, Debug, PartialEq)]
pub struct Posture {
    /// Between the hips, in the actor's metres over the source's floor.
    pub root: Vec3,
    /// Axes of the pelvis.
    pub pelvis: Quat,
    /// Axes of the chest, where it is known.
    pub chest: Option<Quat>,
    /// Axes of the head, where it is known.
    pub head: Option<Quat>,
    /// The left leg and the right one.
    pub legs: [LegPosture; 2],
    /// The left arm and the right one, where they are known.
    pub arms: [Option<Bent>; 2],
}
