//! All frames of a scan, tracked along the tree: frames whose parents are tracked go side by side; what fails is tried again
//! from others, and what fails then is lost, with the reason.

use std::collections::BTreeSet;
use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::{Quat, Vec3};
use job::work::Key;
use job::{Job, Stopped};
use rayon::prelude::*;

use super::checks::{Fault, Fit, Limits, fit};
use super::descriptor::{Descriptor, DescriptorOptions};
use super::detail::{Detail, DetailError};
use super::dissimilarity::Dissimilarity;
use super::far::track_far;
use super::groups::{Anchors, MeshMark, groups};
use super::scan::{Cleaned, Scan};
use super::surface::Surface;
use super::template::Template;
use super::track::{Target, TrackOptions, track};
use super::tree::{Candidate, Tree, choose_root};

/// Where a frame is far from all that are known, it is tried from so many of them.
const FAR_TRIES: usize = 4;
/// Frames that are nearer in time than so many are too much alike to try both.
const APART: usize = 8;
/// Area of a frame over the usual one, or the other way, beyond which it is no scan of this body.
const MOST_GROWTH: f32 = 2.0;
/// Edges of frames of one group that are so many times longer than in the other are no edges of one mesh.
const MOST_FOLLOWED_STRETCH: f64 = 2.0;
/// Changes whenever tracking finds something else in the same input.
const VERSION: u32 = 2;

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
                write!(f, "its surface is {times:.2} times that of most frames (is it in the same unit?)")
            }
            Self::Untracked(Fault::Uncovered, fit) => {
                write!(f, "the template leaves {:.1} % of it uncovered", 100.0 * fit.uncovered)
            }
            Self::Untracked(Fault::Loose, fit) => {
                write!(f, "the template lies {:.1} mm off it", 1000.0 * fit.rms_backward)
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
    /// The keyframe group of each of `frames`.
    pub groups: Vec<usize>,
}

/// A frame that was tracked.
#[derive(Clone, Debug, PartialEq)]
pub struct Tracked {
    /// The frame.
    pub frame: usize,
    /// The frame that it was tracked from; none for the template's own.
    pub parent: Option<usize>,
    /// How the template lies on it, without detail.
    pub fit: Fit,
    /// From how many frames it was tried.
    pub tries: usize,
    /// Whether it followed its parent, of which every point is known, instead of being tracked.
    pub followed: bool,
}

/// A frame just tracked, for whoever writes it.
#[derive(Debug)]
pub struct Found<'a, X> {
    /// The template.
    pub template: &'a Template,
    /// What was found.
    pub tracked: &'a Tracked,
    /// The template's pose on the frame, with detail.
    pub pose: &'a [Vec3],
    /// The frame's surface, ready for closest points.
    pub target: &'a Target,
    /// Texture coordinates of the corners of its triangles; empty where there are none.
    pub uvs: &'a [[glam::Vec2; 3]],
    /// What else it holds.
    pub extra: X,
}

/// Who is given every frame that is tracked, from many threads at once.
pub type Emit<'a, S> = &'a (dyn Fn(Found<'_, <S as Source>::Extra>) -> Result<(), <S as Source>::Error> + Sync);

/// What a frame is like, whether it was turned inside out and whether parts of it float about, and what tells its mesh.
type Look = (Candidate, [bool; 2], MeshMark);

/// What became of all frames.
#[derive(Clone, Debug)]
pub struct Registered {
    /// The frames that were tracked, in order.
    pub tracked: Vec<Tracked>,
    /// The frames that were lost, in order, and why.
    pub lost: Vec<(usize, Lost)>,
}

/// A frame, cleaned; whether it was turned inside out.
fn cleaned(scan: &mut Scan) -> Option<(Cleaned, bool)> {
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
            (Candidate { parts: cleaned.parts, handles, area: surface.area() }, [turned, cleaned.debris > 0], mark)
        });
        looked_at("looking at scans", &done)?;
        Ok(found)
    };
    let seen: Vec<Result<Option<Look>, S::Error>> = (0..count).into_par_iter().map(look).collect();
    let seen: Vec<Option<Look>> = seen.into_iter().collect::<Result<_, _>>()?;
    let mut areas: Vec<f32> = seen.iter().flatten().map(|(candidate, ..)| candidate.area).collect();
    areas.sort_by(f32::total_cmp);
    let usual = areas.get(areas.len() / 2).copied().unwrap_or(1.0).max(1e-12);
    let (mut frames, mut candidates, mut lost) = (Vec::new(), Vec::new(), Vec::new());
    let (mut turned, mut littered, mut marks) = (Vec::new(), Vec::new(), Vec::new());
    for (frame, seen) in seen.into_iter().enumerate() {
        match seen {
            None => lost.push((frame, Lost::Empty)),
            Some((candidate, ..)) if !(usual / MOST_GROWTH..=usual * MOST_GROWTH).contains(&candidate.area) => {
                lost.push((frame, Lost::Size(candidate.area / usual)));
            }
            Some((candidate, [inside_out, debris], mark)) => {
                frames.push(frame);
                candidates.push(candidate);
                marks.push(mark);
                turned.extend(inside_out.then_some(frame));
                littered.extend(debris.then_some(frame));
            }
        }
    }
    let scale = (usual / 2.2).sqrt();
    let done = AtomicU64::new(lost.len() as u64);
    let describe = |&frame: &usize| -> Result<Option<Descriptor>, S::Error> {
        let mut scan = source.shape(frame)?;
        let found = cleaned(&mut scan);
        let found = found.map(|(cleaned, _)| Descriptor::new(&cleaned.surface, scale, &options.descriptor));
        looked_at("describing scans", &done)?;
        Ok(found)
    };
    let described: Vec<Result<Option<Descriptor>, S::Error>> = frames.par_iter().map(describe).collect();
    let described: Vec<Option<Descriptor>> = described.into_iter().collect::<Result<_, _>>()?;
    let descriptors: Vec<Descriptor> = described.into_iter().flatten().collect();
    job.begin("comparing scans")?;
    let dissimilarity = Dissimilarity::new(&descriptors);
    Ok(Survey { frames, candidates, dissimilarity, lost, turned, littered, groups: groups(&marks) })
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
    Ok(cleaned(&mut scan).and_then(|(cleaned, _)| Template::new(cleaned.manifold())))
}

/// Tracks `template` through all frames of `survey` along `tree`. `emit` is given every frame that is tracked, from many threads
/// at once, a parent always before its children.
///
/// # Errors
/// What `source` or `emit` say, or being told to stop.
pub fn register<S: Source>(
    source: &S,
    survey: &Survey,
    tree: &Tree,
    template: &Template,
    options: &RegisterOptions,
    job: &Job,
    emit: Emit<'_, S>,
) -> Result<Registered, S::Error>
where
    S::Error: From<DetailError>,
{
    let detail = Detail::new(&template.surface, template.scale)?;
    let neighbours = template.surface.mesh.neighbours();
    let registrar = Registrar { source, survey, template, neighbours, detail, options, job, emit };
    let count = survey.frames.len();
    let mut state: Vec<State> = (0..count).map(|_| State::default()).collect();
    let done = AtomicU64::new(0);
    job.tell("registering", 0, count as u64)?;
    registrar.work(&[(tree.root, Way::Root)], &mut state, &done)?;
    loop {
        // First along the tree, then from what is beside in time; what is left is far from all.
        let able = |k: usize, parent: usize| state[parent].pose.is_some() && !state[k].tried.contains(&parent);
        let waiting: Vec<usize> = (0..count).filter(|&k| state[k].pose.is_none()).collect();
        let of_tree = |&k: &usize| tree.parents[k].filter(|&p| able(k, p)).map(|p| (k, Way::Near(p)));
        let mut open: Vec<(usize, Way)> = waiting.iter().filter_map(of_tree).collect();
        if open.is_empty() {
            let beside = |&k: &usize| registrar.beside(k, &able).map(|p| (k, Way::Near(p)));
            open = waiting.iter().filter_map(beside).collect();
        }
        if open.is_empty() {
            open = registrar.far(&waiting, &state);
        }
        if open.is_empty() {
            break;
        }
        registrar.work(&open, &mut state, &done)?;
    }
    let mut lost = survey.lost.clone();
    let mut tracked = Vec::new();
    for (k, state) in state.into_iter().enumerate() {
        match (state.tracked, state.failed) {
            (Some(found), _) => tracked.push(found),
            (None, Some((fault, fit))) => lost.push((survey.frames[k], Lost::Untracked(fault, fit))),
            (None, None) => lost.push((survey.frames[k], Lost::Empty)),
        }
    }
    lost.sort_by_key(|&(frame, _)| frame);
    Ok(Registered { tracked, lost })
}

/// What is known of a frame so far.
#[derive(Clone, Debug, Default)]
struct State {
    /// The template's pose without detail, which children are tracked from.
    pose: Option<Vec<Vec3>>,
    /// The template on the frame, without detail and with it, for others of its group.
    anchors: Option<[Anchors; 2]>,
    tracked: Option<Tracked>,
    tried: Vec<usize>,
    /// Whether it was tried as a frame that is far from all.
    far: bool,
    failed: Option<(Fault, Fit)>,
}

/// How a frame is come by.
#[derive(Clone, Debug)]
enum Way {
    /// It is the template's own.
    Root,
    /// From a frame that is near.
    Near(usize),
    /// From each of some that are far, of which the best is kept.
    Far(Vec<usize>),
}

impl Way {
    fn parents(&self) -> &[usize] {
        match self {
            Self::Root => &[],
            Self::Near(parent) => std::slice::from_ref(parent),
            Self::Far(parents) => parents,
        }
    }
}

struct Registrar<'a, S: Source> {
    source: &'a S,
    survey: &'a Survey,
    template: &'a Template,
    /// Of the template's vertices.
    neighbours: Vec<Vec<u32>>,
    detail: Detail,
    options: &'a RegisterOptions,
    job: &'a Job<'a>,
    emit: Emit<'a, S>,
}

enum Outcome {
    Good(Box<Good>),
    Bad(Fault, Fit),
}

/// A frame that was tracked, for those after it.
struct Good {
    pose: Vec<Vec3>,
    anchors: Option<[Anchors; 2]>,
    tracked: Tracked,
}

impl<S: Source> Registrar<'_, S>
where
    S::Error: From<DetailError>,
{
    /// The frame beside `k` in time that it can be tried from, the more alike where both can.
    fn beside(&self, k: usize, able: &impl Fn(usize, usize) -> bool) -> Option<usize> {
        let found = [k.checked_sub(1), Some(k + 1)].into_iter().flatten().filter(|&p| self.follow(p, k) && able(k, p));
        found.min_by(|&a, &b| self.unlike(k, a).total_cmp(&self.unlike(k, b)))
    }

    /// Whether frames follow each other in a sequence.
    fn follow(&self, a: usize, b: usize) -> bool {
        let frames = &self.survey.frames;
        a.max(b) < frames.len()
            && frames[a].abs_diff(frames[b]) == 1
            && self.source.sequence(frames[a]) == self.source.sequence(frames[b])
    }

    fn unlike(&self, a: usize, b: usize) -> f32 {
        self.survey.dissimilarity.get(a, b)
    }

    /// Of every run of frames that wait, the one that is most alike to tracked frames, and these: the others may follow it.
    fn far(&self, waiting: &[usize], state: &[State]) -> Vec<(usize, Way)> {
        let nearest = |k: usize| {
            let mut known: Vec<usize> = (0..state.len()).filter(|&p| state[p].pose.is_some()).collect();
            known.sort_by(|&a, &b| self.unlike(k, a).total_cmp(&self.unlike(k, b)).then(a.cmp(&b)));
            self.apart(&known)
        };
        let mut open = Vec::new();
        for run in waiting.chunk_by(|&a, &b| self.follow(a, b)) {
            let tries = run.iter().filter(|&&k| !state[k].far).map(|&k| (k, nearest(k)));
            let of =
                |(k, parents): &(usize, Vec<usize>)| parents.first().map_or(f32::INFINITY, |&p| self.unlike(*k, p));
            let best = tries.min_by(|a, b| of(a).total_cmp(&of(b)).then(a.0.cmp(&b.0)));
            open.extend(best.filter(|(_, parents)| !parents.is_empty()).map(|(k, parents)| (k, Way::Far(parents))));
        }
        open
    }

    /// The first of `frames`, without those that are too much alike to give another result.
    fn apart(&self, frames: &[usize]) -> Vec<usize> {
        let mut apart: Vec<usize> = Vec::new();
        for &frame in frames {
            if apart.len() == FAR_TRIES {
                break;
            }
            if !apart.iter().any(|&other| self.near_in_time(frame, other)) {
                apart.push(frame);
            }
        }
        apart
    }

    /// Whether frames are of one run.
    fn near_in_time(&self, a: usize, b: usize) -> bool {
        let frames = &self.survey.frames;
        frames[a].abs_diff(frames[b]) < APART && self.source.sequence(frames[a]) == self.source.sequence(frames[b])
    }

    /// Tracks frames side by side.
    fn work(&self, open: &[(usize, Way)], state: &mut [State], done: &AtomicU64) -> Result<(), S::Error> {
        let total = self.survey.frames.len() as u64;
        let before: &[State] = state;
        let one = |(k, way): &(usize, Way)| -> Result<Outcome, S::Error> {
            let found = self.frame(*k, way, before)?;
            if matches!(found, Outcome::Good(..)) {
                self.job.tell("registering", done.fetch_add(1, Ordering::Relaxed) + 1, total)?;
            } else {
                self.job.tell("registering", done.load(Ordering::Relaxed), total)?;
            }
            Ok(found)
        };
        let found: Vec<Result<Outcome, S::Error>> = open.par_iter().map(one).collect();
        for ((k, way), found) in open.iter().zip(found) {
            let state = &mut state[*k];
            state.tried.extend(way.parents());
            state.far |= matches!(way, Way::Far(_));
            match found? {
                Outcome::Good(good) => {
                    let Good { pose, anchors, tracked } = *good;
                    (state.pose, state.anchors, state.tracked) = (Some(pose), anchors, Some(tracked));
                }
                // The first failure, along the tree, is the one to tell of.
                Outcome::Bad(fault, fit) => {
                    state.failed.get_or_insert((fault, fit));
                }
            }
        }
        Ok(())
    }

    fn frame(&self, k: usize, way: &Way, state: &[State]) -> Result<Outcome, S::Error> {
        let frame = self.survey.frames[k];
        let (mut scan, extra) = self.source.read(frame)?;
        let (template, nothing) = (self.template, Fit { uncovered: 1.0, ..Fit::default() });
        let Some((cleaned, _)) = cleaned(&mut scan) else { return Ok(Outcome::Bad(Fault::Uncovered, nothing)) };
        let Cleaned { surface, uvs, kept, .. } = cleaned;
        let target = Target::new(surface, template.scale);
        let followed = match way {
            Way::Near(parent) => self.followed(&state[*parent], &scan, &target),
            _ => None,
        };
        let is_followed = followed.is_some();
        let found = if is_followed { None } else { self.found(k, way, state, &target) };
        let (parent, pose, detailed, fit) = match (followed, found) {
            (Some((pose, detailed, fit)), _) => (way.parents().first().copied(), pose, Some(detailed), fit),
            (None, Some((parent, pose, fit))) => (Some(parent), pose, None, fit),
            (None, None) => {
                let own = template.surface.mesh.positions.clone();
                let fit = fit(template, &template.surface, &own, &target.surface);
                (None, own.clone(), Some(own), fit)
            }
        };
        if let Some(fault) = fit.fault(&self.options.limits, template.scale).filter(|_| parent.is_some()) {
            return Ok(Outcome::Bad(fault, fit));
        }
        let detailed = match detailed {
            Some(detailed) => detailed,
            None if self.options.detail > 0.0 => {
                self.detail.add(&template.surface, &pose, &target, self.options.detail)?
            }
            None => pose.clone(),
        };
        let anchors = if self.is_followed(k, parent) {
            let [plain, detailed] = [&pose, &detailed].map(|pose| {
                let posed = template.surface.posed(pose.clone());
                Anchors::new((&scan, &kept), &posed, template.scale, |place, normal| target.closest(place, normal))
            });
            plain.zip(detailed).map(|(plain, detailed)| [plain, detailed])
        } else {
            None
        };
        let parent = parent.map(|parent| self.survey.frames[parent]);
        let tracked = Tracked { frame, parent, fit, tries: state[k].tried.len() + 1, followed: is_followed };
        (self.emit)(Found { template, tracked: &tracked, pose: &detailed, target: &target, uvs: &uvs, extra })?;
        Ok(Outcome::Good(Box::new(Good { pose, anchors, tracked })))
    }

    /// The parent, the pose that is found from it and how it fits: the best of all parents.
    fn found(&self, k: usize, way: &Way, state: &[State], target: &Target) -> Option<(usize, Vec<Vec3>, Fit)> {
        let template = self.template;
        let of = |&parent: &usize| {
            let from = state[parent].pose.as_ref()?;
            let start = moved(template, from, &target.surface, self.survey.dissimilarity.turn(parent, k));
            let pose = self.tracked(&start, target, matches!(way, Way::Far(_)));
            let fit = fit(template, &template.surface.posed(pose.clone()), &start, &target.surface);
            Some((parent, pose, fit))
        };
        let found = way.parents().iter().filter_map(of);
        found.min_by(|a, b| a.2.badness(template.scale).total_cmp(&b.2.badness(template.scale)))
    }

    /// The template's poses on a frame of the parent's group, where it is the same mesh indeed: without detail, and with it.
    fn followed(&self, parent: &State, scan: &Scan, target: &Target) -> Option<(Vec<Vec3>, Vec<Vec3>, Fit)> {
        let (from, [plain, detailed]) = (parent.pose.as_ref()?, parent.anchors.as_ref()?);
        let (pose, detailed) = (plain.follow(scan, &self.neighbours)?, detailed.follow(scan, &self.neighbours)?);
        let template = self.template;
        let fit = fit(template, &template.surface.posed(pose.clone()), from, &target.surface);
        let sound = fit.fault(&self.options.limits, template.scale).is_none() && fit.stretch < MOST_FOLLOWED_STRETCH;
        sound.then_some((pose, detailed, fit))
    }

    /// Whether others of its group follow a frame: the first of it in the tree.
    fn is_followed(&self, k: usize, parent: Option<usize>) -> bool {
        let groups = &self.survey.groups;
        let others = groups.iter().filter(|&&group| group == groups[k]).nth(1).is_some();
        others && parent.is_none_or(|parent| groups[parent] != groups[k])
    }

    /// The pose tracked from `start`, or what the work folder holds of it.
    fn tracked(&self, start: &[Vec3], target: &Target, far: bool) -> Vec<Vec3> {
        let (template, options) = (self.template, &self.options.track);
        let find =
            || if far { track_far(template, start, target, options) } else { track(template, start, target, options) };
        let Some(work) = self.job.work() else { return find() };
        let bytes = |surface: &Surface| -> Vec<u8> {
            let mesh = &surface.mesh;
            let mut bytes = bytemuck::cast_slice(&mesh.positions).to_vec();
            bytes.extend_from_slice(bytemuck::cast_slice(&mesh.triangles));
            bytes.extend_from_slice(bytemuck::cast_slice(surface.colours.as_deref().unwrap_or_default()));
            bytes
        };
        let key = Key::new("registered", VERSION)
            .told(&(&self.options.track, far))
            .of(&bytes(&self.template.surface))
            .of(&bytes(&target.surface))
            .of(bytemuck::cast_slice(start));
        if let Some(kept) = work.get(&key).filter(|kept| kept.len() == size_of_val(start)) {
            return bytemuck::pod_collect_to_vec(&kept);
        }
        let pose = find();
        // A result that cannot be kept is found again another time.
        let _ = work.put(&key, bytemuck::cast_slice(&pose));
        pose
    }
}

/// `pose` turned about +Y and moved so that its centroid is that of `target`.
fn moved(template: &Template, pose: &[Vec3], target: &Surface, turn: f32) -> Vec<Vec3> {
    let mesh = geometry::mesh::Mesh { positions: pose.to_vec(), triangles: template.surface.mesh.triangles.clone() };
    let (from, to, turn) = (Surface::new(mesh, None).centroid(), target.centroid(), Quat::from_rotation_y(turn));
    pose.iter().map(|&p| turn * (p - from) + to).collect()
}
