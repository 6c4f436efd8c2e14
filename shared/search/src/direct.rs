//! Directing: a request, worked on in slices, target after target; the best answer so far at any time.

use std::collections::VecDeque;

use super::answer::Answer;
use super::anytime::Progress;
use super::bend::Bend;
use super::ground_pose::GroundPose;
use super::request::{Request, RequestError, Target, VERSION};
use super::scene::{Done, MOST_STEPS, Scene, Start};
use super::work::Work;
use actor::walk::Walk;
use kernels::align::Placement;

/// States that are expanded for a target unless told otherwise: about two seconds in a browser.
pub const DEFAULT_EFFORT: u32 = 600_000;
/// Expanded states that a pass of bending a walk counts as.
const STATES_A_PASS: u32 = 100;

/// A request that is being worked on.
#[derive(Clone, Debug)]
pub struct Direction {
    to_do: VecDeque<Target>,
    work: Option<Work>,
    /// Whether its search has ended, so that only its best answer is to be bent before the next target begins.
    is_settling: bool,
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
            is_settling: false,
            seed: request.seed,
            left: effort,
            effort,
            expanded: 0,
            start,
            is_free,
            done: Done {
                frame: start.frame,
                ground_pose: GroundPose::from(&start.placement),
                walk: Walk::default(),
                bend: Vec::new(),
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
            if self.is_settling {
                self.settle(scene, &mut budget)?;
                continue;
            }
            let is_search = self.work.as_ref().is_some_and(|work| work.search_progress().is_some());
            if is_search && self.progress() != Progress::Running {
                // The last search keeps its answer, and what it has proven.
                return Ok(self.progress());
            }
            let Some(work) = &mut self.work else { return Ok(self.progress()) };
            let now = budget.min(self.left.max(1));
            let (ended, expanded) = work.advance(scene, now);
            // What it did not expand it has passed over.
            budget -= now;
            self.left = self.left.saturating_sub(expanded);
            self.expanded += u64::from(expanded);
            // Key poses and wandering are exact and end by themselves; the others go on for as long as they may.
            let is_last = self.to_do.is_empty();
            self.is_settling = (ended || is_search && self.left == 0) && !(is_search && is_last);
        }
        Ok(self.progress())
    }

    /// Works on what [`Self::best`] needs besides, until `is_over` says that it is enough for now; whether that is done. Without
    /// it, that is done there: some tens of milliseconds in a browser, for a path.
    pub fn polish(&mut self, scene: &Scene, mut is_over: impl FnMut() -> bool) -> bool {
        self.work.as_mut().is_none_or(|work| work.polish(scene, self.is_free, &mut is_over))
    }

    /// Whether there may be a better answer.
    #[must_use]
    pub fn progress(&self) -> Progress {
        match self.work.as_ref().map(Work::search_progress) {
            None => Progress::Ended,
            Some(Some(progress)) if self.to_do.is_empty() => self.limited(progress),
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
            seconds: f64::from(steps) / scene.search_graph.fps,
            end_frame: done.frame,
            end_placement: placement(done.ground_pose.into()),
            walk: Walk { bend: Bend(done.bend).placements().collect(), ..done.walk },
            parts: done.parts,
            progress: self.progress(),
            expanded: self.expanded,
        }
    }

    /// Takes the present target's best answer for good and goes on to the next, unless the budget ends before.
    fn settle(&mut self, scene: &Scene, budget: &mut u32) -> Result<(), RequestError> {
        let mut is_over = || {
            *budget = budget.saturating_sub(STATES_A_PASS);
            *budget == 0
        };
        if self.work.as_mut().is_some_and(|work| !work.polish(scene, self.is_free, &mut is_over)) {
            return Ok(());
        }
        self.is_settling = false;
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
            self.work = Work::begin(scene, &mut self.done, target, self.seed, self.is_free)?;
            self.seed = self.seed.wrapping_add(1);
        }
        Ok(())
    }
}

/// What can only be checked against the capture.
fn check(scene: &Scene, target: &Target) -> Result<(), RequestError> {
    match target {
        Target::Pose(frame) => frame.find(scene.timeline).map(|_| ()),
        Target::Behaviour(request) => scene.search_graph.behaviour(&request.name).map(|_| ()),
        Target::Path(request) => {
            if request.vertices != scene.search_graph.group {
                return Err(RequestError::OtherGroup);
            }
            request
                .stretches
                .iter()
                .try_for_each(|stretch| scene.search_graph.behaviour(&stretch.behaviour).map(|_| ()))
        }
        Target::Keys(request) => request.poses.iter().try_for_each(|key| key.pose.find(scene.timeline).map(|_| ())),
        Target::Wander(request) => {
            request.weights.keys().try_for_each(|name| scene.search_graph.behaviour(name).map(|_| ()))
        }
        Target::Place(request) => request.pose.as_ref().map_or(Ok(()), |pose| pose.find(scene.timeline).map(|_| ())),
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
    Ok(scene.search_graph.main.iter().position(|&main| main).unwrap_or(0) as u32)
}
