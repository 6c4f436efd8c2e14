//! What has arrived of the actor: what stays the same for all frames, and where recorded poses come from.

use std::rc::Rc;

use glam::Vec3;
use shared::capture::{Capture, Poses};
use shared::graph::EssentialGraph;
use shared::pose_source::{PoseError, PoseSource};
use shared::surface::Surface;
use shared::timeline::Timeline;
use shared::topology::Topology;

/// What stays the same for all frames.
#[derive(Clone, Debug)]
pub struct Actor {
    /// Its name.
    pub name: String,
    /// Welded connectivity.
    pub topology: Rc<Topology>,
    /// What is drawn.
    pub surface: Rc<Surface>,
    /// The sequences.
    pub timeline: Rc<Timeline>,
}

/// Where recorded poses come from.
pub enum Source {
    /// Nothing has arrived.
    Nothing,
    /// All in memory.
    Memory(Poses),
}

impl PoseSource for Source {
    fn read(&mut self, frame: u32, pose: &mut [Vec3]) -> Result<(), PoseError> {
        match self {
            Self::Nothing => Err(PoseError::NotLoaded(frame)),
            Self::Memory(poses) => poses.read(frame, pose),
        }
    }
}

/// How much has arrived.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Phase {
    /// Nothing.
    Empty,
    /// The header.
    Header,
    /// The first pose: it can be drawn.
    FirstPose,
    /// Some of the frames.
    Partial,
    /// All of it.
    Complete,
}

impl Phase {
    /// The page's word for it.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Empty => "empty",
            Self::Header => "header",
            Self::FirstPose => "first-pose",
            Self::Partial => "partial",
            Self::Complete => "complete",
        }
    }
}

/// The bundle as far as it has arrived.
pub struct Loading {
    /// Recorded poses.
    pub source: Source,
    /// Known from [`Phase::FirstPose`] on.
    pub actor: Option<Actor>,
    /// Known once its section has arrived.
    pub graph: Option<Rc<EssentialGraph>>,
    phase: Phase,
}

impl Loading {
    /// Nothing yet.
    #[must_use]
    pub fn new() -> Self {
        Self { source: Source::Nothing, actor: None, graph: None, phase: Phase::Empty }
    }

    /// All of `capture` at once.
    #[must_use]
    pub fn of_capture(capture: Capture, graph: EssentialGraph) -> Self {
        let actor = Actor {
            name: capture.name,
            topology: Rc::new(capture.topology),
            surface: Rc::new(capture.surface),
            timeline: Rc::new(capture.timeline),
        };
        let graph = Some(Rc::new(graph));
        Self { source: Source::Memory(capture.poses), actor: Some(actor), graph, phase: Phase::Complete }
    }

    /// How much has arrived.
    #[must_use]
    pub fn phase(&self) -> Phase {
        self.phase
    }
}

impl Default for Loading {
    fn default() -> Self {
        Self::new()
    }
}
