//! Directing: a request, worked on in slices, target after target; the best answer so far at any time.

use std::collections::VecDeque;

use glam::Vec3Swizzles;

use super::answer::{Answer, Goal, KeyRow, Part};
use super::anytime::{Anytime, Progress};
use super::behaviour::{holding_loop, walk_to_behaviour};
use super::curve::Curve;
use super::keys::{KeyLeg, LegEnd};
use super::path::{Demand, PathReport, PathTask};
use super::place::{PlaceReport, PlaceTask};
use super::request::{
    BehaviourRequest, KeysRequest, PathRequest, PlaceRequest, Request, RequestError, Target, VERSION, WanderRequest,
    behaviour,
};
use super::shortest::cheapest_walk;
use super::spot::Spot;
use super::task::State;
use super::walk::{Leg, Walk};
use super::wander::Wander;
use super::ways::Ways;
use crate::graph::EssentialGraph;
use crate::timeline::Timeline;
use kernels::align::Placement;

/// States that are expanded for a target unless told otherwise: about two seconds in a browser.
pub const DEFAULT_EFFORT: u32 = 150_000;
/// Most frames at which a path with a free start may begin.
const MOST_STARTS: usize = 192;
/// Metres from the actor to the beginning of a path that are no approach.
const NEAR: f32 = 0.1;
/// Frames of the table of key poses that count as an expanded state.
const CELLS_A_STATE: u32 = 2;
/// Expanded states that a round of the random walk's optimisation counts as.
const STATES_A_ROUND: u32 = 100;
/// Most steps of an answer.
const MOST_STEPS: u32 = 1 << 20;

/// What searches read. It must be the same for all calls of a [`Direction`].
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// The graph.
    pub graph: &'a EssentialGraph,
    /// Its sequences.
    pub timeline: &'a Timeline,
    /// Its ways.
    pub ways: &'a Ways,
}

/// Where the actor is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// The frame shown.
    pub frame: u32,
    /// Where its recorded frames stand: `world_from_recorded`.
    pub placement: Placement,
}

/// A request that is being worked on.
#[derive(Clone, Debug)]
pub struct Direction {
    to_do: VecDeque<Target>,
    work: Option<Work>,
    seed: u64,
    /// States that may still be expanded for the present target, and for each later one.
    left: u32,
    effort: u32,
    expanded: u64,
    start: Start,
    /// Whether the actor may begin anywhere.
    is_free: bool,
    done: Done,
}

/// What has been decided.
#[derive(Clone, Debug)]
struct Done {
    frame: u32,
    spot: Spot,
    walk: Walk,
    parts: Vec<Part>,
}

/// What is being done for a target.
#[derive(Clone, Debug)]
enum Work {
    Path(Box<(PathTask, Anytime, Vec<String>)>),
    Place(Box<(PlaceTask, Anytime)>),
    Keys(Box<Keys>),
    Wander(Box<(Wander, u32)>),
}

/// Key poses that are being worked on.
#[derive(Clone, Debug)]
struct Keys {
    /// Frame and step of those to come; a step without a row is only a stop on a long way.
    to_do: VecDeque<(u32, u32, bool)>,
    leg: Option<KeyLeg>,
    walk: Walk,
    frame: u32,
    taken: u32,
    rows: Vec<KeyRow>,
}

impl Direction {
    /// Begins to work on `request`. Without a `start` the actor begins wherever suits the first target best. `effort` is
    /// the number of states to expand for each target at most ([`DEFAULT_EFFORT`]).
    ///
    /// # Errors
    /// A request that makes no sense for this capture.
    pub fn new(scene: &Scene, start: Option<Start>, request: &Request, effort: u32) -> Result<Self, RequestError> {
        request.check_numbers()?;
        let to_do: VecDeque<Target> = match &request.target {
            Target::Queue(targets) => targets.iter().cloned().collect(),
            target => VecDeque::from([target.clone()]),
        };
        to_do.iter().try_for_each(|target| check(scene, target))?;
        let is_free = start.is_none();
        let start = match start {
            Some(start) if start.frame < scene.timeline.frame_count() => start,
            Some(start) => return Err(RequestError::UnknownFrame(start.frame.to_string())),
            None => Start { frame: usual_start(scene, to_do.front())?, placement: Placement::IDENTITY },
        };
        let mut direction = Self {
            to_do,
            work: None,
            seed: request.seed,
            left: effort,
            effort,
            expanded: 0,
            start,
            is_free,
            done: Done {
                frame: start.frame,
                spot: Spot::from(&start.placement),
                walk: Walk::default(),
                parts: Vec::new(),
            },
        };
        direction.begin_next(scene)?;
        Ok(direction)
    }

    /// Expands up to `budget` states, 5 to 20 microseconds of work each, and says whether there may be a better answer. Call
    /// it with small budgets and look at a clock in between: the answer depends on the number of calls in no way.
    ///
    /// # Errors
    /// None once the request has been accepted, but for a scene that is not the same any more.
    pub fn advance(&mut self, scene: &Scene, budget: u32) -> Result<Progress, RequestError> {
        let mut budget = budget;
        while budget > 0 {
            let is_search = matches!(self.work, Some(Work::Path(_) | Work::Place(_)));
            if is_search && self.progress() != Progress::Running {
                // The last search keeps its answer, and what it has proven.
                return Ok(self.progress());
            }
            let Some(work) = &mut self.work else { return Ok(self.progress()) };
            let now = budget.min(self.left.max(1));
            let (ended, used) = work.advance(scene, now);
            budget -= used.clamp(1, budget);
            self.left = self.left.saturating_sub(used);
            self.expanded += u64::from(used);
            // Key poses and wandering are exact and end by themselves; the others go on for as long as they may.
            let is_last = self.to_do.is_empty();
            if (ended || is_search && self.left == 0) && !(is_search && is_last) {
                self.settle(scene)?;
            }
        }
        Ok(self.progress())
    }

    /// Whether there may be a better answer.
    #[must_use]
    pub fn progress(&self) -> Progress {
        match &self.work {
            None => Progress::Ended,
            Some(Work::Path(work)) if self.to_do.is_empty() => self.limited(work.1.progress()),
            Some(Work::Place(work)) if self.to_do.is_empty() => self.limited(work.1.progress()),
            Some(_) => Progress::Running,
        }
    }

    /// A search that may not expand more states has ended, though there may be a better answer.
    fn limited(&self, progress: Progress) -> Progress {
        if self.left == 0 && progress == Progress::Running { Progress::Ended } else { progress }
    }

    /// The best answer so far: all targets that are done and the present one as far as it is known. It is a walk through
    /// the graph from the start on, whatever was asked for.
    #[must_use]
    pub fn best(&self, scene: &Scene) -> Answer {
        let mut done = self.done.clone();
        let mut start = self.start;
        if let Some(work) = &self.work {
            work.apply(scene, &mut done, &mut start, self.is_free);
        }
        let steps = done.walk.steps(scene.graph);
        let placement = |placement: Placement| [placement.heading, placement.translation.x, placement.translation.y];
        Answer {
            version: VERSION,
            start_frame: start.frame,
            start_placement: placement(start.placement),
            steps,
            seconds: f64::from(steps) / scene.ways.fps,
            end_frame: done.frame,
            end_placement: placement(done.spot.into()),
            walk: done.walk,
            parts: done.parts,
            progress: self.progress(),
            expanded: self.expanded,
        }
    }

    /// Takes the present target's best answer for good and goes on to the next.
    fn settle(&mut self, scene: &Scene) -> Result<(), RequestError> {
        if let Some(work) = self.work.take() {
            work.apply(scene, &mut self.done, &mut self.start, self.is_free);
            self.is_free = false;
        }
        self.left = self.effort;
        self.begin_next(scene)
    }

    /// Begins the next target that takes a search; those that take none are done at once.
    fn begin_next(&mut self, scene: &Scene) -> Result<(), RequestError> {
        while self.work.is_none() && self.done.walk.duration < MOST_STEPS {
            let Some(target) = self.to_do.pop_front() else { return Ok(()) };
            match target {
                Target::Pose(frame) => go_to_pose(scene, &mut self.done, frame.find(scene.timeline)?),
                Target::Behaviour(request) => go_to_behaviour(scene, &mut self.done, &request)?,
                Target::Place(request) => self.work = Some(place_work(scene, &self.done, &request)),
                Target::Path(request) => self.work = Some(path_work(scene, &self.done, &request, self.is_free)?),
                Target::Keys(request) => self.work = Some(keys_work(scene, &self.done, &request)?),
                Target::Wander(request) => self.work = wander_work(scene, &mut self.done, &request, self.seed)?,
                Target::Queue(_) => return Err(RequestError::Nested),
            }
            self.seed = self.seed.wrapping_add(1);
        }
        Ok(())
    }
}

impl Work {
    /// Expands up to `budget` states; whether it has ended, and how many it took.
    fn advance(&mut self, scene: &Scene, budget: u32) -> (bool, u32) {
        match self {
            Self::Path(work) => {
                let before = work.1.expanded();
                let progress = work.1.advance(&work.0, scene.ways, budget);
                (progress != Progress::Running, (work.1.expanded() - before) as u32)
            }
            Self::Place(work) => {
                let before = work.1.expanded();
                let progress = work.1.advance(&work.0, scene.ways, budget);
                (progress != Progress::Running, (work.1.expanded() - before) as u32)
            }
            Self::Keys(keys) => (keys.advance(scene, budget.saturating_mul(CELLS_A_STATE)), budget),
            Self::Wander(work) => {
                let rounds = (budget / STATES_A_ROUND).max(1);
                (work.0.advance(rounds), budget)
            }
        }
    }

    /// Adds what it has found to what is done.
    fn apply(&self, scene: &Scene, done: &mut Done, start: &mut Start, is_free: bool) {
        match self {
            Self::Path(work) => {
                let (task, search, notes) = work.as_ref();
                let Some(found) = search.best() else { return };
                if is_free {
                    *start = Start { frame: found.start.frame, placement: found.start.spot.into() };
                    (done.frame, done.spot) = (found.start.frame, found.start.spot);
                }
                let report = task.judge(scene.ways, found);
                let notes = [notes.clone(), path_notes(&report)].concat();
                done.push(scene, &found.walk(scene.ways), Goal::Path(report), notes);
            }
            Self::Place(work) => {
                let (task, search) = work.as_ref();
                let Some(found) = search.best() else { return };
                let report = task.judge(scene.ways, found);
                done.push(scene, &found.walk(scene.ways), Goal::Place(report), place_notes(&report));
            }
            Self::Keys(keys) => {
                let errors: Vec<f64> = keys.rows.iter().filter_map(error_of).collect();
                let mean_error = errors.iter().sum::<f64>() / errors.len().max(1) as f64;
                let goal = Goal::Keys { rows: keys.rows.clone(), mean_error };
                done.push(scene, &keys.walk, goal, keys_notes(scene, &keys.rows));
            }
            Self::Wander(work) => {
                let (mut wander, steps) = work.as_ref().clone();
                let walk = wander.walk(scene.graph, scene.timeline, done.frame, steps);
                let notes = match walk {
                    Some(_) => Vec::new(),
                    None => vec!["From here the actor cannot get to where it could wander.".into()],
                };
                let goal =
                    Goal::Wander { objectives: wander.optimiser().objectives(), frames: wander.frames().len() as u32 };
                done.push(scene, &walk.unwrap_or_default(), goal, notes);
            }
        }
    }
}

impl Done {
    fn push(&mut self, scene: &Scene, walk: &Walk, goal: Goal, notes: Vec<String>) {
        let first_step = self.walk.steps(scene.graph);
        for leg in &walk.legs {
            self.follow(scene, leg);
        }
        self.walk.append(walk);
        self.parts.push(Part { first_step, steps: walk.steps(scene.graph), goal, notes });
    }

    /// Keeps track of where the actor stands.
    fn follow(&mut self, scene: &Scene, leg: &Leg) {
        match *leg {
            Leg::Recorded { steps, .. } => {
                for _ in 0..steps {
                    let Some(next) = scene.timeline.next(self.frame) else { return };
                    if next != self.frame + 1 {
                        self.spot = self.spot.after(&wrap_of(scene, self.frame));
                    }
                    self.frame = next;
                }
            }
            Leg::Synthetic(index) => {
                if let Some(transition) = scene.graph.transitions().get(index as usize) {
                    self.spot = self.spot.after(&Spot::from(&transition.placement));
                    self.frame = transition.to;
                }
            }
        }
    }

    fn state(&self) -> State {
        State::start(self.frame, self.spot)
    }
}

/// Where the first frame of a cyclic sequence stands after `last`, its last one.
fn wrap_of(scene: &Scene, last: u32) -> Spot {
    let mut recorded = scene.ways.from(last).map(|way| scene.ways.way(way)).filter(|way| way.transition.is_none());
    recorded.next().map_or(Spot::IDENTITY, |way| way.spot)
}

/// What can only be checked against the capture.
fn check(scene: &Scene, target: &Target) -> Result<(), RequestError> {
    match target {
        Target::Pose(frame) => frame.find(scene.timeline).map(|_| ()),
        Target::Behaviour(request) => behaviour(scene.ways, &request.name).map(|_| ()),
        Target::Path(request) => {
            if request.vertices != scene.ways.group {
                return Err(RequestError::OtherGroup);
            }
            request.stretches.iter().try_for_each(|stretch| behaviour(scene.ways, &stretch.behaviour).map(|_| ()))
        }
        Target::Keys(request) => request.poses.iter().try_for_each(|key| key.pose.find(scene.timeline).map(|_| ())),
        Target::Wander(request) => request.weights.keys().try_for_each(|name| behaviour(scene.ways, name).map(|_| ())),
        Target::Place(_) => Ok(()),
        Target::Queue(_) => Err(RequestError::Nested),
    }
}

/// The frame to begin with where none is given: the first key pose, or the first frame that the actor does not get stuck
/// from.
fn usual_start(scene: &Scene, first: Option<&Target>) -> Result<u32, RequestError> {
    if let Some(Target::Keys(request)) = first
        && let Some(key) = request.poses.iter().min_by(|a, b| a.time.total_cmp(&b.time))
    {
        return key.pose.find(scene.timeline);
    }
    Ok(scene.ways.main.iter().position(|&main| main).unwrap_or(0) as u32)
}

fn go_to_pose(scene: &Scene, done: &mut Done, frame: u32) {
    let walk = cheapest_walk(scene.graph, scene.timeline, done.frame, frame);
    let notes = match walk {
        Some(_) => Vec::new(),
        None => vec!["No walk leads from here to that pose; the actor stays.".to_owned()],
    };
    let goal = Goal::Pose { frame, reached: walk.is_some() };
    done.push(scene, &walk.unwrap_or_default(), goal, notes);
}

fn go_to_behaviour(scene: &Scene, done: &mut Done, request: &BehaviourRequest) -> Result<(), RequestError> {
    let number = behaviour(scene.ways, &request.name)?;
    let Scene { graph, timeline, ways } = *scene;
    let mut notes = Vec::new();
    let wanted = ((request.hold * ways.fps).round() as u32).min(MOST_STEPS);
    let hold = if wanted > 0 { holding_loop(graph, timeline, ways, number) } else { None };
    let entered = hold.and_then(|hold| {
        let walk = super::behaviour::walk_to_any(graph, timeline, done.frame, &hold.entries(timeline))?;
        let frame = walk.end(graph).unwrap_or(done.frame);
        Some((walk, hold.entered_at(timeline, frame)))
    });
    let mut held = 0;
    let walk = match entered {
        Some((mut walk, hold)) => {
            while held < wanted && hold.steps > 0 {
                walk.append(&hold.walk);
                held += hold.steps;
            }
            Some(walk)
        }
        None => {
            let mut walk = walk_to_behaviour(graph, timeline, ways, done.frame, number);
            if let Some(walk) = walk.as_mut().filter(|_| wanted > 0) {
                held = play_on(scene, walk, done.frame, number, wanted);
                notes.push(format!("{:?} has no loop: it is played once.", request.name));
            }
            walk
        }
    };
    if walk.is_none() {
        notes.push(format!("No walk leads from here to {:?}; the actor stays.", request.name));
    }
    let goal = Goal::Behaviour { name: request.name.clone(), reached: walk.is_some(), held };
    done.push(scene, &walk.unwrap_or_default(), goal, notes);
    Ok(())
}

/// Appends recorded frames for as long as they show a behaviour and do not lead into a dead end.
fn play_on(scene: &Scene, walk: &mut Walk, start: u32, number: usize, wanted: u32) -> u32 {
    let mut frame = walk.end(scene.graph).unwrap_or(start);
    let mut held = 0;
    let shows = |next: &u32| scene.ways.shows(number, *next) && scene.ways.live[*next as usize];
    while let Some(next) = scene.timeline.next(frame).filter(shows).filter(|_| held < wanted) {
        walk.push_recorded(frame, next, 1);
        (frame, held) = (next, held + 1);
    }
    walk.cost += f64::from(held) * scene.graph.alpha();
    walk.duration += held;
    held
}

fn place_work(scene: &Scene, done: &Done, request: &PlaceRequest) -> Work {
    let place = glam::Vec2::new(request.x, request.z);
    let task = PlaceTask::new(scene.ways, done.state(), place, request.heading, request.realism);
    let search = Anytime::new(&task, scene.ways);
    Work::Place(Box::new((task, search)))
}

fn path_work(scene: &Scene, done: &Done, request: &PathRequest, is_free: bool) -> Result<Work, RequestError> {
    let ways = scene.ways;
    let points = request.points();
    let is_free = is_free || request.free_start && done.walk.legs.is_empty();
    let here = ways.point_at(done.frame, done.spot);
    let first = points.first().copied().unwrap_or_default();
    let gap = if request.is_flat() { here.xz().distance(first.xz()) } else { here.distance(first) };
    let approach = (!is_free && gap > NEAR).then_some(here);
    let curve = Curve::new(&points, request.shape, request.is_flat(), approach);
    let mut demands = Vec::with_capacity(request.stretches.len());
    for stretch in &request.stretches {
        demands.push(Demand {
            from: curve.length_at_knot(stretch.from),
            to: curve.length_at_knot(stretch.to),
            behaviour: behaviour(ways, &stretch.behaviour)?,
        });
    }
    let starts = if is_free { free_starts(ways, &curve) } else { vec![done.state()] };
    let notes = match approach {
        Some(_) => vec![format!("The path begins {gap:.1} m away: the actor goes there first.")],
        None => Vec::new(),
    };
    let task = PathTask::new(ways, curve, demands, starts, request.realism);
    let search = Anytime::new(&task, ways);
    Ok(Work::Path(Box::new((task, search, notes))))
}

/// Frames from all over the capture, standing on the path's first point and facing along it.
fn free_starts(ways: &Ways, curve: &Curve) -> Vec<State> {
    let live: Vec<u32> = (0..ways.frame_count()).filter(|&frame| ways.live[frame as usize]).collect();
    let stride = live.len().div_ceil(MOST_STARTS).max(1);
    live.iter().step_by(stride).filter_map(|&frame| PathTask::start_on(ways, curve, frame)).collect()
}

fn keys_work(scene: &Scene, done: &Done, request: &KeysRequest) -> Result<Work, RequestError> {
    let mut keys: Vec<(u32, u32)> = Vec::new();
    for key in &request.poses {
        keys.push((key.pose.find(scene.timeline)?, (key.time * scene.ways.fps).round() as u32));
    }
    keys.sort_by_key(|&(_, step)| step);
    let longest = KeyLeg::longest(scene.timeline.frame_count());
    let mut to_do = VecDeque::new();
    let mut before = 0;
    for (frame, step) in keys {
        // A long leg is cut: the actor comes by its goal on the way.
        while step - before > longest && scene.ways.main[frame as usize] {
            before += longest;
            to_do.push_back((frame, before, false));
        }
        to_do.push_back((frame, step, true));
        before = step;
    }
    let (frame, taken) = (done.frame, 0);
    Ok(Work::Keys(Box::new(Keys { to_do, leg: None, walk: Walk::default(), frame, taken, rows: Vec::new() })))
}

impl Keys {
    /// Looks at up to `budget` frames at a time; whether all legs are done.
    fn advance(&mut self, scene: &Scene, budget: u32) -> bool {
        let Some(&(frame, step, has_row)) = self.to_do.front() else { return true };
        let (graph, timeline) = (scene.graph, scene.timeline);
        // The error of the leg before is handed on: what is wanted is the time, not the duration.
        let wanted = step.saturating_sub(self.taken);
        let leg = self.leg.get_or_insert_with(|| KeyLeg::new(graph, timeline, self.frame, frame, wanted));
        if !leg.advance(graph, timeline, budget) {
            return false;
        }
        let end = leg.finish(graph, timeline);
        self.leg = None;
        self.to_do.pop_front();
        let reached = match end {
            LegEnd::Walk(walk, steps) => {
                self.walk.append(&walk);
                self.taken += steps;
                self.frame = frame;
                Some(self.taken)
            }
            LegEnd::NoWay => None,
        };
        if has_row {
            self.rows.push(KeyRow { frame, wanted: step, reached });
        }
        self.to_do.is_empty()
    }
}

fn wander_work(
    scene: &Scene,
    done: &mut Done,
    request: &WanderRequest,
    seed: u64,
) -> Result<Option<Work>, RequestError> {
    let mut weights = Vec::with_capacity(request.weights.len());
    for (name, &weight) in &request.weights {
        weights.push((behaviour(scene.ways, name)?, weight));
    }
    let steps = ((request.seconds * scene.ways.fps).round() as u32).min(MOST_STEPS);
    let wander = Wander::new(scene.graph, scene.timeline, scene.ways, &weights, seed);
    if wander.is_none() {
        let notes = vec!["The graph has no loop to wander in; the actor stays.".into()];
        done.push(scene, &Walk::default(), Goal::Wander { objectives: [0.0; 3], frames: 0 }, notes);
    }
    Ok(wander.map(|wander| Work::Wander(Box::new((wander, steps)))))
}

fn path_notes(report: &PathReport) -> Vec<String> {
    let mut notes = Vec::new();
    if report.travelled + 0.05 < report.length {
        let (travelled, length) = (report.travelled, report.length);
        notes.push(format!("The motion does not get to the path's end: it travels {travelled:.1} of {length:.1} m."));
    }
    if report.max_aside > 0.5 {
        let aside = report.max_aside;
        notes.push(format!(
            "The walk strays up to {aside:.1} m from the path: no motion of this capture turns like it."
        ));
    }
    if let Some(kept) = report.demands_kept.filter(|&kept| kept < 0.95) {
        notes.push(format!("{:.0} % of the painted stretches show what they demand.", 100.0 * kept));
    }
    notes
}

fn place_notes(report: &PlaceReport) -> Vec<String> {
    let mut notes = Vec::new();
    if report.distance > 0.3 {
        notes.push(format!(
            "The walk ends {:.1} m from the place: no motion of this capture gets closer.",
            report.distance
        ));
    }
    if let Some(turn) = report.turn.filter(|&turn| turn > 0.35) {
        notes.push(format!("It faces {:.0} degrees away from the heading asked for.", turn.to_degrees()));
    }
    notes
}

fn keys_notes(scene: &Scene, rows: &[KeyRow]) -> Vec<String> {
    let mut notes = Vec::new();
    for (index, row) in rows.iter().enumerate() {
        match row.reached {
            None => notes.push(format!("No walk leads to key pose {}; it is left out.", index + 1)),
            Some(reached) if f64::from(reached.abs_diff(row.wanted)) > 0.25 * scene.ways.fps => {
                let seconds = f64::from(reached.abs_diff(row.wanted)) / scene.ways.fps;
                let how = if reached > row.wanted { "late" } else { "early" };
                notes.push(format!("Key pose {} comes {seconds:.2} s {how}: it cannot be closer in time.", index + 1));
            }
            Some(_) => {}
        }
    }
    notes
}

fn error_of(row: &KeyRow) -> Option<f64> {
    row.reached.map(|reached| f64::from(reached.abs_diff(row.wanted)))
}
