//! The player: a clock over frames that are recorded or synthesised, always one ahead of the picture.
//!
//! It stands at the bundle's first pose until told otherwise. A route (a walk under way) says which frame comes next;
//! without a target the actor plays on, as far as the recording goes. Everything follows from the ticks: no wall clock.

pub mod bench;
pub mod clock;
pub mod events;
pub mod loading;
pub mod plan;
pub mod produce;
pub mod reach;
pub mod state;

use std::collections::VecDeque;
use std::rc::Rc;

use shared::align::Placement;
use shared::bundle::BundleError;
use shared::capture::Capture;
use shared::graph::{DEFAULT_ALPHA, EssentialGraph, Transition};
use shared::pose_source::{PoseError, PoseSource};
use shared::search::{Leg, Walk, cheapest_walk};
use shared::synthesis::Synthesiser;
use shared::timeline::Timeline;
use thiserror::Error;

use crate::trail::{MEMORY, TrailPoint};
use clock::Clock;
use events::{Event, Events};
use loading::{Actor, Loading, Phase};
use plan::{Goal, Plan, PlanReport, Route, Step};
use produce::{Frame, Producer, placed_like};

/// Most frames made in one tick: a slow device plays slower rather than not at all.
const MOST_FRAMES_A_TICK: u32 = 8;

/// Why the player cannot do what it was asked.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum PlayerError {
    /// The part of the bundle that this needs has not arrived.
    #[error("this part of the actor has not arrived yet")]
    NotLoaded,
    /// No such frame.
    #[error("the actor has no frame {0}")]
    NoFrame(u32),
    /// No walk leads there.
    #[error("nothing recorded leads from frame {from} to frame {to}")]
    Unreachable {
        /// Where the actor would leave.
        from: u32,
        /// Where it should go.
        to: u32,
    },
    /// A frame of the bundle is damaged.
    #[error("frame {0} of the bundle is damaged; load it again")]
    Damaged(u32),
}

impl From<PoseError> for PlayerError {
    fn from(error: PoseError) -> Self {
        match error {
            PoseError::OutOfRange(frame) => Self::NoFrame(frame),
            PoseError::NotLoaded(_) => Self::NotLoaded,
            PoseError::Damaged(frame) => Self::Damaged(frame),
        }
    }
}

/// The player of one actor.
pub struct Player {
    loading: Loading,
    clock: Clock,
    producer: Producer,
    events: Events,
    trail: VecDeque<TrailPoint>,
    /// The frame that the picture comes from, and the one that it goes to.
    last: Option<Frame>,
    next: Option<Frame>,
    route: Option<Route>,
    playing: bool,
    looping: bool,
    stalled: Option<u32>,
    reference: Vec<glam::Vec3>,
    /// For every frame, whether it is in the largest strongly connected component; once the graph is there.
    main: Option<Vec<bool>>,
    /// Whether the picture changed other than by time since the last tick.
    changed: bool,
}

impl Player {
    /// A player of what `loading` has and will have. `now` tells milliseconds; only reports depend on it.
    #[must_use]
    pub fn new(loading: Loading, now: fn() -> f64) -> Self {
        let mut player = Self {
            loading,
            clock: Clock::new(25.0),
            producer: Producer::new(now),
            events: Events::default(),
            trail: VecDeque::new(),
            last: None,
            next: None,
            route: None,
            playing: false,
            looping: true,
            stalled: None,
            reference: Vec::new(),
            main: None,
            changed: false,
        };
        player.stand_up();
        player
    }

    /// A player of a capture in memory.
    #[must_use]
    pub fn of_capture(capture: Capture, graph: EssentialGraph) -> Self {
        Self::new(Loading::of_capture(capture, graph), || 0.0)
    }

    /// Takes the next bytes of the bundle. The actor stands on the stage as soon as its first pose is there.
    ///
    /// # Errors
    /// The first thing that is wrong with it, and the same again from then on.
    pub fn push(&mut self, bytes: &[u8]) -> Result<(), BundleError> {
        let outcome = self.loading.push(bytes);
        self.stand_up();
        if let (Phase::Complete, Some(actor)) = (self.loading.phase(), &self.loading.actor) {
            // What fails here fails again, and is told, when a transition begins.
            let _ = self.producer.warm(&self.loading, actor);
        }
        outcome
    }

    fn stand_up(&mut self) {
        if let (None, Some(actor), Some(graph)) = (&self.main, &self.loading.actor, &self.loading.graph) {
            self.main = Some(reach::main_component(graph, &actor.timeline));
        }
        let (None, Some(actor)) = (&self.last, self.loading.actor.clone()) else { return };
        self.clock = Clock::new(actor.timeline.fps());
        if let Ok(frame) = self.recorded(actor.first_frame, Placement::IDENTITY) {
            self.reference.clone_from(&frame.pose);
            self.show_at(frame, None, 0.0);
        }
    }

    /// The actor, once its first pose has arrived.
    #[must_use]
    pub fn actor(&self) -> Option<&Actor> {
        self.loading.actor.as_ref()
    }

    /// The bundle as far as it has arrived.
    #[must_use]
    pub fn loading(&self) -> &Loading {
        &self.loading
    }

    /// Goes on by `seconds` of real time. True where the picture changed.
    pub fn tick(&mut self, seconds: f64) -> bool {
        let mut changed = std::mem::take(&mut self.changed);
        if !self.playing {
            return changed;
        }
        let mut frames = self.clock.frames_in(seconds);
        for _ in 0..MOST_FRAMES_A_TICK {
            if frames <= 0.0 || !self.make_next() {
                break;
            }
            frames = self.clock.advance(frames);
            changed = true;
            if self.clock.at_next_frame() {
                self.reach_next();
            }
        }
        // One ahead: the next frame is made before the picture needs it.
        self.make_next();
        changed
    }

    /// Plays on from here, or goes on with the walk under way.
    pub fn play(&mut self) {
        if self.last.is_some() {
            self.playing = true;
        }
    }

    /// Stands still; a walk under way is kept.
    pub fn pause(&mut self) {
        self.playing = false;
    }

    /// Whether time makes the picture change.
    #[must_use]
    pub fn playing(&self) -> bool {
        self.playing
    }

    /// Plays `speed` times as fast.
    pub fn set_speed(&mut self, speed: f64) {
        self.clock.set_speed(speed);
    }

    /// Whether playing goes on for ever: by the cheapest walk back to the sequence's start.
    pub fn set_loop(&mut self, looping: bool) {
        self.looping = looping;
        self.drop_free_route();
    }

    /// A way that was only played on is thought over; one towards a target stays.
    fn drop_free_route(&mut self) {
        let graph = self.loading.actor.as_ref().and_then(|actor| self.graph(actor));
        if let (Some(route), Some(graph)) = (&self.route, &graph)
            && route.goal == Goal::PlayOn
        {
            let start = route.departure(graph);
            self.route = Some(route.redirected(&Plan { start, ..Plan::default() }, Goal::PlayOn));
        }
    }

    /// The actor's first pose as it was recorded, from which its measures are taken; empty before it has arrived.
    #[must_use]
    pub fn reference_pose(&self) -> &[glam::Vec3] {
        &self.reference
    }

    /// Jumps to `frame`, between two frames where it is fractional, placed where the actor stands; a walk is dropped.
    ///
    /// Within a sequence the actor keeps its heading, so that scrubbing runs as on a treadmill; in another one it is
    /// turned to face as it does.
    ///
    /// # Errors
    /// A frame that does not exist or has not arrived.
    pub fn seek(&mut self, frame: f64) -> Result<(), PlayerError> {
        let actor = self.loading.actor.clone().ok_or(PlayerError::NotLoaded)?;
        let last_frame = actor.timeline.frame_count() - 1;
        let frame = if frame.is_finite() { frame.clamp(0.0, f64::from(last_frame)) } else { 0.0 };
        let (first, weight) = (frame.floor() as u32, frame.fract());
        let recorded = self.recorded_pose(first)?;
        let placement = match self.nearer() {
            Some(shown) => {
                let same = actor.timeline.sequence_index(shown.at.frame()) == actor.timeline.sequence_index(first);
                placed_like(shown, &recorded, &actor.topology, same.then_some(shown.placement.heading))
            }
            None => Placement::IDENTITY,
        };
        let here = self.ground();
        let before = self.recorded(first, placement)?;
        let after = match actor.timeline.next(first).filter(|&next| weight > 0.0 && next == first + 1) {
            Some(next) => Some(self.recorded(next, placement)?),
            None => None,
        };
        if self.route.take().is_some_and(|route| route.goal != Goal::PlayOn) {
            self.playing = false;
        }
        let weight = if after.is_some() { weight } else { 0.0 };
        self.show_at(before, after, weight);
        if let Some(here) = here {
            self.stand_at(here);
        }
        Ok(())
    }

    fn show_at(&mut self, before: Frame, after: Option<Frame>, weight: f64) {
        self.last = Some(before);
        self.next = after;
        self.clock.set_weight(weight);
        self.stalled = None;
        self.changed = true;
        self.leave_trail(true);
    }

    /// Moves what is shown, unturned, so that its centre of mass is over `here`.
    fn stand_at(&mut self, here: glam::Vec2) {
        let Some(now) = self.ground() else { return };
        let shift = Placement { heading: 0.0, translation: here - now };
        for frame in [&mut self.last, &mut self.next].into_iter().flatten() {
            frame.placement = shift.after(&frame.placement);
            frame.ground += shift.translation;
            shift.apply_all(&mut frame.pose);
        }
        if let (Some(point), Some(last)) = (self.trail.back_mut(), &self.last) {
            point.ground = last.ground;
        }
    }

    /// The cheapest walk from the present to frame `to`, without leaving.
    ///
    /// # Errors
    /// No walk, no such frame, or the graph has not arrived.
    pub fn plan(&self, to: u32) -> Result<PlanReport, PlayerError> {
        let (actor, graph) = self.ready(to)?;
        Ok(self.plan_from_here(to)?.report(to, &graph, &actor.timeline))
    }

    /// Leaves for frame `to` by the cheapest walk; a transition under way is finished first.
    ///
    /// # Errors
    /// As [`Self::plan`]; what was under way goes on then.
    pub fn go_to(&mut self, to: u32) -> Result<PlanReport, PlayerError> {
        let (actor, graph) = self.ready(to)?;
        let plan = self.plan_from_here(to)?;
        let goal = Goal::Target(to);
        self.route = Some(match &self.route {
            Some(route) => route.redirected(&plan, goal),
            None => Route::new(&plan, goal),
        });
        self.playing = true;
        self.stalled = None;
        if self.next.is_none() {
            self.finish_route();
        }
        Ok(plan.report(to, &graph, &actor.timeline))
    }

    /// Stops where it is, a transition under way at its end; the target is dropped.
    pub fn cancel(&mut self) {
        let Some(graph) = self.loading.actor.as_ref().and_then(|actor| self.graph(actor)) else { return };
        let Some(route) = self.route.take() else { return };
        if route.inside().is_some() {
            let start = route.departure(&graph);
            self.route = Some(route.redirected(&Plan { start, ..Plan::default() }, Goal::Stop));
        } else if self.next.as_ref().is_some_and(|next| next.at.is_synthetic()) {
            self.route = Some(Route::new(&Plan { start: route.departure(&graph), ..Plan::default() }, Goal::Stop));
        } else {
            self.playing = false;
        }
    }

    fn ready(&self, to: u32) -> Result<(Actor, Rc<EssentialGraph>), PlayerError> {
        let actor = self.loading.actor.clone().ok_or(PlayerError::NotLoaded)?;
        let graph = self.loading.graph.clone().ok_or(PlayerError::NotLoaded)?;
        if to < actor.timeline.frame_count() { Ok((actor, graph)) } else { Err(PlayerError::NoFrame(to)) }
    }

    fn plan_from_here(&self, to: u32) -> Result<Plan, PlayerError> {
        let (actor, graph) = self.ready(to)?;
        let from = self.departure(&graph);
        plan::plan(&graph, &actor.timeline, from, to).ok_or(PlayerError::Unreachable { from, to })
    }

    /// The frame from which what comes next can be chosen freely.
    fn departure(&self, graph: &EssentialGraph) -> u32 {
        match (&self.route, self.next.as_ref().or(self.last.as_ref())) {
            (Some(route), _) => route.departure(graph),
            (None, Some(frame)) => frame.at.frame(),
            (None, None) => 0,
        }
    }

    /// Makes the frame after the present one where there is none yet. False where nothing follows (now).
    fn make_next(&mut self) -> bool {
        if self.next.is_some() {
            return true;
        }
        let Some(actor) = self.loading.actor.clone() else { return false };
        if !self.playing {
            return false;
        }
        if self.route.as_ref().is_none_or(|route| route.next(&actor.timeline).is_none()) && !self.play_on(&actor) {
            return false;
        }
        let Some(step) = self.route.as_ref().and_then(|route| route.next(&actor.timeline)) else { return false };
        match self.make(&actor, step) {
            Ok(frame) => {
                if let (Some(graph), Some(route)) = (self.graph(&actor), &mut self.route) {
                    route.take(&graph, &actor.timeline);
                }
                self.next = Some(frame);
                self.stalled = None;
                true
            }
            Err(PoseError::NotLoaded(frame)) => {
                if self.stalled != Some(frame) {
                    self.stalled = Some(frame);
                    self.events.push(Event::Stall { frame });
                }
                false
            }
            Err(PoseError::OutOfRange(frame) | PoseError::Damaged(frame)) => {
                self.end(frame);
                false
            }
        }
    }

    /// The graph; while it has not arrived, one of the recorded steps alone.
    fn graph(&self, actor: &Actor) -> Option<Rc<EssentialGraph>> {
        let recorded = || EssentialGraph::new(DEFAULT_ALPHA, vec![], &actor.timeline).ok().map(Rc::new);
        self.loading.graph.clone().or_else(recorded)
    }

    fn make(&mut self, actor: &Actor, step: Step) -> Result<Frame, PoseError> {
        let Some((at, placement)) = self.last.as_ref().map(|last| (last.at, last.placement)) else {
            return Err(PoseError::NotLoaded(0));
        };
        match (step, &self.loading.graph) {
            (Step::Recorded(_), graph) => {
                // Recorded frames are quick: there is time for what the next transition needs.
                if let (Some(graph), Some(edge)) = (graph.clone(), self.route.as_ref().and_then(Route::coming)) {
                    self.producer.prepare(&mut self.loading, actor, &graph, edge);
                }
                self.producer.next_recorded(&mut self.loading, actor, at.frame(), placement)
            }
            (Step::Back(frame), _) => self.recorded(frame, placement),
            (Step::Synthetic { edge, node }, Some(graph)) => {
                let graph = Rc::clone(graph);
                let begin = (node == 1).then_some(placement);
                self.producer.synthetic(&mut self.loading, actor, &graph, edge, begin)
            }
            (Step::Synthetic { edge, .. }, None) => Err(PoseError::NotLoaded(edge)),
        }
    }

    fn recorded(&mut self, frame: u32, placement: Placement) -> Result<Frame, PoseError> {
        let Some(actor) = &self.loading.actor else { return Err(PoseError::NotLoaded(frame)) };
        self.producer.recorded(&mut self.loading.source, &actor.topology, frame, placement)
    }

    /// The recorded pose of `frame`, as it was recorded.
    ///
    /// # Errors
    /// A frame that does not exist, has not arrived, or is damaged.
    pub fn recorded_pose(&mut self, frame: u32) -> Result<Vec<glam::Vec3>, PlayerError> {
        let actor = self.loading.actor.as_ref().ok_or(PlayerError::NotLoaded)?;
        let mut pose = vec![glam::Vec3::ZERO; actor.topology.vertex_count()];
        self.loading.source.read(frame, &mut pose)?;
        Ok(pose)
    }

    /// Frame `frame` in the world, where it would stand if the actor went there from the present.
    ///
    /// # Errors
    /// As [`Self::plan`] and [`Self::recorded_pose`].
    pub fn ghost(&mut self, frame: u32) -> Result<Vec<glam::Vec3>, PlayerError> {
        let mut pose = self.recorded_pose(frame)?;
        self.arrival(frame)?.apply_all(&mut pose);
        Ok(pose)
    }

    /// Placement of frame `to` if the actor goes there from the present.
    ///
    /// # Errors
    /// As [`Self::plan`].
    pub fn arrival(&mut self, to: u32) -> Result<Placement, PlayerError> {
        let (actor, graph) = self.ready(to)?;
        let walk = self.plan_from_here(to)?.walk();
        let inside = self.route.as_ref().is_some_and(|route| route.inside().is_some());
        let end = if inside {
            self.producer.transition_end(&mut self.loading, &actor.timeline, &graph)?
        } else {
            self.next.as_ref().or(self.last.as_ref()).map(|frame| frame.placement)
        };
        let start = end.unwrap_or(Placement::IDENTITY);
        Ok(self.producer.arrival(&mut self.loading, &actor, &graph, start, &walk)?)
    }

    /// All frames of the cheapest walk from `from`, as it was recorded, to `to`, made as the player makes them.
    ///
    /// # Errors
    /// No walk, or a frame that cannot be read.
    pub fn synthesise(&mut self, from: u32, to: u32) -> Result<Vec<glam::Vec3>, PlayerError> {
        let (actor, graph) = self.ready(to)?;
        let walk = cheapest_walk(&graph, &actor.timeline, from, to).ok_or(PlayerError::Unreachable { from, to })?;
        let mut synthesiser =
            Synthesiser::new(&actor.topology, self.loading.order()).map_err(|_| PlayerError::Damaged(from))?;
        synthesiser.begin_walk(from, Placement::IDENTITY, &walk);
        let mut pose = vec![glam::Vec3::ZERO; actor.topology.vertex_count()];
        let mut all = Vec::new();
        while synthesiser.next_frame(&graph, &actor.timeline, &mut self.loading.source, &mut pose)?.is_some() {
            all.extend_from_slice(&pose);
        }
        Ok(all)
    }

    /// The picture has come to the next frame.
    fn reach_next(&mut self) {
        let Some(frame) = self.next.take() else { return };
        let left = self.last.as_ref().and_then(|last| last.at.edge());
        let entered = frame.at.edge();
        if left != entered {
            self.tell_transition(left, false);
            self.tell_transition(entered, true);
        }
        self.last = Some(frame);
        self.clock.set_weight(0.0);
        self.leave_trail(false);
        self.finish_route();
    }

    fn tell_transition(&mut self, edge: Option<u32>, starts: bool) {
        let (Some(edge), Some(graph)) = (edge, &self.loading.graph) else { return };
        let Some(&Transition { from, to, .. }) = graph.transitions().get(edge as usize) else { return };
        self.events.push(if starts { Event::TransitionStart { from, to } } else { Event::TransitionEnd { from, to } });
    }

    /// Arrives, or stops, where the route has come to its end.
    fn finish_route(&mut self) {
        let Some(actor) = &self.loading.actor else { return };
        let Some(route) = &self.route else { return };
        if route.next(&actor.timeline).is_some() || route.goal == Goal::PlayOn {
            return;
        }
        if let Goal::Target(frame) = route.goal {
            self.events.push(Event::Arrive { frame });
        }
        self.route = None;
        self.playing = false;
    }

    /// Finds a way on from where the route ended. False where there is none.
    fn play_on(&mut self, actor: &Actor) -> bool {
        let Some(graph) = self.graph(actor) else { return false };
        let from = match &self.route {
            Some(route) => route.departure(&graph),
            None => self.last.as_ref().map_or(0, |last| last.at.frame()),
        };
        let plan = self.way_on(&actor.timeline, &graph, from);
        if plan.duration > 0 {
            self.route = Some(Route::new(&plan, Goal::PlayOn));
            return true;
        }
        let start = actor.timeline.sequence_of(from).map_or(0, |sequence| sequence.first_frame);
        // Nothing leads back: a cut, as in any player of recordings.
        if self.looping && start != from && self.seek(f64::from(start)).is_ok() {
            let plan = self.way_on(&actor.timeline, &graph, start);
            self.route = Some(Route::new(&plan, Goal::PlayOn));
            return plan.duration > 0;
        }
        self.end(from);
        false
    }

    /// Recorded frames from `from` on; when looping, up to the last one with a way back to the sequence's start, and
    /// then that way.
    fn way_on(&self, timeline: &Timeline, graph: &EssentialGraph, from: u32) -> Plan {
        let Some(sequence) = timeline.sequence_of(from) else { return Plan { start: from, ..Plan::default() } };
        let recorded = |last: u32, steps: u32| Walk {
            legs: if steps > 0 { vec![Leg::Recorded { first: from, last, steps }] } else { vec![] },
            ..Walk::default()
        };
        if sequence.cyclic {
            return Plan::of_walk(from, &recorded(from, sequence.frame_count), graph);
        }
        let end = sequence.end_frame() - 1;
        let main = self.main.as_deref().filter(|_| self.looping);
        let way = main.and_then(|main| way_back(timeline, graph, main, from));
        let walk = match way {
            Some((exit, back)) => {
                let mut walk = recorded(exit, exit - from);
                walk.legs.extend(back.legs);
                walk
            }
            None => recorded(end, end - from),
        };
        let plan = Plan::of_walk(from, &walk, graph);
        if plan.duration > 0 { plan } else { Plan::of_walk(from, &recorded(end, end - from), graph) }
    }

    fn end(&mut self, frame: u32) {
        self.route = None;
        self.playing = false;
        self.events.push(Event::End { frame });
    }

    fn leave_trail(&mut self, starts: bool) {
        let Some(last) = &self.last else { return };
        let time = self.clock.played();
        self.trail.push_back(TrailPoint { ground: last.ground, synthetic: last.at.is_synthetic(), starts, time });
        while self.trail.front().is_some_and(|oldest| time - oldest.time > MEMORY) || self.trail.len() > 2048 {
            self.trail.pop_front();
        }
    }
}

/// The last frame of the recording, from `from` on, with a way back to its sequence's start, and that way. The start is
/// the sequence's first frame in the largest component, where the actor never gets stuck.
fn way_back(timeline: &Timeline, graph: &EssentialGraph, main: &[bool], from: u32) -> Option<(u32, Walk)> {
    let sequence = timeline.sequence_of(from)?;
    let is_in = |frame: &u32| main.get(*frame as usize).copied().unwrap_or(false);
    let start = (sequence.first_frame..sequence.end_frame()).find(is_in)?;
    let exit = (from..sequence.end_frame()).rev().find(is_in)?;
    Some((exit, cheapest_walk(graph, timeline, exit, start)?))
}

#[cfg(test)]
mod tests;
