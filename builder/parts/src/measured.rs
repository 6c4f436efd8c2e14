//! What is measured of a body once.

use actor::capture::Poses;
use glam::Vec3;
use kernels::topology::Topology;

/// Poses in which the surface is measured.
pub const MEASURED: usize = 6;

/// What is measured of a body once.
pub struct Measured {
    /// How far it reaches at most along an axis, in metres.
    pub size: f32,
    /// Mean length of an edge, in metres.
    pub edge: f32,
    /// Area of the surface, in square metres.
    pub area: f32,
    /// Area about each vertex, in square metres.
    pub areas: Vec<f32>,
}

impl Measured {
    pub fn of(topology: &Topology, poses: &Poses, chosen: &[u32]) -> Self {
        let reach = |&frame: &u32| {
            let low = poses.frame(frame).iter().copied().fold(Vec3::INFINITY, Vec3::min);
            (poses.frame(frame).iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max) - low).max_element()
        };
        let pose = chosen.first().map_or(&[][..], |&frame| poses.frame(frame));
        let areas = kernels::topology::barycentric_areas(topology.triangles(), pose);
        let sides = topology.triangles().iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        let edge = sides.map(|[a, b]| pose[a as usize].distance(pose[b as usize])).sum::<f32>();
        Self {
            size: chosen.iter().map(reach).fold(0.0, f32::max),
            edge: edge / (3 * topology.triangles().len()) as f32,
            area: areas.iter().sum(),
            areas,
        }
    }
}

/// Up to `count` frames spread over `frames`.
pub fn spread(frames: usize, count: usize) -> Vec<u32> {
    let count = count.min(frames);
    (0..count).map(|k| ((2 * k + 1) * frames / (2 * count)) as u32).collect()
}
