//! How the player gets on: the next frame of the route, arriving, and playing on where nobody gave a target.

use std::rc::Rc;

use actor::graph::{DEFAULT_ALPHA, EssentialGraph, Transition};
use actor::pose_source::PoseError;
use actor::timeline::Timeline;
use actor::walk::{Leg, Walk};
use kernels::align::Placement;
use search::cheapest_walk;

use super::Player;
use super::events::Event;
use super::loading::Actor;
use super::plan::{Goal, Plan, Route, Step};
use super::produce::Frame;
use crate::trail::{MEMORY, TrailPoint};

impl Player {
    /// Makes the frame after the present one where there is none yet. False where nothing follows (now).
    pub(super) fn make_next(&mut self) -> bool {
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
            // The rest of the work comes with the next tick.
            Ok(None) => false,
            Ok(Some(frame)) => {
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
    pub(super) fn graph(&self, actor: &Actor) -> Option<Rc<EssentialGraph>> {
        let recorded = || EssentialGraph::new(DEFAULT_ALPHA, vec![], &actor.timeline).ok().map(Rc::new);
        self.loading.graph.clone().or_else(recorded)
    }

    /// The frame of `step`. `None` where the first frame of a transition needs more work than one tick should do: it is
    /// begun, and asking again goes on with it.
    fn make(&mut self, actor: &Actor, step: Step) -> Result<Option<Frame>, PoseError> {
        let Some((at, placement)) = self.last.as_ref().map(|last| (last.at, last.placement)) else {
            return Err(PoseError::NotLoaded(0));
        };
        match (step, &self.loading.graph) {
            (Step::Recorded(_), graph) => {
                // Recorded frames are quick: there is time for what the next transition needs.
                if let (Some(graph), Some(edge)) = (graph.clone(), self.route.as_ref().and_then(Route::coming)) {
                    self.producer.prepare(&mut self.loading, actor, &graph, edge);
                }
                self.producer.next_recorded(&mut self.loading, actor, at.frame(), placement).map(Some)
            }
            (Step::Back(frame), _) => self.recorded(frame, placement).map(Some),
            (Step::Synthetic { edge, node }, Some(graph)) => {
                let graph = Rc::clone(graph);
                let begin = (node == 1).then_some(placement);
                if begin.is_some() && (self.waited || self.producer.prepare(&mut self.loading, actor, &graph, edge)) {
                    self.waited = true;
                    return Ok(None);
                }
                self.producer.synthetic(&mut self.loading, actor, &graph, edge, begin).map(Some)
            }
            (Step::Synthetic { edge, .. }, None) => Err(PoseError::NotLoaded(edge)),
        }
    }

    pub(super) fn recorded(&mut self, frame: u32, placement: Placement) -> Result<Frame, PoseError> {
        let Some(actor) = &self.loading.actor else { return Err(PoseError::NotLoaded(frame)) };
        self.producer.recorded(&mut self.loading.source, &actor.topology, frame, placement)
    }

    /// The picture has come to the next frame.
    pub(super) fn reach_next(&mut self) {
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
    pub(super) fn finish_route(&mut self) {
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

    pub(super) fn leave_trail(&mut self, starts: bool) {
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
