//! A whole capture in memory: what import hands to every later stage of the builder.

use glam::Vec3;

use crate::pose_source::{PoseError, PoseSource};
use crate::surface::Surface;
use crate::timeline::Timeline;
use kernels::topology::Topology;

/// Textured mesh sequences of one subject over one topology.
#[derive(Clone, Debug, PartialEq)]
pub struct Capture {
    /// Name of the subject.
    pub name: String,
    /// Welded connectivity.
    pub topology: Topology,
    /// What is drawn.
    pub surface: Surface,
    /// The sequences.
    pub timeline: Timeline,
    /// Vertex positions of every frame.
    pub poses: Poses,
    /// Welded vertex of each vertex of the input files, in the files' order.
    pub vertex_of_file_vertex: Vec<u32>,
}

/// Vertex positions of many frames over one topology, in metres, +Y up; frame after frame in one block.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Poses {
    vertex_count: usize,
    positions: Vec<Vec3>,
}

impl Poses {
    /// No frames yet, of `vertex_count` vertices each.
    #[must_use]
    pub fn new(vertex_count: usize) -> Self {
        Self { vertex_count, positions: Vec::new() }
    }

    /// Frames of `vertex_count` vertices each that lie one after the other in `positions`; no copy is made.
    ///
    /// # Panics
    /// Where `positions` are not whole frames.
    #[must_use]
    pub fn from_positions(vertex_count: usize, positions: Vec<Vec3>) -> Self {
        assert!(positions.len().is_multiple_of(vertex_count), "positions must be whole frames");
        Self { vertex_count, positions }
    }

    /// Appends a frame.
    ///
    /// # Panics
    /// Where `pose` has another number of vertices.
    pub fn push(&mut self, pose: &[Vec3]) {
        assert_eq!(pose.len(), self.vertex_count, "a pose of another topology");
        self.positions.extend_from_slice(pose);
    }

    /// Number of frames.
    #[must_use]
    pub fn len(&self) -> usize {
        self.positions.len().checked_div(self.vertex_count).unwrap_or(0)
    }

    /// Whether there is no frame.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// Number of vertices N of each frame.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    /// Vertex positions of frame `frame`, which must exist.
    #[must_use]
    pub fn frame(&self, frame: u32) -> &[Vec3] {
        let start = frame as usize * self.vertex_count;
        &self.positions[start..start + self.vertex_count]
    }

    /// All frames, in order.
    pub fn iter(&self) -> impl Iterator<Item = &[Vec3]> {
        self.positions.chunks_exact(self.vertex_count.max(1))
    }
}

impl PoseSource for Poses {
    fn read(&mut self, frame: u32, pose: &mut [Vec3]) -> Result<(), PoseError> {
        if frame as usize >= self.len() {
            return Err(PoseError::OutOfRange(frame));
        }
        pose.copy_from_slice(self.frame(frame));
        Ok(())
    }
}
