//! Triangles of an implicit surface by marching tetrahedra: always closed and manifold, without a table of cases.
//!
//! This work is based on: A. Doi and A. Koide, "An efficient method of triangulating equi-valued surfaces by using
//! tetrahedral cells", 1991. Each cube is cut into the six Kuhn tetrahedra along its diagonal, which match across cubes.

use std::collections::HashMap;

use glam::{IVec3, Vec3};
use rayon::prelude::*;

use super::mesh::Mesh;

/// Cubes along an edge of a block that is skipped as a whole where the surface is far.
const BLOCK: i32 = 8;

/// The zero set of `distance` in the box from `low` to `high`, sampled every `cell` metres; its largest part.
///
/// `distance` must be negative inside and change by at most about the distance moved.
#[must_use]
pub fn polygonise(low: Vec3, high: Vec3, cell: f32, distance: impl Fn(Vec3) -> f32 + Sync) -> Mesh {
    let size = ((high - low) / cell).ceil().as_ivec3() + IVec3::ONE;
    let place = |lattice: IVec3| low + lattice.as_vec3() * cell;
    let blocks: Vec<IVec3> = (0..size.z)
        .step_by(BLOCK as usize)
        .flat_map(|z| {
            (0..size.y)
                .step_by(BLOCK as usize)
                .flat_map(move |y| (0..size.x).step_by(BLOCK as usize).map(move |x| IVec3::new(x, y, z)))
        })
        .collect();
    let reach = cell * BLOCK as f32 * 0.9 * 1.5;
    let samples: Vec<Option<Vec<f32>>> = blocks
        .par_iter()
        .map(|&origin| {
            let centre = place(origin) + Vec3::splat(cell * BLOCK as f32 * 0.5);
            (distance(centre).abs() < reach).then(|| {
                let side = 0..=BLOCK;
                let mut values = Vec::with_capacity(((BLOCK + 1) * (BLOCK + 1) * (BLOCK + 1)) as usize);
                for z in side.clone() {
                    for y in side.clone() {
                        values.extend(side.clone().map(|x| distance(place(origin + IVec3::new(x, y, z)))));
                    }
                }
                values
            })
        })
        .collect();
    let mut builder = Builder { size, crossing: HashMap::new(), mesh: Mesh::default() };
    for (origin, values) in blocks.iter().zip(&samples) {
        let Some(values) = values else { continue };
        let value = |local: IVec3| values[((local.z * (BLOCK + 1) + local.y) * (BLOCK + 1) + local.x) as usize];
        for z in 0..BLOCK {
            for y in 0..BLOCK {
                for x in 0..BLOCK {
                    let local = IVec3::new(x, y, z);
                    let corners: [f32; 8] = std::array::from_fn(|index| value(local + corner(index)));
                    let inside = corners.iter().filter(|&&d| d < 0.0).count();
                    if inside != 0 && inside != 8 {
                        builder.cube(*origin + local, &corners, &place);
                    }
                }
            }
        }
    }
    builder.mesh.largest_component()
}

struct Builder {
    size: IVec3,
    /// The mesh vertex on an edge of the lattice: from a lattice point in one of seven directions.
    crossing: HashMap<(i64, usize), u32>,
    mesh: Mesh,
}

/// Offset of a corner of a cube: one bit per axis.
fn corner(index: usize) -> IVec3 {
    IVec3::new((index & 1) as i32, (index >> 1 & 1) as i32, (index >> 2 & 1) as i32)
}

impl Builder {
    fn cube(&mut self, origin: IVec3, corners: &[f32; 8], place: &impl Fn(IVec3) -> Vec3) {
        // Paths from corner 0 to corner 7 along the axes, in the six orders.
        const PATHS: [[usize; 4]; 6] =
            [[0, 1, 3, 7], [0, 1, 5, 7], [0, 2, 3, 7], [0, 2, 6, 7], [0, 4, 5, 7], [0, 4, 6, 7]];
        for tetrahedron in PATHS {
            let (inside, outside): (Vec<usize>, Vec<usize>) = tetrahedron.iter().partition(|&&c| corners[c] < 0.0);
            let mut cut = |a: usize, b: usize| self.vertex(origin, a.min(b), a.max(b), corners, place);
            let ring: Vec<u32> = match (inside.as_slice(), outside.as_slice()) {
                ([a], [b, c, d]) | ([b, c, d], [a]) => vec![cut(*a, *b), cut(*a, *c), cut(*a, *d)],
                ([a, b], [c, d]) => vec![cut(*a, *c), cut(*a, *d), cut(*b, *d), cut(*b, *c)],
                _ => continue,
            };
            let centre = |set: &[usize]| set.iter().map(|&c| corner(c).as_vec3()).sum::<Vec3>() / set.len() as f32;
            self.face(&ring, centre(&outside) - centre(&inside));
        }
    }

    /// One or two triangles over `ring`, facing `outwards`.
    fn face(&mut self, ring: &[u32], outwards: Vec3) {
        let at = |k: usize| self.mesh.positions[ring[k] as usize];
        let normal =
            if ring.len() == 4 { (at(2) - at(0)).cross(at(3) - at(1)) } else { (at(1) - at(0)).cross(at(2) - at(0)) };
        let flip = normal.dot(outwards) < 0.0;
        for k in 1..ring.len() - 1 {
            let [a, b, c] = [ring[0], ring[k], ring[k + 1]];
            self.mesh.triangles.push(if flip { [a, c, b] } else { [a, b, c] });
        }
    }

    fn vertex(&mut self, origin: IVec3, a: usize, b: usize, corners: &[f32; 8], place: &impl Fn(IVec3) -> Vec3) -> u32 {
        let from = origin + corner(a);
        let key = i64::from(from.x)
            + i64::from(self.size.x + 9) * (i64::from(from.y) + i64::from(self.size.y + 9) * i64::from(from.z));
        let mesh = &mut self.mesh;
        *self.crossing.entry((key, a ^ b)).or_insert_with(|| {
            // Keep off the lattice points, where triangles would have no area.
            let t = (corners[a] / (corners[a] - corners[b])).clamp(0.02, 0.98);
            mesh.positions.push(place(from).lerp(place(origin + corner(b)), t));
            mesh.positions.len() as u32 - 1
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sphere_is_closed_and_round() {
        let mesh = polygonise(Vec3::splat(-1.2), Vec3::splat(1.2), 0.1, |p| p.length() - 1.0);
        mesh.check_closed().unwrap();
        assert_eq!(mesh.euler_characteristic(), 2);
        assert!(mesh.positions.iter().all(|p| (p.length() - 1.0).abs() < 5e-3));
        assert!((mesh.volume() - 4.1888).abs() < 0.05, "oriented outwards: volume {}", mesh.volume());
    }
}
