//! The surface under handles: one solve for the displacements of all vertices.
//!
//! Least is `sum of w_ij |(u_i - u_j) - ((R_i + R_j) / 2 - 1) (x_i - x_j)|^2 + sum of a |u_i - s_i|^2`: each edge wants to be turned
//! as its ends are (`R`), and each vertex to be displaced a little as it is told (`s`); held vertices are displaced by what is
//! wanted, exactly. This is the Laplacian editing of Tejera et al. (2013), equation 4, for displacements: where nothing turns
//! and nothing is wanted, the solution is zero to the bit.

use glam::{DMat3, Mat3, Quat, Vec3};
use kernels::cholesky::{
    CholeskyError, ConstrainedFactor, Constraints, EliminationOrder, SolveScratch, Symbolic, Workspace,
};
use kernels::gradients::TriangleBatches;
use kernels::laplacian::{Laplacian, LaplacianPattern};
use kernels::topology::Topology;

use kernels::rotation::{best_rotation, turned_towards};

/// Smaller weights are this: negative cotangents would break the search for rotations.
const LEAST_WEIGHT: f32 = 1e-3;

/// Solves for surfaces of one topology.
pub struct Deformer {
    triangles: TriangleBatches,
    pattern: LaplacianPattern,
    symbolic: Symbolic,
    workspace: Workspace,
    scratch: SolveScratch,
}

/// A pose some of whose vertices are held: its weights, and the factor of its system.
#[derive(Clone)]
pub struct Held {
    weights: Vec<f32>,
    factor: ConstrainedFactor,
    /// How firmly vertices are displaced as they are told.
    anchor: f32,
    held: Vec<u32>,
}

impl Held {
    /// The vertices that are held, in the order in which displacements are wanted of them.
    #[must_use]
    pub fn vertices(&self) -> &[u32] {
        &self.held
    }

    /// How firmly the others stay.
    #[must_use]
    pub fn anchor(&self) -> f32 {
        self.anchor
    }

    /// The weights of the edges, in the order of [`Deformer::edges`].
    #[must_use]
    pub fn weights(&self) -> &[f32] {
        &self.weights
    }
}

impl Deformer {
    /// For poses of `topology`; `order` is an elimination order found before, or `None` to find one.
    ///
    /// # Errors
    /// A mesh too large to factorise.
    pub fn new(topology: &Topology, order: Option<&[u32]>) -> Result<Self, CholeskyError> {
        let triangles = TriangleBatches::new(topology.triangles());
        let pattern = LaplacianPattern::unheld(topology, &triangles, &[])?;
        let symmetric = pattern.symmetric();
        let order = match order {
            Some(order) => EliminationOrder::new(symmetric.row_count(), order.to_vec())?,
            None => EliminationOrder::minimum_degree(symmetric),
        };
        let symbolic = Symbolic::new(symmetric, &order)?;
        Ok(Self { triangles, pattern, symbolic, workspace: Workspace::default(), scratch: SolveScratch::default() })
    }

    /// The edges of the mesh.
    #[must_use]
    pub fn edges(&self) -> &[[u32; 2]] {
        self.pattern.symmetric().edges()
    }

    /// Holds the vertices `held`, each once, of `pose`; the others are anchored as firmly as `anchor` says beside the
    /// weights of edges, whose sum at a vertex is about 4. It must not be 0 where a part of the mesh holds no vertex.
    ///
    /// # Errors
    /// A vertex that does not exist or comes twice, or a pose that is not finite.
    pub fn hold(&mut self, pose: &[Vec3], held: &[u32], anchor: f32) -> Result<Held, CholeskyError> {
        let mut laplacian = Laplacian::default();
        self.pattern.assemble(&self.triangles, pose, &mut laplacian);
        self.pattern.change_weights(&mut laplacian, |_, weight| weight.clamp(LEAST_WEIGHT, 1e3));
        let mut matrix = self.pattern.matrix(&laplacian);
        matrix.diagonal_mut().iter_mut().for_each(|diagonal| *diagonal += f64::from(anchor));
        let mut constraints = Constraints::new();
        held.iter().for_each(|&vertex| constraints.hard(vertex));
        let factor = ConstrainedFactor::new(&self.symbolic, &matrix, &constraints, &mut self.workspace)?;
        Ok(Held { weights: laplacian.weights().to_vec(), factor, anchor, held: held.to_vec() })
    }

    /// Displacements of the vertices of `pose`: edges turned by the vertices' `turns`, each vertex told to go by `told`, held
    /// vertices by `wanted`.
    ///
    /// # Errors
    /// Lengths that do not fit.
    pub fn solve(
        &mut self,
        held: &Held,
        pose: &[Vec3],
        turns: &[Quat],
        told: &[Vec3],
        wanted: &[Vec3],
    ) -> Result<Vec<Vec3>, CholeskyError> {
        let mut right: Vec<Vec3> = told.iter().map(|&told| told * held.anchor).collect();
        for (&[i, j], &weight) in self.pattern.symmetric().edges().iter().zip(&held.weights) {
            let (i, j) = (i as usize, j as usize);
            let edge = pose[i] - pose[j];
            let change = 0.5 * (turns[i] * edge + turns[j] * edge) - edge;
            // A turn by nothing is nothing, to the bit.
            let is_still = turns[i] == Quat::IDENTITY && turns[j] == Quat::IDENTITY;
            let pull = if is_still { Vec3::ZERO } else { change * weight };
            right[i] += pull;
            right[j] -= pull;
        }
        let mut x: Vec<f32> = right.iter().flat_map(|v| v.to_array()).collect();
        let wanted: Vec<f32> = wanted.iter().flat_map(|v| v.to_array()).collect();
        held.factor.solve(&self.symbolic, &wanted, 3, &mut x, &mut self.scratch)?;
        Ok(x.chunks_exact(3).map(Vec3::from_slice).collect())
    }

    /// As [`Self::solve`] where all vertices have gone by `drawn` beside, and edges are to be as that leaves them.
    ///
    /// # Errors
    /// As there.
    pub(crate) fn solve_over(
        &mut self,
        held: &Held,
        pose: &[Vec3],
        (turns, told): (&[Quat], &[Vec3]),
        drawn: &[Vec3],
        wanted: &[Vec3],
    ) -> Result<Vec<Vec3>, CholeskyError> {
        let left: Vec<Vec3> =
            held.held.iter().zip(wanted).map(|(&vertex, &wanted)| wanted - drawn[vertex as usize]).collect();
        let mut moved = self.solve(held, pose, turns, told, &left)?;
        moved.iter_mut().zip(drawn).for_each(|(moved, &drawn)| *moved += drawn);
        for (&vertex, &wanted) in held.held.iter().zip(wanted) {
            moved[vertex as usize] = wanted;
        }
        Ok(moved)
    }

    /// As [`Self::solve`] for several fields at once in place of a pose, whose held vertices go to nothing: what is added to each.
    /// `changes` says, edge by edge, how the edges turn beside none.
    pub(crate) fn fields(
        &mut self,
        held: &Held,
        fields: &[Vec<Vec3>],
        changes: Option<&[Mat3]>,
    ) -> Result<Vec<Vec<Vec3>>, CholeskyError> {
        let (n, sides) = (self.pattern.symmetric().row_count(), 3 * fields.len());
        let mut x = vec![0.0_f32; n * sides];
        if let Some(changes) = changes {
            let edges = self.pattern.symmetric().edges();
            for ((&[i, j], &change), &weight) in edges.iter().zip(changes).zip(&held.weights) {
                let (i, j) = (i as usize, j as usize);
                for (k, field) in fields.iter().enumerate() {
                    let pull = (change * (field[i] - field[j]) * weight).to_array();
                    for (axis, pull) in pull.into_iter().enumerate() {
                        x[i * sides + 3 * k + axis] += pull;
                        x[j * sides + 3 * k + axis] -= pull;
                    }
                }
            }
        }
        let back = |&vertex: &u32| fields.iter().flat_map(move |field| (-field[vertex as usize]).to_array());
        let wanted: Vec<f32> = held.held.iter().flat_map(back).collect();
        held.factor.solve(&self.symbolic, &wanted, sides, &mut x, &mut self.scratch)?;
        let of = |k: usize| x.chunks_exact(sides).map(move |row| Vec3::from_slice(&row[3 * k..])).collect();
        Ok((0..fields.len()).map(of).collect())
    }

    /// Moves `turns` some steps towards what [`Self::turns`] finds, from where they are: for surfaces that move on little by little.
    pub(crate) fn follow(&self, held: &Held, pose: &[Vec3], displacements: &[Vec3], turns: &mut [Quat], steps: usize) {
        let pattern = self.pattern.symmetric();
        for (i, turn) in turns.iter_mut().enumerate() {
            let mut sum = Mat3::ZERO;
            let (columns, edges) = pattern.row(i);
            for (&j, &edge) in columns.iter().zip(edges) {
                let from = pose[i] - pose[j as usize];
                let to = from + (displacements[i] - displacements[j as usize]);
                let from = from * held.weights[edge as usize];
                sum.x_axis += to * from.x;
                sum.y_axis += to * from.y;
                sum.z_axis += to * from.z;
            }
            *turn = turned_towards(*turn, &sum, steps);
        }
    }

    /// How long edges of `pose` are once displaced beside before: that of which one edge in `one_in` is longer.
    pub(crate) fn nearly_longest(&self, pose: &[Vec3], displacements: &[Vec3], one_in: usize) -> f32 {
        let longer = |&[i, j]: &[u32; 2]| {
            let (i, j) = (i as usize, j as usize);
            let edge = pose[i] - pose[j];
            (edge + (displacements[i] - displacements[j])).length() / edge.length().max(1e-6)
        };
        let mut all: Vec<f32> = self.edges().iter().map(longer).collect();
        let at = all.len().saturating_sub(1 + all.len() / one_in.max(1));
        if all.is_empty() { 1.0 } else { *all.select_nth_unstable_by(at, f32::total_cmp).1 }
    }

    /// The rotation of each vertex that takes its edges in `pose` best to those of `pose` displaced by `displacements`: the
    /// local step of as-rigid-as-possible surfaces.
    #[must_use]
    pub fn turns(&self, held: &Held, pose: &[Vec3], displacements: &[Vec3]) -> Vec<Quat> {
        let pattern = self.pattern.symmetric();
        let moved = |v: usize| pose[v] + displacements[v];
        (0..pose.len())
            .map(|i| {
                let mut sum = DMat3::ZERO;
                let (columns, edges) = pattern.row(i);
                for (&j, &edge) in columns.iter().zip(edges) {
                    let from = (pose[i] - pose[j as usize]).as_dvec3() * f64::from(held.weights[edge as usize]);
                    let to = (moved(i) - moved(j as usize)).as_dvec3();
                    sum += DMat3::from_cols(to * from.x, to * from.y, to * from.z);
                }
                best_rotation(&sum).as_quat()
            })
            .collect()
    }

    /// Vertices within `radius` metres of `from` along the edges of `pose`, and how far each is; infinite beyond.
    #[must_use]
    pub fn distances(&self, pose: &[Vec3], from: &[u32], radius: f32) -> Vec<f32> {
        let pattern = self.pattern.symmetric();
        let mut distances = vec![f32::INFINITY; pose.len()];
        let mut queue = std::collections::BinaryHeap::new();
        for &vertex in from {
            distances[vertex as usize] = 0.0;
            queue.push((std::cmp::Reverse(0_u32), vertex));
        }
        // The bits of a positive float are in its order.
        while let Some((std::cmp::Reverse(bits), vertex)) = queue.pop() {
            let at = f32::from_bits(bits);
            if at > distances[vertex as usize] {
                continue;
            }
            for &other in pattern.row(vertex as usize).0 {
                let next = at + pose[vertex as usize].distance(pose[other as usize]);
                if next < distances[other as usize] && next <= radius {
                    distances[other as usize] = next;
                    queue.push((std::cmp::Reverse(next.to_bits()), other));
                }
            }
        }
        distances
    }

    /// How near vertices of `pose` are to `vertex` along its edges: from 1 there to 0 at `radius` metres.
    pub(crate) fn near(&self, pose: &[Vec3], vertex: u32, radius: f32) -> Vec<(u32, f32)> {
        let distances = self.distances(pose, &[vertex], radius);
        let near =
            distances.iter().enumerate().filter(|(_, distance)| distance.is_finite()).map(|(other, distance)| {
                let u = (distance / radius).clamp(0.0, 1.0);
                (other as u32, 1.0 - u * u * (3.0 - 2.0 * u))
            });
        near.collect()
    }
}

/// Of what is said of one vertex several times only the first stays; there are `count` vertices.
pub(crate) fn once(held: &mut Vec<(u32, Vec3)>, count: usize) {
    let mut seen = vec![false; count];
    held.retain(|(vertex, _)| !std::mem::replace(&mut seen[*vertex as usize], true));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strip() -> (Topology, Vec<Vec3>) {
        let pose: Vec<Vec3> = (0..24).map(|k| Vec3::new((k / 2) as f32 * 0.1, (k % 2) as f32 * 0.1, 0.0)).collect();
        let triangles =
            (0..11).flat_map(|k| [[2 * k, 2 * k + 2, 2 * k + 1], [2 * k + 1, 2 * k + 2, 2 * k + 3]]).collect();
        (Topology::new(24, triangles, vec![1.0; 24]).unwrap(), pose)
    }

    #[test]
    fn nothing_wanted_is_nothing_moved_and_a_turn_of_all_is_a_turn() {
        let (topology, pose) = strip();
        let mut deformer = Deformer::new(&topology, None).unwrap();
        let held = deformer.hold(&pose, &[0, 1, 23], 0.01).unwrap();
        let still = vec![Quat::IDENTITY; 24];
        let zero = vec![Vec3::ZERO; 24];
        let moved = deformer.solve(&held, &pose, &still, &zero, &zero[..3]).unwrap();
        assert!(moved.iter().all(|u| *u == Vec3::ZERO));

        let turn = Quat::from_scaled_axis(Vec3::new(0.4, 1.0, -0.3));
        let told: Vec<Vec3> = pose.iter().map(|&p| turn * p - p).collect();
        let wanted = [told[0], told[1], told[23]];
        let moved = deformer.solve(&held, &pose, &[turn; 24], &told, &wanted).unwrap();
        moved.iter().zip(&told).for_each(|(a, b)| assert!(a.distance(*b) < 1e-4));
        assert_eq!([moved[0], moved[1], moved[23]], wanted);
        let turns = deformer.turns(&held, &pose, &moved);
        // A row of the strip is flat: its vertices know the turn all the same.
        assert!(turns[10].angle_between(turn) < 1e-2);
    }

    #[test]
    fn distances_follow_the_surface() {
        let (topology, pose) = strip();
        let deformer = Deformer::new(&topology, None).unwrap();
        let distances = deformer.distances(&pose, &[0], 0.55);
        assert!((distances[10] - 0.5).abs() < 1e-5 && distances[14].is_infinite());
    }
}
