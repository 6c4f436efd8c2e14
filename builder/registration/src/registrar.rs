//! One frame: the template is tracked onto it from frames that are known.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::{Quat, Vec3};
use job::Job;
use job::work::Key;
use rayon::prelude::*;

use super::checks::{Fault, Fit, fit};
use super::colouring::{Colourings, Worn, are_others, shown};
use super::detail::{Detail, DetailError};
use super::far::Manner;
use super::groups::Anchors;
use super::headings::headings;
use super::round::{self, Round};
use super::scan::{Cleaned, Scan};
use super::slip::{SLIPS, roundness, slipped};
use super::surface::Surface;
use super::survey::{RegisterOptions, Source, Survey, cleaned};
use super::template::Template;
use super::track::Target;
use super::tracked::{Emit, Found, Tracked};
use super::twists::Twists;
use super::ways::{Known, Way};

/// Headings that a far frame is tried with, radians from the one by which it is most alike: a leg that is raised turns that.
const TURNS: [f32; 3] = [0.0, 0.8, -0.8];
/// Of the poses that came near so many are refined, and of those so many once more.
const REFINED: usize = 10;
const AGAIN: usize = 4;
/// What is found from so many parents is turned, each by itself.
const TURNED: usize = 4;
/// So often what is round is turned, as a whole and by its shares.
const MOST_TURNS: usize = 4;
const MOST_SLIPS: usize = 4;
/// What is strained less ([`Fit::strain`]) is settled.
const SETTLED: f64 = 0.03;
/// So many times as much as colours strain counts, where sides of what is round are turned each by itself, and so often that is done.
const STRAINS: [f32; 2] = [1.0, 4.0];
const MOST_TWISTS: usize = 3;
/// Edges of frames of one group that are so many times longer than in the other are no edges of one mesh.
const MOST_FOLLOWED_STRETCH: f64 = 2.0;
/// Changes whenever tracking finds something else in the same input.
const VERSION: u32 = 2;

/// What is known of a frame so far.
#[derive(Clone, Debug, Default)]
pub(crate) struct State {
    /// The template's pose without detail, which children are tracked from.
    pub pose: Option<Vec<Vec3>>,
    /// The template on the frame, without detail and with it, for others of its group.
    pub anchors: Option<[Anchors; 2]>,
    pub tracked: Option<Tracked>,
    pub failed: Option<(Fault, Fit)>,
}

/// A pose that was found.
pub(crate) struct Tried {
    pub parent: usize,
    /// What it was held against.
    start: Vec<Vec3>,
    pub pose: Vec<Vec3>,
    pub fit: Fit,
}

/// Where a far frame is tracked from: from which frame, whether by closest points alone, too, and the pose.
type Start = (usize, bool, Vec<Vec3>);

/// Brings one template onto frames.
pub(crate) struct Registrar<'a, S: Source> {
    source: &'a S,
    survey: &'a Survey,
    /// In the colours that it is looked for with.
    template: Arc<Template>,
    shape: Arc<Shape>,
    options: &'a RegisterOptions,
    pub job: &'a Job<'a>,
    emit: Emit<'a, S>,
}

/// What the template is like in all colours.
struct Shape {
    /// Of its vertices.
    neighbours: Vec<Vec<u32>>,
    /// What of it may be found turned.
    round: Option<Round>,
    twists: Option<Twists>,
    detail: Detail,
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
    /// What it was found with, and the colours that it shows, where that was its shape alone.
    worn: Worn,
    colours: Option<Vec<Vec3>>,
}

/// What was found, with what, and the colours that the frame shows where that was its shape alone.
struct Dressed {
    tried: Option<Tried>,
    worn: Worn,
    colours: Option<Vec<Vec3>>,
}

impl<'a, S: Source> Registrar<'a, S>
where
    S::Error: From<DetailError>,
{
    /// Of `template`, on frames of `survey`.
    pub fn new(
        (source, survey): (&'a S, &'a Survey),
        template: &Template,
        options: &'a RegisterOptions,
        job: &'a Job<'a>,
        emit: Emit<'a, S>,
    ) -> Result<Self, DetailError> {
        let detail = Detail::new(&template.surface, template.scale)?;
        let neighbours = template.surface.mesh.neighbours();
        let round = Round::new(template, &neighbours);
        let twists = round.as_ref().and_then(|round| Twists::new(round, &template.surface, template.scale));
        let template = Arc::new(template.coloured(template.surface.colours.clone()));
        let shape = Arc::new(Shape { neighbours, round, twists, detail });
        Ok(Self { source, survey, template, shape, options, job, emit })
    }

    /// The same, that looks for the template in other colours.
    fn wearing(&self, template: Arc<Template>) -> Self {
        let Self { source, survey, options, job, emit, .. } = *self;
        Self { source, survey, template, shape: Arc::clone(&self.shape), options, job, emit }
    }

    /// A frame, ready to be tracked to; `None` where it has no surface.
    pub fn target(&self, k: usize) -> Result<Option<Target>, S::Error> {
        let (mut scan, _) = self.source.read(self.survey.frames[k])?;
        Ok(cleaned(&mut scan).map(|(cleaned, _)| Target::new(cleaned.surface, self.template.scale)))
    }

    /// Tracks frames side by side.
    pub fn work(
        &self,
        open: &[(usize, Way)],
        (state, colourings): (&mut [State], &mut Colourings),
        known: &[Known],
        done: &AtomicU64,
    ) -> Result<(), S::Error> {
        let total = self.survey.frames.len() as u64;
        let before: (&[State], &Colourings) = (state, colourings);
        let one = |(k, way): &(usize, Way)| -> Result<Outcome, S::Error> {
            let found = self.frame(*k, way, before, known[*k].tried.len())?;
            if matches!(found, Outcome::Good(..)) {
                self.job.tell("registering", done.fetch_add(1, Ordering::Relaxed) + 1, total)?;
            } else {
                self.job.tell("registering", done.load(Ordering::Relaxed), total)?;
            }
            Ok(found)
        };
        let found: Vec<Result<Outcome, S::Error>> = open.par_iter().map(one).collect();
        for ((k, _), found) in open.iter().zip(found) {
            let (frame, state) = (self.survey.frames[*k], &mut state[*k]);
            match found? {
                Outcome::Good(good) => {
                    let Good { pose, anchors, tracked, worn, colours } = *good;
                    colourings.decide((self.source.sequence(frame), frame), worn, colours);
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

    fn frame(
        &self,
        k: usize,
        way: &Way,
        (state, colourings): (&[State], &Colourings),
        tried: usize,
    ) -> Result<Outcome, S::Error> {
        let frame = self.survey.frames[k];
        let (mut scan, extra) = self.source.read(frame)?;
        let (template, nothing) = (&*self.template, Fit { uncovered: 1.0, ..Fit::default() });
        let Some((cleaned, _)) = cleaned(&mut scan) else { return Ok(Outcome::Bad(Fault::Uncovered, nothing)) };
        let Cleaned { surface, uvs, kept, .. } = cleaned;
        let target = Target::new(surface, template.scale);
        let followed = match way {
            Way::Near(parent) => self.followed(&state[*parent], &scan, &target),
            _ => None,
        };
        let is_followed = followed.is_some();
        let own = Dressed { tried: None, worn: Worn::Known(0), colours: None };
        let Dressed { tried: found, worn, colours } =
            if is_followed { own } else { self.dressed(k, way, (state, colourings), &target) };
        let (parent, pose, detailed, fit) = match (followed, found) {
            (Some((pose, detailed, fit)), _) => (way.parents().first().copied(), pose, Some(detailed), fit),
            (None, Some(tried)) => (Some(tried.parent), tried.pose, None, tried.fit),
            (None, None) => {
                let own = template.surface.mesh.positions.clone();
                let fit = fit(template, &template.surface, &own, &target.surface);
                (None, own.clone(), Some(own), fit)
            }
        };
        let (limits, scale) = (&self.options.limits, template.scale);
        let fault = if matches!(way, Way::Far(_)) { fit.far_fault(limits, scale) } else { fit.fault(limits, scale) };
        if let Some(fault) = fault.filter(|_| parent.is_some()) {
            return Ok(Outcome::Bad(fault, fit));
        }
        let detailed = match detailed {
            Some(detailed) => detailed,
            None if self.options.detail > 0.0 => {
                self.shape.detail.add(&template.surface, &pose, &target, self.options.detail)?
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
        let tries = tried + way.parents().len().max(1);
        let tracked = Tracked { frame, parent, fit, tries, followed: is_followed, through: None };
        (self.emit)(Found { template, tracked: &tracked, pose: &detailed, target: &target, uvs: &uvs, extra })?;
        Ok(Outcome::Good(Box::new(Good { pose, anchors, tracked, worn, colours })))
    }

    /// What is found with the colours of the frame's sequence; where these are not known, with those of all that are known that it shows; or by
    /// its shape alone, where it shows none of them.
    fn dressed(&self, k: usize, way: &Way, (state, colourings): (&[State], &Colourings), target: &Target) -> Dressed {
        let templates = colourings.templates();
        let wearing = |number: usize| self.wearing(Arc::clone(&templates[number]));
        let known = |number: usize, tried: Option<Tried>| Dressed { tried, worn: Worn::Known(number), colours: None };
        if let Some(number) = colourings.of(self.source.sequence(self.survey.frames[k])) {
            return known(number, wearing(number).found(k, way, state, target));
        }
        let are_others =
            |tried: &Tried, number: usize| are_others(tried.fit.colour, &templates[number].surface, &target.surface);
        let mut found: Vec<Option<Tried>> = Vec::new();
        for number in 0..templates.len() {
            let tried = wearing(number).found(k, way, state, target);
            if tried.as_ref().is_none_or(|tried| !are_others(tried, number)) {
                return known(number, tried);
            }
            found.push(tried);
        }
        let bare = self.wearing(Arc::new(self.template.coloured(None)));
        match bare.found(k, way, state, target) {
            Some(tried) => {
                let colours = shown(&self.template.surface.posed(tried.pose.clone()), &target.surface);
                Dressed { tried: Some(tried), worn: Worn::Shape, colours }
            }
            None => known(0, found.swap_remove(0)),
        }
    }

    /// The parent, the pose that is found from it and how it fits.
    fn found(&self, k: usize, way: &Way, state: &[State], target: &Target) -> Option<Tried> {
        match way {
            Way::Root => None,
            Way::Near(parent) => {
                let start = self.start(k, *parent, 0.0, state, target)?;
                Some(self.settled(self.tried(*parent, (&start, &start), target, Manner::Near), target))
            }
            Way::Far(parents) => self.found_far(k, parents, state, target),
        }
    }

    /// The pose of `parent`, where frame `k` is, turned by `turn` radians more than the likeness of both says.
    pub fn start(&self, k: usize, parent: usize, turn: f32, state: &[State], target: &Target) -> Option<Vec<Vec3>> {
        let from = state[parent].pose.as_ref()?;
        Some(self.start_of((parent, from), k, turn, target))
    }

    /// The same of a pose that is known.
    pub fn start_of(&self, (parent, pose): (usize, &[Vec3]), k: usize, turn: f32, target: &Target) -> Vec<Vec3> {
        let turn = turn + self.survey.dissimilarity.turn(parent, k);
        moved(&self.template, pose, &target.surface, turn)
    }

    /// The best pose from far `parents`: of what comes near it from all of them and several headings the best is refined.
    pub fn found_far(&self, k: usize, parents: &[usize], state: &[State], target: &Target) -> Option<Tried> {
        let template = &self.template;
        let starts = parents.iter().flat_map(|&parent| TURNS.map(|turn| (parent, turn)));
        let starts: Vec<Start> = starts
            .filter_map(|(parent, turn)| Some((parent, turn == 0.0, self.start(k, parent, turn, state, target)?)))
            .collect();
        let found = self.best_of(&starts, target);
        // What was found may be twisted, for not all of it started with the right heading.
        let headed: Vec<Start> = found.iter().flat_map(|tried| self.headed(tried, target)).collect();
        let again = self.best_of(&headed, target);
        let found: Vec<Tried> = found.into_iter().chain(again).collect();
        // Once more, held against what was found: what was far from the start may bend now.
        let found: Vec<Tried> = found.par_iter().map(|tried| self.again(tried, target)).collect();
        let (good, bad): (Vec<Tried>, Vec<Tried>) =
            found.into_iter().partition(|tried| tried.fit.far_fault(&self.options.limits, template.scale).is_none());
        // What a parent was found turned by is held against by all that are tracked from it: others may know better.
        let found = self.best_of_parents(if good.is_empty() { bad } else { good }, TURNED);
        let turned = |tried: Tried| self.settled(self.unturned(tried, target), target);
        let turned = found.into_par_iter().map(turned).collect::<Vec<_>>();
        Some(self.unslipped(self.best(turned, 1).pop()?, target))
    }

    /// What is found once more from `tried`, held against itself: what was far from the start may bend now.
    pub fn again(&self, tried: &Tried, target: &Target) -> Tried {
        let again = self.tried(tried.parent, (&tried.pose, &tried.pose), target, Manner::Refine);
        let stretch = again.fit.stretch.max(tried.fit.stretch);
        Tried { start: tried.start.clone(), fit: Fit { stretch, ..again.fit }, ..again }
    }

    /// `found`, or what is better of it where the template has something round: held against the template itself, for the parent's pose has
    /// twists of its own, which would be kept; and then with each side of what is round turned by itself, as often as that helps.
    fn settled(&self, found: Tried, target: &Target) -> Tried {
        let Some(twists) = self.shape.twists.as_ref().filter(|_| found.fit.strain > SETTLED) else { return found };
        let (surface, scale) = (&self.template.surface, self.template.scale);
        let is_better = |tried: &Tried, than: &Tried| tried.fit.badness(scale) < than.fit.badness(scale);
        let plain = self.settle(&found, &found.pose, target);
        let mut found = if is_better(&plain, &found) { plain } else { found };
        for _ in 0..MOST_TWISTS {
            let turned = twists.turned(surface, &surface.posed(found.pose.clone()), target, &STRAINS);
            let tried = turned.par_iter().map(|pose| self.settle(&found, pose, target)).collect();
            match self.best(tried, 1).pop() {
                Some(better) if is_better(&better, &found) => found = better,
                _ => break,
            }
        }
        found
    }

    /// What is found from the pose `near` by colours, held against the template itself; it is to take the place of `found`.
    fn settle(&self, found: &Tried, near: &[Vec3], target: &Target) -> Tried {
        let surface = &self.template.surface;
        let coloured = self.tracked((&surface.mesh.positions, near), target, Manner::Coloured);
        let pose = self.tracked((&coloured, &coloured), target, Manner::Refine);
        let fit = fit(&self.template, &surface.posed(pose.clone()), &found.start, &target.surface);
        Tried { parent: found.parent, start: found.start.clone(), pose, fit }
    }

    /// `found`, or what is better of it with the template's round part turned as a whole, as often as that helps.
    fn unturned(&self, found: Tried, target: &Target) -> Tried {
        let Some(round) = &self.shape.round else { return found };
        let surface = &self.template.surface;
        self.turned(found, MOST_TURNS, target, |found| {
            let posed = surface.posed(found.pose.clone());
            round::TRIED.map(|turn| round.turned(surface, &posed, turn)).to_vec()
        })
    }

    /// `found`, or what is better of it with all that is round turned by its share of roundness, as often as that helps.
    fn unslipped(&self, found: Tried, target: &Target) -> Tried {
        let (template, axis) = (&self.template, target.surface.centroid());
        self.turned(found, MOST_SLIPS, target, |found| {
            let posed = template.surface.posed(found.pose.clone());
            let shares = roundness(&posed, target, &self.shape.neighbours, (axis, template.scale));
            SLIPS.map(|turn| slipped(&found.pose, &shares, axis, turn)).to_vec()
        })
    }

    /// `found`, or what is better of it from the poses that `turn` makes of it, as often as that helps, `most` times.
    fn turned(&self, mut found: Tried, most: usize, target: &Target, turn: impl Fn(&Tried) -> Vec<Vec<Vec3>>) -> Tried {
        let (limits, scale) = (&self.options.limits, self.template.scale);
        for _ in 0..most {
            let tried = |pose: &Vec<Vec3>| {
                let tried = self.tried(found.parent, (&found.start, pose), target, Manner::Coloured);
                self.again(&tried, target)
            };
            let turned: Vec<Tried> = turn(&found).par_iter().map(tried).collect();
            let sound = turned.into_iter().filter(|tried| tried.fit.far_fault(limits, scale).is_none());
            let better = |tried: &Tried| tried.fit.badness(scale) < found.fit.badness(scale);
            match self.best(sound.filter(better).collect(), 1).pop() {
                Some(better) => found = better,
                None => break,
            }
        }
        found
    }

    /// The best of what is found from `starts`.
    fn best_of(&self, starts: &[Start], target: &Target) -> Vec<Tried> {
        let near = |(parent, plain, start): &Start| {
            let plain = plain.then(|| self.tried(*parent, (start, start), target, Manner::Near));
            [plain, Some(self.tried(*parent, (start, start), target, Manner::Approach))]
        };
        let found: Vec<[Option<Tried>; 2]> = starts.par_iter().map(near).collect();
        let (plain, near): (Vec<_>, Vec<_>) = found.into_iter().map(|[plain, near]| (plain, near)).unzip();
        let near = self.best(near.into_iter().flatten().collect(), REFINED);
        let refined = |tried: &Tried| {
            [Manner::Refine, Manner::Coloured]
                .map(|manner| self.tried(tried.parent, (&tried.start, &tried.pose), target, manner))
        };
        let refined: Vec<[Tried; 2]> = near.par_iter().map(refined).collect();
        let found = refined.into_iter().flatten().chain(plain.into_iter().flatten()).collect();
        let (mut best, mut others) = (self.best(found, usize::MAX), Vec::new());
        if best.len() > AGAIN {
            others = best.split_off(AGAIN);
        }
        // And the best from each parent that is not among these.
        for other in others {
            if best.iter().all(|tried| tried.parent != other.parent) {
                best.push(other);
            }
        }
        best
    }

    /// The best of what was found from each parent, of the `count` best parents.
    fn best_of_parents(&self, found: Vec<Tried>, count: usize) -> Vec<Tried> {
        let mut best: Vec<Tried> = Vec::new();
        for tried in self.best(found, usize::MAX) {
            if best.len() < count && best.iter().all(|other| other.parent != tried.parent) {
                best.push(tried);
            }
        }
        best
    }

    /// The start of `tried`, turned as parts of the body were.
    fn headed(&self, tried: &Tried, target: &Target) -> Vec<Start> {
        let (template, axis) = (&self.template, target.surface.centroid());
        let turns = headings((&tried.start, &tried.pose), &template.surface.areas, axis, template.scale);
        let start = |turn: f32| {
            let turn = Quat::from_rotation_y(turn);
            (tried.parent, true, tried.start.iter().map(|&p| turn * (p - axis) + axis).collect())
        };
        turns.into_iter().map(start).collect()
    }

    /// The best `count` of what was found.
    pub fn best(&self, mut found: Vec<Tried>, count: usize) -> Vec<Tried> {
        let bad = |tried: &Tried| tried.fit.badness(self.template.scale);
        found.sort_by(|a, b| bad(a).total_cmp(&bad(b)));
        found.truncate(count);
        found
    }

    /// What `manner` finds on `target` from the second pose, held against the first.
    pub fn tried(&self, parent: usize, (start, near): (&[Vec3], &[Vec3]), target: &Target, manner: Manner) -> Tried {
        let pose = self.tracked((start, near), target, manner);
        let posed = self.template.surface.posed(pose.clone());
        let fit = fit(&self.template, &posed, start, &target.surface);
        Tried { parent, start: start.to_vec(), pose, fit }
    }

    /// The template's poses on a frame of the parent's group, where it is the same mesh indeed: without detail, and with it.
    fn followed(&self, parent: &State, scan: &Scan, target: &Target) -> Option<(Vec<Vec3>, Vec<Vec3>, Fit)> {
        let (from, [plain, detailed]) = (parent.pose.as_ref()?, parent.anchors.as_ref()?);
        let (pose, detailed) =
            (plain.follow(scan, &self.shape.neighbours)?, detailed.follow(scan, &self.shape.neighbours)?);
        let template = &self.template;
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

    /// The pose tracked from `near` and held against `start`, or what the work folder holds of it.
    fn tracked(&self, (start, near): (&[Vec3], &[Vec3]), target: &Target, manner: Manner) -> Vec<Vec3> {
        let find = || manner.track(&self.template, (start, near), target, &self.options.track);
        let Some(work) = self.job.work() else { return find() };
        let bytes = |surface: &Surface| -> Vec<u8> {
            let mesh = &surface.mesh;
            let mut bytes = bytemuck::cast_slice(&mesh.positions).to_vec();
            bytes.extend_from_slice(bytemuck::cast_slice(&mesh.triangles));
            bytes.extend_from_slice(bytemuck::cast_slice(surface.colours.as_deref().unwrap_or_default()));
            bytes
        };
        let key = Key::new("registered", VERSION)
            .told(&(&self.options.track, manner))
            .of(&bytes(&self.template.surface))
            .of(&bytes(&target.surface))
            .of(bytemuck::cast_slice(start))
            .of(bytemuck::cast_slice(near));
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
