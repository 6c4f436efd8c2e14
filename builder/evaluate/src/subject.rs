//! The capture under evaluation and what several sections need to know of it.

use std::path::PathBuf;
use std::sync::OnceLock;

use actor::capture::Capture;
use actor::contacts::Contacts;
use actor::graph::EssentialGraph;
use actor::timeline::Timeline;
use glam::{Vec2, Vec3Swizzles};
use kernels::align::centre_of_mass;

use super::truth::Truth;
use super::{EvaluateError, EvaluateOptions};
use capture_io::import::{ImportOptions, import};
use job::progress::{Progress, Report};
use pipeline::distance::{self, DistanceOptions, Measured};
use pipeline::essential::{self, Findings};
use pipeline::transitions::{LengthChoice, TransitionMatrix, TransitionOptions, optimal_transitions};

/// A capture with its pose distances, ready to be evaluated.
pub struct Subject {
    /// The capture.
    pub capture: Capture,
    /// Texture files of all frames, where every frame has its own.
    pub textures: Option<Vec<PathBuf>>,
    /// Masks of what no camera saw, one a frame, where there are any.
    pub masks: Vec<Option<PathBuf>>,
    /// Its skeleton's truth, where it came with one.
    pub truth: Option<Truth>,
    /// How it is evaluated.
    pub options: EvaluateOptions,
    pub(super) measured: Measured,
    /// Centres of mass along (X, Z).
    pub(super) centres: Vec<Vec2>,
    /// What its transitions keep still.
    pub(super) contacts: Contacts,
    total: OnceLock<TransitionMatrix>,
    mean: OnceLock<TransitionMatrix>,
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
        report: Report,
    ) -> Result<Self, EvaluateError> {
        let imported = import(inputs, import_options, &|step| report(step))?;
        let truth = Truth::beside(inputs, &imported.capture.timeline)?;
        let subject = Self::new(imported.capture, truth, options, report)?;
        Ok(Self { textures: imported.frame_textures, masks: imported.frame_masks, ..subject })
    }

    /// Measures the pose distances of a capture in memory.
    ///
    /// # Errors
    /// Poses without distances.
    pub fn new(
        capture: Capture,
        truth: Option<Truth>,
        options: EvaluateOptions,
        report: Report,
    ) -> Result<Self, EvaluateError> {
        let told = told(report, "pose distances");
        let measured = distance::measure(&capture.topology, &capture.poses, &DistanceOptions::default(), &told)?;
        let weights = capture.topology.weights();
        let centres = capture.poses.iter().map(|pose| centre_of_mass(pose, weights).xz()).collect();
        let contacts = pipeline::contacts::contacts(&capture.topology, &capture.timeline, &capture.poses);
        Ok(Self {
            contacts,
            capture,
            textures: None,
            masks: Vec::new(),
            truth,
            options,
            measured,
            centres,
            total: OnceLock::new(),
            mean: OnceLock::new(),
        })
    }

    pub(super) fn timeline(&self) -> &Timeline {
        &self.capture.timeline
    }

    pub(super) fn frame_count(&self) -> usize {
        self.timeline().frame_count() as usize
    }

    /// Transitions with lengths by the least sum or the least mean.
    pub(super) fn transitions(&self, choice: LengthChoice, report: Report) -> Result<&TransitionMatrix, EvaluateError> {
        let slot = if choice == LengthChoice::Total { &self.total } else { &self.mean };
        if let Some(known) = slot.get() {
            return Ok(known);
        }
        let found = self.search(&TransitionOptions { choice, ..self.options.transition }, report)?;
        Ok(slot.get_or_init(|| found))
    }

    /// Transitions as `options` say.
    pub(super) fn search(
        &self,
        options: &TransitionOptions,
        report: Report,
    ) -> Result<TransitionMatrix, EvaluateError> {
        let told = told(report, "transitions");
        Ok(optimal_transitions(&self.measured.distances, self.timeline(), options, &told)?)
    }

    /// The essential graph with lengths by the least sum or the least mean.
    pub(super) fn graph(&self, choice: LengthChoice, report: Report) -> Result<EssentialGraph, EvaluateError> {
        let transitions = self.transitions(choice, report)?;
        let alpha = self.options.alpha;
        let essential = essential::essential_edges(transitions, self.timeline(), alpha)?;
        let findings = Findings {
            distances: &self.measured.distances,
            headings: &self.measured.headings,
            transitions,
            options: &TransitionOptions { choice, ..self.options.transition },
        };
        Ok(essential::build_graph(&self.capture, &findings, &essential.edges, alpha, self.contacts.clone())?)
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

/// Tells `report` the share of a stage that is done.
pub(super) fn told<'a>(report: Report<'a>, what: &'static str) -> impl Fn(f64) + Sync + 'a {
    move |share| report(Progress { what, done: (share * 1000.0) as u64, total: 1000 })
}
