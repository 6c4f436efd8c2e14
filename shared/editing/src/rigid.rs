//! Rigid transforms.

use glam::{Quat, Vec3};

/// A rigid transform: rotation, then translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rigid {
    /// Rotation.
    pub rotation: Quat,
    /// Translation in metres.
    pub translation: Vec3,
}

impl Rigid {
    /// The image of `point`.
    #[must_use]
    pub fn apply(&self, point: Vec3) -> Vec3 {
        self.rotation * point + self.translation
    }

    /// The transform that first does `other`, then `self`.
    #[must_use]
    pub fn after(&self, other: &Self) -> Self {
        Self { rotation: self.rotation * other.rotation, translation: self.apply(other.translation) }
    }

    /// The inverse.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.conjugate();
        Self { rotation, translation: rotation * -self.translation }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_done_is_undone() {
        let motion = Rigid { rotation: Quat::from_rotation_y(2.5), translation: Vec3::new(1.0, 0.2, -3.0) };
        let other = Rigid { rotation: Quat::from_rotation_x(-0.4), translation: Vec3::new(0.0, 2.0, 0.5) };
        let point = Vec3::new(0.3, 1.0, 0.1);
        assert!(motion.inverse().apply(motion.apply(point)).distance(point) < 1e-6);
        assert!(motion.after(&other).apply(point).distance(motion.apply(other.apply(point))) < 1e-6);
    }
}
