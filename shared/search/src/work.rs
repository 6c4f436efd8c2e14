//! What is done for each target of a request: begun, worked on in slices, and added to the walk.

use glam::Vec3Swizzles;

use super::answer::Goal;
use super::anytime::{Anytime, Progress};
use super::behaviour::{LoopSearch, walk_to_any, walk_to_behaviour};
use super::bend::Bend;
use super::curve::Curve;
use super::key_plan::KeyPlan;
use super::notes::{keys_notes, path_notes, place_notes, substitute_note};
use super::path::{Demand, PathTask};
use super::path_work::{Bent, PathWork};
use super::place::PlaceTask;
use super::random::Optimiser;
use super::request::{BehaviourRequest, PathRequest, PlaceRequest, RequestError, Target, WanderRequest};
use super::scene::{Done, MOST_STEPS, Scene, Start};
use super::search_graph::SearchGraph;
use super::shortest::cheapest_walk;
use super::task::{State, Task};
use super::wander::Wander;
use actor::walk::Walk;

/// Most frames at which a path with a free start may begin.
const MOST_STARTS: usize = 192;
/// Metres from the actor to the beginning of a path that are no approach.
const NEAR: f32 = 0.1;
/// Frames of the table of key poses that count as an expanded state.
const CELLS_A_STATE: u32 = 2;
/// Expanded states that a frame from which loops are looked for counts as.
const STATES_A_LOOP: u32 = 50;

/// What is being done for a target.
#[derive(Clone, Debug)]
pub(super) enum Work {
    Hold(Box<Holding>),
    Path(Box<PathWork>),
    Place(Box<(PlaceTask, Anytime, Vec<String>)>),
    Keys(Box<KeyPlan>),
    Wander(Box<(Wander, u32)>),
}

impl Work {
    /// Begins a target; `None` for one that takes no search and is done at once. Where the actor `is_free` it may begin
    /// anywhere.
    pub fn begin(
        scene: &Scene,
        done: &mut Done,
        target: Target,
        seed: u64,
        is_free: bool,
    ) -> Result<Option<Self>, RequestError> {
        Ok(Some(match target {
            Target::Pose(frame) => {
                go_to_pose(scene, done, frame.find(scene.timeline)?);
                return Ok(None);
            }
            Target::Behaviour(request) => hold_work(scene, request)?,
            Target::Place(request) => place_work(scene, done, &request)?,
            Target::Path(request) => path_work(scene, done, &request, is_free)?,
            Target::Keys(request) => Self::Keys(Box::new(KeyPlan::new(scene, done.frame, &request)?)),
            Target::Wander(request) => wander_work(scene, &request, seed)?,
            Target::Queue(_) => return Err(RequestError::Nested),
        }))
    }

    /// How far its search is, where it has one that can be gone on with for as long as one likes.
    pub fn search_progress(&self) -> Option<Progress> {
        match self {
            Self::Path(work) => Some(work.search.progress()),
            Self::Place(work) => Some(work.1.progress()),
            _ => None,
        }
    }

    /// Expands up to `budget` states, or passes over others instead; whether it has ended, and how many it expanded.
    pub fn advance(&mut self, scene: &Scene, budget: u32) -> (bool, u32) {
        match self {
            Self::Path(work) => search(&work.task, &mut work.search, scene, budget),
            Self::Place(work) => {
                let prepared = work.0.prepare(scene.search_graph, budget);
                if prepared == budget {
                    return (false, prepared);
                }
                let (ended, expanded) = search(&work.0, &mut work.1, scene, budget - prepared);
                (ended, prepared + expanded)
            }
            Self::Keys(plan) => (plan.advance(scene, budget.saturating_mul(CELLS_A_STATE)), budget),
            Self::Hold(holding) => {
                let mut ended = false;
                for _ in 0..budget.div_ceil(STATES_A_LOOP) {
                    ended = holding.search.advance(scene.graph, scene.timeline);
                }
                (ended, budget)
            }
            Self::Wander(work) => (work.0.advance(scene.graph, scene.timeline, scene.search_graph, budget), budget),
        }
    }

    /// Works on what the best answer so far needs besides, until `is_over` says that it is enough for now; whether that is done.
    pub fn polish(&mut self, scene: &Scene, is_free: bool, is_over: &mut dyn FnMut() -> bool) -> bool {
        match self {
            Self::Path(work) => work.polish(scene.search_graph, is_free, is_over),
            _ => true,
        }
    }

    /// Adds what it has found to what is done.
    pub fn apply(&self, scene: &Scene, done: &mut Done, start: &mut Start, is_free: bool) {
        match self {
            Self::Path(work) => {
                let Some(Bent { found, mut bend, report }) = work.bent(scene.search_graph, is_free) else { return };
                if is_free {
                    let ground_pose = bend.begin().after(&found.start.ground_pose);
                    *start = Start { frame: found.start.frame, placement: ground_pose.into() };
                    (done.frame, done.ground_pose) = (found.start.frame, ground_pose);
                }
                let notes = [work.notes.clone(), path_notes(&report, !bend.0.is_empty())].concat();
                done.push(scene, &found.walk(scene.search_graph), &bend, Goal::Path(report), notes);
            }
            Self::Place(work) => {
                let (task, search, notes) = work.as_ref();
                let Some(found) = search.best() else { return };
                let found = task.completed(scene.search_graph, found);
                let bend = task.bend(scene.search_graph, &found);
                let report = task.judge_bent(scene.search_graph, &found, &bend);
                let notes = [notes.clone(), place_notes(&report)].concat();
                done.push(scene, &found.walk(scene.search_graph), &bend, Goal::Place(report), notes);
            }
            Self::Keys(plan) => done.push(
                scene,
                &plan.walk,
                &Bend::default(),
                plan.goal(),
                keys_notes(scene.search_graph.fps, &plan.rows),
            ),
            Self::Hold(holding) => hold(scene, done, holding),
            Self::Wander(work) => {
                let (mut wander, steps) = work.as_ref().clone();
                let walk = wander.walk(scene.graph, scene.timeline, done.frame, steps);
                let notes = match (&walk, wander.is_stuck()) {
                    (Some(_), _) => Vec::new(),
                    (None, true) => vec!["The graph has no loop to wander in; the actor stays.".into()],
                    (None, false) => vec!["From here the actor cannot get to where it could wander.".into()],
                };
                let objectives = wander.optimiser().map_or([0.0; 3], Optimiser::objectives);
                let goal = Goal::Wander { objectives, frames: wander.frames().len() as u32 };
                done.push(scene, &walk.unwrap_or_default(), &Bend::default(), goal, notes);
            }
        }
    }
}

fn search(task: &impl Task, search: &mut Anytime, scene: &Scene, budget: u32) -> (bool, u32) {
    let before = search.expanded();
    let progress = search.advance(task, scene.search_graph, budget);
    (progress != Progress::Running, (search.expanded() - before) as u32)
}

fn go_to_pose(scene: &Scene, done: &mut Done, frame: u32) {
    let to = |frame: u32| Some((frame, cheapest_walk(scene.graph, scene.timeline, done.frame, frame)?));
    let found = to(frame).or_else(|| to(scene.search_graph.substitute(frame)?));
    let notes = match &found {
        Some((shown, _)) if *shown == frame => Vec::new(),
        Some((shown, _)) => vec![substitute_note(frame, *shown)],
        None => vec!["No walk leads from here to that pose; the actor stays.".to_owned()],
    };
    let reached = found.is_some();
    let (shown, walk) = found.unwrap_or((frame, Walk::default()));
    done.push(scene, &walk, &Bend::default(), Goal::Pose { frame, shown, reached }, notes);
}

/// A behaviour to be held: a loop is looked for.
#[derive(Clone, Debug)]
pub(super) struct Holding {
    request: BehaviourRequest,
    number: usize,
    search: LoopSearch,
}

fn hold_work(scene: &Scene, request: BehaviourRequest) -> Result<Work, RequestError> {
    let number = scene.search_graph.behaviour(&request.name)?;
    let mut search = LoopSearch::new(scene.search_graph, number);
    if request.hold <= 0.0 {
        search.skip();
    }
    Ok(Work::Hold(Box::new(Holding { request, number, search })))
}

/// Goes to the behaviour and holds it with the best loop so far.
fn hold(scene: &Scene, done: &mut Done, holding: &Holding) {
    let Holding { request, number, search } = holding;
    let number = *number;
    let Scene { graph, timeline, search_graph } = *scene;
    let mut notes = Vec::new();
    let wanted = ((request.hold * search_graph.fps).round() as u32).min(MOST_STEPS);
    let entered = search.best.as_ref().filter(|_| wanted > 0).and_then(|hold| {
        let walk = walk_to_any(graph, timeline, done.frame, &hold.entries(timeline))?;
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
            let mut walk = walk_to_behaviour(graph, timeline, search_graph, done.frame, number);
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
    done.push(scene, &walk.unwrap_or_default(), &Bend::default(), goal, notes);
}

/// Appends recorded frames for as long as they show a behaviour and do not lead into a dead end.
fn play_on(scene: &Scene, walk: &mut Walk, start: u32, number: usize, wanted: u32) -> u32 {
    let mut frame = walk.end(scene.graph).unwrap_or(start);
    let mut held = 0;
    let shows = |next: &u32| scene.search_graph.shows(number, *next) && scene.search_graph.live[*next as usize];
    while let Some(next) = scene.timeline.next(frame).filter(shows).filter(|_| held < wanted) {
        walk.push_recorded(frame, next, 1);
        (frame, held) = (next, held + 1);
    }
    walk.cost += f64::from(held) * scene.graph.alpha();
    walk.duration += held;
    held
}

fn place_work(scene: &Scene, done: &Done, request: &PlaceRequest) -> Result<Work, RequestError> {
    let place = glam::Vec2::new(request.x, request.z);
    let mut task = PlaceTask::new(scene.search_graph, done.state(), place, request.heading, request.realism);
    task.exactness = request.exactness;
    let mut notes = Vec::new();
    if let Some(pose) = &request.pose {
        let frame = pose.find(scene.timeline)?;
        let shown =
            if scene.search_graph.main[frame as usize] { Some(frame) } else { scene.search_graph.substitute(frame) };
        match shown {
            Some(shown) => task = task.in_pose(scene.search_graph, shown),
            None => notes.push("No walk leads to that pose: it is left out.".to_owned()),
        }
        notes.extend(shown.filter(|&shown| shown != frame).map(|shown| substitute_note(frame, shown)));
    }
    let search = Anytime::new(&task, scene.search_graph).with_patience();
    Ok(Work::Place(Box::new((task, search, notes))))
}

fn path_work(scene: &Scene, done: &Done, request: &PathRequest, is_free: bool) -> Result<Work, RequestError> {
    let search_graph = scene.search_graph;
    let points = request.points();
    let is_free = is_free || request.free_start && done.walk.legs.is_empty();
    let here = search_graph.point_at(done.frame, done.ground_pose);
    let first = points.first().copied().unwrap_or_default();
    let gap = if request.is_flat() { here.xz().distance(first.xz()) } else { here.distance(first) };
    let approach = (!is_free && gap > NEAR).then_some(here);
    let curve = Curve::new(&points, request.shape, request.is_flat(), approach);
    let mut demands = Vec::with_capacity(request.stretches.len());
    for stretch in &request.stretches {
        demands.push(Demand {
            from: curve.length_at_knot(stretch.from),
            to: curve.length_at_knot(stretch.to),
            behaviour: search_graph.behaviour(&stretch.behaviour)?,
        });
    }
    let starts = if is_free { free_starts(search_graph, &curve) } else { vec![done.state()] };
    let notes = match approach {
        Some(_) => vec![format!("The path begins {gap:.1} m away: the actor goes there first.")],
        None => Vec::new(),
    };
    let mut task = PathTask::new(search_graph, curve, demands, starts, request.realism);
    task.exactness = request.exactness;
    let search = Anytime::new(&task, search_graph).with_patience();
    Ok(Work::Path(Box::new(PathWork::new(task, search, notes))))
}

/// Frames from all over the capture, standing on the path's first point and facing along it.
fn free_starts(search_graph: &SearchGraph, curve: &Curve) -> Vec<State> {
    let live: Vec<u32> = (0..search_graph.frame_count()).filter(|&frame| search_graph.live[frame as usize]).collect();
    let stride = live.len().div_ceil(MOST_STARTS).max(1);
    live.iter().step_by(stride).filter_map(|&frame| PathTask::start_on(search_graph, curve, frame)).collect()
}

fn wander_work(scene: &Scene, request: &WanderRequest, seed: u64) -> Result<Work, RequestError> {
    let mut weights = Vec::with_capacity(request.weights.len());
    for (name, &weight) in &request.weights {
        weights.push((scene.search_graph.behaviour(name)?, weight));
    }
    let steps = ((request.seconds * scene.search_graph.fps).round() as u32).min(MOST_STEPS);
    Ok(Work::Wander(Box::new((Wander::new(weights, seed), steps))))
}
