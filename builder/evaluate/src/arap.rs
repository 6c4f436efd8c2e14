//! As-rigid-as-possible in-betweens, plainly, to compare with Poisson interpolation.
//!
//! Sorkine and Alexa, "As-rigid-as-possible surface modeling" (2007). The in-between has the least energy
//! `(1 - lambda) E_source + lambda E_destination`, each the ARAP energy against one end. Local step: per vertex and end,
//! the best rotation; global step: one system. Both ends take the source's cotangent weights, so one factor serves.

use std::collections::HashMap;

use glam::{Mat3, Quat, Vec3, Vec4};
use kernels::cholesky::{CholeskyError, Factor, Symbolic, Workspace};
use kernels::gradients::TriangleBatches;
use kernels::laplacian::{Laplacian, LaplacianPattern};
use kernels::topology::Topology;

/// The in-between stops moving when no vertex goes further than this in an iteration, in metres.
const STILL: f32 = 1e-4;
/// Iterations at most.
const MOST_ITERATIONS: usize = 100;

/// Makes in-betweens over one topology.
pub struct Arap<'a> {
    topology: &'a Topology,
    triangles: TriangleBatches,
    pattern: LaplacianPattern,
    symbolic: Symbolic,
}

/// An in-between and how many iterations it took.
#[derive(Clone, Debug, PartialEq)]
pub struct InBetween {
    /// Vertex positions in metres.
    pub pose: Vec<Vec3>,
    /// Iterations.
    pub iterations: usize,
}

/// Neighbours of each vertex with their weights.
type Neighbours = Vec<Vec<(u32, f32)>>;

impl<'a> Arap<'a> {
    /// For poses of `topology`, vertices eliminated in `order`.
    ///
    /// # Errors
    /// A mesh too large to factorise.
    pub fn new(topology: &'a Topology, order: &[u32]) -> Result<Self, CholeskyError> {
        let triangles = TriangleBatches::new(topology.triangles());
        let pattern = LaplacianPattern::new(topology, &triangles, order)?;
        let symbolic = pattern.symbolic()?;
        Ok(Self { topology, triangles, pattern, symbolic })
    }

    /// The pose at `lambda` between two poses that are aligned; starts from their linear blend.
    ///
    /// # Errors
    /// A pose that is not finite.
    pub fn in_between(&self, source: &[Vec3], destination: &[Vec3], lambda: f32) -> Result<InBetween, CholeskyError> {
        let mut laplacian = Laplacian::default();
        self.pattern.assemble(&self.triangles, source, &mut laplacian);
        let factor = self.symbolic.factorise_regularised(&laplacian, &mut Workspace::default())?;
        let neighbours = neighbours(self.topology, source);
        let blend: Vec<Vec3> = source.iter().zip(destination).map(|(a, b)| a.lerp(*b, lambda)).collect();
        let mut pose = blend.clone();
        let mut turns = [vec![Quat::IDENTITY; pose.len()], vec![Quat::IDENTITY; pose.len()]];
        let ends = [(source, 1.0 - lambda), (destination, lambda)];
        for iteration in 1..=MOST_ITERATIONS {
            for ((end, _), turns) in ends.iter().zip(&mut turns) {
                for vertex in 0..pose.len() {
                    turns[vertex] = best_turn(&neighbours[vertex], end, &pose, vertex, turns[vertex]);
                }
            }
            let next = self.solve(&factor, &neighbours, ends, &turns, &blend);
            let moved = next.iter().zip(&pose).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
            pose = next;
            if moved < STILL || iteration == MOST_ITERATIONS {
                return Ok(InBetween { pose, iterations: iteration });
            }
        }
        Ok(InBetween { pose, iterations: 0 })
    }

    /// The global step; each component's centre stays where the linear blend has it.
    fn solve(
        &self,
        factor: &Factor,
        neighbours: &Neighbours,
        ends: [(&[Vec3], f32); 2],
        turns: &[Vec<Quat>; 2],
        blend: &[Vec3],
    ) -> Vec<Vec3> {
        let mut right = vec![Vec3::ZERO; blend.len()];
        for ((end, share), turns) in ends.into_iter().zip(turns) {
            let matrices: Vec<Mat3> = turns.iter().map(|turn| Mat3::from_quat(*turn)).collect();
            for (k, around) in neighbours.iter().enumerate() {
                for &(l, weight) in around {
                    let edge = end[k] - end[l as usize];
                    right[k] += (matrices[k] * edge + matrices[l as usize] * edge) * (0.5 * weight * share);
                }
            }
        }
        let order = self.pattern.order();
        let free = self.pattern.free_count();
        let mut x: Vec<Vec4> = order[..free].iter().map(|&vertex| right[vertex as usize].extend(0.0)).collect();
        self.symbolic.solve_in_order(factor, &mut x, &mut Vec::new());
        let mut pose = vec![Vec3::ZERO; blend.len()];
        for (&vertex, value) in order.iter().zip(&x) {
            pose[vertex as usize] = value.truncate();
        }
        self.centre(&mut pose, blend);
        pose
    }

    fn centre(&self, pose: &mut [Vec3], blend: &[Vec3]) {
        let component = self.topology.component_of_vertex();
        let mut shifts = vec![(Vec3::ZERO, 0.0_f32); self.topology.component_count()];
        for ((&component, moved), wanted) in component.iter().zip(pose.iter()).zip(blend) {
            let shift = &mut shifts[component as usize];
            *shift = (shift.0 + (*wanted - *moved), shift.1 + 1.0);
        }
        for (&component, moved) in component.iter().zip(pose.iter_mut()) {
            let (sum, count) = shifts[component as usize];
            *moved += sum / count;
        }
    }
}

/// Cotangent weights, half of the sum over both sides of an edge; degenerate triangles have none.
fn neighbours(topology: &Topology, pose: &[Vec3]) -> Neighbours {
    let mut weights: HashMap<(u32, u32), f32> = HashMap::new();
    for corners in topology.triangles() {
        for corner in 0..3 {
            let [o, a, b] = [corners[corner], corners[(corner + 1) % 3], corners[(corner + 2) % 3]];
            let (u, v) = (pose[a as usize] - pose[o as usize], pose[b as usize] - pose[o as usize]);
            let area = u.cross(v).length();
            if area > 1e-14 {
                *weights.entry((a.min(b), a.max(b))).or_default() += 0.5 * u.dot(v) / area;
            }
        }
    }
    let mut neighbours = vec![Vec::new(); pose.len()];
    for ((a, b), weight) in weights {
        neighbours[a as usize].push((b, weight));
        neighbours[b as usize].push((a, weight));
    }
    // A map's order is not fixed, sums are to be.
    neighbours.iter_mut().for_each(|around| around.sort_unstable_by_key(|&(vertex, _)| vertex));
    neighbours
}

/// The rotation that turns the edges of `end` around a vertex best onto those of `pose`, from a guess.
///
/// Müller, Bender, Chentanez and Macklin, "A robust method to extract the rotational part of deformations" (2016).
fn best_turn(around: &[(u32, f32)], end: &[Vec3], pose: &[Vec3], vertex: usize, guess: Quat) -> Quat {
    let mut covariance = Mat3::ZERO;
    for &(other, weight) in around {
        let (to, from) = (pose[vertex] - pose[other as usize], (end[vertex] - end[other as usize]) * weight);
        covariance += Mat3::from_cols(to * from.x, to * from.y, to * from.z);
    }
    let mut turn = guess;
    for _ in 0..30 {
        let r = Mat3::from_quat(turn);
        let cross =
            r.x_axis.cross(covariance.x_axis) + r.y_axis.cross(covariance.y_axis) + r.z_axis.cross(covariance.z_axis);
        let dot = r.x_axis.dot(covariance.x_axis) + r.y_axis.dot(covariance.y_axis) + r.z_axis.dot(covariance.z_axis);
        let omega = cross / (dot.abs() + 1e-12);
        let angle = omega.length();
        if angle < 1e-6 {
            break;
        }
        turn = (Quat::from_axis_angle(omega / angle, angle) * turn).normalize();
    }
    turn
}

#[cfg(test)]
mod tests {
    use kernels::cholesky::elimination_order;
    use kernels::topology::barycentric_areas;

    use super::*;

    /// An octahedron with uneven axes.
    fn octahedron() -> (Topology, Vec<Vec3>) {
        let pose = vec![Vec3::X, -Vec3::X, Vec3::Y * 0.7, Vec3::Y * -0.7, Vec3::Z * 0.5, Vec3::Z * -0.5];
        let mut triangles = Vec::new();
        for (x, y, z) in [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)] {
            triangles.push([x, y, z]);
        }
        let weights = barycentric_areas(&triangles, &pose);
        (Topology::new(6, triangles, weights).unwrap(), pose)
    }

    #[test]
    fn a_turned_body_is_turned_by_half() {
        let (topology, source) = octahedron();
        let order = elimination_order(&topology);
        let arap = Arap::new(&topology, &order).unwrap();
        let turned = |angle: f32| -> Vec<Vec3> {
            source.iter().map(|p| Quat::from_rotation_y(angle) * *p + Vec3::Z * angle).collect()
        };
        let found = arap.in_between(&source, &turned(1.2), 0.5).unwrap();
        let error = found.pose.iter().zip(turned(0.6)).map(|(a, b)| a.distance(b)).fold(0.0, f32::max);
        assert!(error < 1e-3, "{error}");
        let still = arap.in_between(&source, &source, 0.3).unwrap();
        assert!(still.pose.iter().zip(&source).all(|(a, b)| a.distance(*b) < 1e-4));
    }
}
