//! Polygons into triangles.

use glam::{Vec2, Vec3};

/// Beyond this many corners a concave polygon is split as a fan: clipping ears takes cubic time.
const MAX_EAR_CORNERS: usize = 1024;

/// Splits a polygon into `points.len() - 2` triangles over indices into `points`, with the polygon's orientation.
///
/// Convex polygons become a fan around the first corner, as most programs split them; concave ones are split by
/// clipping ears in the plane of their area vector (Newell). What cannot be clipped (a polygon without area, one that
/// cuts itself) ends as a fan too: every corner is still used, and nothing is dropped silently.
pub(super) fn triangulate(points: &[Vec3]) -> Vec<[usize; 3]> {
    let fan = |ring: &[usize]| -> Vec<[usize; 3]> {
        let Some((&apex, rest)) = ring.split_first() else { return Vec::new() };
        rest.windows(2).map(|w| [apex, w[0], w[1]]).collect()
    };
    let mut ring: Vec<usize> = (0..points.len()).collect();
    if points.len() <= 3 || points.len() > MAX_EAR_CORNERS {
        return fan(&ring);
    }
    let flat = project(points);
    if (0..ring.len()).all(|k| turn_at(&flat, &ring, k) >= 0.0) {
        return fan(&ring);
    }
    let mut triangles = Vec::with_capacity(points.len() - 2);
    while ring.len() > 3 {
        let Some(ear) = (0..ring.len()).find(|&k| is_ear(&flat, &ring, k)) else { break };
        triangles.push(corner(&ring, ear));
        ring.remove(ear);
    }
    triangles.extend(fan(&ring));
    triangles
}

/// The polygon seen against its area vector, so that it runs counter-clockwise.
fn project(points: &[Vec3]) -> Vec<Vec2> {
    let centre = points.iter().sum::<Vec3>() / points.len() as f32;
    let normal: Vec3 = (0..points.len())
        .map(|k| (points[k] - centre).cross(points[(k + 1) % points.len()] - centre))
        .sum::<Vec3>()
        .normalize_or(Vec3::Y);
    let (u, v) = normal.any_orthonormal_pair();
    let handed = if u.cross(v).dot(normal) < 0.0 { -1.0 } else { 1.0 };
    points.iter().map(|&p| Vec2::new((p - centre).dot(u), handed * (p - centre).dot(v))).collect()
}

/// The corner before `k`, `k`, and the corner after it.
fn corner(ring: &[usize], k: usize) -> [usize; 3] {
    let n = ring.len();
    [ring[(k + n - 1) % n], ring[k], ring[(k + 1) % n]]
}

/// Twice the signed area at corner `k`: positive where the polygon is convex.
fn turn_at(flat: &[Vec2], ring: &[usize], k: usize) -> f32 {
    let [a, b, c] = corner(ring, k).map(|i| flat[i]);
    (b - a).perp_dot(c - b)
}

fn is_ear(flat: &[Vec2], ring: &[usize], k: usize) -> bool {
    if turn_at(flat, ring, k) <= 0.0 {
        return false;
    }
    let ear = corner(ring, k);
    let [a, b, c] = ear.map(|i| flat[i]);
    ring.iter().filter(|i| !ear.contains(i)).map(|&i| flat[i]).all(|p| {
        let inside = (b - a).perp_dot(p - a) >= 0.0 && (c - b).perp_dot(p - b) >= 0.0 && (a - c).perp_dot(p - c) >= 0.0;
        // A corner repeated at the same place (a hole's bridge) does not block the ear.
        !inside || p == a || p == b || p == c
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(points: &[Vec3], triangles: &[[usize; 3]]) -> (f32, f32) {
        let parts = triangles.iter().map(|t| {
            let [a, b, c] = t.map(|i| points[i]);
            (b - a).cross(c - a) / 2.0
        });
        let total: Vec3 = parts.clone().sum();
        (total.length(), parts.map(Vec3::length).sum())
    }

    #[test]
    fn concave_polygons_keep_their_area() {
        // A comb: fans from any corner would leave the polygon.
        let flat = [[0., 0.], [6., 0.], [6., 3.], [5., 1.], [4., 3.], [3., 1.], [2., 3.], [1., 1.], [0., 3.]];
        for tilt in [0.0, 0.4, 1.3, 2.9] {
            let turn = glam::Quat::from_rotation_x(tilt) * glam::Quat::from_rotation_y(0.3);
            let mut points: Vec<Vec3> = flat.iter().map(|&[x, y]| turn * Vec3::new(x, y, 0.0)).collect();
            for _ in 0..points.len() {
                points.rotate_left(1);
                let triangles = triangulate(&points);
                assert_eq!(triangles.len(), points.len() - 2);
                let (net, gross) = area(&points, &triangles);
                assert!((net - gross).abs() < 1e-4 && (net - 12.0).abs() < 1e-4, "{net} {gross}");
            }
        }
    }

    #[test]
    fn convex_polygons_become_fans() {
        let square = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y];
        assert_eq!(triangulate(&square), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(triangulate(&square[..3]), [[0, 1, 2]]);
    }

    #[test]
    fn hopeless_polygons_still_end() {
        for points in [vec![Vec3::ZERO; 7], (0..9).map(|k| Vec3::X * (k % 3) as f32).collect()] {
            assert_eq!(triangulate(&points).len(), points.len() - 2);
        }
    }
}
