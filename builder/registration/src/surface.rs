//! A surface with what registration asks of it: normals, areas, colours and how these change, and closest points.

use geometry::closest::closest_of_triangle;
use geometry::kd::KdTree;
use geometry::mesh::Mesh;
use glam::Vec3;
use rayon::prelude::*;

/// A surface, one pose of it.
#[derive(Clone, Debug)]
pub struct Surface {
    /// Positions in metres and triangles, counter-clockwise seen from outside.
    pub mesh: Mesh,
    /// Unit normals of the vertices, weighted by area.
    pub normals: Vec<Vec3>,
    /// A third of the areas of the triangles around each vertex, square metres.
    pub areas: Vec<f32>,
    /// Colours of the vertices, 0 to 1, where there are any.
    pub colours: Option<Vec<Vec3>>,
    around: Around,
}

/// Triangles around each vertex.
#[derive(Clone, Debug)]
struct Around {
    first: Vec<u32>,
    triangles: Vec<u32>,
}

impl Around {
    fn new(mesh: &Mesh) -> Self {
        let mut first = vec![0_u32; mesh.positions.len() + 1];
        for &vertex in mesh.triangles.as_flattened() {
            first[vertex as usize + 1] += 1;
        }
        for k in 1..first.len() {
            first[k] += first[k - 1];
        }
        let mut next = first.clone();
        let mut triangles = vec![0; mesh.triangles.len() * 3];
        for (index, triangle) in mesh.triangles.iter().enumerate() {
            for &vertex in triangle {
                triangles[next[vertex as usize] as usize] = index as u32;
                next[vertex as usize] += 1;
            }
        }
        Self { first, triangles }
    }

    fn of(&self, vertex: u32) -> &[u32] {
        &self.triangles[self.first[vertex as usize] as usize..self.first[vertex as usize + 1] as usize]
    }
}

/// A point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// The vertex that was nearest.
    pub vertex: u32,
    /// The triangle, one of those around it.
    pub triangle: u32,
    /// Barycentric coordinates in the triangle.
    pub weights: Vec3,
    /// The point.
    pub position: Vec3,
    /// The surface's unit normal there, interpolated.
    pub normal: Vec3,
}

impl Surface {
    /// A surface of `mesh`, with `colours` of its vertices.
    #[must_use]
    pub fn new(mesh: Mesh, colours: Option<Vec<Vec3>>) -> Self {
        let around = Around::new(&mesh);
        let normals = mesh.normals();
        let mut areas = vec![0.0; mesh.positions.len()];
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|v| mesh.positions[v as usize]);
            let third = (b - a).cross(c - a).length() / 6.0;
            triangle.iter().for_each(|&v| areas[v as usize] += third);
        }
        Self { mesh, normals, areas, colours, around }
    }

    /// The same surface in another pose; areas stay those that they were.
    #[must_use]
    pub fn posed(&self, positions: Vec<Vec3>) -> Self {
        let mesh = Mesh { positions, triangles: self.mesh.triangles.clone() };
        let normals = mesh.normals();
        Self { mesh, normals, ..self.clone() }
    }

    /// Moves the surface to another pose; areas stay those that they were.
    pub fn pose(&mut self, positions: &[Vec3]) {
        self.mesh.positions.copy_from_slice(positions);
        self.normals = self.mesh.normals();
    }

    /// Area of the whole surface.
    #[must_use]
    pub fn area(&self) -> f32 {
        self.areas.iter().map(|&area| f64::from(area)).sum::<f64>() as f32
    }

    /// The mean of its points.
    #[must_use]
    pub fn centroid(&self) -> Vec3 {
        let sum = self
            .mesh
            .positions
            .iter()
            .zip(&self.areas)
            .fold(glam::DVec3::ZERO, |sum, (p, &area)| sum + p.as_dvec3() * f64::from(area));
        (sum / f64::from(self.area()).max(1e-12)).as_vec3()
    }

    /// The point closest to `place` in the triangles around `vertex`; `None` where there are none.
    #[must_use]
    pub fn closest_around(&self, vertex: u32, place: Vec3) -> Option<SurfacePoint> {
        let mut best: Option<(f32, u32, Vec3, Vec3)> = None;
        for &triangle in self.around.of(vertex) {
            let corners = self.mesh.triangles[triangle as usize].map(|v| self.mesh.positions[v as usize]);
            let weights = closest_of_triangle(place, corners);
            let position = corners[0] * weights.x + corners[1] * weights.y + corners[2] * weights.z;
            let distance = position.distance_squared(place);
            if best.is_none_or(|(least, ..)| distance < least) {
                best = Some((distance, triangle, weights, position));
            }
        }
        best.map(|(_, triangle, weights, position)| SurfacePoint {
            vertex,
            triangle,
            weights,
            position,
            normal: self.interpolated(&self.normals, triangle, weights).normalize_or(self.normals[vertex as usize]),
        })
    }

    /// `values` of the vertices at a point of a triangle.
    #[must_use]
    pub fn interpolated(&self, values: &[Vec3], triangle: u32, weights: Vec3) -> Vec3 {
        let [a, b, c] = self.mesh.triangles[triangle as usize].map(|v| values[v as usize]);
        a * weights.x + b * weights.y + c * weights.z
    }
}

/// Finds closest points of a surface: the nearest of its vertices by place and normal, then the nearest point of the
/// triangles around that.
#[derive(Clone, Debug)]
pub struct Closest {
    tree: KdTree<6>,
    normal: f32,
}

impl Closest {
    /// For `surface`; `normal` is the distance, in metres, that a unit of difference between two normals counts.
    #[must_use]
    pub fn new(surface: &Surface, normal: f32) -> Self {
        let places = surface.mesh.positions.iter().zip(&surface.normals);
        let points: Vec<[f32; 6]> = places.map(|(&p, &n)| joined(p, n * normal)).collect();
        Self { tree: KdTree::new(&points), normal }
    }

    /// The point of `surface`, the one that this was made for, that is closest to `place` with its `normal`.
    #[must_use]
    pub fn find(&self, surface: &Surface, place: Vec3, normal: Vec3) -> Option<SurfacePoint> {
        let (vertex, _) = self.tree.nearest(joined(place, normal * self.normal), f32::INFINITY)?;
        surface.closest_around(vertex, place)
    }
}

fn joined(a: Vec3, b: Vec3) -> [f32; 6] {
    [a.x, a.y, a.z, b.x, b.y, b.z]
}

/// How a surface's colours change along it: for each vertex and channel the gradient, per metre, tangential.
#[must_use]
pub fn gradients(surface: &Surface) -> Option<Vec<[Vec3; 3]>> {
    let colours = surface.colours.as_ref()?;
    let mesh = &surface.mesh;
    let of_triangles: Vec<([Vec3; 3], f32)> = mesh
        .triangles
        .par_iter()
        .map(|&[i, j, k]| {
            let [a, b, c] = [i, j, k].map(|v| mesh.positions[v as usize]);
            let normal = (b - a).cross(c - a);
            let doubled = normal.length_squared();
            if doubled < 1e-20 {
                return ([Vec3::ZERO; 3], 0.0);
            }
            // The gradient of the hat function of a corner: the opposite edge turned by the normal.
            let hats = [(c - b), (a - c), (b - a)].map(|edge| normal.cross(edge) / doubled);
            let [ca, cb, cc] = [i, j, k].map(|v| colours[v as usize]);
            let channel = |n: usize| hats[0] * ca[n] + hats[1] * cb[n] + hats[2] * cc[n];
            ([channel(0), channel(1), channel(2)], doubled.sqrt())
        })
        .collect();
    let of_vertex = |vertex: usize| {
        let (mut sums, mut area) = ([Vec3::ZERO; 3], 0.0);
        for &triangle in surface.around.of(vertex as u32) {
            let (gradient, weight) = of_triangles[triangle as usize];
            for (sum, gradient) in sums.iter_mut().zip(gradient) {
                *sum += gradient * weight;
            }
            area += weight;
        }
        sums.map(|sum| sum / f32::max(area, 1e-12))
    };
    Some((0..mesh.positions.len()).into_par_iter().map(of_vertex).collect())
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A sheet of `n` by `n` squares in the plane y = 0, a metre wide, facing up.
    pub(crate) fn sheet(n: u32) -> Mesh {
        let at = |k: u32| k as f32 / n as f32;
        let positions = (0..=n).flat_map(|z| (0..=n).map(move |x| Vec3::new(at(x), 0.0, at(z)))).collect();
        let mut triangles = Vec::new();
        for z in 0..n {
            for x in 0..n {
                let a = z * (n + 1) + x;
                triangles.extend([[a, a + n + 1, a + 1], [a + 1, a + n + 1, a + n + 2]]);
            }
        }
        Mesh { positions, triangles }
    }

    #[test]
    fn closest_points_lie_on_the_surface() {
        let surface = Surface::new(sheet(8), None);
        assert!((surface.area() - 1.0).abs() < 1e-6);
        assert!(surface.centroid().distance(Vec3::new(0.5, 0.0, 0.5)) < 1e-6);
        let closest = Closest::new(&surface, 0.1);
        let found = closest.find(&surface, Vec3::new(0.31, 0.2, 0.77), Vec3::Y).unwrap();
        assert!(found.position.distance(Vec3::new(0.31, 0.0, 0.77)) < 1e-6 && found.normal.distance(Vec3::Y) < 1e-6);
    }

    #[test]
    fn gradients_of_a_ramp_are_its_slope() {
        let mesh = sheet(6);
        let colours = mesh.positions.iter().map(|p| Vec3::new(0.3 * p.x, 0.5 * p.z, 0.1 * p.x - 0.2 * p.z)).collect();
        let surface = Surface::new(mesh, Some(colours));
        for [red, green, blue] in gradients(&surface).unwrap() {
            assert!(red.distance(Vec3::new(0.3, 0.0, 0.0)) < 1e-5);
            assert!(green.distance(Vec3::new(0.0, 0.0, 0.5)) < 1e-5);
            assert!(blue.distance(Vec3::new(0.1, 0.0, -0.2)) < 1e-5);
        }
    }
}
