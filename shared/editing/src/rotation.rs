//! Rigid transforms that fit, rotations and their logarithms, and what those need.
//!
//! Sines and arc tangents are the kernels': the platform's differ in their last bits, and a page must make the same frames as
//! a film.

use glam::{DMat3, DVec3, Mat3, Quat, Vec3};
use kernels::rotation::best_rotation;
use kernels::scalar::{atan2, sin_cos};

/// The rotation of the rotation vector `r`, in radians; the identity, to the bit, of none.
#[must_use]
pub fn turn_by(r: Vec3) -> Quat {
    let angle = r.length();
    if angle == 0.0 {
        return Quat::IDENTITY;
    }
    let (sin, cos) = sin_cos(0.5 * angle);
    let v = r * (sin / angle);
    Quat::from_xyzw(v.x, v.y, v.z, cos)
}

/// The rotation vector of `turn`, in radians, of at most half a turn where its real part is not negative.
#[must_use]
pub fn rotation_vector(turn: Quat) -> Vec3 {
    let v = Vec3::new(turn.x, turn.y, turn.z);
    let sin = v.length();
    // A small turn's sine is its angle.
    if sin < 1e-6 { v * 2.0 } else { v * (2.0 * atan2(sin, turn.w) / sin) }
}

/// The rotation a share of the shorter way from `from` to `to`.
#[must_use]
pub fn between(from: Quat, to: Quat, share: f32) -> Quat {
    let step = from.conjugate() * to;
    from * turn_by(rotation_vector(if step.w < 0.0 { -step } else { step }) * share)
}

/// The matrix of `v x`.
#[must_use]
pub fn cross_matrix(v: Vec3) -> Mat3 {
    Mat3::from_cols(Vec3::new(0.0, v.z, -v.y), Vec3::new(-v.z, 0.0, v.x), Vec3::new(v.y, -v.x, 0.0))
}

/// How the logarithm `r` of a rotation changes when a small one is done after it: `log(exp(e) exp(r)) = r + J e`, to first
/// order in `e`.
#[must_use]
pub fn log_change(r: Vec3) -> Mat3 {
    let angle = r.length();
    let cross = cross_matrix(r);
    let square = if angle < 1e-3 {
        1.0 / 12.0
    } else {
        // (1 + cos) / sin is finite up to a half turn, which a logarithm never passes.
        let half = 0.5 * angle.min(3.1);
        let (sin, cos) = sin_cos(half);
        1.0 / (angle * angle) - cos / (2.0 * angle * sin)
    };
    Mat3::IDENTITY - cross * 0.5 + cross * cross * square
}

/// Sums of what [`best_rotation`] needs, with weights, and the centres of both sides.
#[derive(Clone, Copy, Debug, Default)]
pub struct Fit {
    weight: f64,
    from: DVec3,
    to: DVec3,
    sum: [DVec3; 3],
}

impl Fit {
    /// Adds a pair of points.
    pub fn add(&mut self, from: Vec3, to: Vec3, weight: f32) {
        let (from, to, weight) = (from.as_dvec3(), to.as_dvec3(), f64::from(weight));
        self.weight += weight;
        self.from += from * weight;
        self.to += to * weight;
        for axis in 0..3 {
            self.sum[axis] += to * (from[axis] * weight);
        }
    }

    /// The rigid transform that takes the first points to the second ones best, in the sense of weighted least squares.
    #[must_use]
    pub fn rigid(&self) -> crate::rigid::Rigid {
        if self.weight <= 0.0 {
            return crate::rigid::Rigid { rotation: Quat::IDENTITY, translation: Vec3::ZERO };
        }
        let (from, to) = (self.from / self.weight, self.to / self.weight);
        let columns = [0, 1, 2].map(|axis: usize| self.sum[axis] - to * (from[axis] * self.weight));
        let rotation = best_rotation(&DMat3::from_cols(columns[0], columns[1], columns[2]));
        crate::rigid::Rigid { rotation: rotation.as_quat(), translation: (to - rotation * from).as_vec3() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_are_those_of_their_vectors() {
        assert_eq!((turn_by(Vec3::ZERO), rotation_vector(Quat::IDENTITY)), (Quat::IDENTITY, Vec3::ZERO));
        for r in [Vec3::new(1e-5, 0.0, -1e-5), Vec3::new(0.3, -1.2, 0.5), Vec3::new(2.0, 2.0, 0.3), Vec3::Z * 3.1] {
            let turn = turn_by(r);
            assert!(turn.dot(Quat::from_scaled_axis(r)) > 1.0 - 1e-6 && turn.is_normalized());
            assert!(rotation_vector(turn).distance(r) < 2e-5, "{r}: {}", rotation_vector(turn));
            let other = Quat::from_rotation_x(0.4);
            for share in [0.0, 0.3, 1.0] {
                let wanted = other.slerp(turn, share);
                assert!(between(other, turn, share).dot(wanted).abs() > 1.0 - 1e-6, "{r}, {share}");
            }
        }
    }

    #[test]
    fn rotations_are_found_again_half_turns_too() {
        let points = [Vec3::new(0.3, 1.0, 0.2), Vec3::new(-0.5, 0.1, 0.9), Vec3::new(0.7, -0.4, -0.1), Vec3::ONE];
        for r in [Vec3::ZERO, Vec3::new(0.3, -1.2, 0.5), Vec3::Z * std::f32::consts::PI, Vec3::new(2.0, 2.0, 0.3)] {
            let wanted = Quat::from_scaled_axis(r);
            let mut fit = Fit::default();
            points.iter().for_each(|&p| fit.add(p, wanted * p + Vec3::new(1.0, 2.0, 3.0), 0.5));
            let found = fit.rigid();
            points.iter().for_each(|&p| assert!(found.apply(p).distance(wanted * p + Vec3::new(1.0, 2.0, 3.0)) < 1e-5));
        }
    }

    #[test]
    fn logarithms_change_as_differences_say() {
        for r in [Vec3::new(1e-4, 0.0, 0.0), Vec3::new(0.4, -0.9, 0.3), Vec3::new(1.5, 1.5, -1.0)] {
            for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
                let h = 2e-3;
                let at = |h: f32| (Quat::from_scaled_axis(axis * h) * Quat::from_scaled_axis(r)).to_scaled_axis();
                let difference = (at(h) - at(-h)) / (2.0 * h);
                assert!(difference.distance(log_change(r) * axis) < 2e-3, "{r}");
            }
        }
    }
}
