//! How the player gets on: the next frame of the route, arriving, and playing on where nobody gave a target.

use std::rc::Rc;

use actor::graph::{DEFAULT_ALPHA, EssentialGraph, Transition};
use actor::pose_source::PoseError;
use actor::timeline::Timeline;
use actor::walk::{Leg, Walk};
use kernels::align::Placement;
use search::cheapest_walk;

use super::events::Event;
use super::loading::Actor;
use super::produce::ShownFrame;
use super::{Goal, Player};
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
        if self.is_given() {
            self.next = self.given.pop_front();
            return self.next.is_some();
        }
        if self.producer.walker().is_none_or(|walker| walker.next(&actor.timeline).is_none()) && !self.play_on(&actor) {
            return false;
        }
        let Some(graph) = self.graph(&actor) else { return false };
        match self.producer.next(&mut self.loading, &actor, &graph, &mut self.factorisations) {
            // The rest of the work comes with the next tick.
            Ok(None) => false,
            Ok(Some(frame)) => {
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

    pub(super) fn recorded(&mut self, frame: u32, placement: Placement) -> Result<ShownFrame, PoseError> {
        let Some(actor) = self.loading.actor.clone() else { return Err(PoseError::NotLoaded(frame)) };
        self.producer.recorded(&mut self.loading, &actor, frame, placement)
    }

    /// The picture has come to the next frame.
    pub(super) fn reach_next(&mut self) {
        let Some(frame) = self.next.take() else { return };
        let left = self.last.as_ref().and_then(|last| last.kind.transition());
        let entered = frame.kind.transition();
        if left != entered {
            self.tell_transition(left, false);
            self.tell_transition(entered, true);
        }
        self.last = Some(frame);
        self.note_scan(false);
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
        let (Some(actor), Some(goal), false) = (&self.loading.actor, self.goal, self.is_given()) else { return };
        let goes_on = self.producer.walker().is_some_and(|walker| walker.next(&actor.timeline).is_some());
        if goes_on || goal == Goal::PlayOn {
            return;
        }
        if let Goal::Target(frame) = goal {
            self.events.push(Event::Arrive { frame });
        }
        self.drop_route();
        self.playing = false;
    }

    /// Finds a way on from where the route ended. False where there is none.
    fn play_on(&mut self, actor: &Actor) -> bool {
        let Some(graph) = self.graph(actor) else { return false };
        let from = self.departure(&graph);
        if self.set_out(actor, &graph, from) {
            return true;
        }
        let start = actor.timeline.sequence_of(from).map_or(0, |sequence| sequence.first_frame);
        // Nothing leads back: a cut, as in any player of recordings.
        if self.looping && start != from && self.seek(f64::from(start)).is_ok() {
            return self.set_out(actor, &graph, start);
        }
        self.end(from);
        false
    }

    /// Plays on from frame `from`; whether anything goes on there.
    fn set_out(&mut self, actor: &Actor, graph: &EssentialGraph, from: u32) -> bool {
        let way = Walk { legs: self.way_on(&actor.timeline, graph, from), ..Walk::default() };
        let goes_on = !way.legs.is_empty() && self.producer.retarget(actor, graph, &way).is_ok();
        if goes_on {
            self.goal = Some(Goal::PlayOn);
        }
        goes_on
    }

    /// Recorded frames from `from` on; when looping, up to the last one with a way back to the sequence's start, and
    /// then that way.
    fn way_on(&self, timeline: &Timeline, graph: &EssentialGraph, from: u32) -> Vec<Leg> {
        let Some(sequence) = timeline.sequence_of(from) else { return Vec::new() };
        let recorded = |last: u32, steps: u32| match steps {
            0 => Vec::new(),
            _ => vec![Leg::Recorded { first: from, last, steps }],
        };
        if sequence.cyclic {
            return recorded(from, sequence.frame_count);
        }
        let end = sequence.end_frame() - 1;
        let main = self.main.as_deref().filter(|_| self.looping);
        if let Some((exit, back)) = main.and_then(|main| way_back(timeline, graph, main, from)) {
            let legs = [recorded(exit, exit - from), back.legs].concat();
            if !legs.is_empty() {
                return legs;
            }
        }
        recorded(end, end - from)
    }

    fn end(&mut self, frame: u32) {
        self.drop_route();
        self.playing = false;
        self.events.push(Event::End { frame });
    }

    pub(super) fn leave_trail(&mut self, starts: bool) {
        let Some(last) = &self.last else { return };
        let time = self.clock.played();
        self.trail.push_back(TrailPoint { ground: last.ground, synthetic: last.kind.is_synthetic(), starts, time });
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
