//! The player: a clock over frames that are recorded or synthesised, always one ahead of the picture.
//!
//! It stands at the bundle's first pose until told otherwise. A route (a walk under way) says which frame comes next;
//! without a target the actor plays on, as far as the recording goes. Everything follows from the ticks: no wall clock.

#[cfg(any(feature = "bench", test))]
pub mod bench;
pub mod body_parts;
pub mod clock;
mod direct;
mod directing;
mod edited;
pub mod events;
mod follow;
mod given;
pub mod loading;
mod motion;
mod plan;
mod plans;
pub mod produce;
pub mod report;
pub mod scanned;
pub mod state;
pub mod texture_modes;
mod variety;

use std::collections::VecDeque;
use std::rc::Rc;

use actor::capture::Capture;
use actor::graph::EssentialGraph;
use actor::pose_source::{PoseError, PoseSource};
use actor::walk::Walk;
use bundle::BundleError;
use kernels::align::Placement;
use search::{UnknownBehaviour, cheapest_walk, main_component};
use synthesis::{Synthesiser, Varied};
use thiserror::Error;

use crate::trail::TrailPoint;
use clock::Clock;
use directing::Directing;
use events::Events;
use loading::{Actor, Loading, Phase};
use plans::Plans;
use produce::{Producer, ShownFrame, placed_like};
use variety::Variety;

/// Most frames made in one tick: a slow device plays slower rather than not at all.
const MOST_FRAMES_A_TICK: u32 = 8;
/// Factorisations for a transition's beginning that a tick waits for.
const FACTORISATIONS_A_TICK: u32 = 1;

/// Why the player cannot do what it was asked.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum PlayerError {
    /// The part of the bundle that this needs has not arrived.
    #[error("this part of the actor has not arrived yet")]
    NotLoaded,
    /// No such frame.
    #[error("the actor has no frame {0}")]
    NoFrame(u32),
    /// No such vertex.
    #[error("the actor has no vertex {0}")]
    NoVertex(u32),
    /// No such behaviour.
    #[error(transparent)]
    Behaviour(#[from] UnknownBehaviour),
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
    /// A mode of the textures is damaged.
    #[error("the textures of the bundle are damaged; load it again")]
    DamagedLooks,
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

/// What happens at the end of a route.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Goal {
    /// The actor has arrived, and stands.
    Target(u32),
    /// It plays on.
    PlayOn,
    /// It stands.
    Stop,
}

/// The player of one actor.
pub struct Player {
    loading: Loading,
    clock: Clock,
    producer: Producer,
    looks: [texture_modes::TextureModes; 2],
    now: fn() -> f64,
    events: Events,
    trail: VecDeque<TrailPoint>,
    /// The frame that the picture comes from, and the one that it goes to.
    last: Option<ShownFrame>,
    next: Option<ShownFrame>,
    /// Frames made elsewhere that come before those of the route, and how many are still to be given.
    given: VecDeque<ShownFrame>,
    expected: u32,
    /// What the route under way is for; `None` where there is none.
    goal: Option<Goal>,
    playing: bool,
    looping: bool,
    stalled: Option<u32>,
    /// Factorisations for a transition's beginning that this tick may still do; the rest is left to the next.
    factorisations: u32,
    plans: Plans,
    /// The weight of a frame's duration that the actor came with, once another one was chosen.
    own_alpha: Option<f64>,
    reference: Vec<glam::Vec3>,
    /// For every frame, whether it is in the largest strongly connected component; once the graph is there.
    main: Option<Vec<bool>>,
    directing: Directing,
    variety: Variety,
    /// Frames with a scan in a row up to the one that the picture comes from.
    scans_behind: u32,
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
            looks: Default::default(),
            now,
            events: Events::default(),
            trail: VecDeque::new(),
            last: None,
            next: None,
            given: VecDeque::new(),
            expected: 0,
            goal: None,
            playing: false,
            looping: true,
            stalled: None,
            factorisations: 0,
            plans: Plans::default(),
            own_alpha: None,
            reference: Vec::new(),
            main: None,
            directing: Directing::default(),
            variety: Variety::default(),
            scans_behind: 0,
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
            self.main = Some(main_component(graph, &actor.timeline).main);
        }
        let (None, Some(actor)) = (&self.last, self.loading.actor.clone()) else { return };
        self.clock.set_fps(actor.timeline.fps());
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
        self.factorisations = FACTORISATIONS_A_TICK;
        if !self.playing {
            return changed;
        }
        self.variety.read(&mut self.loading);
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

    /// How much recorded stretches vary: the share of their alternatives' differences, from 0, as recorded, to 1. From the next
    /// stretch on.
    pub fn set_variety(&mut self, amount: f64) {
        self.variety.set(&mut self.loading, amount);
    }

    /// The number of the stretch that is shown in another way than it was recorded, and which one that is.
    #[must_use]
    pub fn alternative(&self) -> Option<(usize, usize)> {
        self.loading.source.varied.as_ref()?.present()
    }

    /// The recording again, at once.
    fn leave_variety(&mut self) {
        if self.loading.source.varied.as_mut().is_some_and(Varied::leave) {
            self.producer.forget_poses();
        }
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
        if self.goal == Some(Goal::PlayOn) {
            self.come_to_stand(Goal::PlayOn);
        }
    }

    /// Drops what is left of the route; a transition under way is finished.
    fn come_to_stand(&mut self, goal: Goal) {
        let Some(actor) = self.loading.actor.clone() else { return };
        if let Some(graph) = self.graph(&actor)
            && self.producer.retarget(&actor, &graph, &Walk::default()).is_ok()
        {
            self.goal = Some(goal);
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
        self.leave_variety();
        let (first, weight) = (frame.floor() as u32, frame.fract());
        let recorded = self.recorded_pose(first)?;
        let placement = match self.nearer() {
            Some(shown) => {
                let same = actor.timeline.sequence_index(shown.kind.frame()) == actor.timeline.sequence_index(first);
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
        if self.goal.take().is_some_and(|goal| goal != Goal::PlayOn) {
            self.playing = false;
        }
        let weight = if after.is_some() { weight } else { 0.0 };
        self.show_at(before, after, weight);
        if let Some(here) = here {
            self.stand_at(here);
        }
        Ok(())
    }

    fn show_at(&mut self, before: ShownFrame, after: Option<ShownFrame>, weight: f64) {
        self.last = Some(before);
        self.next = after;
        self.note_scan(true);
        self.clock.set_weight(weight);
        self.stalled = None;
        self.forget_given();
        self.changed = true;
        self.stand_as_shown();
        self.leave_trail(true);
    }

    /// The actor goes on from the frame that was made last.
    fn stand_as_shown(&mut self) {
        if let (Some(actor), Some(frame)) = (&self.loading.actor, self.next.as_ref().or(self.last.as_ref())) {
            self.producer.stand(actor, frame.kind.frame(), frame.placement);
        }
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
        self.stand_as_shown();
        if let (Some(point), Some(last)) = (self.trail.back_mut(), &self.last) {
            point.ground = last.ground;
        }
    }

    /// Stops where it is, a transition under way at its end; the target is dropped.
    pub fn cancel(&mut self) {
        if self.goal.is_none() {
            return;
        }
        if self.producer.walker().is_some_and(|walker| walker.inside().is_some()) {
            self.come_to_stand(Goal::Stop);
        } else {
            self.drop_route();
            self.playing = false;
        }
    }

    /// Drops the route at once.
    pub(crate) fn drop_route(&mut self) {
        self.goal = None;
        self.producer.halt();
    }

    fn ready(&self, to: u32) -> Result<(Actor, Rc<EssentialGraph>), PlayerError> {
        let actor = self.loading.actor.clone().ok_or(PlayerError::NotLoaded)?;
        let graph = self.loading.graph.clone().ok_or(PlayerError::NotLoaded)?;
        if to < actor.timeline.frame_count() { Ok((actor, graph)) } else { Err(PlayerError::NoFrame(to)) }
    }

    /// The frame from which what comes next can be chosen freely.
    fn departure(&self, graph: &EssentialGraph) -> u32 {
        self.producer.walker().map_or(0, |walker| walker.departure(graph))
    }

    /// The recorded pose of `frame`, as it was recorded.
    ///
    /// # Errors
    /// A frame that does not exist, has not arrived, or is damaged.
    pub fn recorded_pose(&mut self, frame: u32) -> Result<Vec<glam::Vec3>, PlayerError> {
        let actor = self.loading.actor.as_ref().ok_or(PlayerError::NotLoaded)?;
        let mut pose = vec![glam::Vec3::ZERO; actor.topology.vertex_count()];
        self.loading.source.recorded.read(frame, &mut pose)?;
        Ok(pose)
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
        synthesiser
            .begin_walk(&graph, &actor.timeline, (from, Placement::IDENTITY), &walk)
            .map_err(|_| PlayerError::Unreachable { from, to })?;
        let mut pose = vec![glam::Vec3::ZERO; actor.topology.vertex_count()];
        // Without variety, of which what is shown must not hear.
        let varied = self.loading.source.varied.take();
        let mut all = Vec::new();
        let made = loop {
            match synthesiser.next_frame(&graph, &actor.timeline, &mut self.loading.source, &mut pose) {
                Ok(Some(_)) => all.extend_from_slice(&pose),
                Ok(None) => break Ok(all),
                Err(error) => break Err(error.into()),
            }
        };
        self.loading.source.varied = varied;
        made
    }
}

#[cfg(test)]
mod scanned_tests;
#[cfg(test)]
mod tests;
