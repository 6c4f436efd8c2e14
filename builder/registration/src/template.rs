//! The template: the mesh that is moved through all frames, and the deformation graphs that move it.

use std::sync::Arc;

use glam::Vec3;

use super::energy::System;
use super::graph::Graph;
use super::scan::Cleaned;
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
    pub levels: Arc<[Level; 2]>,
    /// Triangles of its frame that are no part of it: edges of theirs had a triangle on each side already.
    pub left_out: usize,
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
        let levels = Arc::new([coarse?, fine?]);
        Some(Self { surface, scale, levels, left_out: 0 })
    }

    /// The template of a frame: what of its surface is manifold ([`Cleaned::manifold`]); `None` where that has no vertices.
    #[must_use]
    pub fn of(frame: &Cleaned) -> Option<Self> {
        let surface = frame.manifold();
        let left_out = frame.surface.mesh.triangles.len() - surface.mesh.triangles.len();
        Some(Self { left_out, ..Self::new(surface)? })
    }

    /// The same template with other colours of its vertices, or none; it shares the graphs.
    #[must_use]
    pub fn coloured(&self, colours: Option<Vec<Vec3>>) -> Self {
        let mut surface = self.surface.clone();
        surface.colours = colours;
        Self { surface, levels: Arc::clone(&self.levels), ..*self }
    }
}

/// Metres of a body that are one of a person, by its area.
#[must_use]
pub fn scale_of(surface: &Surface) -> f32 {
    (surface.area() / PERSON).sqrt().max(1e-6)
}

#[cfg(test)]
mod tests {
    use geometry::polygonise::polygonise;
    use glam::Vec3;

    use super::*;
    use crate::scan::Scan;

    #[test]
    fn triangles_that_are_no_part_of_a_template_are_counted() {
        let ball = polygonise(Vec3::splat(-0.7), Vec3::splat(0.7), 0.1, |p| p.length() - 0.5);
        let left_out = |fins: usize| {
            let mut scan =
                Scan { positions: ball.positions.clone(), triangles: ball.triangles.clone(), ..Scan::default() };
            for &[a, b, _] in ball.triangles.iter().step_by(40).take(fins) {
                scan.triangles.push([a, b, scan.positions.len() as u32]);
                scan.positions.push(ball.positions[a as usize] * 1.2);
            }
            let template = Template::of(&scan.cleaned().unwrap()).unwrap();
            template.surface.mesh.check_closed().unwrap();
            template.left_out
        };
        assert_eq!([left_out(0), left_out(3)], [0, 3]);
    }
}
