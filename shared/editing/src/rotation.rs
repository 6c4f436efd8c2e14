//! Rotations that fit: the best one between two sets of points, and what logarithms need.

use glam::{DMat3, DQuat, DVec3, Mat3, Vec3};

/// The rotation `R` that maximises `trace(R^T S)` for `sum = S = sum of to * from^T`: the best one from the points `from` to
/// the points `to`, both about their centres. Identity where there is nothing to fit.
///
/// This work is based on: Horn, "Closed-form solution of absolute orientation using unit quaternions" (1987): the eigenvector
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
        1.0 / (angle * angle) - half.cos() / (2.0 * angle * half.sin())
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
            return crate::rigid::Rigid { rotation: glam::Quat::IDENTITY, translation: Vec3::ZERO };
        }
        let (from, to) = (self.from / self.weight, self.to / self.weight);
        let columns = [0, 1, 2].map(|axis: usize| self.sum[axis] - to * (from[axis] * self.weight));
        let rotation = best_rotation(&DMat3::from_cols(columns[0], columns[1], columns[2]));
        crate::rigid::Rigid { rotation: rotation.as_quat(), translation: (to - rotation * from).as_vec3() }
    }
}

#[cfg(test)]
mod tests {
    use glam::Quat;

    use super::*;

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
