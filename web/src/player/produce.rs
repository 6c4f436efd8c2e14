//! Makes frames: recorded ones placed in the world.

use glam::{Vec2, Vec3};
use shared::align::{Placement, align_heading, centre_of_mass};
use shared::pose_source::{PoseError, PoseSource};
use shared::topology::Topology;

/// Where a frame comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum At {
    /// It was recorded.
    Recorded(u32),
    /// It was synthesised.
    Synthetic {
        /// Index of the transition in the graph.
        edge: u32,
        /// Weight of the destination, 0 to 1.
        lambda: f32,
        /// The recorded frame of the source side.
        source: u32,
        /// The recorded frame of the destination side.
        destination: u32,
    },
}

impl At {
    /// The recorded frame that it is, or is nearer to.
    #[must_use]
    pub fn frame(self) -> u32 {
        match self {
            Self::Recorded(frame) => frame,
            Self::Synthetic { lambda, source, destination, .. } => {
                if lambda < 0.5 {
                    source
                } else {
                    destination
                }
            }
        }
    }

    /// Whether it was synthesised.
    #[must_use]
    pub fn is_synthetic(self) -> bool {
        matches!(self, Self::Synthetic { .. })
    }
}

/// A frame as it is shown.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Equal numbers are equal poses.
    pub number: u64,
    /// World positions, metres, one per welded vertex.
    pub pose: Vec<Vec3>,
    /// Where it comes from.
    pub at: At,
    /// The world from the recorded pose (of the nearer side in a transition).
    pub placement: Placement,
    /// The centre of mass on the ground (X, Z), metres.
    pub ground: Vec2,
}

/// Makes numbered frames.
#[derive(Clone, Debug, Default)]
pub struct Producer {
    made: u64,
}

impl Producer {
    /// Recorded frame `frame`, placed by `placement`.
    ///
    /// # Errors
    /// A frame that cannot be read.
    pub fn recorded(
        &mut self,
        source: &mut impl PoseSource,
        topology: &Topology,
        frame: u32,
        placement: Placement,
    ) -> Result<Frame, PoseError> {
        let mut pose = vec![Vec3::ZERO; topology.vertex_count()];
        source.read(frame, &mut pose)?;
        placement.apply_all(&mut pose);
        Ok(self.finish(topology, pose, At::Recorded(frame), placement))
    }

    fn finish(&mut self, topology: &Topology, pose: Vec<Vec3>, at: At, placement: Placement) -> Frame {
        let centre = centre_of_mass(&pose, topology.weights());
        self.made += 1;
        Frame { number: self.made, pose, at, placement, ground: Vec2::new(centre.x, centre.z) }
    }
}

/// The placement that puts `recorded` where `shown` stands, and turns it like that unless `heading` says how.
#[must_use]
pub fn placed_like(shown: &Frame, recorded: &[Vec3], topology: &Topology, heading: Option<f32>) -> Placement {
    let heading = heading.unwrap_or_else(|| align_heading(&shown.pose, recorded, topology.weights()));
    let centre = centre_of_mass(recorded, topology.weights());
    Placement::turning(heading, Vec2::new(centre.x, centre.z), shown.ground)
}
