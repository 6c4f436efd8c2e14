//! The section of a group of scanned frames, as the browser and the stage take it.

use actor::carry::Surface;
use bundle::{ScannedCorner, ScannedGroup, ScannedHead, ScannedIndex};
use glam::Vec3;

use crate::carried::carried;

/// Bytes of a corner: its vertex, u and v, its colour, and none for the body's part. The twin of the player's `DrawnCorner`.
pub const CORNER_BYTES: usize = 20;

/// A group that was read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Opened {
    /// Where its images lie in the section: beginning and end of each.
    pub images: Vec<u32>,
    /// Its corners, [`CORNER_BYTES`] each.
    pub corners: Vec<u8>,
    /// Its triangles over corners.
    pub triangles: Vec<u32>,
    /// Vertex positions of one frame after the other, in metres.
    pub poses: Vec<f32>,
    /// Its triangles over vertices, and how many vertices there are.
    over_vertices: (Vec<[u32; 3]>, usize),
}

impl Opened {
    /// Reads the section `bytes`, of which the index tells `words`.
    ///
    /// # Errors
    /// The reason where that is no such section.
    pub fn read(words: &[u32], bytes: &[u8]) -> Result<Self, &'static str> {
        let head = ScannedHead::read(&mut words.iter().copied())?;
        let index = ScannedIndex { groups: vec![head] };
        let images = index.open(0, bytes)?.images;
        let group = index.read(0, bytes)?;
        let vertex = |corner: u32| group.corners.get(corner as usize).map_or(0, |corner| corner.vertex);
        let over_vertices = group.triangles.iter().map(|triangle| triangle.map(vertex)).collect();
        Ok(Self {
            over_vertices: (over_vertices, group.poses.first().map_or(0, Vec::len)),
            images: images.into_iter().flat_map(|range| [range.start as u32, range.end as u32]).collect(),
            corners: group.corners.iter().flat_map(|corner| drawn(corner, &group)).collect(),
            triangles: group.triangles.into_iter().flatten().collect(),
            poses: group.poses.iter().flatten().flat_map(|p| p.to_array()).collect(),
        })
    }

    /// How the registered mesh, its `triangles` at `pose`, carries the vertices of frame `frame`, as bytes; empty where it cannot.
    #[must_use]
    pub fn carried(&self, frame: u32, triangles: &[u32], pose: &[f32]) -> Vec<u8> {
        let (own, vertices) = &self.over_vertices;
        let points =
            |numbers: &[f32]| numbers.as_chunks::<3>().0.iter().map(|&p| Vec3::from_array(p)).collect::<Vec<_>>();
        let start = 3 * vertices * frame as usize;
        let scan = self.poses.get(start..start + 3 * vertices).map(points).unwrap_or_default();
        let found = carried(triangles.as_chunks::<3>().0, &points(pose), &scan, Surface::new(own, &scan).normals());
        bytemuck::cast_slice(&found).to_vec()
    }
}

fn drawn(corner: &ScannedCorner, group: &ScannedGroup) -> [u8; CORNER_BYTES] {
    let [r, g, b] = group.colours.get(corner.vertex as usize).copied().unwrap_or([255; 3]);
    let [u, v] = corner.uv.map(f32::to_bits);
    bytemuck::cast([corner.vertex, u, v, u32::from_le_bytes([r, g, b, 255]), 0].map(u32::to_le))
}
