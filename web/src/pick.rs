//! Which pose is under the pointer: a ray against triangles.

use glam::Vec3;

/// Distance along the ray from `origin` in `direction` (of length 1) to the nearest triangle of `pose`, metres.
///
/// Both sides count. `None` where the ray misses.
#[must_use]
pub fn nearest_hit(origin: Vec3, direction: Vec3, triangles: &[[u32; 3]], pose: &[Vec3]) -> Option<f32> {
    let mut nearest = f32::INFINITY;
    if !may_hit(origin, direction, pose) {
        return None;
    }
    for corners in triangles {
        let [Some(&a), Some(&b), Some(&c)] = corners.map(|vertex| pose.get(vertex as usize)) else { continue };
        if let Some(distance) = hit(origin, direction, a, b, c) {
            nearest = nearest.min(distance);
        }
    }
    nearest.is_finite().then_some(nearest)
}

/// Möller and Trumbore, "Fast, minimum storage ray/triangle intersection" (1997).
fn hit(origin: Vec3, direction: Vec3, a: Vec3, b: Vec3, c: Vec3) -> Option<f32> {
    let (ab, ac) = (b - a, c - a);
    let p = direction.cross(ac);
    let determinant = ab.dot(p);
    if determinant == 0.0 {
        return None;
    }
    let from_a = origin - a;
    let u = from_a.dot(p) / determinant;
    let q = from_a.cross(ab);
    let v = direction.dot(q) / determinant;
    let distance = ac.dot(q) / determinant;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0).then_some(distance)
}

/// Whether the ray meets the pose's bounding box.
fn may_hit(origin: Vec3, direction: Vec3, pose: &[Vec3]) -> bool {
    let low = pose.iter().fold(Vec3::INFINITY, |low, &p| low.min(p)) - 1e-3;
    let high = pose.iter().fold(Vec3::NEG_INFINITY, |high, &p| high.max(p)) + 1e-3;
    let (mut enter, mut leave) = (0.0_f32, f32::INFINITY);
    for axis in 0..3 {
        let a = (low[axis] - origin[axis]) / direction[axis];
        let b = (high[axis] - origin[axis]) / direction[axis];
        // Comparisons with NaN (a ray within a side's plane) leave the bounds as they are.
        enter = enter.max(a.min(b));
        leave = leave.min(a.max(b));
    }
    enter <= leave
}

#[cfg(test)]
mod tests {
    use super::*;

    const POSE: [Vec3; 4] = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(0.0, 0.0, -1.0)];
    const TRIANGLES: [[u32; 3]; 2] = [[0, 1, 2], [0, 1, 3]];

    #[test]
    fn the_nearest_triangle_counts() {
        let from = Vec3::new(0.2, 0.3, 2.0);
        assert!((nearest_hit(from, Vec3::NEG_Z, &TRIANGLES, &POSE).unwrap() - 2.0).abs() < 1e-6);
        let from = Vec3::new(0.2, -1.0, -0.3);
        assert!((nearest_hit(from, Vec3::Y, &TRIANGLES, &POSE).unwrap() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn misses_beside_and_behind() {
        assert_eq!(nearest_hit(Vec3::new(0.9, 0.9, 2.0), Vec3::NEG_Z, &TRIANGLES, &POSE), None);
        assert_eq!(nearest_hit(Vec3::new(0.2, 0.3, 2.0), Vec3::Z, &TRIANGLES, &POSE), None);
        assert_eq!(nearest_hit(Vec3::ZERO, Vec3::Z, &[[0, 1, 9]], &POSE), None);
        assert_eq!(nearest_hit(Vec3::ZERO, Vec3::Z, &[], &[]), None);
    }

    #[test]
    fn hits_lie_on_the_triangle() {
        let target = (POSE[0] * 0.2 + POSE[1] * 0.5 + POSE[2] * 0.3) + Vec3::ZERO;
        for eye in [Vec3::new(3.0, 2.0, 5.0), Vec3::new(-1.0, 0.5, 4.0), Vec3::new(0.1, -3.0, 1.0)] {
            let direction = (target - eye).normalize();
            let distance = nearest_hit(eye, direction, &TRIANGLES[..1], &POSE).unwrap();
            assert!((eye + direction * distance).distance(target) < 1e-5);
        }
    }
}
