//! Small meshes made in code.

use fixtures::Random;
use glam::{Quat, Vec3};
use kernels::topology::{Topology, barycentric_areas};

/// A closed tube of `rings` rings of `around` vertices, 2 m tall along +Y, with two poles.
pub fn tube(rings: u32, around: u32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut points = vec![Vec3::new(0.0, -0.1, 0.0), Vec3::new(0.0, 2.1, 0.0)];
    let mut triangles = Vec::new();
    let at = |ring: u32, step: u32| 2 + ring * around + step % around;
    for ring in 0..rings {
        for step in 0..around {
            let angle = std::f32::consts::TAU * step as f32 / around as f32;
            let height = 2.0 * ring as f32 / (rings - 1) as f32;
            points.push(Vec3::new(0.2 * angle.cos(), height, 0.15 * angle.sin()));
            if ring == 0 {
                triangles.push([0, at(0, step), at(0, step + 1)]);
            } else {
                triangles.push([at(ring - 1, step), at(ring, step), at(ring, step + 1)]);
                triangles.push([at(ring - 1, step), at(ring, step + 1), at(ring - 1, step + 1)]);
            }
            if ring == rings - 1 {
                triangles.push([1, at(ring, step + 1), at(ring, step)]);
            }
        }
    }
    (points, triangles)
}

/// Several meshes as one, with a component each; the last `isolated` vertices belong to no triangle.
pub fn together(parts: &[(Vec<Vec3>, Vec<[u32; 3]>)], isolated: u32) -> (Topology, Vec<Vec3>) {
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for (part_points, part_triangles) in parts {
        let first = points.len() as u32;
        points.extend_from_slice(part_points);
        triangles.extend(part_triangles.iter().map(|t| t.map(|vertex| vertex + first)));
    }
    points.extend((0..isolated).map(|k| Vec3::new(1.0, k as f32, 1.0)));
    let mut weights = barycentric_areas(&triangles, &points);
    let last = weights.len() - isolated as usize;
    weights[last..].fill(0.01);
    (Topology::new(points.len() as u32, triangles, weights).unwrap(), points)
}

/// Bends along +Y by up to `bend` radians, twists by `twist`, and jitters each vertex by `noise` metres.
pub fn bent(points: &[Vec3], bend: f32, twist: f32, noise: f32, random: &mut Random) -> Vec<Vec3> {
    points
        .iter()
        .map(|p| {
            let turned = Quat::from_rotation_y(twist * p.y / 2.0) * Vec3::new(p.x, 0.0, p.z);
            let angle = bend * p.y / 2.0;
            let radius = 2.0 / bend;
            let spine = Vec3::new(radius * (1.0 - angle.cos()), radius * angle.sin(), 0.0);
            spine + Quat::from_rotation_z(-angle) * turned + random.vector() * noise
        })
        .collect()
}
