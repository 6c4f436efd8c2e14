//! Even triangles of a wanted number on an implicit surface.
//!
//! This work is based on: M. Botsch and L. Kobbelt, "A remeshing approach to multiresolution modeling", 2004: split long
//! edges, collapse short ones, flip towards six neighbours, relax along the surface. Here the surface is the implicit
//! one, to which vertices return by projection, and a last pass meets the number of vertices exactly.

use std::collections::BTreeSet;

use glam::Vec3;
use rayon::prelude::*;

use super::mesh::Mesh;

/// What to remesh to.
pub struct Target<'a> {
    /// Number of vertices.
    pub vertices: usize,
    /// The nearest point of the surface.
    pub project: &'a (dyn Fn(Vec3) -> Vec3 + Sync),
    /// How long edges should be at a point, relative to elsewhere.
    pub scale: &'a (dyn Fn(Vec3) -> f32 + Sync),
}

/// Remeshes `mesh`, closed and manifold, to exactly `target.vertices` vertices unless it cannot be refined that far.
#[must_use]
pub fn remesh(mesh: &Mesh, target: &Target) -> Mesh {
    let mut editor = Editor::new(mesh);
    let mut length = first_length(mesh, target);
    for round in 0..5 {
        for _ in 0..if round == 0 { 5 } else { 3 } {
            editor.pass(length, target);
        }
        let ratio = editor.vertex_count() as f32 / target.vertices as f32;
        length *= ratio.sqrt();
        if round > 0 && (ratio - 1.0).abs() < 0.01 {
            break;
        }
    }
    editor.meet_count(target);
    for _ in 0..3 {
        editor.flip_all();
        editor.relax(target);
    }
    editor.finish()
}

/// The edge length at which an even triangulation has the wanted number of vertices.
fn first_length(mesh: &Mesh, target: &Target) -> f32 {
    let weighted: f32 = mesh
        .triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
            (b - a).cross(c - a).length() * 0.5 / (target.scale)((a + b + c) / 3.0).powi(2)
        })
        .sum();
    // Two triangles a vertex, each of sqrt(3)/4 times the squared length.
    (weighted / (target.vertices as f32 * 2.0) * 4.0 / 3.0_f32.sqrt()).sqrt()
}

struct Editor {
    positions: Vec<Vec3>,
    /// Relative edge length wanted at each vertex.
    scales: Vec<f32>,
    /// Removed triangles are `None`.
    triangles: Vec<Option<[u32; 3]>>,
    /// Triangles around each vertex; empty where the vertex was removed.
    around: Vec<Vec<u32>>,
}

impl Editor {
    fn new(mesh: &Mesh) -> Self {
        Self {
            positions: mesh.positions.clone(),
            scales: vec![1.0; mesh.positions.len()],
            triangles: mesh.triangles.iter().copied().map(Some).collect(),
            around: mesh.triangles_of_vertices(),
        }
    }

    fn vertex_count(&self) -> usize {
        self.around.iter().filter(|list| !list.is_empty()).count()
    }

    fn pass(&mut self, length: f32, target: &Target) {
        self.scales = self.positions.par_iter().map(|&p| (target.scale)(p)).collect();
        self.split_long(length);
        self.collapse_short(length);
        self.flip_all();
        self.relax(target);
    }

    fn at(&self, vertex: u32) -> Vec3 {
        self.positions[vertex as usize]
    }

    /// Length of an edge as a multiple of the wanted one, for unit wanted length.
    fn relative(&self, a: u32, b: u32) -> f32 {
        self.at(a).distance(self.at(b)) / (0.5 * (self.scales[a as usize] + self.scales[b as usize]))
    }

    fn edges(&self) -> Vec<(u32, u32)> {
        let mut edges: Vec<(u32, u32)> = Vec::new();
        for &[a, b, c] in self.triangles.iter().flatten() {
            edges.extend([(a, b), (b, c), (c, a)].into_iter().filter(|(from, to)| from < to));
        }
        edges
    }

    /// The triangle that has the directed edge from `a` to `b`, and its third vertex.
    fn across(&self, a: u32, b: u32) -> Option<(u32, u32)> {
        self.around[a as usize].iter().find_map(|&index| {
            let t = self.triangles[index as usize]?;
            let k = t.iter().position(|&v| v == a)?;
            (t[(k + 1) % 3] == b).then_some((index, t[(k + 2) % 3]))
        })
    }

    fn neighbours(&self, vertex: u32) -> BTreeSet<u32> {
        let triangles = self.around[vertex as usize].iter().filter_map(|&index| self.triangles[index as usize]);
        triangles.flatten().filter(|&v| v != vertex).collect()
    }

    fn add(&mut self, triangle: [u32; 3]) {
        let index = self.triangles.len() as u32;
        self.triangles.push(Some(triangle));
        for vertex in triangle {
            self.around[vertex as usize].push(index);
        }
    }

    fn remove(&mut self, index: u32) {
        if let Some(triangle) = self.triangles[index as usize].take() {
            for vertex in triangle {
                self.around[vertex as usize].retain(|&other| other != index);
            }
        }
    }

    fn split_long(&mut self, length: f32) {
        let mut long: Vec<(u32, u32)> = self.edges();
        long.retain(|&(a, b)| self.relative(a, b) > length * 4.0 / 3.0);
        long.sort_by(|x, y| self.relative(y.0, y.1).total_cmp(&self.relative(x.0, x.1)));
        for (a, b) in long {
            self.split(a, b);
        }
    }

    fn split(&mut self, a: u32, b: u32) {
        let (Some((left, c)), Some((right, d))) = (self.across(a, b), self.across(b, a)) else { return };
        let middle = self.positions.len() as u32;
        self.positions.push((self.at(a) + self.at(b)) * 0.5);
        self.scales.push(0.5 * (self.scales[a as usize] + self.scales[b as usize]));
        self.around.push(Vec::new());
        self.remove(left);
        self.remove(right);
        for triangle in [[a, middle, c], [middle, b, c], [b, middle, d], [middle, a, d]] {
            self.add(triangle);
        }
    }

    fn collapse_short(&mut self, length: f32) {
        let mut short: Vec<(u32, u32)> = self.edges();
        short.retain(|&(a, b)| self.relative(a, b) < length * 0.8);
        short.sort_by(|x, y| self.relative(x.0, x.1).total_cmp(&self.relative(y.0, y.1)));
        for (a, b) in short {
            // Earlier collapses may have moved or removed the edge.
            let there = !self.around[a as usize].is_empty() && self.across(a, b).is_some();
            if there && self.relative(a, b) < length * 0.8 {
                self.collapse(a, b, length * 4.0 / 3.0);
            }
        }
    }

    /// Moves `b` into `a` at the edge's middle, unless that folds the surface, pinches it or makes a long edge.
    fn collapse(&mut self, a: u32, b: u32, longest: f32) -> bool {
        let (near_a, near_b) = (self.neighbours(a), self.neighbours(b));
        let shared: Vec<u32> = near_a.intersection(&near_b).copied().collect();
        if shared.len() != 2 || shared.iter().any(|&v| self.around[v as usize].len() <= 3) {
            return false;
        }
        let middle = (self.at(a) + self.at(b)) * 0.5;
        let scale = 0.5 * (self.scales[a as usize] + self.scales[b as usize]);
        for &v in near_a.union(&near_b) {
            if v != a && v != b {
                let wanted = 0.5 * (scale + self.scales[v as usize]);
                if self.at(v).distance(middle) > longest * wanted {
                    return false;
                }
            }
        }
        let moved: Vec<u32> = [a, b].iter().flat_map(|&v| self.around[v as usize].iter().copied()).collect();
        for index in moved {
            let Some(t) = self.triangles[index as usize] else { continue };
            if t.contains(&a) && t.contains(&b) {
                continue;
            }
            let before = normal(t.map(|v| self.at(v)));
            let after = normal(t.map(|v| if v == a || v == b { middle } else { self.at(v) }));
            if before.dot(after) < 0.4 * before.length() * after.length() || after.length() < 1e-12 {
                return false;
            }
        }
        for index in self.around[b as usize].clone() {
            let Some(t) = self.triangles[index as usize] else { continue };
            self.remove(index);
            if !t.contains(&a) {
                self.add(t.map(|v| if v == b { a } else { v }));
            }
        }
        self.positions[a as usize] = middle;
        self.scales[a as usize] = scale;
        true
    }

    fn flip_all(&mut self) {
        for (a, b) in self.edges() {
            let (Some((left, c)), Some((right, d))) = (self.across(a, b), self.across(b, a)) else { continue };
            let valence = |v: u32| self.around[v as usize].len() as i32;
            let off = |v: u32, change: i32| (valence(v) + change - 6).pow(2);
            let before = off(a, 0) + off(b, 0) + off(c, 0) + off(d, 0);
            let after = off(a, -1) + off(b, -1) + off(c, 1) + off(d, 1);
            if after >= before || valence(a) <= 3 || valence(b) <= 3 || c == d || self.across(c, d).is_some() {
                continue;
            }
            if self.across(d, c).is_some() {
                continue;
            }
            let at = |v: u32| self.at(v);
            let old =
                normal([at(a), at(b), at(c)]).normalize_or_zero() + normal([at(b), at(a), at(d)]).normalize_or_zero();
            let new = [normal([at(c), at(d), at(b)]), normal([at(d), at(c), at(a)])];
            if new.iter().any(|n| n.normalize_or_zero().dot(old) < 0.9) {
                continue;
            }
            self.remove(left);
            self.remove(right);
            self.add([c, d, b]);
            self.add([d, c, a]);
        }
    }

    /// Moves every vertex along the surface to the middle of its neighbours, then back onto the surface.
    fn relax(&mut self, target: &Target) {
        let moved: Vec<Vec3> = (0..self.positions.len())
            .into_par_iter()
            .map(|vertex| {
                let here = self.positions[vertex];
                let (mut centre, mut weight, mut up) = (Vec3::ZERO, 0.0, Vec3::ZERO);
                for t in self.around[vertex].iter().filter_map(|&index| self.triangles[index as usize]) {
                    let corners = t.map(|v| self.at(v));
                    let facing = normal(corners);
                    let middle = corners.iter().sum::<Vec3>() / 3.0;
                    let size = t.iter().map(|&v| self.scales[v as usize]).sum::<f32>();
                    let share = facing.length() / (size * size);
                    centre += middle * share;
                    weight += share;
                    up += facing;
                }
                if weight <= 0.0 {
                    return here;
                }
                let up = up.normalize_or_zero();
                let step = centre / weight - here;
                (target.project)(here + (step - up * step.dot(up)) * 0.7)
            })
            .collect();
        self.positions = moved;
    }

    /// Splits the longest or collapses the shortest edges until the number of vertices is met.
    fn meet_count(&mut self, target: &Target) {
        for _ in 0..8 {
            let count = self.vertex_count();
            let mut edges = self.edges();
            edges.sort_by(|x, y| self.relative(x.0, x.1).total_cmp(&self.relative(y.0, y.1)));
            let mut missing = target.vertices as i64 - count as i64;
            if missing == 0 {
                return;
            }
            while missing > 0 {
                let Some((a, b)) = edges.pop() else { break };
                let before = self.positions.len();
                self.split(a, b);
                missing -= (self.positions.len() - before) as i64;
            }
            for &(a, b) in &edges {
                if missing >= 0 {
                    break;
                }
                let there = !self.around[a as usize].is_empty() && self.across(a, b).is_some();
                if there && self.collapse(a, b, f32::INFINITY) {
                    missing += 1;
                }
            }
            self.relax(target);
        }
    }

    fn finish(self) -> Mesh {
        let triangles = self.triangles.into_iter().flatten().collect();
        Mesh { positions: self.positions, triangles }.compact()
    }
}

fn normal(corners: [Vec3; 3]) -> Vec3 {
    (corners[1] - corners[0]).cross(corners[2] - corners[0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::polygonise::polygonise;

    #[test]
    fn a_sphere_gets_the_vertices_asked_for_and_even_triangles() {
        let mesh = polygonise(Vec3::splat(-1.3), Vec3::splat(1.3), 0.1, |p| p.length() - 1.0);
        for vertices in [300, 1500] {
            let target = Target { vertices, project: &|p| p.normalize(), scale: &|_| 1.0 };
            let even = remesh(&mesh, &target);
            even.check_closed().unwrap();
            assert_eq!((even.positions.len(), even.euler_characteristic()), (vertices, 2));
            let usual = (even.area() / even.triangles.len() as f32 * 4.0 / 3.0_f32.sqrt()).sqrt();
            for t in &even.triangles {
                for k in 0..3 {
                    let length = even.positions[t[k] as usize].distance(even.positions[t[(k + 1) % 3] as usize]);
                    assert!((0.5..1.7).contains(&(length / usual)), "an edge of {} usual lengths", length / usual);
                }
            }
        }
    }
}
