//! What has arrived of the actor: what stays the same for all frames, and where recorded poses come from.

use std::rc::Rc;

use actor::capture::{Capture, Poses};
use actor::graph::EssentialGraph;
use actor::pose_source::{PoseError, PoseSource};
use actor::surface::{Image, Surface};
use actor::timeline::Timeline;
use bundle::{AlternativesDecoder, BundleError, BundleReader, SectionKind};
use glam::Vec3;
use kernels::topology::Topology;
use synthesis::Varied;

/// What stays the same for all frames.
#[derive(Clone, Debug)]
pub struct Actor {
    /// Its name.
    pub name: String,
    /// Welded connectivity.
    pub topology: Rc<Topology>,
    /// What is drawn; its images may have no bytes yet.
    pub surface: Rc<Surface>,
    /// The sequences.
    pub timeline: Rc<Timeline>,
    /// The frame that it begins with.
    pub first_frame: u32,
}

/// Whose pose a frame has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// That of a recorded frame.
    Recorded,
    /// That of a recorded frame, edited or varied.
    Changed,
    /// It was made, in a transition or elsewhere.
    Made,
}

/// Where recorded poses come from, and what stands in for them.
pub struct Source {
    /// The poses as they were recorded.
    pub recorded: Recorded,
    /// Frames that the page has edited.
    pub edited: Vec<(u32, Vec<Vec3>)>,
    /// Alternatives of recorded stretches, once they are there.
    pub varied: Option<Varied>,
}

/// Where recorded poses come from.
pub enum Recorded {
    /// All in memory.
    Memory(Poses),
    /// A bundle that may still be arriving.
    Bundle(Box<BundleReader>),
}

impl Source {
    fn of(recorded: Recorded) -> Self {
        Self { recorded, edited: Vec::new(), varied: None }
    }

    /// Whether what is read of `frame` now is what was recorded, or was changed.
    #[must_use]
    pub fn origin(&self, frame: u32) -> Origin {
        let varied = self.varied.as_ref().is_some_and(|varied| varied.differs(frame));
        let changed = varied || self.edited.iter().any(|(edited, _)| *edited == frame);
        if changed { Origin::Changed } else { Origin::Recorded }
    }
}

impl PoseSource for Source {
    fn read(&mut self, frame: u32, pose: &mut [Vec3]) -> Result<(), PoseError> {
        match self.edited.iter().find(|(edited, _)| *edited == frame) {
            Some((_, edited)) => pose.copy_from_slice(edited),
            None => {
                self.recorded.read(frame, pose)?;
                if let Some(varied) = &self.varied {
                    varied.add(frame, pose);
                }
            }
        }
        Ok(())
    }

    fn enters(&mut self, frame: u32) -> bool {
        // Edits are of the recording: where there are any, it is shown as it is.
        match &mut self.varied {
            Some(varied) if self.edited.is_empty() => varied.enters(frame),
            Some(varied) => varied.leave(),
            None => false,
        }
    }
}

impl PoseSource for Recorded {
    fn read(&mut self, frame: u32, pose: &mut [Vec3]) -> Result<(), PoseError> {
        match self {
            Self::Memory(poses) => poses.read(frame, pose),
            Self::Bundle(reader) => reader.read(frame, pose),
        }
    }
}

/// How much has arrived.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Nothing that tells anything.
    Empty,
    /// The header.
    Header,
    /// The first pose: it can be drawn.
    FirstPose,
    /// The graph too: it can be directed.
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
    /// Recorded poses, or what stands in for them.
    pub source: Source,
    /// Known from [`Phase::FirstPose`] on.
    pub actor: Option<Actor>,
    /// Known once its section has arrived.
    pub graph: Option<Rc<EssentialGraph>>,
}

impl Default for Loading {
    fn default() -> Self {
        Self { source: Source::of(Recorded::Bundle(Box::default())), actor: None, graph: None }
    }
}

impl Loading {
    /// All of `capture` at once.
    #[must_use]
    pub fn of_capture(capture: Capture, graph: EssentialGraph) -> Self {
        let actor = Actor {
            name: capture.name,
            topology: Rc::new(capture.topology),
            surface: Rc::new(capture.surface),
            timeline: Rc::new(capture.timeline),
            first_frame: 0,
        };
        Self { source: Source::of(Recorded::Memory(capture.poses)), actor: Some(actor), graph: Some(Rc::new(graph)) }
    }

    /// Takes the next bytes of the bundle.
    ///
    /// # Errors
    /// The first thing that is wrong with it, and the same again from then on.
    pub fn push(&mut self, bytes: &[u8]) -> Result<(), BundleError> {
        let Recorded::Bundle(reader) = &mut self.source.recorded else { return Ok(()) };
        let outcome = reader.push(bytes);
        if self.actor.is_none() {
            self.actor = arrived(reader);
        }
        if self.graph.is_none() {
            self.graph = reader.graph().map(|graph| Rc::new(graph.clone()));
        }
        outcome
    }

    /// Says that no more bytes will come.
    ///
    /// # Errors
    /// The bundle is cut off, or was wrong before.
    pub fn finish(&self) -> Result<(), BundleError> {
        match &self.source.recorded {
            Recorded::Memory(_) => Ok(()),
            // Scanned frames may come later, or never.
            Recorded::Bundle(reader) if reader.is_playable() => Ok(()),
            Recorded::Bundle(reader) => reader.finish(),
        }
    }

    /// How much has arrived.
    #[must_use]
    pub fn phase(&self) -> Phase {
        let Recorded::Bundle(reader) = &self.source.recorded else { return Phase::Complete };
        match (&self.actor, &self.graph) {
            _ if reader.is_playable() => Phase::Complete,
            (Some(_), Some(_)) => Phase::Partial,
            (Some(_), None) => Phase::FirstPose,
            (None, _) if reader.header().is_some() => Phase::Header,
            (None, _) => Phase::Empty,
        }
    }

    /// The bundle; `None` where all is in memory.
    #[must_use]
    pub fn reader(&self) -> Option<&BundleReader> {
        match &self.source.recorded {
            Recorded::Memory(_) => None,
            Recorded::Bundle(reader) => Some(reader),
        }
    }

    /// Whether the positions of `frame` have arrived.
    #[must_use]
    pub fn loaded(&self, frame: u32) -> bool {
        match &self.source.recorded {
            Recorded::Memory(poses) => (frame as usize) < poses.len(),
            Recorded::Bundle(reader) => reader.frame_loaded(frame),
        }
    }

    /// Texture `index`, once its bytes have arrived.
    #[must_use]
    pub fn image(&self, index: usize) -> Option<&Image> {
        match &self.source.recorded {
            Recorded::Memory(_) => self.actor.as_ref()?.surface.images.get(index),
            Recorded::Bundle(reader) => reader.image(index),
        }
    }

    /// Whether there are alternatives of recorded stretches, arrived or not.
    #[must_use]
    pub fn varies(&self) -> bool {
        let Recorded::Bundle(reader) = &self.source.recorded else { return false };
        let kinds = [SectionKind::Alternatives, SectionKind::EarlierAlternatives].map(Some);
        let is = |section: &bundle::SectionEntry| kinds.contains(&section.kind);
        reader.header().is_some_and(|header| header.sections.iter().any(is))
    }

    /// A reader of the alternatives of recorded stretches, once they have arrived; they are taken.
    ///
    /// # Errors
    /// They are damaged.
    pub fn take_alternatives(&mut self) -> Result<Option<AlternativesDecoder>, BundleError> {
        match &mut self.source.recorded {
            Recorded::Memory(_) => Ok(None),
            Recorded::Bundle(reader) => reader.take_alternatives(),
        }
    }

    /// The section of the rig, where the bundle has one.
    #[must_use]
    pub fn rig(&self) -> Option<&[u8]> {
        match &self.source.recorded {
            Recorded::Memory(_) => None,
            Recorded::Bundle(reader) => reader.rig_bytes(),
        }
    }

    /// The section of the learned space, where the bundle has one.
    #[must_use]
    pub fn learned(&self) -> Option<&[u8]> {
        match &self.source.recorded {
            Recorded::Memory(_) => None,
            Recorded::Bundle(reader) => reader.learned_bytes(),
        }
    }

    /// The section of families, where the bundle has one.
    #[must_use]
    pub fn families(&self) -> Option<&[u8]> {
        match &self.source.recorded {
            Recorded::Memory(_) => None,
            Recorded::Bundle(reader) => reader.families_bytes(),
        }
    }

    /// The elimination order of the vertices, where the bundle has one.
    #[must_use]
    pub fn order(&self) -> Option<&[u32]> {
        match &self.source.recorded {
            Recorded::Memory(_) => None,
            Recorded::Bundle(reader) => reader.order(),
        }
    }
}

fn arrived(reader: &BundleReader) -> Option<Actor> {
    reader.first_pose()?;
    let meta = reader.meta()?;
    Some(Actor {
        name: meta.name.clone(),
        topology: Rc::new(reader.topology()?.clone()),
        surface: Rc::new(reader.surface()?.clone()),
        timeline: Rc::new(reader.timeline()?.clone()),
        first_frame: meta.first_frame,
    })
}
