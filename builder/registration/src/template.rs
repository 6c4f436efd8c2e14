//! The template: the mesh that is moved through all frames, and the deformation graphs that move it.

use super::energy::System;
use super::graph::Graph;
use super::surface::Surface;

/// Area of a person, square metres: what lengths of this crate mean.
const PERSON: f32 = 2.2;
/// Metres between nodes on a person, coarse and fine.
const DISTANCES: [f32; 2] = [0.12, 0.06];
/// Order of nodes.
const SEED: u64 = 2016;

/// A deformation graph with the pattern of its equations.
#[derive(Debug)]
pub struct Level {
    /// The graph.
    pub graph: Graph,
    /// Its equations.
    pub system: System,
}

/// The template with its graphs.
#[derive(Debug)]
pub struct Template {
    /// The template as it was scanned.
    pub surface: Surface,
    /// Metres of this body that are one of a person.
    pub scale: f32,
    /// The coarse and the fine graph.
    pub levels: [Level; 2],
}

impl Template {
    /// The template `surface`; `None` where it has no vertices.
    #[must_use]
    pub fn new(surface: Surface) -> Option<Self> {
        super::energy::alone();
        let scale = scale_of(&surface);
        let level = |distance: f32| -> Option<Level> {
            let graph = Graph::new(&surface.mesh, distance * scale, SEED);
            let system = System::new(&graph)?;
            Some(Level { graph, system })
        };
        let [coarse, fine] = DISTANCES.map(level);
        let levels = [coarse?, fine?];
        Some(Self { surface, scale, levels })
    }
}

/// Metres of a body that are one of a person, by its area.
#[must_use]
pub fn scale_of(surface: &Surface) -> f32 {
    (surface.area() / PERSON).sqrt().max(1e-6)
}
