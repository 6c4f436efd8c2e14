//! Axes of body parts: left, up, forwards.

use glam::{Mat3, Quat, Vec3};

/// The rotation that takes +X to the left, +Y to `up`, +Z forwards, where `left` is about to the left.
#[must_use]
pub fn upright(up: Vec3, left: Vec3) -> Quat {
    let y = up.normalize_or(Vec3::Y);
    let x = left.reject_from_normalized(y).normalize_or(y.any_orthonormal_vector());
    Quat::from_mat3(&Mat3::from_cols(x, y, x.cross(y))).normalize()
}

/// The rotation that takes +Y along a bone and +X to its hinge.
#[must_use]
pub fn hinged(along: Vec3, hinge: Vec3) -> Quat {
    upright(along, hinge)
}

/// The shortest rotation from the direction `from` to the direction `to`.
#[must_use]
pub fn arc(from: Vec3, to: Vec3) -> Quat {
    let (from, to) = (from.normalize_or(Vec3::Y), to.normalize_or(Vec3::Y));
    Quat::from_rotation_arc(from, to)
}

/// The horizontal part of a vector.
#[must_use]
pub fn level(v: Vec3) -> Vec3 {
    Vec3::new(v.x, 0.0, v.z)
}

/// The angle between two vectors in radians.
#[must_use]
pub fn angle(a: Vec3, b: Vec3) -> f32 {
    kernels::scalar::atan2(a.cross(b).length(), a.dot(b))
}
