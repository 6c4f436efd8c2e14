//! All frames of a scan before one is tracked: which of them hold a body, what each is like, and how unlike they are.

use std::collections::BTreeSet;
use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering};

use job::{Job, Stopped};
use rayon::prelude::*;

use super::checks::{Fault, Fit, Limits};
use super::descriptor::{Descriptor, DescriptorOptions};
use super::dissimilarity::Dissimilarity;
use super::groups::{MeshMark, groups};
use super::scan::{Cleaned, Mended, Scan};
use super::surface::Surface;
use super::template::Template;
use super::track::TrackOptions;
use super::tree::{Candidate, Tree, choose_root};

/// Area of a frame over the usual one, or the other way, beyond which it is no scan of this body.
const MOST_GROWTH: f32 = 2.0;

/// How a scan is registered.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RegisterOptions {
    /// How frames are described.
    pub descriptor: DescriptorOptions,
    /// The frame whose mesh is the template; chosen where not given.
    pub template: Option<usize>,
    /// How frames are tracked.
    pub track: TrackOptions,
    /// When a frame counts as lost.
    pub limits: Limits,
    /// How smooth detail is, square metres on a person; 0 without any.
    pub detail: f32,
}

impl Default for RegisterOptions {
    fn default() -> Self {
        Self {
            descriptor: DescriptorOptions::default(),
            template: None,
            track: TrackOptions::default(),
            limits: Limits::default(),
            detail: 2e-4,
        }
    }
}

/// Where frames come from. Frames are counted over all sequences.
pub trait Source: Sync {
    /// What a frame holds beside its surface.
    type Extra: Send;
    /// Why a frame cannot be read.
    type Error: From<Stopped> + Send;

    /// Number of frames.
    fn count(&self) -> usize;

    /// The sequence of a frame.
    fn sequence(&self, frame: usize) -> usize;

    /// Reads a frame.
    ///
    /// # Errors
    /// What is wrong with it.
    fn read(&self, frame: usize) -> Result<(Scan, Self::Extra), Self::Error>;

    /// Reads a frame without its colours, where that is less work.
    ///
    /// # Errors
    /// What is wrong with it.
    fn shape(&self, frame: usize) -> Result<Scan, Self::Error> {
        self.read(frame).map(|(scan, _)| scan)
    }
}

/// Why a frame is not part of the result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lost {
    /// It holds no surface.
    Empty,
    /// Its area is so many times that of most frames.
    Size(f32),
    /// The template did not cover it, from whichever frame it was tracked.
    Untracked(Fault, Fit),
}

impl fmt::Display for Lost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => write!(f, "no surface is left without crumbs"),
            Self::Size(times) => {
                write!(f, "its surface is {times:.2} times that of most frames (another unit, or noise?)")
            }
            Self::Untracked(Fault::Uncovered, fit) => {
                write!(f, "the template leaves {:.1} % of it uncovered", 100.0 * fit.uncovered)
            }
            Self::Untracked(Fault::Loose, fit) => {
                write!(f, "the template lies {:.1} mm off it", 1000.0 * fit.rms_backward)
            }
            Self::Untracked(Fault::Strained, fit) => {
                write!(f, "the template's edges are {:.1} % too long or too short on it", 100.0 * fit.strain)
            }
        }
    }
}

/// What is known of all frames before one is tracked.
#[derive(Clone, Debug)]
pub struct Survey {
    /// The frames that hold a body, in order; what follows is of these.
    pub frames: Vec<usize>,
    /// What each is like.
    pub candidates: Vec<Candidate>,
    /// How unlike they are.
    pub dissimilarity: Dissimilarity,
    /// Frames that hold none, and why.
    pub lost: Vec<(usize, Lost)>,
    /// Frames whose triangles were turned, for they faced inwards.
    pub turned: Vec<usize>,
    /// Frames of which parts that float about were left out.
    pub littered: Vec<usize>,
    /// Frames of which single triangles were left out, and how many.
    pub mended: Vec<(usize, Mended)>,
    /// The keyframe group of each of `frames`.
    pub groups: Vec<usize>,
}

/// What a frame is like, whether it was turned inside out and whether parts of it float about, what else was mended, and what tells its mesh.
type Look = (Candidate, [bool; 2], Mended, MeshMark);

/// A frame, cleaned; whether it was turned, for its triangles faced inwards. `None` where nothing is left.
pub fn cleaned(scan: &mut Scan) -> Option<(Cleaned, bool)> {
    let cleaned = scan.cleaned()?;
    if cleaned.surface.mesh.volume() >= 0.0 {
        return Some((cleaned, false));
    }
    scan.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    scan.uvs.iter_mut().for_each(|uvs| uvs.swap(1, 2));
    scan.cleaned().map(|cleaned| (cleaned, true))
}

/// Looks at all frames of `source` and compares them.
///
/// # Errors
/// What `source` says, or being told to stop.
pub fn survey<S: Source>(source: &S, options: &RegisterOptions, job: &Job) -> Result<Survey, S::Error> {
    let count = source.count();
    let looked_at = |what: &'static str, done: &AtomicU64| -> Result<(), Stopped> {
        job.tell(what, done.fetch_add(1, Ordering::Relaxed) + 1, count as u64)
    };
    job.tell("looking at scans", 0, count as u64)?;
    let done = AtomicU64::new(0);
    let look = |frame: usize| -> Result<Option<Look>, S::Error> {
        let mut scan = source.shape(frame)?;
        let mark = MeshMark::new(&scan);
        let found = cleaned(&mut scan).map(|(cleaned, turned)| {
            let surface = &cleaned.surface;
            let handles = handles_of(surface, cleaned.parts);
            (
                Candidate { parts: cleaned.parts, handles, area: surface.area() },
                [turned, cleaned.debris > 0],
                cleaned.mended,
                mark,
            )
        });
        looked_at("looking at scans", &done)?;
        Ok(found)
    };
    let seen: Vec<Result<Option<Look>, S::Error>> = (0..count).into_par_iter().map(look).collect();
    let seen: Vec<Option<Look>> = seen.into_iter().collect::<Result<_, _>>()?;
    let usual = usual(seen.iter().flatten().map(|(candidate, ..)| candidate.area));
    let (mut frames, mut candidates, mut lost) = (Vec::new(), Vec::new(), Vec::new());
    let (mut turned, mut littered, mut mended, mut marks) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (frame, seen) in seen.into_iter().enumerate() {
        match seen {
            None => lost.push((frame, Lost::Empty)),
            Some((candidate, ..)) if !(usual / MOST_GROWTH..=usual * MOST_GROWTH).contains(&candidate.area) => {
                lost.push((frame, Lost::Size(candidate.area / usual)));
            }
            Some((candidate, [inside_out, debris], left_out, mark)) => {
                frames.push(frame);
                candidates.push(candidate);
                marks.push(mark);
                turned.extend(inside_out.then_some(frame));
                littered.extend(debris.then_some(frame));
                mended.extend((left_out != Mended::default()).then_some((frame, left_out)));
            }
        }
    }
    let descriptors = described(source, &frames, &candidates, options, job)?;
    job.begin("comparing scans")?;
    let dissimilarity = Dissimilarity::new(&descriptors);
    Ok(Survey { frames, candidates, dissimilarity, lost, turned, littered, mended, groups: groups(&marks) })
}

/// What `frames` of `source` are like; their areas, of `candidates`, say how large the body is.
fn described<S: Source>(
    source: &S,
    frames: &[usize],
    candidates: &[Candidate],
    options: &RegisterOptions,
    job: &Job,
) -> Result<Vec<Descriptor>, S::Error> {
    let scale = (usual(candidates.iter().map(|candidate| candidate.area)) / 2.2).sqrt();
    let (done, total) = (AtomicU64::new(0), frames.len() as u64);
    let describe = |&frame: &usize| -> Result<Option<Descriptor>, S::Error> {
        let mut scan = source.shape(frame)?;
        let found = cleaned(&mut scan);
        let found = found.map(|(cleaned, _)| Descriptor::new(&cleaned.surface, scale, &options.descriptor));
        job.tell("describing scans", done.fetch_add(1, Ordering::Relaxed) + 1, total)?;
        Ok(found)
    };
    let found: Vec<Result<Option<Descriptor>, S::Error>> = frames.par_iter().map(describe).collect();
    Ok(found.into_iter().collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
}

/// The middle one of areas.
fn usual(areas: impl Iterator<Item = f32>) -> f32 {
    let mut areas: Vec<f32> = areas.collect();
    areas.sort_by(f32::total_cmp);
    areas.get(areas.len() / 2).copied().unwrap_or(1.0).max(1e-12)
}

/// How unlike windows of `reach` frames to both sides about all frames of `survey` are.
///
/// # Errors
/// What `source` says, or being told to stop.
pub fn windowed<S: Source>(
    source: &S,
    survey: &Survey,
    reach: usize,
    options: &RegisterOptions,
    job: &Job,
) -> Result<Dissimilarity, S::Error> {
    let descriptors = described(source, &survey.frames, &survey.candidates, options, job)?;
    let sequences: Vec<usize> = survey.frames.iter().map(|&frame| source.sequence(frame)).collect();
    Ok(Dissimilarity::windowed(&descriptors, &sequences, reach))
}

/// Handles by the Euler number, rounded up; what is open counts as handles, too.
fn handles_of(surface: &Surface, parts: usize) -> i64 {
    let mesh = &surface.mesh;
    let edges: BTreeSet<[u32; 2]> = mesh
        .triangles
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    let euler = mesh.positions.len() as i64 - edges.len() as i64 + mesh.triangles.len() as i64;
    (2 * parts as i64 - euler + 1).div_euclid(2).abs()
}

impl Survey {
    /// The frame that is the template, as a number among [`Self::frames`]: `wanted`, if it is one of them.
    #[must_use]
    pub fn root(&self, wanted: Option<usize>) -> usize {
        let wanted = wanted.and_then(|wanted| self.frames.iter().position(|&frame| frame == wanted));
        wanted.unwrap_or_else(|| choose_root(&self.candidates, &self.dissimilarity))
    }

    /// The same of some of the frames alone, which `which` numbers in order; what was said of single frames is left out.
    #[must_use]
    pub fn only(&self, which: &[usize]) -> Self {
        Self {
            frames: which.iter().map(|&k| self.frames[k]).collect(),
            candidates: which.iter().map(|&k| self.candidates[k]).collect(),
            dissimilarity: self.dissimilarity.only(which),
            lost: Vec::new(),
            turned: Vec::new(),
            littered: Vec::new(),
            mended: Vec::new(),
            groups: which.iter().map(|&k| self.groups[k]).collect(),
        }
    }

    /// The order in which frames are tracked.
    #[must_use]
    pub fn tree(&self, wanted: Option<usize>) -> Tree {
        Tree::new(&self.dissimilarity, self.root(wanted)).grouped(&self.groups)
    }
}

/// The template from frame `frame` of `source`; `None` where it has no surface.
///
/// # Errors
/// What `source` says.
pub fn template<S: Source>(source: &S, frame: usize) -> Result<Option<Template>, S::Error> {
    let (mut scan, _) = source.read(frame)?;
    Ok(cleaned(&mut scan).and_then(|(cleaned, _)| Template::of(&cleaned)))
}
