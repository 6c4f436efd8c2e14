//! The rotation that takes one set of points best onto another.

use glam::{Mat3, Quat, Vec3};

/// Steps of the search: from any start it turns by the larger part of what is left in each.
const STEPS: usize = 40;
/// Below this angle in radians it has arrived.
const ARRIVED: f32 = 1e-6;

/// The rotation whose matrix R has the largest trace of R^T `covariance`, where `covariance` is the sum of products
/// (to) (from)^T of points about their centres: the best one in the least squares sense (Kabsch 1976).
///
/// By Müller, Bender, Chentanez and Macklin, "A robust method to extract the rotational part of deformations" (2016), from
/// the identity: it also finds a turn for points on a line or in one place. Points that are not finite give the identity.
#[must_use]
pub fn best_rotation(covariance: &Mat3) -> Quat {
    let mut rotation = Quat::IDENTITY;
    for _ in 0..STEPS {
        let turned = Mat3::from_quat(rotation);
        let (mut axis, mut dot) = (Vec3::ZERO, 0.0);
        for column in 0..3 {
            axis += turned.col(column).cross(covariance.col(column));
            dot += turned.col(column).dot(covariance.col(column));
        }
        let omega = axis / (dot.abs() + f32::MIN_POSITIVE);
        let angle = omega.length();
        if angle.is_nan() || angle.is_infinite() {
            return Quat::IDENTITY;
        }
        if angle < ARRIVED {
            break;
        }
        // The sine and cosine of half the angle, as accurate as a step needs to be and the same on every machine.
        let half = (angle / 2.0).min(1.0);
        let step = omega / angle;
        let w = 1.0 / (1.0 + half * half).sqrt();
        rotation = (Quat::from_xyzw(step.x * half * w, step.y * half * w, step.z * half * w, w) * rotation).normalize();
    }
    rotation
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::signed;

    fn covariance(points: &[Vec3], rotation: Quat) -> Mat3 {
        let product = |point: &Vec3| {
            let to = rotation * *point;
            Mat3::from_cols(to * point.x, to * point.y, to * point.z)
        };
        points.iter().map(product).fold(Mat3::ZERO, |sum, product| sum + product)
    }

    #[test]
    fn it_finds_the_turn_that_was_made() {
        for seed in 0..500 {
            let number = |index: u64| signed(seed, index);
            let points: Vec<Vec3> = (0..12)
                .map(|index| Vec3::new(number(3 * index), number(3 * index + 1), number(3 * index + 2)))
                .collect();
            let axis = Vec3::new(number(100), number(101), number(102)).normalize_or(Vec3::Y);
            let turn = Quat::from_axis_angle(axis, 2.6 * number(103));
            let found = best_rotation(&covariance(&points, turn));
            assert!(found.angle_between(turn) < 2e-3, "seed {seed}: {} for {turn}", found);
        }
    }

    #[test]
    fn what_tells_nothing_is_not_turned() {
        assert_eq!(best_rotation(&Mat3::ZERO), Quat::IDENTITY);
        assert_eq!(best_rotation(&Mat3::from_diagonal(Vec3::new(f32::NAN, 1.0, 1.0))), Quat::IDENTITY);
        assert_eq!(best_rotation(&Mat3::from_diagonal(Vec3::new(f32::MAX, f32::MAX, f32::MAX))), Quat::IDENTITY);
        let line = [Vec3::X, -Vec3::X];
        let turn = Quat::from_rotation_z(0.7);
        assert!((best_rotation(&covariance(&line, turn)) * Vec3::X).distance(turn * Vec3::X) < 1e-3);
    }
}
