//! `builder pack`: the whole pipeline, from files to the bytes of a bundle.

use std::time::Instant;

use actor::alternatives::Alternatives;
use actor::capture::Capture;
use actor::files::Files;
use actor::graph::EssentialGraph;
use actor::timeline::Timeline;
use appearance::naive::naive;
use appearance::textures::{TextureFiles, TextureSource};
use appearance::{self, AppearanceOptions, AppearanceSummary, Charts};
use bundle::{
    self, AppearanceInput, AppearanceQuality, BundleInput, EncodeReport, Extras, FoundParts, ScannedFrames,
    default_max_error,
};
use capture_io::import::{self, FileSkeleton, ImportError, Warning};
use editing::{StoredRig, StoredSpace};
use job::{Job, memory};
use kernels::cholesky::elimination_order;
use pipeline::distance::{self};
use pipeline::graph::{Graphed, essential_graph};
use serde::Serialize;
use texture::TextureModel;

use crate::families::{self, FamilySummary};
pub use crate::found_parts::PartsSummary;
use crate::found_parts::found_parts;
#[cfg(feature = "scans")]
use crate::look::is_scan;
use crate::options::FIRST_FRAME;
#[cfg(feature = "scans")]
pub use crate::options::ScanMode;
pub use crate::options::{AppearanceChoice, PackError, PackOptions};
pub use crate::packed::Packed;
use crate::preflight::{before_stages, holes};
use crate::reach::unreachable;
#[cfg(feature = "scans")]
use crate::registered::RegisteredScan;
pub use crate::rigged::{RigSummary, SpaceSummary};
use crate::rigged::{stored_rig, stored_space};
#[cfg(feature = "variations")]
use crate::vary::{self, AlternativesSummary, VariedSequence};
#[cfg(feature = "scans")]
pub use crate::windows::ScannedSummary;

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
    /// What came of the rig, where one was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rig: Option<RigSummary>,
    /// The parts of the body, where they were asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub parts: Option<PartsSummary>,
    /// What came of the learned space, where a rig was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub learned: Option<SpaceSummary>,
    /// Families that were made, and where their samples come from.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub families: Vec<FamilySummary>,
    /// What came of the sequences that were varied.
    #[cfg(feature = "variations")]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub variations: Vec<VariedSequence>,
    /// What came of storing them as alternatives of recorded stretches.
    #[cfg(feature = "variations")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alternatives: Option<AlternativesSummary>,
    /// The frames as they were scanned, where these are shown.
    #[cfg(feature = "scans")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scanned: Option<ScannedSummary>,
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
    /// Bringing frames with meshes of their own onto one.
    pub registration: f64,
    /// Reading files.
    pub import: f64,
    /// The rig and the learned space.
    pub rig: f64,
    /// Finding the parts of the body.
    pub parts: f64,
    /// Pose distances.
    pub distances: f64,
    /// Optimal transitions, the essential graph, its warps and placements.
    pub graph: f64,
    /// Textures.
    pub appearance: f64,
    /// Learning and storing variations.
    pub variations: f64,
    /// Frames as they were scanned.
    pub scanned: f64,
    /// Encoding the bundle.
    pub bundle: f64,
}

/// Reads a capture and returns the bytes of its bundle with a report.
///
/// # Errors
/// Input that cannot be read, options that do not fit it, or stages that contradict each other.
pub fn pack(inputs: &[String], options: &PackOptions, job: &Job) -> Result<(Vec<u8>, PackReport), PackError> {
    let (packed, report) = pack_streamed(inputs, options, job)?;
    let whole = packed.whole().map_err(|source| ImportError::Io { path: std::env::temp_dir(), source })?;
    Ok((whole, report))
}

/// As [`pack`], but what is too much for the memory waits on the disk until the bundle is written.
///
/// # Errors
/// As [`pack`].
pub fn pack_streamed(inputs: &[String], options: &PackOptions, job: &Job) -> Result<(Packed, PackReport), PackError> {
    pack_of(inputs, options, None, job)
}

/// As [`pack`]; of the registered scan `of`, where `inputs` are its.
fn pack_of(
    inputs: &[String],
    options: &PackOptions,
    of: Option<ScanOf>,
    job: &Job,
) -> Result<(Packed, PackReport), PackError> {
    let mut seconds = StageSeconds::default();
    let start = Instant::now();
    let imported = match import::import(inputs, &options.import, job) {
        // Every frame, or some, are meshes of their own.
        #[cfg(feature = "scans")]
        Err(error) if is_scan(&error) => {
            let registered = RegisteredScan::new(inputs, options, job)?;
            seconds.registration = start.elapsed().as_secs_f64();
            let of = (options.mode == ScanMode::Windows).then_some((&registered, options));
            let mut own = registered.options(options);
            own.mode = ScanMode::Global;
            let (packed, mut report) = pack_of(&[registered.input()], &own, of, job)?;
            report.seconds.registration = seconds.registration;
            report.warnings.splice(0..0, registered.warnings);
            return Ok((packed, report));
        }
        imported => imported?,
    };
    seconds.import = start.elapsed().as_secs_f64();
    #[cfg(feature = "scans")]
    if options.mode == ScanMode::Windows {
        return Err(PackError::Option(
            "--mode windows shows the frames of a scan, of which each has its own mesh; here all frames share one: leave it out"
                .into(),
        ));
    }
    let mut imported = imported;
    let families = families::add(&mut imported, job)?;
    #[cfg(feature = "variations")]
    let made = timed(&mut seconds.variations, || {
        // Frames that are shown as they were scanned have none.
        let wanted = options.variations.as_ref().filter(|wanted| !wanted.usual || of.is_none());
        vary::made(&mut imported, &families, wanted, job)
    })?;
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
                eigen_appearance(&imported.capture, &files, options, &mut warnings, job)
            })?;
            Some(built)
        }
        (AppearanceChoice::Static, _) | (_, None) => None,
    };
    let (models, summary) = built.map_or((Vec::new(), None), |(models, summary)| (models, Some(summary)));
    let quality = summary.as_ref().map_or_else(AppearanceQuality::default, |summary| summary.quality);
    let looks = (models.as_slice(), quality);
    #[cfg(feature = "variations")]
    let (stored, summary_of_stored) =
        timed(&mut seconds.variations, || vary::stored(made.as_ref(), &imported.capture, &mut warnings, job))?.unzip();
    #[cfg(not(feature = "variations"))]
    let stored = None;
    #[cfg(feature = "scans")]
    let (scanned, summary_of_scanned, rest) = match of {
        Some((registered, scan)) => {
            // A position that is rounded to this goes less far than the poses may.
            let step = max_error(&imported.capture, options);
            let frames = imported.capture.poses.len();
            let start = Instant::now();
            let found = registered.scanned(scan, frames, (imported.offset, step), job)?;
            seconds.scanned = start.elapsed().as_secs_f64();
            (Some(found.0), Some(found.1), Some(found.2))
        }
        None => (None, None, None),
    };
    #[cfg(not(feature = "scans"))]
    let (scanned, _, rest) = (None, of, None);
    let besides = Besides {
        files: &imported.files,
        alternatives: stored.as_ref(),
        body_parts: imported.parts.as_deref(),
        scanned: scanned.as_ref(),
        skeleton: imported.skeleton.as_ref(),
    };
    let (bytes, mut pack_report) = pack_with_files(&imported.capture, besides, looks, options, job)?;
    let told = &mut pack_report.seconds;
    (told.import, told.appearance, told.variations) = (seconds.import, seconds.appearance, seconds.variations);
    #[cfg(feature = "scans")]
    {
        (pack_report.seconds.scanned, pack_report.scanned) = (seconds.scanned, summary_of_scanned);
    }
    pack_report.appearance = summary;
    pack_report.families = families;
    #[cfg(feature = "variations")]
    {
        let bytes_of = |name: &str| {
            pack_report.bundle.sections.iter().find(|section| section.name == name).map_or(0, |section| section.stored)
        };
        let bytes = bytes_of("alternatives") as usize;
        pack_report.alternatives = summary_of_stored.map(|summary| AlternativesSummary { bytes, ..summary });
        pack_report.variations = made.map_or(Vec::new(), |made| made.learned.told);
    }
    pack_report.offset = imported.offset.to_array();
    // What the graph says comes last.
    warnings.append(&mut pack_report.warnings);
    pack_report.warnings = warnings;
    Ok((Packed { bytes, rest }, pack_report))
}

/// Eigen textures and Eigen warps of a capture whose frames wear the textures `paths`.
fn eigen_appearance(
    capture: &Capture,
    textures: &TextureFiles,
    options: &AppearanceOptions,
    warnings: &mut Vec<Warning>,
    job: &Job,
) -> Result<(Vec<TextureModel>, AppearanceSummary), PackError> {
    let (width, height) = textures.size();
    let (charts, _) = Charts::new(&capture.surface, width, height)?;
    let (model, summary) = appearance::build(textures, &charts, options, job)?;
    warnings.extend(holes(summary.completed_frames.len()));
    warnings.extend(missed_similarity(options, &summary));
    let mut models = vec![model];
    if options.compare {
        job.begin("naive components")?;
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
pub fn pack_capture(capture: &Capture, options: &PackOptions, job: &Job) -> Result<(Vec<u8>, PackReport), PackError> {
    pack_with_looks(capture, &[], AppearanceQuality::default(), options, job)
}

/// Returns the bytes of the bundle of a capture in memory with the models of its textures, and with those to compare with
/// where `models` has them, too; and a report.
///
/// # Errors
/// Options that do not fit the capture, or stages that contradict each other.
pub fn pack_with_looks(
    capture: &Capture,
    models: &[TextureModel],
    quality: AppearanceQuality,
    options: &PackOptions,
    job: &Job,
) -> Result<(Vec<u8>, PackReport), PackError> {
    let files = Files::default();
    pack_with_files(
        capture,
        Besides { files: &files, alternatives: None, body_parts: None, scanned: None, skeleton: None },
        (models, quality),
        options,
        job,
    )
}

/// What goes into a bundle besides a capture.
#[derive(Clone, Copy)]
struct Besides<'a> {
    /// What exports need to know of the capture's files.
    files: &'a Files,
    alternatives: Option<&'a Alternatives>,
    /// The part of the body that each vertex belongs to, as it was painted.
    body_parts: Option<&'a [u8]>,
    /// Frames as they were scanned.
    scanned: Option<&'a ScannedFrames>,
    /// The bones that the capture's file brings.
    skeleton: Option<&'a FileSkeleton>,
}

/// What goes into a bundle besides a capture, what was made on the way among it.
struct Stored<'a> {
    besides: Besides<'a>,
    rig: Option<&'a StoredRig>,
    found_parts: Option<&'a FoundParts>,
    learned: Option<&'a StoredSpace>,
}
/// A scan that was registered, and how it is packed.
#[cfg(feature = "scans")]
type ScanOf<'a> = (&'a RegisteredScan, &'a PackOptions);
#[cfg(not(feature = "scans"))]
type ScanOf<'a> = &'a std::convert::Infallible;

/// As [`pack_with_looks`], with what goes into the bundle besides.
fn pack_with_files(
    capture: &Capture,
    besides: Besides,
    looks: (&[TextureModel], AppearanceQuality),
    options: &PackOptions,
    job: &Job,
) -> Result<(Vec<u8>, PackReport), PackError> {
    let (mut seconds, mut warnings) = (StageSeconds::default(), Vec::new());
    let mut rig = None;
    if let Some(file) = &options.rig {
        rig = timed(&mut seconds.rig, || stored_rig(capture, besides.skeleton, file, job, &mut warnings))?;
    }
    let (rig, rig_summary) = rig.unzip();
    let wanted = options.parts.then(|| timed(&mut seconds.parts, || found_parts(capture, besides.body_parts, job)));
    let (found, parts) = wanted.transpose()?.unzip();
    let found = found.flatten();
    let mut learned = None;
    if options.rig.is_some() {
        let mut own = 0.0;
        match timed(&mut own, || stored_space(capture)) {
            Ok(found) => learned = Some(found),
            Err(warning) => warnings.push(warning),
        }
        seconds.rig += own;
    }
    let (learned, learned_summary) = learned.unzip();
    let stored = Stored { besides, rig: rig.as_ref(), found_parts: found.as_ref(), learned: learned.as_ref() };
    let measured =
        timed(&mut seconds.distances, || distance::measure(&capture.topology, &capture.poses, &options.distance, job))?;
    let graphed = timed(&mut seconds.graph, || essential_graph(capture, &measured, &options.graph, job))?;
    job.begin("bundle")?;
    let (bytes, bundle) = timed(&mut seconds.bundle, || encode(capture, &stored, &graphed.graph, looks, options))?;
    let edges: Vec<(u32, u32)> = graphed.graph.transitions().iter().map(|edge| (edge.from, edge.to)).collect();
    let unreachable = unreachable(&capture.timeline, &edges, graphed.unreachable_pairs);
    warnings.extend(unreachable);
    let pack_report = PackReport {
        name: capture.name.clone(),
        capture: summary_of(capture),
        graph: summary_of_graph(&graphed, &capture.timeline),
        appearance: None,
        rig: rig_summary,
        parts,
        learned: learned_summary,
        families: Vec::new(),
        #[cfg(feature = "variations")]
        variations: Vec::new(),
        #[cfg(feature = "variations")]
        alternatives: None,
        #[cfg(feature = "scans")]
        scanned: None,
        seconds,
        peak_memory_bytes: memory::peak_bytes(),
        bundle,
        offset: [0.0; 3],
        warnings,
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

fn summary_of_graph(graphed: &Graphed, timeline: &Timeline) -> GraphSummary {
    let graph = &graphed.graph;
    GraphSummary {
        transitions: graph.transitions().len(),
        density: graph.density(timeline),
        alpha: graph.alpha(),
        alpha_per_second: graph.alpha() * f64::from(timeline.fps()),
        unreachable_pairs: graphed.unreachable_pairs,
        dead_ends: graphed.dead_ends.len(),
        largest_component: graphed.components.largest_frames().count(),
    }
}

fn encode(
    capture: &Capture,
    stored: &Stored,
    graph: &EssentialGraph,
    (models, quality): (&[TextureModel], AppearanceQuality),
    options: &PackOptions,
) -> Result<(Vec<u8>, EncodeReport), PackError> {
    let order = elimination_order(&capture.topology);
    let input = BundleInput {
        capture,
        graph,
        first_frame: FIRST_FRAME,
        max_error: max_error(capture, options),
        poisson_order: Some(&order),
        generator: format!("Reprise builder {}", env!("CARGO_PKG_VERSION")),
    };
    // The model is of the atlas of the first material that has a texture, as `Charts` are.
    let material = capture.surface.materials.iter().position(|material| material.image.is_some()).unwrap_or(0) as u32;
    let looks: Vec<AppearanceInput> = models.iter().map(|model| AppearanceInput { model, material, quality }).collect();
    let mut extras = Extras::default();
    let besides = stored.besides;
    (extras.rig, extras.alternatives, extras.body_parts) = (stored.rig, besides.alternatives, besides.body_parts);
    (extras.found_parts, extras.learned, extras.scanned) = (stored.found_parts, stored.learned, besides.scanned);
    Ok(bundle::encode_with_extras(&input, &looks, besides.files, &extras)?)
}

/// The largest error of a position, in metres.
fn max_error(capture: &Capture, options: &PackOptions) -> f32 {
    options.max_error.unwrap_or_else(|| default_max_error(capture, FIRST_FRAME))
}

fn timed<T>(seconds: &mut f64, stage: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = stage();
    *seconds += start.elapsed().as_secs_f64();
    result
}
