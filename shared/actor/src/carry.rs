//! Points that a surface carries: where each lies over a triangle stays while the surface moves.

use bytemuck::{Pod, Zeroable};
use glam::{Mat3, Vec3};

/// Where a point lies over a surface.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Carried {
    /// The triangle.
    pub triangle: u32,
    /// Barycentric coordinates of the foot: those of the second and third corner.
    pub foot: [f32; 2],
    /// From the foot to the point in a frame of its triangle there, metres.
    pub offset: [f32; 3],
}

/// A surface in a pose.
pub struct Surface<'a> {
    triangles: &'a [[u32; 3]],
    pose: &'a [Vec3],
    /// Sums of the normals of a vertex's triangles, each twice its triangle's area long.
    normals: Vec<Vec3>,
}

impl<'a> Surface<'a> {
    /// `triangles` over the vertices at `pose`.
    #[must_use]
    pub fn new(triangles: &'a [[u32; 3]], pose: &'a [Vec3]) -> Self {
        let mut surface = Self { triangles, pose, normals: vec![Vec3::ZERO; pose.len()] };
        for number in 0..triangles.len() {
            let Some([a, b, c]) = surface.corners(number) else { continue };
            let normal = (b - a).cross(c - a);
            for &vertex in &triangles[number] {
                surface.normals[vertex as usize] += normal;
            }
        }
        surface
    }

    /// The corners of triangle `number`; `None` where there is no such triangle or vertex.
    #[must_use]
    pub fn corners(&self, number: usize) -> Option<[Vec3; 3]> {
        of_corners(*self.triangles.get(number)?, self.pose)
    }

    /// Which way the surface faces at each vertex, of no particular length.
    #[must_use]
    pub fn normals(&self) -> &[Vec3] {
        &self.normals
    }

    /// The point of triangle `number` at `foot`, and a frame there: along its first side, across, and outwards, smooth but for the first
    /// two.
    fn frame(&self, number: usize, [v, w]: [f32; 2]) -> Option<(Vec3, Mat3)> {
        let [a, b, c] = self.corners(number)?;
        let [na, nb, nc] = of_corners(*self.triangles.get(number)?, &self.normals)?.map(Vec3::normalize_or_zero);
        let u = 1.0 - v - w;
        let out = (na * u + nb * v + nc * w).normalize_or(Vec3::Y);
        let along = (b - a - out * (b - a).dot(out)).normalize_or_zero();
        Some((a * u + b * v + c * w, Mat3::from_cols(along, out.cross(along), out)))
    }

    /// How `point` is carried by triangle `number` from `foot`; `None` where there is no such triangle.
    #[must_use]
    pub fn carry(&self, point: Vec3, number: u32, foot: [f32; 2]) -> Option<Carried> {
        let (from, frame) = self.frame(number as usize, foot)?;
        let offset = (frame.transpose() * (point - from)).to_array();
        Some(Carried { triangle: number, foot, offset })
    }

    /// Where `carried` is; `None` where its triangle is none of the surface's.
    #[must_use]
    pub fn place(&self, carried: &Carried) -> Option<Vec3> {
        let (from, frame) = self.frame(carried.triangle as usize, carried.foot)?;
        Some(from + frame * Vec3::from_array(carried.offset))
    }
}

fn of_corners(corners: [u32; 3], values: &[Vec3]) -> Option<[Vec3; 3]> {
    match corners.map(|vertex| values.get(vertex as usize).copied()) {
        [Some(a), Some(b), Some(c)] => Some([a, b, c]),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use glam::Quat;

    use super::*;

    const TRIANGLES: [[u32; 3]; 4] = [[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]];

    fn body() -> Vec<Vec3> {
        vec![Vec3::ZERO, Vec3::X, Vec3::Y * 1.2, Vec3::Z * 0.8]
    }

    #[test]
    fn a_point_stays_where_it_was_and_goes_along() {
        let pose = body();
        let point = Vec3::new(0.3, 0.35, -0.1);
        let carried = Surface::new(&TRIANGLES, &pose).carry(point, 0, [0.3, 0.3]).unwrap();
        let stays = Surface::new(&TRIANGLES, &pose).place(&carried).unwrap();
        assert!(stays.distance(point) < 1e-6, "{stays}");
        let (turn, shift) = (Quat::from_rotation_y(1.1) * Quat::from_rotation_x(0.4), Vec3::new(3.0, -1.0, 2.0));
        let moved: Vec<Vec3> = pose.iter().map(|&p| turn * p + shift).collect();
        let there = Surface::new(&TRIANGLES, &moved).place(&carried).unwrap();
        assert!(there.distance(turn * point + shift) < 1e-5, "{there}");
        // A body twice as large carries it from the same foot, as far away as before.
        let larger: Vec<Vec3> = pose.iter().map(|&p| 2.0 * p).collect();
        let there = Surface::new(&TRIANGLES, &larger).place(&carried).unwrap();
        let foot = |pose: &[Vec3]| 0.4 * pose[0] + 0.3 * pose[2] + 0.3 * pose[1];
        assert!((there.distance(foot(&larger)) - point.distance(foot(&pose))).abs() < 1e-5);
    }

    #[test]
    fn what_is_no_surface_carries_nothing() {
        let flat = [Vec3::ZERO; 4];
        let surface = Surface::new(&TRIANGLES, &flat);
        let carried = surface.carry(Vec3::X, 1, [0.2, 0.2]).unwrap();
        assert!(surface.place(&carried).unwrap().is_finite());
        assert_eq!(surface.carry(Vec3::X, 4, [0.2, 0.2]), None);
        assert_eq!(surface.place(&Carried { triangle: 9, ..carried }), None);
        assert_eq!(Surface::new(&[[0, 1, 7]], &flat).place(&Carried::default()), None);
    }
}
