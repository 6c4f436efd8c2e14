//! A whole capture in memory: what import hands to every later stage of the builder.

use glam::{Vec2, Vec3, Vec3Swizzles};
use thiserror::Error;

use crate::pose_source::{PoseError, PoseSource};
use crate::surface::Surface;
use crate::timeline::Timeline;
use kernels::align::centre_of_mass;
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

/// Why parts are not a capture.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum CaptureError {
    /// There are other numbers of poses than of frames.
    #[error("there are {poses} poses for {frames} frames")]
    FrameCount {
        /// Poses given.
        poses: usize,
        /// Frames of the timeline.
        frames: u32,
    },
    /// The poses are of another mesh.
    #[error("the poses have {poses} vertices, but the mesh has {mesh}")]
    VertexCount {
        /// Vertices of each pose.
        poses: usize,
        /// Vertices of the topology.
        mesh: usize,
    },
    /// A coordinate is not a number, or infinite.
    #[error("frame {frame}, vertex {vertex}: a coordinate is not finite")]
    Position {
        /// The frame.
        frame: u32,
        /// The vertex.
        vertex: u32,
    },
    /// What is drawn does not follow the topology.
    #[error("the surface does not follow the topology: {0}")]
    Surface(&'static str),
    /// A vertex of the file is welded into one that does not exist.
    #[error("vertex {0} of the file is welded into one that does not exist")]
    FileVertex(u32),
}

impl Capture {
    /// A capture of these parts, once they fit together. Its vertices are those of the file, in the file's order;
    /// [`Self::with_file_vertices`] says otherwise.
    ///
    /// # Errors
    /// Parts that do not fit together; see [`CaptureError`].
    pub fn new(
        name: impl Into<String>,
        topology: Topology,
        surface: Surface,
        timeline: Timeline,
        poses: Poses,
    ) -> Result<Self, CaptureError> {
        if poses.vertex_count() != topology.vertex_count() {
            return Err(CaptureError::VertexCount { poses: poses.vertex_count(), mesh: topology.vertex_count() });
        }
        if poses.len() != timeline.frame_count() as usize {
            return Err(CaptureError::FrameCount { poses: poses.len(), frames: timeline.frame_count() });
        }
        for (frame, pose) in poses.iter().enumerate() {
            if let Some(vertex) = pose.iter().position(|position| !position.is_finite()) {
                return Err(CaptureError::Position { frame: frame as u32, vertex: vertex as u32 });
            }
        }
        surface.check(&topology).map_err(CaptureError::Surface)?;
        let vertex_of_file_vertex = (0..topology.vertex_count() as u32).collect();
        Ok(Self { name: name.into(), topology, surface, timeline, poses, vertex_of_file_vertex })
    }

    /// The same with the welded vertex of each vertex of the input files, in the files' order.
    ///
    /// # Errors
    /// A welded vertex that does not exist.
    pub fn with_file_vertices(self, vertex_of_file_vertex: Vec<u32>) -> Result<Self, CaptureError> {
        let beyond = |&vertex: &u32| vertex as usize >= self.topology.vertex_count();
        match vertex_of_file_vertex.iter().position(beyond) {
            Some(vertex) => Err(CaptureError::FileVertex(vertex as u32)),
            None => Ok(Self { vertex_of_file_vertex, ..self }),
        }
    }
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

    /// Centre of mass of every frame as it was recorded, in metres along (X, Z); `weights` are the topology's.
    #[must_use]
    pub fn ground_centres(&self, weights: &[f32]) -> Vec<Vec2> {
        self.iter().map(|pose| centre_of_mass(pose, weights).xz()).collect()
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::timeline::Sequence;

    fn parts() -> (Topology, Surface, Timeline, Poses) {
        let topology = Topology::new(4, vec![[0, 1, 2], [0, 2, 3]], vec![1.0; 4]).unwrap();
        let sequence = Sequence { name: "all".into(), labels: vec![], first_frame: 0, frame_count: 2, cyclic: false };
        let mut poses = Poses::new(4);
        (0..2).for_each(|frame| poses.push(&[Vec3::X, Vec3::Y, Vec3::Z, Vec3::ONE * frame as f32]));
        (topology.clone(), Surface::plain(&topology), Timeline::new(25.0, vec![sequence]).unwrap(), poses)
    }

    #[test]
    fn parts_that_do_not_fit_are_named() {
        let (topology, surface, timeline, poses) = parts();
        let capture = |surface: &Surface, poses: &Poses| {
            Capture::new("square", topology.clone(), surface.clone(), timeline.clone(), poses.clone())
        };
        let whole = capture(&surface, &poses).unwrap();
        assert_eq!(whole.vertex_of_file_vertex, [0, 1, 2, 3]);
        assert_eq!(whole.with_file_vertices(vec![0, 4]).unwrap_err(), CaptureError::FileVertex(1));

        let mut more = poses.clone();
        more.push(&[Vec3::ZERO; 4]);
        assert_eq!(capture(&surface, &more).unwrap_err(), CaptureError::FrameCount { poses: 3, frames: 2 });
        let other = Poses::from_positions(2, vec![Vec3::ZERO; 4]);
        assert_eq!(capture(&surface, &other).unwrap_err(), CaptureError::VertexCount { poses: 2, mesh: 4 });
        let mut broken = poses.iter().flatten().copied().collect::<Vec<_>>();
        broken[6].y = f32::NAN;
        let broken = Poses::from_positions(4, broken);
        assert_eq!(capture(&surface, &broken).unwrap_err(), CaptureError::Position { frame: 1, vertex: 2 });

        let turned = Surface { triangles: vec![[0, 1, 2], [0, 3, 2]], ..surface.clone() };
        assert!(matches!(capture(&turned, &poses), Err(CaptureError::Surface(_))));
        let uncovered = Surface { parts: vec![], ..surface.clone() };
        assert!(matches!(capture(&uncovered, &poses), Err(CaptureError::Surface(_))));
        let bare = Surface { materials: vec![], ..surface };
        assert!(matches!(capture(&bare, &poses), Err(CaptureError::Surface(_))));
    }
}
