//! `builder evaluate`: the papers' evaluations again, on any capture.
//!
//! Boukhayma and Boyer, TVCG, figures 7, 9, 11, 12, 22 and table 1; thesis sections 2.3.2, 2.5.5, 3.3.4, 3.5.2 and 4.5;
//! Prada and others (2016), section 7.1. Each section is a file or folder of its own that takes the [`Subject`] and
//! returns a [`SectionReport`]; the page, CSV and JSON are made from those. Everything but the times is a function of
//! the capture, the options and the seed.
//!
//! ```text
//! capture, truth -> subject -> sections -> document -> page, CSV, JSON
//! ```

mod acceleration;
pub mod arap;
mod blended;
mod blending;
mod body;
pub mod clay;
mod contacts;
pub mod document;
mod editing;
mod escape;
mod families;
mod graphs;
pub mod html;
mod interpolation;
mod motion;
mod performance;
pub mod plot;
mod poses;
mod scaling;
pub mod scanned;
pub mod scans;
mod seams;
mod seen;
pub mod short;
pub mod statistics;
mod subject;
pub mod textures;
mod trajectories;
mod transferred;
mod transitions;
pub mod truth;
mod variations;
mod walks;
mod wandering;

use thiserror::Error;

pub use self::document::{Document, SectionReport};
pub use self::subject::Subject;
use appearance::AppearanceError;
use capture_io::export::ExportError;
use capture_io::import::ImportError;
use job::Job;
use pipeline::distance::DistanceError;
use pipeline::essential::{BuildError, EssentialError};
use pipeline::graph::GraphError;
use pipeline::transitions::{TransitionError, TransitionOptions};

/// A section of the evaluation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Section {
    /// 1: pose distance against the skeleton's truth.
    Poses,
    /// 2: transitions.
    Transitions,
    /// 3: essential graph against motion graph.
    Graphs,
    /// 4: blending, foot skate and seams.
    Blending,
    /// 5: interpolation.
    Interpolation,
    /// 6: walks along paths and through poses at times.
    Walks,
    /// 7: size, speed and scaling.
    Scaling,
    /// 8: eigen appearance maps.
    Appearance,
    /// 9: what walks look like.
    Motion,
    /// 10: wandering.
    Wandering,
    /// 11: transfer, on the built-in performers: only where it is asked for.
    Transfer,
    /// 12: families of cycles: only where it is asked for, for it makes performers of its own.
    Families,
    /// 13: variations: only where they are asked for.
    Variations,
    /// 14: edits, rigs and driven sequences: only where they are asked for.
    Editing,
    /// 15: a scan brought onto one mesh: only by [`scanned::evaluate_scan`], for it takes no capture.
    Scans,
}

impl Section {
    /// All sections about a capture, in order.
    pub const ALL: [Self; 10] = [
        Self::Poses,
        Self::Transitions,
        Self::Graphs,
        Self::Blending,
        Self::Interpolation,
        Self::Walks,
        Self::Scaling,
        Self::Appearance,
        Self::Motion,
        Self::Wandering,
    ];

    /// Its number.
    #[must_use]
    pub fn number(self) -> u8 {
        self as u8 + 1
    }

    /// Its title.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Poses => "Pose distance against the skeleton",
            Self::Transitions => "Transitions",
            Self::Graphs => "Essential graph against motion graph",
            Self::Blending => "Blending",
            Self::Interpolation => "Interpolation",
            Self::Walks => "Walks",
            Self::Scaling => "Size and speed",
            Self::Appearance => "Appearance",
            Self::Motion => "What walks look like",
            Self::Wandering => "Wandering",
            Self::Transfer => "Transfer between performers",
            Self::Families => "Families of cycles",
            Self::Variations => "Variations",
            Self::Editing => "Edits, rigs and driven sequences",
            Self::Scans => "Scans",
        }
    }
}

/// What is evaluated, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct EvaluateOptions {
    /// The sections to make, in this order.
    pub sections: Vec<Section>,
    /// Seed of everything that is drawn at random.
    pub seed: u64,
    /// Permutations of Mantel's test.
    pub permutations: usize,
    /// Transitions of each graph whose seams are measured, drawn at random where there are more.
    pub seam_transitions: usize,
    /// Transitions as the actor would have them.
    pub transition: TransitionOptions,
    /// Weight of a frame's duration.
    pub alpha: f64,
    /// Clips of motion capture by which the actor is driven, as `builder drive` takes them.
    pub clips: Vec<String>,
}

impl Default for EvaluateOptions {
    fn default() -> Self {
        Self {
            sections: Section::ALL.to_vec(),
            seed: 1,
            permutations: 10_000,
            seam_transitions: 1_000,
            transition: TransitionOptions::default(),
            alpha: actor::graph::DEFAULT_ALPHA,
            clips: Vec::new(),
        }
    }
}

/// Why a capture could not be evaluated.
#[derive(Debug, Error)]
pub enum EvaluateError {
    /// It was asked to stop.
    #[error(transparent)]
    Stopped(#[from] job::Stopped),
    /// The capture cannot be read.
    #[error(transparent)]
    Import(#[from] ImportError),
    /// The ground truth beside the capture cannot be read.
    #[error(transparent)]
    Truth(#[from] truth::TruthError),
    /// No pose distances.
    #[error(transparent)]
    Distance(#[from] DistanceError),
    /// No transitions.
    #[error(transparent)]
    Transition(#[from] TransitionError),
    /// No essential graph.
    #[error(transparent)]
    Essential(#[from] EssentialError),
    /// The graph could not be built: a fault of ours.
    #[error("the graph cannot be built: {0}")]
    Build(#[from] BuildError),
    /// There is no graph.
    #[error(transparent)]
    Graph(#[from] GraphError),
    /// Textures of frames that no appearance can be made of.
    #[error(transparent)]
    Appearance(#[from] AppearanceError),
    /// A picture of the actor could not be drawn.
    #[error("the actor cannot be drawn: {0}")]
    Drawing(#[from] ExportError),
    /// Poses could not be interpolated: a fault of ours.
    #[error("poses cannot be interpolated: {0}")]
    Interpolation(#[from] kernels::cholesky::CholeskyError),
    /// A picture could not be encoded: a fault of ours.
    #[error("a picture cannot be encoded: {0}")]
    Picture(image::ImageError),
    /// A walk leaves the graph: a fault of ours.
    #[error("a walk cannot be shown: {0}")]
    Walk(#[from] actor::walk::WalkError),
    /// Performers could not be made to move as each other: a fault of ours.
    #[error("performers cannot be transferred: {0}")]
    Transfer(#[from] transfer::TransferError),
    /// What the performer does could not be made a family: a fault of ours.
    #[error("performed cycles are no family: {0}")]
    Family(family::FamilyError),
    /// A scan cannot be brought onto one mesh.
    #[error(transparent)]
    Register(#[from] reprise::scans::RegisterError),
    /// There is no folder to write into.
    #[error("no temporary folder can be made: {0}")]
    Folder(String),
    /// A frame could not be edited: a fault of ours.
    #[error("an edit cannot be made: {0}")]
    Edit(String),
    /// The size of a bundle could not be measured: a fault of ours.
    #[error("a bundle cannot be made: {0}")]
    Bundle(#[from] bundle::EncodeError),
    /// A frame could not be placed: a fault of ours.
    #[error("a transition cannot be placed: {0}")]
    Pose(#[from] actor::pose_source::PoseError),
}

impl EvaluateError {
    /// Whether it was stopped, in whatever stage.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        if let Self::Register(error) = self {
            return error.is_stopped();
        }
        matches!(
            self,
            Self::Stopped(_)
                | Self::Transfer(transfer::TransferError::Stopped(_))
                | Self::Family(family::FamilyError::Stopped(_))
                | Self::Import(ImportError::Stopped(_))
                | Self::Distance(DistanceError::Stopped(_))
                | Self::Transition(TransitionError::Stopped(_))
                | Self::Graph(GraphError::Stopped(_) | GraphError::Transition(TransitionError::Stopped(_)))
                | Self::Appearance(AppearanceError::Stopped(_))
        )
    }

    /// Whether the input, not the builder, is at fault.
    #[must_use]
    pub fn is_input(&self) -> bool {
        !matches!(
            self,
            Self::Build(_)
                | Self::Graph(GraphError::Build(_))
                | Self::Interpolation(_)
                | Self::Picture(_)
                | Self::Walk(_)
                | Self::Transfer(_)
                | Self::Family(_)
                | Self::Bundle(_)
                | Self::Edit(_)
                | Self::Pose(_)
        )
    }
}

/// Evaluates a capture.
///
/// # Errors
/// A capture that has no distances or transitions.
pub fn evaluate(subject: &Subject, job: &Job) -> Result<Document, EvaluateError> {
    let sections = subject.options.sections.iter().map(|&section| {
        let made = match section {
            Section::Poses => poses::section(subject, job),
            Section::Transitions => transitions::section(subject, job),
            Section::Graphs => graphs::section(subject, job),
            Section::Blending => blending::section(subject, job),
            Section::Interpolation => interpolation::section(subject, job),
            Section::Walks => walks::section(subject, job),
            Section::Scaling => scaling::section(subject, job),
            Section::Appearance => textures::section(subject, job),
            Section::Motion => motion::section(subject, job),
            Section::Wandering => wandering::section(subject, job),
            Section::Transfer => transferred::section(subject.options.seed, job),
            Section::Families => families::section(subject, job),
            Section::Variations => variations::section(subject, job),
            Section::Editing => editing::section(subject, job),
            Section::Scans => Ok(missing("a scan is evaluated by itself, not with a capture of one mesh")),
        };
        made.map(|made| SectionReport { number: section.number(), title: section.title().into(), ..made })
    });
    Ok(Document {
        title: format!("{}: evaluation", subject.capture.name),
        lead: "The evaluations of \u{201c}Surface Motion Capture Animation Synthesis\u{201d} (Boukhayma and Boyer) \
               and of Boukhayma\u{2019}s thesis, made again on this capture."
            .into(),
        sections: sections.collect::<Result<_, _>>()?,
        facts: subject.facts(),
    })
}

/// A section that could not be made.
fn missing(why: &str) -> SectionReport {
    SectionReport { missing: Some(why.to_owned()), ..SectionReport::default() }
}
