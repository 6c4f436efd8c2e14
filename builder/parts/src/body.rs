//! All parts of a body.

use actor::capture::Poses;
use geometry::geodesic::SurfaceGraph;
use kernels::topology::Topology;

use crate::band::{self, Limb};
use crate::measured::{MEASURED, Measured, spread};
use crate::painted::{self, Painted};
use crate::{extremities, hinge};

/// Poses whose motion is looked at.
const LOOKED_AT: usize = 60;

/// The parts of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Parts {
    /// The limbs, those first whose ends stand out most from the middle.
    pub limbs: Vec<Limb>,
    /// For each vertex how far it belongs to the torso: what the limbs leave.
    pub torso: Vec<f32>,
    /// The end of the head, where there is one.
    pub head: Option<u32>,
    /// The numbers that parts were painted with, the torso's first; none where they were found.
    pub painted: Vec<u8>,
}

impl Parts {
    /// The parts of a body with these poses.
    #[must_use]
    pub fn find(topology: &Topology, poses: &Poses) -> Self {
        let chosen = spread(poses.len(), MEASURED);
        let body = Measured::of(topology, poses, &chosen);
        let graph = surface_graph(topology, poses, &chosen);
        let Some(found) = extremities::extremities(&graph, topology, poses, &body) else {
            return Self::whole(topology.vertex_count());
        };
        let radii = hinge::hinges(&found, poses, &spread(poses.len(), LOOKED_AT), &body);
        let limbs: Vec<Limb> = found
            .limbs
            .iter()
            .zip(radii)
            .map(|(limb, radius)| band::limb(limb, radius, topology.triangles(), &body))
            .collect();
        let rest = |vertex: usize| 1.0 - limbs.iter().map(|limb| limb.weights[vertex]).sum::<f32>();
        let torso = (0..topology.vertex_count()).map(|vertex| rest(vertex).clamp(0.0, 1.0)).collect();
        Self { limbs, torso, head: found.head, painted: Vec::new() }
    }

    /// The parts that were painted: `of_vertex` has the number of each vertex's part, of which the lowest is the torso's. Parts overlap
    /// where they meet, whichever they are; one that nobody else touches has no band. A mesh of another size is one part.
    #[must_use]
    pub fn of_painted(topology: &Topology, poses: &Poses, of_vertex: &[u8]) -> Self {
        let chosen = spread(poses.len(), MEASURED);
        let body = Measured::of(topology, poses, &chosen);
        let graph = surface_graph(topology, poses, &chosen);
        let painted = painted::painted(&graph, topology, &body, of_vertex);
        painted.map_or_else(
            || Self::whole(topology.vertex_count()),
            |Painted { limbs, torso, numbers }| Self { limbs, torso, head: None, painted: numbers },
        )
    }

    /// For each vertex the part that it belongs to most; the torso is 0.
    #[must_use]
    pub fn of_vertices(&self) -> Vec<usize> {
        let most = |vertex: usize| {
            let weight = |part: usize| self.weights(part)[vertex];
            // The first of parts that are alike.
            (0..self.count()).rev().max_by(|&a, &b| weight(a).total_cmp(&weight(b))).unwrap_or(0)
        };
        (0..self.torso.len()).map(most).collect()
    }

    /// One part: the whole body.
    #[must_use]
    pub fn whole(vertex_count: usize) -> Self {
        Self { limbs: Vec::new(), torso: vec![1.0; vertex_count], head: None, painted: Vec::new() }
    }

    /// Number of parts, the torso among them.
    #[must_use]
    pub fn count(&self) -> usize {
        self.limbs.len() + 1
    }

    /// How far each vertex belongs to a part: the torso is part 0. The weights of all parts at a vertex add up to 1.
    #[must_use]
    pub fn weights(&self, part: usize) -> &[f32] {
        part.checked_sub(1).map_or(&self.torso, |limb| &self.limbs[limb].weights)
    }
}

/// The graph of the surface, with lengths as they are on average in some frames.
fn surface_graph(topology: &Topology, poses: &Poses, frames: &[u32]) -> SurfaceGraph {
    let mean = |a: u32, b: u32| {
        let length = |&frame: &u32| {
            let pose = poses.frame(frame);
            pose[a as usize].distance(pose[b as usize])
        };
        frames.iter().map(length).sum::<f32>() / frames.len().max(1) as f32
    };
    SurfaceGraph::new(topology.vertex_count(), topology.triangles(), &[], mean)
        .with_diagonals(topology.triangles(), mean)
}
