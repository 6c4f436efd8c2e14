//! What packing can be told, and why there may be no bundle.

#[cfg(feature = "scans")]
use std::path::PathBuf;

use appearance::{AppearanceError, AppearanceOptions};
use bundle::EncodeError;
use capture_io::import::{ImportError, ImportOptions};
use family::FamilyError;
use job::Stopped;
#[cfg(feature = "variations")]
use motion::vary::VaryOptions;
use pipeline::distance::{DistanceError, DistanceOptions};
use pipeline::graph::{GraphError, GraphOptions};
use pipeline::transitions::TransitionError;
use rig::RigFile;
use thiserror::Error;

use crate::failure::FamilyFailure;
#[cfg(feature = "scans")]
use crate::scans::RegisterError;

/// The frame that the player shows first.
pub(crate) const FIRST_FRAME: u32 = 0;

/// Everything that `builder pack` can be told.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct PackOptions {
    /// How the input is read.
    pub import: ImportOptions,
    /// How pose distances are measured.
    pub distance: DistanceOptions,
    /// How transitions are chosen, and which of them stay.
    pub graph: GraphOptions,
    /// Largest error of a stored vertex position in metres; by the body's height where not given.
    pub max_error: Option<f32>,
    /// What becomes of textures that change from frame to frame.
    pub appearance: AppearanceChoice,
    /// Corrections of the rig that is estimated, by which edits move the body; no rig where not given.
    pub rig: Option<RigFile>,
    /// Whether the parts of the body are found, unless they were painted, and stored for the page to show.
    pub parts: bool,
    /// What the page shows of a scan.
    #[cfg(feature = "scans")]
    pub mode: ScanMode,
    /// What captures are named like that hold frames of a scan which need a mesh of their own; not written where not given.
    #[cfg(feature = "scans")]
    pub others: Option<PathBuf>,
    /// Which sequences get variations; none where not given.
    #[cfg(feature = "variations")]
    pub variations: Option<Variations>,
}

/// What the page shows of a scan, of which every frame has its own mesh.
#[cfg(feature = "scans")]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ScanMode {
    /// The one mesh that all frames were brought onto.
    #[default]
    Global,
    /// In recorded frames the scan's own mesh and image; in transitions and in whatever is edited that one mesh.
    Windows,
}

#[cfg(feature = "variations")]
/// Which sequences get variations, and which.
#[derive(Clone, Debug, Default)]
pub struct Variations {
    /// Names or labels of the sequences; all where there is none.
    pub sequences: Vec<String>,
    /// How they are varied.
    pub options: VaryOptions,
    /// Whether they become sequences of their own, with transitions, instead of alternatives of recorded stretches.
    pub as_sequences: bool,
    /// Whether nobody asked for them: what goes wrong is a warning, and where frames are shown as they were scanned there are none.
    pub usual: bool,
}

#[cfg(feature = "variations")]
impl Variations {
    /// Variations of each sequence, where nothing is said.
    pub const COUNT: usize = 8;

    /// Alternatives of all sequences, as `builder pack` makes them where nothing is said.
    #[must_use]
    pub fn usual() -> Self {
        let mut options = VaryOptions::default();
        options.count = Self::COUNT;
        Self { options, usual: true, ..Self::default() }
    }
}

/// What becomes of textures that change from frame to frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum AppearanceChoice {
    /// The first frame's texture is used for all.
    Static,
    /// They become Eigen textures and Eigen warps.
    Eigen(AppearanceOptions),
}

impl Default for AppearanceChoice {
    fn default() -> Self {
        Self::Eigen(AppearanceOptions::default())
    }
}

/// Why there is no bundle.
#[derive(Debug, Error)]
pub enum PackError {
    /// The input cannot be read as a capture.
    #[error(transparent)]
    Import(#[from] ImportError),
    /// Frames have meshes of their own, and cannot be brought onto one.
    #[cfg(feature = "scans")]
    #[error("frames have meshes of their own, and cannot be brought onto one: {0}")]
    Register(#[from] RegisterError),
    /// The textures of the frames cannot become an appearance.
    #[error(transparent)]
    Appearance(#[from] AppearanceError),
    /// A family that its manifest asks for cannot be made.
    #[error(transparent)]
    Family(#[from] FamilyFailure),
    /// The capture cannot be packed, or not with these options: the sentence says what to do.
    #[error("{0}")]
    Option(String),
    /// The poses cannot be compared.
    #[error(transparent)]
    Distance(#[from] DistanceError),
    /// There is no graph.
    #[error(transparent)]
    Graph(#[from] GraphError),
    /// The bundle cannot hold it.
    #[error(transparent)]
    Encode(#[from] EncodeError),
    /// It was asked to stop: nothing was written.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

impl PackError {
    /// Whether Reprise itself is at fault, not what it was given.
    #[must_use]
    pub fn is_ours(&self) -> bool {
        matches!(self, Self::Graph(GraphError::Build(_)))
    }

    /// Whether it was stopped, in whatever stage.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        #[cfg(feature = "scans")]
        if let Self::Register(error) = self {
            return error.is_stopped();
        }
        matches!(
            self,
            Self::Stopped(_)
                | Self::Import(ImportError::Stopped(_))
                | Self::Appearance(AppearanceError::Stopped(_))
                | Self::Family(FamilyFailure { cause: FamilyError::Stopped(_), .. })
                | Self::Distance(DistanceError::Stopped(_))
                | Self::Graph(GraphError::Stopped(_) | GraphError::Transition(TransitionError::Stopped(_)))
        )
    }
}

impl PackError {
    /// A name for the kind of error that never changes, for scripts and for `builder validate`.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Self::Import(error) => error.code(),
            #[cfg(feature = "scans")]
            Self::Register(error) => error.code(),
            Self::Appearance(_) => "E_APPEARANCE",
            Self::Family(_) => "E_FAMILY",
            Self::Option(_) | Self::Distance(_) | Self::Encode(_) => "E_OPTION",
            Self::Graph(GraphError::Build(_)) => "E_INTERNAL",
            Self::Graph(_) => "E_OPTION",
            Self::Stopped(_) => "E_STOPPED",
        }
    }
}
