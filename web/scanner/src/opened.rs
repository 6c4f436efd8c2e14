//! The section of a group of scanned frames, as the browser and the stage take it.

use actor::carry::{Carried, Surface};
use bundle::{ScannedCorner, ScannedGroup, ScannedHead, ScannedIndex};
use glam::Vec3;

use crate::carried::carried;
use crate::flow::{colours_of, flow};

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
    /// Which of its images each frame wears; empty where there is none.
    pub worn: Vec<u32>,
    /// Its triangles over vertices, and how many vertices there are.
    over_vertices: (Vec<[u32; 3]>, usize),
}

/// A picture: red, green, blue and opacity of each texel, rows from the top.
#[derive(Clone, Copy, Debug, Default)]
pub struct Picture<'a> {
    /// The texels.
    pub texels: &'a [u8],
    /// Texels in a row.
    pub width: usize,
}

impl Picture<'_> {
    /// The colour at `uv`, 0 to 1; white where there is no picture.
    fn at(&self, [u, v]: [f32; 2]) -> Vec3 {
        let height = self.texels.len() / 4 / self.width.max(1);
        let place = |at: f32, size: usize| ((at * size as f32).max(0.0) as usize).min(size.saturating_sub(1));
        let start = 4 * (place(v, height) * self.width + place(u, self.width));
        let texel = self.texels.get(start..start + 3);
        texel.map_or(Vec3::ONE, |texel| Vec3::new(texel[0].into(), texel[1].into(), texel[2].into()) / 255.0)
    }
}

impl Opened {
    /// Reads the section `bytes`, of which the index tells `words`.
    ///
    /// # Errors
    /// The reason where that is no such section.
    pub fn read(words: &[u32], bytes: &[u8]) -> Result<Self, &'static str> {
        let head = ScannedHead::read(&mut words.iter().copied())?;
        let worn = head.worn.clone();
        let index = ScannedIndex { groups: vec![head] };
        let images = index.open(0, bytes)?.images;
        let group = index.read(0, bytes)?;
        let vertex = |corner: u32| group.corners.get(corner as usize).map_or(0, |corner| corner.vertex);
        let over_vertices = group.triangles.iter().map(|triangle| triangle.map(vertex)).collect();
        Ok(Self {
            worn,
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
        let start = 3 * vertices * frame as usize;
        let scan = self.poses.get(start..start + 3 * vertices).map(points).unwrap_or_default();
        let found = carried(triangles.as_chunks::<3>().0, &points(pose), &scan, Surface::new(own, &scan).normals());
        bytemuck::cast_slice(&found).to_vec()
    }

    /// The colours of the registered mesh's vertices, `count` of them under `triangles`, as a frame has them that wears `picture` and is
    /// `carried`: three numbers each, 0 to 1.
    #[must_use]
    pub fn colours(&self, carried: &[u8], triangles: &[u32], count: usize, picture: Picture<'_>) -> Vec<f32> {
        let mut own = vec![Vec3::ONE; self.over_vertices.1];
        for corner in self.corners.chunks_exact(CORNER_BYTES) {
            let [vertex, u, v, colour, _]: [u32; CORNER_BYTES / 4] = bytemuck::pod_read_unaligned(corner);
            let [r, g, b, _] = colour.to_le_bytes().map(|channel| f32::from(channel) / 255.0);
            if let Some(own) = own.get_mut(vertex as usize) {
                *own = Vec3::new(r, g, b) * picture.at([u, v].map(f32::from_bits));
            }
        }
        let carried: Vec<Carried> =
            carried.chunks_exact(size_of::<Carried>()).map(bytemuck::pod_read_unaligned).collect();
        let found = colours_of(triangles.as_chunks::<3>().0, count, &carried, &own);
        found.iter().flat_map(|colour| colour.to_array()).collect()
    }
}

fn points(numbers: &[f32]) -> Vec<Vec3> {
    numbers.as_chunks::<3>().0.iter().map(|&p| p.into()).collect()
}

/// Where each vertex of the registered mesh, its `triangles` at `pose`, is in the other of two pictures, of which [`Opened::colours`] are
/// given: from the one to the other, and back, as the stage takes it; empty where there is no flow.
#[must_use]
pub fn flows(triangles: &[u32], pose: &[f32], colours: [&[f32]; 2]) -> Vec<u8> {
    let (triangles, pose, [from, to]) = (triangles.as_chunks::<3>().0, points(pose), colours.map(points));
    let there = flow(triangles, &pose, &from, &to);
    let back = flow(triangles, &pose, &to, &from);
    if there.is_empty() || back.is_empty() {
        return Vec::new();
    }
    bytemuck::cast_slice(&[there, back].concat()).to_vec()
}

fn drawn(corner: &ScannedCorner, group: &ScannedGroup) -> [u8; CORNER_BYTES] {
    let [r, g, b] = group.colours.get(corner.vertex as usize).copied().unwrap_or([255; 3]);
    let [u, v] = corner.uv.map(f32::to_bits);
    bytemuck::cast([corner.vertex, u, v, u32::from_le_bytes([r, g, b, 255]), 0].map(u32::to_le))
}
