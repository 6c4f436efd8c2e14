//! `builder pack`: the whole pipeline, from files to the bytes of a bundle.

use std::time::Instant;

use actor::capture::Capture;
use actor::contacts::Contacts;
use actor::graph::{DEFAULT_ALPHA, EssentialGraph};
use bundle::{self, AppearanceInput, AppearanceQuality, BundleInput, EncodeReport, default_max_error};
use kernels::cholesky::elimination_order;
use serde::Serialize;
use texture::AppearanceModel;
use thiserror::Error;

use appearance::naive::naive;
use appearance::textures::{TextureFiles, TextureSource};
use appearance::{self, AppearanceError, AppearanceOptions, AppearanceSummary, Charts};
use capture_io::import::{self, ImportError, ImportOptions, Warning};
use job::memory;
use job::progress::{Progress, Report};
use pipeline::distance::{self, DistanceOptions};
use pipeline::essential::{self, Findings};
use pipeline::transitions::{self, TransitionOptions};

use crate::preflight::{before_stages, holes};
use crate::reach::unreachable;

/// The frame that the player shows first.
pub(crate) const FIRST_FRAME: u32 = 0;

/// Everything that `builder pack` can be told.
#[derive(Clone, Debug)]
pub struct PackOptions {
    /// How the input is read.
    pub import: ImportOptions,
    /// How pose distances are measured.
    pub distance: DistanceOptions,
    /// How transitions are chosen.
    pub transition: TransitionOptions,
    /// Weight of a frame's duration against surface deformation.
    pub alpha: f64,
    /// Whether transitions keep still what stands on the ground on both sides; else they follow the papers alone.
    pub hold_contacts: bool,
    /// Largest error of a stored vertex position in metres; by the body's height where not given.
    pub max_error: Option<f32>,
    /// What becomes of textures that change from frame to frame.
    pub appearance: AppearanceChoice,
}

impl Default for PackOptions {
    /// What `builder pack` does where it is told nothing.
    fn default() -> Self {
        Self {
            import: ImportOptions::default(),
            distance: DistanceOptions::default(),
            transition: TransitionOptions::default(),
            alpha: DEFAULT_ALPHA,
            hold_contacts: true,
            max_error: None,
            appearance: AppearanceChoice::Eigen(AppearanceOptions::default()),
        }
    }
}

/// What becomes of textures that change from frame to frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AppearanceChoice {
    /// The first frame's texture is used for all.
    Static,
    /// They become Eigen textures and Eigen warps.
    Eigen(AppearanceOptions),
}

/// Why there is no bundle.
#[derive(Debug, Error)]
pub enum PackError {
    /// The input cannot be read as a capture.
    #[error(transparent)]
    Import(#[from] ImportError),
    /// The textures of the frames cannot become an appearance.
    #[error(transparent)]
    Appearance(#[from] AppearanceError),
    /// An option makes no sense for this capture.
    #[error("{0}")]
    Option(String),
    /// A stage contradicts the stage before it.
    #[error("{0}")]
    Ours(String),
}

impl PackError {
    /// A name for the kind of error that never changes, for scripts and for `builder validate`.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Self::Import(error) => error.code(),
            Self::Appearance(_) => "E_APPEARANCE",
            Self::Option(_) => "E_OPTION",
            Self::Ours(_) => "E_INTERNAL",
        }
    }
}

/// What packing cost and what came out; what `--json` prints.
#[derive(Clone, Debug, Serialize)]
pub struct PackReport {
    /// Name of the actor.
    pub name: String,
    /// What the capture holds.
    pub capture: CaptureSummary,
    /// What the essential graph holds.
    pub graph: GraphSummary,
    /// What the frames' textures became, where they have their own.
    pub appearance: Option<AppearanceSummary>,
    /// Wall-clock seconds of each stage.
    pub seconds: StageSeconds,
    /// The most memory that the process held, in bytes, where the system tells.
    pub peak_memory_bytes: Option<u64>,
    /// What the bundle weighs and how exact it is.
    pub bundle: EncodeReport,
    /// What was taken off all positions so that the actor stands near the origin, in metres, +Y up.
    pub offset: [f64; 3],
    /// What the user should know about the input.
    pub warnings: Vec<Warning>,
}

/// What a capture holds.
#[derive(Clone, Debug, Serialize)]
pub struct CaptureSummary {
    /// Frames of all sequences.
    pub frames: u32,
    /// Sequences.
    pub sequences: usize,
    /// Welded vertices.
    pub vertices: usize,
    /// Triangles.
    pub triangles: usize,
    /// Connected components of the mesh.
    pub components: usize,
    /// Frames per second.
    pub fps: f32,
}

/// What an essential graph holds.
#[derive(Clone, Debug, Serialize)]
pub struct GraphSummary {
    /// Transitions that were kept.
    pub transitions: usize,
    /// Edges over the possible ones.
    pub density: f64,
    /// Weight of a frame's duration, as it was used.
    pub alpha: f64,
    /// The same per second.
    pub alpha_per_second: f64,
    /// Pairs of frames with no way from the first to the second.
    pub unreachable_pairs: u64,
    /// Frames that nothing leads on from.
    pub dead_ends: usize,
    /// Frames among which every one can be reached from every other.
    pub largest_component: usize,
}

/// Wall-clock seconds of each stage.
#[derive(Clone, Debug, Default, Serialize)]
pub struct StageSeconds {
    /// Reading files.
    pub import: f64,
    /// Pose distances.
    pub distances: f64,
    /// Optimal transitions.
    pub transitions: f64,
    /// The essential graph, its warps and placements.
    pub graph: f64,
    /// Textures.
    pub appearance: f64,
    /// Encoding the bundle.
    pub bundle: f64,
}

/// Reads a capture and returns the bytes of its bundle with a report.
///
/// # Errors
/// Input that cannot be read, options that do not fit it, or stages that contradict each other.
pub fn pack(inputs: &[String], options: &PackOptions, report: Report) -> Result<(Vec<u8>, PackReport), PackError> {
    let mut seconds = StageSeconds::default();
    let imported = timed(&mut seconds.import, || import::import(inputs, &options.import, &|step| report(step)))?;
    let before = before_stages(&imported, options);
    if let Some(refusal) = before.refusal {
        return Err(refusal);
    }
    let mut warnings = imported.warnings;
    warnings.extend(before.warnings);
    let built = match (&options.appearance, imported.frame_textures) {
        (AppearanceChoice::Eigen(options), Some(paths)) => {
            let files = TextureFiles::new(paths, imported.frame_masks)?;
            let built = timed(&mut seconds.appearance, || {
                eigen_appearance(&imported.capture, &files, options, &mut warnings, report)
            })?;
            Some(built)
        }
        (AppearanceChoice::Static, _) | (_, None) => None,
    };
    let (models, summary) = built.map_or((Vec::new(), None), |(models, summary)| (models, Some(summary)));
    let quality = summary.as_ref().map_or_else(AppearanceQuality::default, |summary| summary.quality);
    let (bytes, mut pack_report) = pack_with_looks(&imported.capture, &models, quality, options, report)?;
    pack_report.seconds.import = seconds.import;
    pack_report.seconds.appearance = seconds.appearance;
    pack_report.appearance = summary;
    pack_report.offset = imported.offset.to_array();
    // What the graph says comes last.
    warnings.append(&mut pack_report.warnings);
    pack_report.warnings = warnings;
    Ok((bytes, pack_report))
}

/// Eigen textures and Eigen warps of a capture whose frames wear the textures `paths`.
fn eigen_appearance(
    capture: &Capture,
    textures: &TextureFiles,
    options: &AppearanceOptions,
    warnings: &mut Vec<Warning>,
    report: Report,
) -> Result<(Vec<AppearanceModel>, AppearanceSummary), PackError> {
    let (width, height) = textures.size();
    let (charts, _) = Charts::new(&capture.surface, width, height)?;
    let (model, summary) = appearance::build(textures, &charts, options, report)?;
    warnings.extend(holes(summary.completed_frames.len()));
    warnings.extend(missed_similarity(options, &summary));
    let mut models = vec![model];
    if options.compare {
        report(Progress { what: "naive components", done: 0, total: 0 });
        models.push(naive(textures, &charts, summary.textures + summary.warps)?);
    }
    Ok((models, summary))
}

/// That textures are not as similar as was asked for, where they are not.
fn missed_similarity(options: &AppearanceOptions, summary: &AppearanceSummary) -> Option<Warning> {
    let (wanted, stored) = (options.ssim?, &summary.stored);
    if stored.ssim >= wanted {
        return None;
    }
    let advice = if options.any_components { "ask for less" } else { "ask for less, or for more components" };
    let message = format!(
        "textures do not reach a structural similarity of {wanted}: they have {:.4} before storing and {:.4} after, in \
         {:.0} bytes a frame, with {} Eigen textures and {} Eigen warps, the best that was found; {advice}",
        summary.ssim, stored.ssim, stored.bytes_per_frame, summary.textures, summary.warps
    );
    Some(Warning::new("W_APPEARANCE_SSIM", message))
}

/// Returns the bytes of the bundle of a capture in memory, with a report.
///
/// # Errors
/// Options that do not fit the capture, or stages that contradict each other.
pub fn pack_capture(
    capture: &Capture,
    options: &PackOptions,
    report: Report,
) -> Result<(Vec<u8>, PackReport), PackError> {
    pack_with_looks(capture, &[], AppearanceQuality::default(), options, report)
}

/// Returns the bytes of the bundle of a capture in memory with the models of its textures, and with those to compare with
/// where `models` has them, too; and a report.
///
/// # Errors
/// Options that do not fit the capture, or stages that contradict each other.
pub fn pack_with_looks(
    capture: &Capture,
    models: &[AppearanceModel],
    quality: AppearanceQuality,
    options: &PackOptions,
    report: Report,
) -> Result<(Vec<u8>, PackReport), PackError> {
    let mut seconds = StageSeconds::default();
    let (graph, graph_summary, unreachable) = essential_graph(capture, options, &mut seconds, report)?;
    report(Progress { what: "bundle", done: 0, total: 0 });
    let (bytes, bundle) = timed(&mut seconds.bundle, || encode(capture, &graph, (models, quality), options))?;
    let pack_report = PackReport {
        name: capture.name.clone(),
        capture: summary_of(capture),
        graph: graph_summary,
        appearance: None,
        seconds,
        peak_memory_bytes: memory::peak_bytes(),
        bundle,
        offset: [0.0; 3],
        warnings: unreachable.into_iter().collect(),
    };
    Ok((bytes, pack_report))
}

/// What a capture holds.
#[must_use]
pub fn summary_of(capture: &Capture) -> CaptureSummary {
    CaptureSummary {
        frames: capture.timeline.frame_count(),
        sequences: capture.timeline.sequences().len(),
        vertices: capture.topology.vertex_count(),
        triangles: capture.topology.triangles().len(),
        components: capture.topology.component_count(),
        fps: capture.timeline.fps(),
    }
}

/// The essential graph of a capture: distances, transitions, edges, warps; and a sentence about ways that are missing.
fn essential_graph(
    capture: &Capture,
    options: &PackOptions,
    seconds: &mut StageSeconds,
    report: Report,
) -> Result<(EssentialGraph, GraphSummary, Option<Warning>), PackError> {
    let timeline = &capture.timeline;
    let told = |what| move |share: f64| report(Progress { what, done: (share * 1000.0) as u64, total: 1000 });
    let measured = timed(&mut seconds.distances, || {
        distance::measure(&capture.topology, &capture.poses, &options.distance, &told("pose distances"))
    });
    let measured = measured.map_err(|error| PackError::Option(error.to_string()))?;
    let transitions = timed(&mut seconds.transitions, || {
        transitions::optimal_transitions(&measured.distances, timeline, &options.transition, &told("transitions"))
    });
    let transitions = transitions.map_err(|error| PackError::Option(error.to_string()))?;
    report(Progress { what: "essential graph", done: 0, total: 0 });
    let start = Instant::now();
    let essential = essential::essential_edges(&transitions, timeline, options.alpha)
        .map_err(|error| PackError::Option(error.to_string()))?;
    let findings = Findings {
        distances: &measured.distances,
        headings: &measured.headings,
        transitions: &transitions,
        options: &options.transition,
    };
    let contacts = if options.hold_contacts {
        pipeline::contacts::contacts(&capture.topology, &capture.timeline, &capture.poses)
    } else {
        Contacts::default()
    };
    let graph = essential::build_graph(capture, &findings, &essential.edges, options.alpha, contacts)
        .map_err(|error| PackError::Ours(error.to_string()))?;
    let components = essential::strongly_connected(timeline, &essential.edges);
    seconds.graph = start.elapsed().as_secs_f64();
    let summary = GraphSummary {
        transitions: graph.transitions().len(),
        density: graph.density(timeline),
        alpha: graph.alpha(),
        alpha_per_second: graph.alpha() * f64::from(timeline.fps()),
        unreachable_pairs: essential.unreachable_pairs,
        dead_ends: essential.dead_ends.len(),
        largest_component: components.largest_frames().count(),
    };
    let unreachable = unreachable(timeline, &essential.edges, essential.unreachable_pairs);
    Ok((graph, summary, unreachable))
}

fn encode(
    capture: &Capture,
    graph: &EssentialGraph,
    (models, quality): (&[AppearanceModel], AppearanceQuality),
    options: &PackOptions,
) -> Result<(Vec<u8>, EncodeReport), PackError> {
    let order = elimination_order(&capture.topology);
    let input = BundleInput {
        capture,
        graph,
        first_frame: FIRST_FRAME,
        max_error: options.max_error.unwrap_or_else(|| default_max_error(capture, FIRST_FRAME)),
        poisson_order: Some(&order),
        generator: format!("Reprise builder {}", env!("CARGO_PKG_VERSION")),
    };
    // The model is of the atlas of the first material that has a texture, as `Charts` are.
    let material = capture.surface.materials.iter().position(|material| material.image.is_some()).unwrap_or(0) as u32;
    let looks: Vec<AppearanceInput> = models.iter().map(|model| AppearanceInput { model, material, quality }).collect();
    bundle::encode_with_looks(&input, &looks).map_err(|error| PackError::Option(error.to_string()))
}

fn timed<T>(seconds: &mut f64, stage: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = stage();
    *seconds = start.elapsed().as_secs_f64();
    result
}
