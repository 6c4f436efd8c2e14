//! The rotation from some points to others.

use glam::{DMat3, DQuat};

use crate::symmetric::eigen;

/// The rotation that fits best, of `sum` whose column k is the sum of what was, times coordinate k of what is (Horn,
/// *Closed-form solution of absolute orientation using unit quaternions*, 1987).
#[must_use]
pub fn best_rotation(sum: &DMat3) -> DQuat {
    // s(a, b): the sum of coordinate a before times coordinate b after.
    let s = |a: usize, b: usize| sum.col(b)[a];
    let (x, y, z) = (0, 1, 2);
    let matrix = [
        s(x, x) + s(y, y) + s(z, z),
        s(y, z) - s(z, y),
        s(z, x) - s(x, z),
        s(x, y) - s(y, x),
        s(y, z) - s(z, y),
        s(x, x) - s(y, y) - s(z, z),
        s(x, y) + s(y, x),
        s(z, x) + s(x, z),
        s(z, x) - s(x, z),
        s(x, y) + s(y, x),
        s(y, y) - s(x, x) - s(z, z),
        s(y, z) + s(z, y),
        s(x, y) - s(y, x),
        s(z, x) + s(x, z),
        s(y, z) + s(z, y),
        s(z, z) - s(x, x) - s(y, y),
    ];
    let found = eigen(&matrix, 4);
    match found.vectors.first().map(Vec::as_slice) {
        Some(&[w, x, y, z]) => {
            let rotation = DQuat::from_xyzw(x, y, z, w);
            if rotation.is_finite() && rotation.length_squared() > 0.5 { rotation.normalize() } else { DQuat::IDENTITY }
        }
        _ => DQuat::IDENTITY,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn a_turn_is_found_again() {
        let turn = DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 2.1);
        let mut sum = DMat3::ZERO;
        for point in [DVec3::X, DVec3::new(0.2, 1.0, -0.4), DVec3::new(-1.0, 0.3, 2.0)] {
            let after = turn * point;
            sum += DMat3::from_cols(point * after.x, point * after.y, point * after.z);
        }
        assert!(best_rotation(&sum).angle_between(turn) < 1e-9);
        assert_eq!(best_rotation(&(DMat3::ZERO * f64::NAN)), DQuat::IDENTITY);
    }
}
