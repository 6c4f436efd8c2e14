//! Planar rigid alignment of poses: a rotation about the vertical axis and a translation.
//!
//! Boukhayma, thesis (2017), equations 2.3 to 2.5, with `atan2` in place of the arc tangent.

use glam::{DVec3, Vec2, Vec3};

/// A rotation about +Y followed by a translation in the ground plane: `world_from_pose`.
///
/// The vertical coordinate is never touched: heights are interpolated, not aligned away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Rotation about +Y in radians, right-handed: a positive angle turns +Z towards +X.
    pub heading: f32,
    /// Translation in metres along (X, Z).
    pub translation: Vec2,
}

impl Default for Placement {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Placement {
    /// Leaves everything where it is.
    pub const IDENTITY: Self = Self { heading: 0.0, translation: Vec2::ZERO };

    /// A turn by `heading` about the vertical line through `from`, then a move that takes `from` to `to`; both (X, Z).
    #[must_use]
    pub fn turning(heading: f32, from: Vec2, to: Vec2) -> Self {
        Self { heading, translation: to - rotate(heading, from) }
    }

    /// Where `point` goes.
    #[must_use]
    pub fn apply(&self, point: Vec3) -> Vec3 {
        let ground = rotate(self.heading, Vec2::new(point.x, point.z)) + self.translation;
        Vec3::new(ground.x, point.y, ground.y)
    }

    /// Where `points` go, in place.
    pub fn apply_all(&self, points: &mut [Vec3]) {
        let (sin, cos) = self.heading.sin_cos();
        for point in points {
            let (x, z) = (point.x, point.z);
            point.x = cos * x + sin * z + self.translation.x;
            point.z = cos * z - sin * x + self.translation.y;
        }
    }

    /// What takes everything back: `pose_from_world`.
    #[must_use]
    pub fn inverse(&self) -> Self {
        Self { heading: -self.heading, translation: rotate(-self.heading, -self.translation) }
    }

    /// First `inner`, then `self`.
    #[must_use]
    pub fn after(&self, inner: &Self) -> Self {
        Self {
            heading: self.heading + inner.heading,
            translation: rotate(self.heading, inner.translation) + self.translation,
        }
    }
}

/// `v`, an (X, Z) vector, turned by `heading` about +Y.
#[must_use]
pub fn rotate(heading: f32, v: Vec2) -> Vec2 {
    let (sin, cos) = heading.sin_cos();
    Vec2::new(cos * v.x + sin * v.y, cos * v.y - sin * v.x)
}

/// Weighted centre of mass of a pose in metres; `weights` have a sum of 1.
#[must_use]
pub fn centre_of_mass(pose: &[Vec3], weights: &[f32]) -> Vec3 {
    weighted_sum(pose, weights).as_vec3()
}

/// The sum of a pose's points times their `weights`, in double precision: the centre of mass as far as these have a sum
/// of 1.
#[must_use]
pub fn weighted_sum(pose: &[Vec3], weights: &[f32]) -> DVec3 {
    let mut sum = DVec3::ZERO;
    for (point, &weight) in pose.iter().zip(weights) {
        sum += point.as_dvec3() * f64::from(weight);
    }
    sum
}

/// The angle in radians by which `moving` must be turned about +Y to lie best on `fixed` (`Align` of thesis algorithm
/// 2, by thesis equation 2.3):
/// the least weighted sum of squared distances in the ground plane once their centres of mass coincide.
///
/// 0 where the poses do not tell (all weight on one vertical line).
#[must_use]
pub fn align_heading(fixed: &[Vec3], moving: &[Vec3], weights: &[f32]) -> f32 {
    let (mut dot, mut cross) = (0.0_f64, 0.0_f64);
    let (mut fx, mut fz, mut mx, mut mz) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
    for ((f, m), &w) in fixed.iter().zip(moving).zip(weights) {
        let w = f64::from(w);
        let (f_x, f_z, m_x, m_z) = (f64::from(f.x), f64::from(f.z), f64::from(m.x), f64::from(m.z));
        dot += w * (f_x * m_x + f_z * m_z);
        cross += w * (f_x * m_z - f_z * m_x);
        fx += w * f_x;
        fz += w * f_z;
        mx += w * m_x;
        mz += w * m_z;
    }
    (cross - (fx * mz - fz * mx)).atan2(dot - (fx * mx + fz * mz)) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    const POSE: [Vec3; 4] =
        [Vec3::new(0.3, 1.0, 0.1), Vec3::new(-0.5, 0.2, 0.4), Vec3::new(0.1, 0.0, -0.7), Vec3::new(0.9, 1.5, 0.2)];
    const WEIGHTS: [f32; 4] = [0.1, 0.4, 0.3, 0.2];

    #[test]
    fn alignment_undoes_a_placement() {
        for step in -3..=3 {
            let heading = step as f32;
            let placement = Placement { heading, translation: Vec2::new(2.0, -1.0) };
            let fixed = POSE.map(|p| placement.apply(p));
            let found = align_heading(&fixed, &POSE, &WEIGHTS);
            assert!((found - heading).abs() < 1e-5, "{found} against {heading}");
        }
    }

    #[test]
    fn placements_compose() {
        let a = Placement { heading: 0.7, translation: Vec2::new(1.0, 2.0) };
        let b = Placement::turning(-1.1, Vec2::new(0.5, 0.5), Vec2::new(3.0, 1.0));
        for p in POSE {
            assert!(a.after(&b).apply(p).distance(a.apply(b.apply(p))) < 1e-5);
        }
        let mut all = POSE;
        b.apply_all(&mut all);
        assert!(all[2].distance(b.apply(POSE[2])) < 1e-6);
        assert!(b.apply(Vec3::new(0.5, 9.0, 0.5)).distance(Vec3::new(3.0, 9.0, 1.0)) < 1e-6);
    }

    #[test]
    fn heading_is_a_right_handed_rotation_about_y() {
        let turned = Placement { heading: 0.3, translation: Vec2::ZERO }.apply(Vec3::Z);
        assert!(turned.distance(glam::Quat::from_rotation_y(0.3) * Vec3::Z) < 1e-6);
    }
}
