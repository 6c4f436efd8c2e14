//! The closest point of a triangle.

use glam::Vec3;

/// Barycentric coordinates of the point of triangle (a, b, c) that is closest to `p`.
///
/// By the regions of Ericson, *Real-Time Collision Detection*, 2005, section 5.1.5. A triangle without area gives a point of
/// one of its edges.
#[must_use]
pub fn closest_of_triangle(p: Vec3, [a, b, c]: [Vec3; 3]) -> Vec3 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return Vec3::X;
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return Vec3::Y;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let v = share(d1, d1 - d3);
        return Vec3::new(1.0 - v, v, 0.0);
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return Vec3::Z;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let w = share(d2, d2 - d6);
        return Vec3::new(1.0 - w, 0.0, w);
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        let w = share(d4 - d3, (d4 - d3) + (d5 - d6));
        return Vec3::new(0.0, 1.0 - w, w);
    }
    let scale = 1.0 / (va + vb + vc);
    let (v, w) = (vb * scale, vc * scale);
    Vec3::new(1.0 - v - w, v, w)
}

fn share(part: f32, all: f32) -> f32 {
    if all > 0.0 { (part / all).clamp(0.0, 1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use kernels::random::signed;

    use super::*;

    #[test]
    fn no_point_of_the_triangle_is_closer() {
        let mut drawn = 0;
        let mut point = || {
            drawn += 3;
            Vec3::new(signed(3, drawn), signed(3, drawn + 1), signed(3, drawn + 2))
        };
        for round in 0..300 {
            let corners = [point(), point(), point()];
            // Some have no area, some are a point.
            let [a, b, c] = match round % 5 {
                0 => [corners[0], corners[1], 0.5 * (corners[0] + corners[1])],
                1 => [corners[0]; 3],
                _ => corners,
            };
            let p = 2.0 * point();
            let weights = closest_of_triangle(p, [a, b, c]);
            assert!(weights.min_element() >= 0.0 && (weights.element_sum() - 1.0).abs() < 1e-5, "{weights}");
            let found = (a * weights.x + b * weights.y + c * weights.z).distance(p);
            for i in 0..=30 {
                for j in 0..=30 - i {
                    let (v, w) = (i as f32 / 30.0, j as f32 / 30.0);
                    assert!((a * (1.0 - v - w) + b * v + c * w).distance(p) >= found - 1e-5);
                }
            }
        }
    }
}
