//! Scanned frames: recorded frames as they were scanned, each with a mesh and an image of its own, or those of a keyframe group.
//!
//! An index says which frames there are. Each group is a section by itself, so that a page can fetch it when its frames are near;
//! all groups lie at the end of the file. What the actor does is told by the registered mesh alone: a reader that skips all this
//! shows that instead.
//!
//! ```text
//! ScannedGroup -> code_group -> CodedGroup -> ScannedFrames -> sections        (writer)
//! sections -> ScannedIndex -> open -> images, mesh -> ScannedGroup             (reader)
//! ```

mod arrived;
mod group;
mod index;
mod mesh;
mod order;

use actor::surface::{Image, ImageFormat};
use glam::Vec3;

pub(super) use arrived::ArrivedScans;
pub use group::{CodedGroup, OpenGroup, code_group};
pub use index::{ScannedFrames, ScannedIndex};
pub use order::ordered;

/// Frames of one group at most that the writer puts together: what a page has to hold at once.
pub const GROUP_FRAMES: usize = 4;

/// Consecutive frames of one mesh, as they were scanned.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScannedGroup {
    /// The first of its frames, counted over the whole capture.
    pub first_frame: u32,
    /// Corners of the drawn mesh: a vertex, and where it lies in the image.
    pub corners: Vec<ScannedCorner>,
    /// Triangles over `corners`.
    pub triangles: Vec<[u32; 3]>,
    /// Vertex positions of each frame, in metres.
    pub poses: Vec<Vec<Vec3>>,
    /// sRGB colours of the vertices; empty where there are images, or no colours.
    pub colours: Vec<[u8; 3]>,
    /// Images, of which each is worn by some frame; none where the colours are those of vertices.
    pub images: Vec<Image>,
    /// Which image each frame wears; empty where there is none.
    pub worn: Vec<u32>,
}

/// A corner of a scanned mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ScannedCorner {
    /// Its vertex.
    pub vertex: u32,
    /// Texture coordinates, v downwards.
    pub uv: [f32; 2],
}

/// What is told of a group before it is there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ScannedHead {
    /// The first of its frames, counted over the whole capture.
    pub first_frame: u32,
    /// How many there are, one after the other.
    pub frames: u32,
    /// Vertices of its mesh.
    pub vertices: u32,
    /// Corners of its mesh.
    pub corners: u32,
    /// Triangles of its mesh.
    pub triangles: u32,
    /// Whether vertices have colours.
    pub coloured: bool,
    /// Format, width and height of its images.
    pub images: Vec<(ImageFormat, u32, u32)>,
    /// Which image each frame wears; empty where there is none.
    pub worn: Vec<u32>,
}
