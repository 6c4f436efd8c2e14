//! What the deformation graph is too coarse for: every vertex moves along its normal to the frame's surface, as far as its
//! neighbours agree. Only what is written has it; children are tracked from the pose without, for part of it is noise.

use glam::Vec3;
use kernels::cholesky::EliminationOrder;
use kernels::cholesky::{CholeskyError, ConstrainedFactor, Constraints, SolveScratch, Symbolic, Workspace};
use kernels::gradients::TriangleBatches;
use kernels::laplacian::{Laplacian, LaplacianPattern};
use kernels::topology::{Topology, TopologyError, barycentric_areas};
use thiserror::Error;

use super::surface::Surface;
use super::track::Target;

/// How smooth normals are made, square metres on a person.
const NORMALS: f32 = 1e-4;
/// No vertex moves farther, metres on a person.
const FARTHEST: f32 = 0.03;
const ROUNDS: usize = 2;
/// Where no point is found, this share of the weight of one keeps the vertex.
const UNSEEN: f64 = 1e-3;
const LEAST_COSINE: f32 = 0.5;

/// Why the template's equations cannot be set up.
#[derive(Debug, Error)]
pub enum DetailError {
    /// The template is no mesh.
    #[error(transparent)]
    Topology(#[from] TopologyError),
    /// Its equations have no solution.
    #[error(transparent)]
    Equations(#[from] CholeskyError),
}

/// The template's equations: (W + eps S) h = W d, of which only the weights change.
#[derive(Debug)]
pub struct Detail {
    pattern: LaplacianPattern,
    laplacian: Laplacian,
    symbolic: Symbolic,
    areas: Vec<f32>,
    scale: f32,
}

impl Detail {
    /// For the template `surface`; `scale` as [`Template::scale`](super::template::Template::scale).
    ///
    /// # Errors
    /// A template that is no usable mesh.
    pub fn new(surface: &Surface, scale: f32) -> Result<Self, DetailError> {
        let (mesh, vertices) = (&surface.mesh, surface.mesh.positions.len() as u32);
        let areas = barycentric_areas(&mesh.triangles, &mesh.positions);
        let topology = Topology::new(vertices, mesh.triangles.clone(), areas.clone())?;
        let batches = TriangleBatches::new(topology.triangles());
        let pattern = LaplacianPattern::unheld(&topology, &batches, &[])?;
        let mut laplacian = Laplacian::default();
        pattern.assemble(&batches, &mesh.positions, &mut laplacian);
        pattern.change_weights(&mut laplacian, |_, weight| weight.clamp(1e-3, 1e2));
        let symmetric = pattern.symmetric();
        let symbolic = Symbolic::new(symmetric, &EliminationOrder::minimum_degree(symmetric))?;
        Ok(Self { pattern, laplacian, symbolic, areas, scale })
    }

    /// `pose` with detail of `target`; `smoothness` is eps, square metres on a person.
    ///
    /// # Errors
    /// Equations without a solution.
    pub fn add(
        &self,
        template: &Surface,
        pose: &[Vec3],
        target: &Target,
        smoothness: f32,
    ) -> Result<Vec<Vec3>, DetailError> {
        let mut moved = template.posed(pose.to_vec());
        for _ in 0..ROUNDS {
            let normals = self.smooth_normals(&moved)?;
            let found: Vec<Option<f32>> = (0..pose.len())
                .map(|k| {
                    let place = moved.mesh.positions[k];
                    let y = target.closest(place, moved.normals[k])?;
                    let off = y.position - place;
                    let near = off.length() < FARTHEST * self.scale && y.normal.dot(moved.normals[k]) > LEAST_COSINE;
                    near.then(|| off.dot(y.normal) / y.normal.dot(normals[k]).max(LEAST_COSINE))
                })
                .collect();
            let weight = |k: usize| f64::from(self.areas[k]) * if found[k].is_some() { 1.0 } else { UNSEEN };
            let wanted: Vec<f32> = found.iter().map(|off| off.unwrap_or(0.0)).collect();
            let heights = self.solve(weight, smoothness, &wanted, 1)?;
            let most = FARTHEST * self.scale;
            let places = (0..pose.len()).map(|k| moved.mesh.positions[k] + normals[k] * heights[k].clamp(-most, most));
            let places: Vec<Vec3> = places.collect();
            moved.pose(&places);
        }
        Ok(moved.mesh.positions)
    }

    /// n~ = (M + 1e-4 S)^-1 M n.
    fn smooth_normals(&self, surface: &Surface) -> Result<Vec<Vec3>, DetailError> {
        let normals: Vec<f32> = surface.normals.iter().flat_map(Vec3::to_array).collect();
        let smooth = self.solve(|k| f64::from(self.areas[k]), NORMALS, &normals, 3)?;
        let of = |(n, own): (&[f32], &Vec3)| Vec3::from_slice(n).normalize_or(*own);
        Ok(smooth.chunks_exact(3).zip(&surface.normals).map(of).collect())
    }

    /// (W + eps S) x = W wanted, for `columns` numbers of each vertex.
    fn solve(
        &self,
        weight: impl Fn(usize) -> f64,
        eps: f32,
        wanted: &[f32],
        columns: usize,
    ) -> Result<Vec<f32>, DetailError> {
        let eps = f64::from(eps * self.scale * self.scale).max(1e-12);
        let mut constraints = Constraints::new();
        for k in 0..self.areas.len() {
            // A vertex without area still has its equation.
            constraints.soft(k as u32, weight(k).max(1e-12) / eps);
        }
        let (matrix, mut workspace) = (self.pattern.matrix(&self.laplacian), Workspace::default());
        let factor = ConstrainedFactor::<f32>::new(&self.symbolic, &matrix, &constraints, &mut workspace)?;
        let mut x = vec![0.0; wanted.len()];
        factor.solve(&self.symbolic, wanted, columns, &mut x, &mut SolveScratch::default())?;
        Ok(x)
    }
}

#[cfg(test)]
mod tests {
    use geometry::mesh::Mesh;

    use super::*;

    fn sheet(n: u32, height: impl Fn(f32, f32) -> f32) -> Surface {
        let at = |k: u32| k as f32 / n as f32;
        let place = |x: u32, z: u32| Vec3::new(at(x), height(at(x), at(z)), at(z));
        let positions = (0..=n).flat_map(|z| (0..=n).map(move |x| (x, z))).map(|(x, z)| place(x, z)).collect();
        let mut triangles = Vec::new();
        for z in 0..n {
            for x in 0..n {
                let a = z * (n + 1) + x;
                triangles.extend([[a, a + n + 1, a + 1], [a + 1, a + n + 1, a + n + 2]]);
            }
        }
        Surface::new(Mesh { positions, triangles }, None)
    }

    #[test]
    fn offsets_are_those_of_the_plain_equations() {
        let surface = sheet(7, |x, z| 0.02 * (5.0 * x).sin() * z);
        let detail = Detail::new(&surface, 1.0).unwrap();
        let count = surface.mesh.positions.len();
        let wanted: Vec<f32> = (0..count).map(|k| kernels::random::signed(5, k as u64)).collect();
        let weight = |k: usize| f64::from(detail.areas[k]) * if k.is_multiple_of(3) { UNSEEN } else { 1.0 };
        let eps = 2e-3;
        let got = detail.solve(weight, eps, &wanted, 1).unwrap();
        // S by the cotangents, clamped as there; the residual of the equations.
        let mut s = vec![vec![0.0_f64; count]; count];
        let mut edges = std::collections::BTreeMap::new();
        for triangle in &surface.mesh.triangles {
            for k in 0..3 {
                let [a, b, c] = [0, 1, 2].map(|j| triangle[(k + j) % 3]);
                let [pa, pb, pc] = [a, b, c].map(|v| surface.mesh.positions[v as usize].as_dvec3());
                let (u, v) = (pa - pc, pb - pc);
                *edges.entry((a.min(b), a.max(b))).or_insert(0.0) += 0.5 * u.dot(v) / u.cross(v).length();
            }
        }
        for ((a, b), weight) in edges {
            let (a, b, weight) = (a as usize, b as usize, f64::clamp(weight, 1e-3, 1e2));
            s[a][b] -= weight;
            s[b][a] -= weight;
            s[a][a] += weight;
            s[b][b] += weight;
        }
        for i in 0..count {
            let left: f64 = (0..count).map(|j| f64::from(eps) * s[i][j] * f64::from(got[j])).sum();
            let residual = left + weight(i) * f64::from(got[i] - wanted[i]);
            assert!(residual.abs() < 1e-6, "{residual} in row {i}");
        }
    }

    #[test]
    fn a_dent_is_found() {
        let flat = sheet(40, |_, _| 0.0);
        let dent = |x: f32, z: f32| 0.012 * (-((x - 0.5).powi(2) + (z - 0.5).powi(2)) / 0.04).exp();
        let target = Target::new(sheet(56, dent), 1.0);
        let detail = Detail::new(&flat, 1.0).unwrap();
        let found = detail.add(&flat, &flat.mesh.positions, &target, 1e-5).unwrap();
        let worst = found.iter().map(|p| (p.y - dent(p.x, p.z)).abs()).fold(0.0, f32::max);
        assert!(worst < 0.001, "{worst}");
    }
}
