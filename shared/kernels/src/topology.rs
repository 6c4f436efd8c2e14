//! The connectivity that every pose of a capture shares, welded: one vertex per point of the surface.

use glam::Vec3;
use thiserror::Error;

use crate::components::connected_components;

/// Triangles over welded vertices, and the vertex weights of the planar alignment.
///
/// Distances, Laplacians and Poisson solves run on this; drawing runs on `actor::surface::Surface`, whose corners
/// point back here.
#[derive(Clone, Debug, PartialEq)]
pub struct Topology {
    vertex_count: u32,
    triangles: Vec<[u32; 3]>,
    weights: Vec<f32>,
    component_of_vertex: Vec<u32>,
    component_count: usize,
}

/// Why triangles and weights are not a topology.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum TopologyError {
    /// There is no vertex or no triangle.
    #[error("the mesh has no vertex or no triangle")]
    Empty,
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} names vertex {vertex}, but there are only {vertex_count}")]
    IndexOutOfRange {
        /// The triangle.
        triangle: usize,
        /// The vertex that it names.
        vertex: u32,
        /// The number of vertices.
        vertex_count: u32,
    },
    /// The number of weights is not the number of vertices.
    #[error("there are {weights} vertex weights for {vertices} vertices")]
    WeightCount {
        /// Weights given.
        weights: usize,
        /// Vertices of the mesh.
        vertices: u32,
    },
    /// A weight is negative or not finite, or all are zero.
    #[error("vertex weights must be finite, not negative, and not all zero")]
    Weights,
}

impl Topology {
    /// A topology of `vertex_count` vertices. `weights` hold one value per vertex and are scaled to a sum of 1.
    ///
    /// # Errors
    /// An empty mesh, an index out of range, or weights that do not fit.
    pub fn new(vertex_count: u32, triangles: Vec<[u32; 3]>, mut weights: Vec<f32>) -> Result<Self, TopologyError> {
        if vertex_count == 0 || triangles.is_empty() {
            return Err(TopologyError::Empty);
        }
        for (triangle, corners) in triangles.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|&&vertex| vertex >= vertex_count) {
                return Err(TopologyError::IndexOutOfRange { triangle, vertex, vertex_count });
            }
        }
        if weights.len() != vertex_count as usize {
            return Err(TopologyError::WeightCount { weights: weights.len(), vertices: vertex_count });
        }
        let sum: f64 = weights.iter().map(|&w| f64::from(w)).sum();
        if !(sum.is_finite() && sum > 0.0) || weights.iter().any(|&w| w < 0.0) {
            return Err(TopologyError::Weights);
        }
        for weight in &mut weights {
            *weight = (f64::from(*weight) / sum) as f32;
        }
        let sides = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [a, c]]);
        let (component_of_vertex, component_count) = connected_components(vertex_count as usize, sides);
        Ok(Self { vertex_count, triangles, weights, component_of_vertex, component_count })
    }

    /// Number of welded vertices N.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.vertex_count as usize
    }

    /// The M triangles, counter-clockwise seen from outside.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Weights of the planar alignment, one per vertex, with a sum of 1.
    #[must_use]
    pub fn weights(&self) -> &[f32] {
        &self.weights
    }

    /// The connected component of each vertex, numbered by first vertex. A vertex of no triangle is its own component.
    #[must_use]
    pub fn component_of_vertex(&self) -> &[u32] {
        &self.component_of_vertex
    }

    /// Number of connected components.
    #[must_use]
    pub fn component_count(&self) -> usize {
        self.component_count
    }
}

/// Barycentric vertex areas in square metres: a third of the area of each triangle to each of its corners.
///
/// The default weights of the planar alignment, taken in the first frame.
#[must_use]
pub fn barycentric_areas(triangles: &[[u32; 3]], pose: &[Vec3]) -> Vec<f32> {
    let mut areas = vec![0.0; pose.len()];
    for corners in triangles {
        let [a, b, c] = corners.map(|vertex| pose[vertex as usize]);
        let third = (b - a).cross(c - a).length() / 6.0;
        for &vertex in corners {
            areas[vertex as usize] += third;
        }
    }
    areas
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn components_are_numbered_by_first_vertex() {
        let triangles = vec![[4, 5, 6], [0, 2, 3], [6, 5, 7]];
        let topology = Topology::new(8, triangles, vec![1.0; 8]).unwrap();
        assert_eq!(topology.component_of_vertex(), [0, 1, 0, 0, 2, 2, 2, 2]);
        assert_eq!(topology.component_count(), 3);
        assert!((topology.weights().iter().sum::<f32>() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn refuses_bad_indices_and_weights() {
        let bad = TopologyError::IndexOutOfRange { triangle: 0, vertex: 3, vertex_count: 3 };
        assert_eq!(Topology::new(3, vec![[0, 1, 3]], vec![1.0; 3]), Err(bad));
        assert_eq!(Topology::new(3, vec![[0, 1, 2]], vec![0.0; 3]), Err(TopologyError::Weights));
        assert_eq!(Topology::new(3, vec![[0, 1, 2]], vec![f32::NAN; 3]), Err(TopologyError::Weights));
        assert_eq!(Topology::new(3, vec![[0, 1, 2]], vec![2.0, 1.0, -1.0]), Err(TopologyError::Weights));
    }
}
