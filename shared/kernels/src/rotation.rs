//! The rotation that takes one set of points best onto another: in closed form, and by going there from none.

use glam::{DMat3, DQuat, Mat3, Quat, Vec3};

/// Steps of the search: from any start it turns by the larger part of what is left in each.
const STEPS: usize = 40;
/// Below this angle in radians it has arrived.
const ARRIVED: f32 = 1e-6;

/// The rotation whose matrix R has the largest trace of R^T `covariance`, where `covariance` is the sum of products
/// (to) (from)^T of points about their centres: the best one in the least squares sense (Kabsch 1976).
///
/// Unlike [`best_rotation`] it turns the least where points leave a choice, but half a turn is not found from here.
/// By Müller, Bender, Chentanez and Macklin, "A robust method to extract the rotational part of deformations" (2016), from
/// the identity: it also finds a turn for points on a line or in one place. Points that are not finite give the identity.
#[must_use]
pub fn least_turn(covariance: &Mat3) -> Quat {
    turned_towards(Quat::IDENTITY, covariance, STEPS)
}

/// The same in `steps` steps from `rotation`: little is left of what was nearly found before.
#[must_use]
pub fn turned_towards(mut rotation: Quat, covariance: &Mat3, steps: usize) -> Quat {
    for _ in 0..steps {
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

/// The rotation `R` that maximises `trace(R^T S)` for `sum = S = sum of to * from^T`: the best one from the points `from` to
/// the points `to`, both about their centres. Identity where there is nothing to fit.
///
/// Horn, "Closed-form solution of absolute orientation using unit quaternions" (1987): the eigenvector
/// of the largest eigenvalue of a symmetric 4x4 matrix, here by Jacobi's rotations.
#[must_use]
pub fn best_rotation(sum: &DMat3) -> DQuat {
    // S[row][column] = to_row * from_column; Horn's matrix has from first.
    let s = |from: usize, to: usize| sum.col(from)[to];
    let (xx, yy, zz) = (s(0, 0), s(1, 1), s(2, 2));
    let [yz, zx, xy] = [s(1, 2) - s(2, 1), s(2, 0) - s(0, 2), s(0, 1) - s(1, 0)];
    let [a, b, c] = [s(0, 1) + s(1, 0), s(2, 0) + s(0, 2), s(1, 2) + s(2, 1)];
    let matrix =
        [[xx + yy + zz, yz, zx, xy], [yz, xx - yy - zz, a, b], [zx, a, yy - xx - zz, c], [xy, b, c, zz - xx - yy]];
    let [w, x, y, z] = largest_eigenvector(matrix);
    let rotation = DQuat::from_xyzw(x, y, z, w);
    if rotation.is_finite() && rotation.length_squared() > 0.5 { rotation.normalize() } else { DQuat::IDENTITY }
}

fn largest_eigenvector(mut m: [[f64; 4]; 4]) -> [f64; 4] {
    let mut vectors = [[0.0; 4]; 4];
    (0..4).for_each(|k| vectors[k][k] = 1.0);
    for _ in 0..30 {
        let off: f64 = (0..4).flat_map(|p| (p + 1..4).map(move |q| (p, q))).map(|(p, q)| m[p][q] * m[p][q]).sum();
        let scale: f64 = (0..4).map(|k| m[k][k] * m[k][k]).sum();
        if off <= 1e-28 * scale.max(f64::MIN_POSITIVE) {
            break;
        }
        for p in 0..3 {
            for q in p + 1..4 {
                turn(&mut m, &mut vectors, p, q);
            }
        }
    }
    let largest = (0..4).fold(0, |best, k| if m[k][k] > m[best][best] { k } else { best });
    [0, 1, 2, 3].map(|row: usize| vectors[row][largest])
}

/// One of Jacobi's rotations, which takes the entry (p, q) away.
fn turn(m: &mut [[f64; 4]; 4], vectors: &mut [[f64; 4]; 4], p: usize, q: usize) {
    if m[p][q] == 0.0 {
        return;
    }
    let theta = (m[q][q] - m[p][p]) / (2.0 * m[p][q]);
    let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
    let t = if theta == 0.0 { 1.0 } else { t };
    let c = 1.0 / (t * t + 1.0).sqrt();
    let s = t * c;
    for k in 0..4 {
        let (a, b) = (m[k][p], m[k][q]);
        (m[k][p], m[k][q]) = (c * a - s * b, s * a + c * b);
    }
    for k in 0..4 {
        let (a, b) = (m[p][k], m[q][k]);
        (m[p][k], m[q][k]) = (c * a - s * b, s * a + c * b);
    }
    for row in vectors.iter_mut() {
        let (a, b) = (row[p], row[q]);
        (row[p], row[q]) = (c * a - s * b, s * a + c * b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::signed;
    use glam::DVec3;

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
            let found = least_turn(&covariance(&points, turn));
            assert!(found.angle_between(turn) < 2e-3, "seed {seed}: {} for {turn}", found);
        }
    }

    #[test]
    fn what_tells_nothing_is_not_turned() {
        assert_eq!(least_turn(&Mat3::ZERO), Quat::IDENTITY);
        assert_eq!(least_turn(&Mat3::from_diagonal(Vec3::new(f32::NAN, 1.0, 1.0))), Quat::IDENTITY);
        assert_eq!(least_turn(&Mat3::from_diagonal(Vec3::new(f32::MAX, f32::MAX, f32::MAX))), Quat::IDENTITY);
        let line = [Vec3::X, -Vec3::X];
        let turn = Quat::from_rotation_z(0.7);
        assert!((least_turn(&covariance(&line, turn)) * Vec3::X).distance(turn * Vec3::X) < 1e-3);
    }

    #[test]
    fn the_closed_form_finds_any_turn() {
        let points = [DVec3::X, DVec3::new(0.2, 1.0, -0.4), DVec3::new(-1.0, 0.3, 2.0)];
        for angle in [0.0, 0.3, 2.1, std::f64::consts::PI] {
            let turn = DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), angle);
            let product = |from: &DVec3| {
                let to = turn * *from;
                DMat3::from_cols(to * from.x, to * from.y, to * from.z)
            };
            let sum = points.iter().map(product).fold(DMat3::ZERO, |sum, product| sum + product);
            let found = best_rotation(&sum);
            points.iter().for_each(|&point| assert!((found * point).distance(turn * point) < 1e-9));
        }
        assert_eq!(best_rotation(&(DMat3::ZERO * f64::NAN)), DQuat::IDENTITY);
    }
}
