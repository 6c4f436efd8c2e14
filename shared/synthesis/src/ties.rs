//! Holds the components of a blended frame where they are on each other.
//!
//! Not in the papers. Where a component touches another one it stays, seen from there, between where both sides have it; so it
//! is moved as a whole. Its shape and its turn are those of the in-between, which knows them well: only its place is not
//! known, for no edge leads there.

use actor::ties::Ties;
use glam::{Mat3, Vec3};
use kernels::rotation::least_turn;
use kernels::topology::Topology;

/// Which vertices go with which component, and how heavy components are.
pub(crate) struct Components {
    of_vertex: Vec<u32>,
    weights: Vec<f32>,
    /// Where each component goes, and the one that it goes with in the end.
    shifts: Vec<(Vec3, usize)>,
}

impl Components {
    pub fn of(topology: &Topology) -> Self {
        let mut weights = vec![0.0; topology.component_count()];
        for (&component, weight) in topology.component_of_vertex().iter().zip(topology.weights()) {
            weights[component as usize] += weight;
        }
        Self { of_vertex: topology.component_of_vertex().to_vec(), weights, shifts: Vec::new() }
    }

    /// Moves the components of `pose`, a blend of `sides` with the weight `lambda` of the second one, to where they are tied.
    /// What is tied together keeps its common centre.
    pub fn hold(&mut self, ties: &Ties, sides: &[Vec<Vec3>; 2], lambda: f32, pose: &mut [Vec3]) {
        if ties.all().is_empty() {
            return;
        }
        self.shifts.clear();
        self.shifts.extend((0..self.weights.len()).map(|component| (Vec3::ZERO, component)));
        for tie in ties.all() {
            let [from, to] = [&tie.contact, &tie.patch].map(|end| self.of_vertex[end[0] as usize] as usize);
            let (shift, root) = self.shifts[to];
            let apart = [0, 1].map(|side| {
                let (there, here) = (&sides[side], &*pose);
                rotation(&tie.patch, there, here) * (mean(&tie.contact, there) - mean(&tie.patch, there))
            });
            let wanted = mean(&tie.patch, pose) + shift + apart[0].lerp(apart[1], lambda);
            self.shifts[from] = (wanted - mean(&tie.contact, pose), root);
        }
        // (Sum of weights, weighted sum of shifts) of all that is tied together.
        let mut sums = vec![(0.0_f32, Vec3::ZERO); self.weights.len()];
        for (&(shift, root), &weight) in self.shifts.iter().zip(&self.weights) {
            sums[root].0 += weight;
            sums[root].1 += shift * weight;
        }
        for (shift, root) in &mut self.shifts {
            let (weight, sum) = sums[*root];
            if weight > 0.0 {
                *shift -= sum / weight;
            }
        }
        for (point, &component) in pose.iter_mut().zip(&self.of_vertex) {
            *point += self.shifts[component as usize].0;
        }
    }
}

fn mean(vertices: &[u32], pose: &[Vec3]) -> Vec3 {
    vertices.iter().map(|&vertex| pose[vertex as usize]).sum::<Vec3>() / vertices.len() as f32
}

/// The turn that takes `vertices` from one pose to another.
fn rotation(vertices: &[u32], from: &[Vec3], to: &[Vec3]) -> glam::Quat {
    let [from_mean, to_mean] = [from, to].map(|pose| mean(vertices, pose));
    let mut covariance = Mat3::ZERO;
    for &vertex in vertices {
        let (a, b) = (from[vertex as usize] - from_mean, to[vertex as usize] - to_mean);
        covariance += Mat3::from_cols(b * a.x, b * a.y, b * a.z);
    }
    least_turn(&covariance)
}
