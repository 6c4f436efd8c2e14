//! `builder register`: a scan, of which every frame has its own mesh, becomes a capture of one mesh and one atlas.
//!
//! ```text
//! Scans -> survey -> tree, template -> register -> CaptureWriter -> a folder that import reads
//!                                         |-> projection of textures -^
//! ```

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use capture_io::export::{CaptureWriter, ExportError, WrittenCapture, WrittenSequence};
use capture_io::import::{ImportError, ImportOptions, ScannedFrame, ScannedTexture, Scans, Warning, scans};
use glam::{Vec2, Vec3};
use job::{Job, Stopped};
use registration::checks::Fit;
use registration::detail::DetailError;
use registration::projection::{Projection, Texture};
use registration::register::{Found, Lost, RegisterOptions, Registered, Source, Survey};
use registration::register::{register as register_frames, survey, template};
use registration::scan::Scan;
use registration::template::Template;
use registration::tree::Tree;
use thiserror::Error;

pub use super::scan_report::{FrameReport, LostReport, RegisterReport};
use super::scan_truth::Truth;
pub use super::scan_truth::{TruthError, TruthReport};

/// Of the frames at most this share may be lost.
const MOST_LOST: f64 = 0.5;
/// Beyond these a frame is doubtful: edges over those of the frame that it was tracked from, the share of the template that lies off
/// the scan, and how much edges are longer or shorter than the template's own.
const MOST_STRETCH: f64 = 1.3;
const MOST_BEYOND: f64 = 0.06;
const MOST_STRAIN: f64 = 0.12;
/// Width of the template's texture: a power of two from and to.
const SIZES: (usize, usize) = (256, 4096);
/// Share of an atlas that charts cover, roughly.
const COVERED: f32 = 0.5;
/// Holes of a smaller share of the texels are as good as seen, once they are filled: webs and folds make some in every frame.
const SMALL_HOLES: f64 = 0.02;
/// A model of textures needs so many that were seen in full; with fewer, what was filled in stands for what was seen.
const LEAST_SEEN: usize = 2;
/// Texels for each vertex of a scan whose colours are those of its vertices.
const TEXELS_OF_VERTEX: f32 = 6.0;

/// How a scan becomes a capture.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct ScanOptions {
    /// How the input is read.
    pub import: ImportOptions,
    /// How it is registered.
    pub register: RegisterOptions,
    /// Width and height of the textures; as dense as the scan's own where not given.
    pub texture_size: Option<usize>,
    /// A folder with the truth, where it is known: the capture that the scan was made from.
    pub truth: Option<PathBuf>,
}

/// Why there is no capture.
#[derive(Debug, Error)]
pub enum RegisterError {
    /// A scan cannot be read.
    #[error(transparent)]
    Import(#[from] ImportError),
    /// The capture cannot be written.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// The template's equations cannot be set up.
    #[error("the template cannot be deformed: {0}. Choose another frame with --template-frame")]
    Detail(#[from] DetailError),
    /// No frame holds a body.
    #[error("none of the {0} frames holds a surface of more than crumbs: are they meshes of one subject?")]
    Nothing(usize),
    /// The frame that is to be the template is none.
    #[error("frame {wanted} cannot be the template: {reason}; the scan has frames 0 to {last}")]
    Template {
        /// The frame.
        wanted: usize,
        /// Why not.
        reason: String,
        /// The last frame.
        last: usize,
    },
    /// Most frames were lost.
    #[error(
        "{lost} of {frames} frames could not be brought onto the mesh of frame {root}; the first of them is {place}: {why}. \
         Choose another template with --template-frame, or leave out what shows something else"
    )]
    MostLost {
        /// Frames that were lost.
        lost: usize,
        /// All frames.
        frames: usize,
        /// The template's frame.
        root: usize,
        /// The first one that was lost.
        place: String,
        /// Why.
        why: Lost,
    },
    /// The truth is none of this scan.
    #[error(transparent)]
    Truth(#[from] TruthError),
    /// It was asked to stop: nothing was written.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

impl RegisterError {
    /// Whether it was stopped, in whatever stage.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        matches!(self, Self::Stopped(_) | Self::Import(ImportError::Stopped(_)) | Self::Export(ExportError::Stopped(_)))
    }

    /// A name for the kind of error that never changes.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Self::Import(error) => error.code(),
            Self::Export(_) => "E_IO",
            Self::Detail(_) | Self::Template { .. } => "E_TEMPLATE",
            Self::Nothing(_) => "E_NO_TRIANGLES",
            Self::Truth(TruthError::Import(error)) => error.code(),
            Self::Truth(TruthError::Other { .. }) => "E_TRUTH",
            Self::MostLost { .. } => "E_SCANS_LOST",
            Self::Stopped(_) => "E_STOPPED",
        }
    }
}

/// Scans as registration reads them.
pub(crate) struct Frames<'a>(pub &'a Scans);

impl Source for Frames<'_> {
    type Extra = Option<ScannedTexture>;
    type Error = RegisterError;

    fn count(&self) -> usize {
        self.0.frame_count()
    }

    fn sequence(&self, frame: usize) -> usize {
        self.0.place_of(frame).map_or(0, |(sequence, _)| sequence)
    }

    fn read(&self, frame: usize) -> Result<(Scan, Self::Extra), RegisterError> {
        let (mut scan, texture) = self.plain(frame)?;
        // Colours stop the template from sliding: those of the texture, where there is one, else those of vertices.
        if let (Some(texture), false) = (&texture, scan.uvs.is_empty()) {
            scan.colours = decoded(texture)?.of_vertices(scan.positions.len(), &scan.triangles, &scan.uvs);
        }
        Ok((scan, texture))
    }

    fn shape(&self, frame: usize) -> Result<Scan, RegisterError> {
        self.plain(frame).map(|(scan, _)| scan)
    }
}

impl Frames<'_> {
    /// A frame with the colours that its file gives vertices.
    pub(crate) fn plain(&self, frame: usize) -> Result<(Scan, Option<ScannedTexture>), RegisterError> {
        let read = match self.0.read(frame) {
            // A frame without a surface is lost, and not the whole scan.
            Err(ImportError::NoTriangles { .. } | ImportError::Collapsed { .. }) => ScannedFrame::default(),
            read => read?,
        };
        let colour = |c: &[u8; 4]| Vec3::new(f32::from(c[0]), f32::from(c[1]), f32::from(c[2])) / 255.0;
        let colours = read.colours.iter().map(colour).collect();
        let scan = Scan { positions: read.positions, triangles: read.triangles, uvs: read.uvs, colours };
        Ok((scan, read.texture))
    }
}

fn decoded(texture: &ScannedTexture) -> Result<Texture, RegisterError> {
    let (width, height, texels) = texture.decoded()?;
    Ok(Texture { width, height, texels })
}

/// Registers the scan that `inputs` name, and writes it as the folder `out`.
///
/// # Errors
/// Scans that cannot be read, or of which most cannot be brought onto one mesh; a folder that cannot be written. Nothing is
/// half-written.
pub fn register(
    inputs: &[String],
    options: &ScanOptions,
    out: &Path,
    job: &Job,
) -> Result<RegisterReport, RegisterError> {
    let mut scans = scans(inputs, &options.import)?;
    let mut warnings = std::mem::take(&mut scans.warnings);
    let source = Frames(&scans);
    let start = Instant::now();
    let survey = survey(&source, &options.register, job)?;
    let tree = tree(&scans, &survey, options)?;
    let root = survey.frames[tree.root];
    let template = template(&source, root)?.ok_or(RegisterError::Nothing(scans.frame_count()))?;
    let compared = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let writer = Writer::new(&scans, &template, root, out, options)?;
    let emit = |found: Found<Option<ScannedTexture>>| writer.take(found);
    let registered = register_frames(&source, &survey, &tree, &template, &options.register, job, &emit)?;
    let (sequences, alone) = parts(&scans, &registered);
    check_lost(&scans, &registered.lost, alone.len(), root)?;
    warnings.extend(told_of_frames(&scans, &survey, &tree, &registered.lost));
    warnings.extend(writer.projection.is_none().then(colourless));
    warnings.extend(told_of_registered(&scans, &registered, &alone));
    let written =
        sequences.iter().flat_map(|s| (s.frames.0..=s.frames.1).map(|frame| first_of(&scans, s.number) + frame));
    let written = written.collect();
    let named = sequences.iter().map(|s| (s.name.clone(), s.frames.1 - s.frames.0 + 1)).collect();
    let textures = writer.projection.is_some();
    let texture_size = writer.projection.as_ref().map(|projection| projection.atlas.size);
    let [whole, masked] = writer.seen.each_ref().map(|count| count.load(Ordering::Relaxed));
    let masks = masked > 0 && whole >= LEAST_SEEN;
    let capture = WrittenCapture { name: scans.name.clone(), fps: scans.fps, textures, masks, sequences };
    let frames = registered.tracked.iter().map(|tracked| FrameReport::new(tracked, writer.truth_of(tracked.frame)));
    let frames = frames.collect();
    let manifest = writer.files.finish(&capture)?;
    let count = survey.frames.len();
    Ok(RegisterReport {
        manifest,
        name: scans.name.clone(),
        frames: scans.frame_count(),
        template: root,
        vertices: template.surface.mesh.positions.len(),
        triangles: template.surface.mesh.triangles.len(),
        meshes: survey.groups.iter().max().map_or(0, |last| last + 1),
        texture_size,
        sequences: named,
        registered: frames,
        lost: lost_reports(&scans, &registered.lost),
        written,
        dissimilarity: (0..count * count).map(|k| survey.dissimilarity.get(k / count, k % count)).collect(),
        compared: survey.frames,
        warnings,
        seconds: [compared, start.elapsed().as_secs_f64()],
    })
}

pub(crate) fn tree(scans: &Scans, survey: &Survey, options: &ScanOptions) -> Result<Tree, RegisterError> {
    if survey.frames.is_empty() {
        return Err(RegisterError::Nothing(scans.frame_count()));
    }
    let last = scans.frame_count() - 1;
    if let Some(wanted) = options.register.template.filter(|wanted| !survey.frames.contains(wanted)) {
        let lost = survey.lost.iter().find(|(frame, _)| *frame == wanted);
        let reason = lost.map_or_else(|| "there is no such frame".into(), |(_, why)| why.to_string());
        return Err(RegisterError::Template { wanted, reason, last });
    }
    Ok(survey.tree(options.register.template))
}

/// The frames that were lost, as they are told.
pub(crate) fn lost_reports(scans: &Scans, lost: &[(usize, Lost)]) -> Vec<LostReport> {
    let report =
        |&(frame, why): &(usize, Lost)| LostReport { frame, place: place(scans, frame), reason: with_remedy(why) };
    lost.iter().map(report).collect()
}

/// Why a frame was lost, and what can be done.
fn with_remedy(why: Lost) -> String {
    let remedy = match why {
        Lost::Empty => "export it again, or leave it out",
        Lost::Size(_) => "export it in the unit of the others, or leave it out",
        Lost::Untracked(..) => {
            "if it shows something else, or more than one body, leave it out; else name another template with --template-frame"
        }
    };
    format!("{why}; {remedy}")
}

/// A frame of the scan, as its user counts.
fn place(scans: &Scans, frame: usize) -> String {
    match scans.place_of(frame).and_then(|(sequence, number)| {
        let sequence = &scans.sequences[sequence];
        sequence.files.get(number).map(|file| (sequence, number, file))
    }) {
        Some((sequence, number, file)) => {
            format!("frame {number} of sequence \"{}\" ({})", sequence.name, file.display())
        }
        None => format!("frame {frame}"),
    }
}

/// Refuses a scan of which most is lost, with so many frames that stand `alone` between others that are.
pub(crate) fn check_lost(scans: &Scans, all: &[(usize, Lost)], alone: usize, root: usize) -> Result<(), RegisterError> {
    let (lost, frames) = (all.len() + alone, scans.frame_count());
    match all.first() {
        Some(&(first, why)) if lost as f64 > MOST_LOST * frames as f64 => {
            Err(RegisterError::MostLost { lost, frames, root, place: place(scans, first), why })
        }
        _ => Ok(()),
    }
}

/// The first frame of a sequence, counted over all.
fn first_of(scans: &Scans, sequence: usize) -> usize {
    scans.sequences[..sequence].iter().map(|s| s.files.len()).sum()
}

/// The sequences without the frames that were lost: each is cut there. Frames that stand alone between two lost ones go, too.
fn parts(scans: &Scans, registered: &Registered) -> (Vec<WrittenSequence>, Vec<usize>) {
    let mut runs: BTreeMap<usize, Vec<(usize, usize)>> = BTreeMap::new();
    for tracked in &registered.tracked {
        let Some((sequence, number)) = scans.place_of(tracked.frame) else { continue };
        let runs = runs.entry(sequence).or_default();
        match runs.last_mut() {
            Some((_, last)) if *last + 1 == number => *last = number,
            _ => runs.push((number, number)),
        }
    }
    let (mut parts, mut alone) = (Vec::new(), Vec::new());
    for (number, runs) in runs {
        let sequence = &scans.sequences[number];
        let whole = runs.first() == Some(&(0, sequence.files.len() - 1));
        let mut count = 0;
        for frames in runs {
            if frames.0 == frames.1 && sequence.files.len() > 1 {
                alone.push(first_of(scans, number) + frames.0);
                continue;
            }
            count += 1;
            let name = if count == 1 { sequence.name.clone() } else { format!("{} part {count}", sequence.name) };
            let (labels, cyclic) = (sequence.labels.clone(), if whole { sequence.cyclic } else { Some(false) });
            parts.push(WrittenSequence { name, labels, cyclic, number, frames });
        }
    }
    (parts, alone)
}

/// One sentence for all of `frames`, of which the first is named; none where there is none.
fn told(scans: &Scans, code: &'static str, frames: &[usize], what: impl Fn(usize) -> String) -> Option<Warning> {
    let &first = frames.first()?;
    let more = match frames.len() {
        1 => String::new(),
        more => format!("; so it is with {} more frames", more - 1),
    };
    Some(Warning::new(code, format!("{}: {}{more}", place(scans, first), what(first))))
}

/// What the user should know of the frames of `survey`, of which `lost` are lost, and of the template, the root of `tree`.
pub(crate) fn told_of_frames(scans: &Scans, survey: &Survey, tree: &Tree, lost: &[(usize, Lost)]) -> Vec<Warning> {
    let turned = told(scans, "W_SCAN_INSIDE_OUT", &survey.turned, |_| {
        "its triangles face inwards: they were turned, nothing else need be done".into()
    });
    let littered = told(scans, "W_SCAN_DEBRIS", &survey.littered, |_| {
        "parts of less than a hundredth of its surface float about: they are left out; what belongs to the body must touch it".into()
    });
    let parts = survey.candidates[tree.root].parts;
    let root = survey.frames[tree.root];
    let apart = (parts > 1).then(|| {
        let message = format!(
            "{}, the template, has {parts} parts that do not touch: if they are two people, or a person and a thing, they become \
             one actor; take the other out of the frames, or name another template with --template-frame",
            place(scans, root)
        );
        Warning::new("W_SCAN_PARTS", message)
    });
    let frames: Vec<usize> = lost.iter().map(|lost| lost.0).collect();
    let lost = told(scans, "W_SCAN_LOST", &frames, |frame| {
        let found = lost.iter().find(|(lost, _)| *lost == frame);
        let why = found.map(|&(_, why)| with_remedy(why)).unwrap_or_default();
        format!("it is left out, and its sequence cut there: {why}")
    });
    turned.into_iter().chain(littered).chain(apart).chain(lost).collect()
}

fn colourless() -> Warning {
    let message = "the frames have neither textures nor colours: the template may slide along the body, and nothing here can \
                   tell; give their textures (--texture), if there are any";
    Warning::new("W_SCAN_COLOURLESS", message.into())
}

/// What the user should know of frames that are registered, or are left out because they stand alone.
fn told_of_registered(scans: &Scans, registered: &Registered, alone: &[usize]) -> Vec<Warning> {
    let alone = told(scans, "W_SCAN_ALONE", alone, |_| {
        "it stands alone between lost frames, and is left out: mend those, and it stays".into()
    });
    let doubtful = |fit: &Fit| fit.stretch > MOST_STRETCH || fit.beyond > MOST_BEYOND || fit.strain > MOST_STRAIN;
    let stretched = registered.tracked.iter().filter(|tracked| doubtful(&tracked.fit));
    let stretched: Vec<usize> = stretched.map(|tracked| tracked.frame).collect();
    let heirs = heirs(registered, &stretched);
    let inherited = match heirs {
        0 => String::new(),
        _ => format!("; {heirs} more were tracked from these, and are where these are wrong, too"),
    };
    let doubtful = told(scans, "W_SCAN_DOUBTFUL", &stretched, |frame| {
        let found = registered.tracked.iter().find(|tracked| tracked.frame == frame).map(|tracked| tracked.fit);
        let fit = found.unwrap_or_default();
        format!(
            "{:.1} % of the template lies off the scan, and edges are up to {:.2} times as long as before, {:.1} % off their \
             length on average: look at it (--report shows the worst), and leave it out if it is wrong{inherited}",
            100.0 * fit.beyond,
            fit.stretch,
            100.0 * fit.strain
        )
    });
    alone.into_iter().chain(doubtful).collect()
}

/// How many frames were tracked from those of `doubtful`, which are in order, from their children and so on.
fn heirs(registered: &Registered, doubtful: &[usize]) -> usize {
    let from: BTreeMap<usize, usize> =
        registered.tracked.iter().filter_map(|tracked| Some((tracked.frame, tracked.parent?))).collect();
    let is_doubtful = |frame: &usize| doubtful.binary_search(frame).is_ok();
    let is_heir = |frame: &&usize| {
        let ancestors = std::iter::successors(Some(**frame), |frame| from.get(frame).copied());
        !is_doubtful(frame) && ancestors.take(from.len() + 1).any(|ancestor| is_doubtful(&ancestor))
    };
    from.keys().filter(is_heir).count()
}

/// Writes frames as they are tracked.
struct Writer<'a> {
    scans: &'a Scans,
    files: CaptureWriter,
    projection: Option<Projection>,
    /// Frames whose textures were seen in full, and frames with masks.
    seen: [AtomicUsize; 2],
    truth: Option<Truth>,
}

impl<'a> Writer<'a> {
    fn new(
        scans: &'a Scans,
        template: &Template,
        root: usize,
        out: &Path,
        options: &ScanOptions,
    ) -> Result<Self, RegisterError> {
        let read = scans.read(root)?;
        let wanted = match &read.texture {
            Some(texture) if !read.uvs.is_empty() => {
                let (width, height, _) = texture.decoded()?;
                let area: f32 = read.uvs.iter().map(|[a, b, c]| (*b - *a).perp_dot(*c - *a).abs() * 0.5).sum();
                Some(area * width as f32 * height as f32)
            }
            _ if !read.colours.is_empty() => Some(read.positions.len() as f32 * TEXELS_OF_VERTEX),
            _ => None,
        };
        let mesh = &template.surface.mesh;
        let projection = wanted.map(|texels| {
            let size = (texels / COVERED).sqrt() as usize;
            let size = options.texture_size.unwrap_or(size.next_power_of_two().clamp(SIZES.0, SIZES.1));
            Projection::new(&template.surface, template.scale, size)
        });
        let plain = vec![[Vec2::ZERO; 3]; mesh.triangles.len()];
        let uvs = projection.as_ref().map_or(&plain, |projection| &projection.atlas.uvs);
        let files = CaptureWriter::new(out, &mesh.triangles, uvs, scans.sequences.len())?;
        let truth =
            options.truth.as_deref().map(|folder| Truth::read(folder, scans, (template, root, &read.positions)));
        Ok(Self { scans, files, projection, seen: Default::default(), truth: truth.transpose()? })
    }

    fn truth_of(&self, frame: usize) -> Option<TruthReport> {
        self.truth.as_ref().and_then(|truth| truth.of(frame))
    }

    fn take(&self, found: Found<Option<ScannedTexture>>) -> Result<(), RegisterError> {
        let Some((sequence, number)) = self.scans.place_of(found.tracked.frame) else { return Ok(()) };
        self.files.frame(sequence, number, found.pose)?;
        if let Some(truth) = &self.truth {
            truth.take(found.tracked.frame, found.pose)?;
        }
        let Some(projection) = &self.projection else { return Ok(()) };
        let texture = found.extra.as_ref().map(decoded).transpose()?;
        let posed = found.template.surface.posed(found.pose.to_vec());
        let mut projected = projection.project(&posed, found.target, found.uvs, texture.as_ref());
        let parent = found.tracked.parent.and_then(|parent| self.scans.place_of(parent));
        let other = match parent {
            Some((sequence, number)) => Some(self.files.written_texture(sequence, number)?),
            None => None,
        };
        projection.complete(&mut projected, other.as_deref());
        let large = projected.holes.len() as f64 > SMALL_HOLES * projection.atlas.texels.len() as f64;
        self.seen[usize::from(large)].fetch_add(1, Ordering::Relaxed);
        let unseen = if large { projected.holes.as_slice() } else { &[] };
        self.files.texture(sequence, number, projection.atlas.size, &projected.texels, unseen)?;
        Ok(())
    }
}
