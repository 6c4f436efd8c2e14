//! The capture under evaluation and what several sections need to know of it.

use std::path::PathBuf;
use std::sync::OnceLock;

use actor::capture::Capture;
use actor::contacts::Contacts;
use actor::graph::EssentialGraph;
use actor::timeline::Timeline;
use glam::Vec2;

use super::truth::Truth;
use super::{EvaluateError, EvaluateOptions};
use capture_io::import::{ImportOptions, ManifestFamily, Scratch, import};
use job::{Job, Stopped};
use pipeline::distance::{self, DistanceOptions, Measured};
use pipeline::graph::{GraphOptions, essential_graph};
use pipeline::transitions::{LengthChoice, TransitionMatrix, TransitionOptions, optimal_transitions};

/// A capture with its pose distances, ready to be evaluated.
pub struct Subject {
    /// The capture.
    pub capture: Capture,
    /// Texture files of all frames, where every frame has its own.
    pub textures: Option<Vec<PathBuf>>,
    /// Masks of what no camera saw, one a frame, where there are any.
    pub masks: Vec<Option<PathBuf>>,
    /// Keeps textures alive that were written out for this capture.
    pub scratch: Option<Scratch>,
    /// Families that its manifest asks for.
    pub families: Vec<ManifestFamily>,
    /// Its skeleton's truth, where it came with one.
    pub truth: Option<Truth>,
    /// How it is evaluated.
    pub options: EvaluateOptions,
    pub(super) measured: Measured,
    /// Centres of mass along (X, Z).
    pub(super) centres: Vec<Vec2>,
    /// What its transitions keep still.
    pub(super) contacts: Contacts,
    /// By the choice of lengths.
    transitions: [OnceLock<TransitionMatrix>; LengthChoice::ALL.len()],
}

impl Subject {
    /// Reads a capture, with the truth beside it, and measures its pose distances.
    ///
    /// # Errors
    /// A capture or a truth that cannot be read, or poses without distances.
    pub fn read(
        inputs: &[String],
        import_options: &ImportOptions,
        options: EvaluateOptions,
        job: &Job,
    ) -> Result<Self, EvaluateError> {
        let imported = import(inputs, import_options, job)?;
        let truth = Truth::beside(inputs, &imported.capture.timeline)?;
        let subject = Self::new(imported.capture, truth, options, job)?;
        let (textures, masks, scratch) = (imported.frame_textures, imported.frame_masks, imported.scratch);
        Ok(Self { textures, masks, scratch, families: imported.families, ..subject })
    }

    /// Measures the pose distances of a capture in memory.
    ///
    /// # Errors
    /// Poses without distances.
    pub fn new(
        capture: Capture,
        truth: Option<Truth>,
        options: EvaluateOptions,
        job: &Job,
    ) -> Result<Self, EvaluateError> {
        let measured = distance::measure(&capture.topology, &capture.poses, &DistanceOptions::default(), job)?;
        let centres = capture.poses.ground_centres(capture.topology.weights());
        let (contacts, _) = pipeline::contacts::contacts(&capture.topology, &capture.timeline, &capture.poses);
        Ok(Self {
            contacts,
            capture,
            textures: None,
            masks: Vec::new(),
            scratch: None,
            families: Vec::new(),
            truth,
            options,
            measured,
            centres,
            transitions: Default::default(),
        })
    }

    pub(super) fn timeline(&self) -> &Timeline {
        &self.capture.timeline
    }

    pub(super) fn frame_count(&self) -> usize {
        self.timeline().frame_count() as usize
    }

    /// Transitions with lengths by `choice`.
    pub(super) fn transitions(&self, choice: LengthChoice, job: &Job) -> Result<&TransitionMatrix, EvaluateError> {
        let slot = &self.transitions[choice as usize];
        if let Some(known) = slot.get() {
            return Ok(known);
        }
        let found = self.search(&TransitionOptions { choice, ..self.options.transition }, job)?;
        Ok(slot.get_or_init(|| found))
    }

    /// Transitions as `options` say.
    pub(super) fn search(&self, options: &TransitionOptions, job: &Job) -> Result<TransitionMatrix, EvaluateError> {
        Ok(optimal_transitions(&self.measured.distances, self.timeline(), options, job)?)
    }

    /// The essential graph with lengths by `choice`.
    pub(super) fn graph(&self, choice: LengthChoice, job: &Job) -> Result<EssentialGraph, EvaluateError> {
        let mut options = GraphOptions::default();
        options.transition = TransitionOptions { choice, ..self.options.transition };
        options.alpha = self.options.alpha;
        Ok(essential_graph(&self.capture, &self.measured, &options, job)?.graph)
    }

    pub(super) fn facts(&self) -> Vec<(String, String)> {
        let timeline = self.timeline();
        let fact = |name: &str, value: String| (name.to_owned(), value);
        vec![
            fact("Frames", format!("{} at {} a second", timeline.frame_count(), timeline.fps())),
            fact("Sequences", timeline.sequences().len().to_string()),
            fact("Vertices", self.capture.topology.vertex_count().to_string()),
            fact("Triangles", self.capture.topology.triangles().len().to_string()),
            fact("Segments blended", {
                let transition = &self.options.transition;
                format!("{} to {} s", transition.shortest_seconds, transition.longest_seconds)
            }),
            fact("Weight of a frame, alpha", self.options.alpha.to_string()),
            fact("Skeleton\u{2019}s truth", if self.truth.is_some() { "yes" } else { "no" }.into()),
            fact("Seed", self.options.seed.to_string()),
            fact("Builder", env!("CARGO_PKG_VERSION").into()),
        ]
    }
}

/// Says the share of a stage that is done.
pub(super) fn progress_of<'a>(job: &'a Job, what: &'static str) -> impl Fn(f64) -> Result<(), Stopped> + Sync + 'a {
    move |share| job.share(what, share)
}
