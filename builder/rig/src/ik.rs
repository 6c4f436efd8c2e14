//! Two-bone inverse kinematics in closed form.

use glam::{Mat3, Quat, Vec3};

/// A solved chain of two bones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoBones {
    /// World rotation of the upper bone, whose neutral frame is the world's.
    pub upper: Quat,
    /// World rotation of the lower bone.
    pub lower: Quat,
    /// Where the bones meet, world.
    pub middle: Vec3,
    /// Where the chain ends: the target, or the nearest point in reach.
    pub end: Vec3,
}

/// Bends the chain from `start` to `target` so that its middle joint points to `forward`.
///
/// `upper` and `lower` are the bones as vectors in the neutral pose, in which the middle joint bends about +X. A target
/// out of reach is approached along the line to it.
#[must_use]
pub fn two_bones(start: Vec3, target: Vec3, forward: Vec3, upper: &Vec3, lower: &Vec3) -> TwoBones {
    let (a, b) = (upper.length(), lower.length());
    let to_target = target - start;
    let distance = to_target.length().clamp((a - b).abs() + 1e-3, (a + b) * 0.9999);
    let along = to_target.normalize_or(Vec3::NEG_Y);
    let bend = (forward - along * forward.dot(along)).normalize_or(Vec3::Z);
    let cosine = ((a * a + distance * distance - b * b) / (2.0 * a * distance)).clamp(-1.0, 1.0);
    let middle = start + along * (a * cosine) + bend * (a * (1.0 - cosine * cosine).max(0.0).sqrt());
    let end = start + along * distance;
    let hinge = bend.cross(along).normalize_or(Vec3::X);
    TwoBones { upper: aligned(*upper, middle - start, hinge), lower: aligned(*lower, end - middle, hinge), middle, end }
}

/// The rotation that takes `neutral` to the direction of `wanted`, and +X to `hinge`.
fn aligned(neutral: Vec3, wanted: Vec3, hinge: Vec3) -> Quat {
    let frame = |along: Vec3, side: Vec3| {
        let y = along.normalize_or(Vec3::NEG_Y);
        let x = (side - y * side.dot(y)).normalize_or(Vec3::X);
        Mat3::from_cols(x, y, x.cross(y))
    };
    Quat::from_mat3(&(frame(wanted, hinge) * frame(neutral, Vec3::X).transpose())).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reaches_the_target_and_bends_forwards() {
        let (upper, lower) = (Vec3::new(0.0, -0.43, 0.004), Vec3::new(0.0, -0.41, -0.02));
        let start = Vec3::new(0.1, 0.9, 0.2);
        let target = Vec3::new(0.2, 0.2, 0.45);
        let leg = two_bones(start, target, Vec3::Z, &upper, &lower);
        assert!(leg.end.distance(target) < 1e-5);
        assert!((start + leg.upper * upper).distance(leg.middle) < 1e-5);
        assert!((leg.middle + leg.lower * lower).distance(target) < 1e-5);
        let straight = (start + target) * 0.5;
        assert!((leg.middle - straight).dot(Vec3::Z) > 0.05, "the knee bends forwards");
    }

    #[test]
    fn a_straight_hanging_leg_is_not_turned() {
        let (upper, lower) = (Vec3::new(0.0, -0.4, 0.0), Vec3::new(0.0, -0.4, 0.0));
        let leg = two_bones(Vec3::ZERO, Vec3::new(0.0, -0.7999, 0.0), Vec3::Z, &upper, &lower);
        assert!(leg.upper.angle_between(Quat::IDENTITY) < 0.05);
    }
}
