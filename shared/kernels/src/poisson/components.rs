//! Where the connected components of a mesh go: each keeps its own centre.

use glam::{DVec3, Vec4};

use crate::topology::Topology;

/// Weights by which each component's centre of mass is taken.
pub(super) struct MeshComponents {
    component_of_vertex: Vec<u32>,
    /// One per vertex; those of a component have a sum of 1.
    weights: Vec<f32>,
    shifts: Vec<DVec3>,
}

impl MeshComponents {
    /// Components of `topology`, weighted as its vertices; evenly where a component's weights are all zero.
    pub fn new(topology: &Topology) -> Self {
        let component_of_vertex = topology.component_of_vertex().to_vec();
        let mut sums = vec![(0.0_f64, 0.0_f64); topology.component_count()];
        for (&component, &weight) in component_of_vertex.iter().zip(topology.weights()) {
            sums[component as usize].0 += f64::from(weight);
            sums[component as usize].1 += 1.0;
        }
        let weights = component_of_vertex
            .iter()
            .zip(topology.weights())
            .map(|(&component, &weight)| match sums[component as usize] {
                (sum, _) if sum > 0.0 => (f64::from(weight) / sum) as f32,
                (_, count) => (1.0 / count) as f32,
            })
            .collect();
        Self { component_of_vertex, weights, shifts: vec![DVec3::ZERO; sums.len()] }
    }

    /// Moves each component so that its centre does not move by `offsets`.
    pub fn centre(&mut self, offsets: &mut [Vec4]) {
        self.shifts.fill(DVec3::ZERO);
        for ((offset, &component), &weight) in offsets.iter().zip(&self.component_of_vertex).zip(&self.weights) {
            self.shifts[component as usize] += offset.truncate().as_dvec3() * f64::from(weight);
        }
        for (offset, &component) in offsets.iter_mut().zip(&self.component_of_vertex) {
            *offset -= self.shifts[component as usize].as_vec3().extend(0.0);
        }
    }
}
