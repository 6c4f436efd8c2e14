//! Where an actor is on its route, step by step. It knows no pose and no placement: film, page and tests walk by it alike,
//! and what a step looks like is made by the [`Synthesiser`](crate::Synthesiser).

use actor::graph::EssentialGraph;
use actor::timeline::Timeline;
use actor::walk::{Leg, WalkError, end_of};

/// A step from the frame shown to the next one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// To the frame that was recorded right after it.
    Forward(u32),
    /// To the frame that was recorded right before it.
    Back(u32),
    /// To a node of a transition.
    Node {
        /// Index of the transition in [`EssentialGraph::transitions`].
        transition: u32,
        /// Index of the node in its warp, from 1: node 0 is the frame that the transition leaves. The last node is the
        /// frame that it arrives at.
        node: u32,
    },
}

/// A route under way: legs, and how many of their steps are taken. Without legs it stands.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Walker {
    legs: Vec<Leg>,
    /// Legs before those that were asked for last: the transition that was under way then.
    kept: usize,
    index: usize,
    taken: u32,
    /// The frame that it has come to; within a transition the one that it left.
    at: u32,
}

impl Walker {
    /// It stands in `frame`.
    #[must_use]
    pub fn standing(frame: u32) -> Self {
        Self { at: frame, ..Self::default() }
    }

    /// Leaves for the end of `legs`, which begin at [`Self::departure`], and drops what is left of the route. A transition
    /// under way is finished first: it becomes the first leg. Without legs it comes to stand.
    ///
    /// # Errors
    /// Legs that are not in the graph, or do not begin where the one before ends. The route is as it was, then.
    pub fn retarget(&mut self, graph: &EssentialGraph, timeline: &Timeline, legs: &[Leg]) -> Result<(), WalkError> {
        end_of(legs, graph, timeline, self.departure(graph))?;
        let under_way = self.inside().map(Leg::Synthetic);
        if under_way.is_none() {
            self.taken = 0;
        }
        self.kept = usize::from(under_way.is_some());
        self.index = 0;
        self.legs.clear();
        self.legs.extend(under_way.into_iter().chain(legs.iter().copied()));
        Ok(())
    }

    /// Goes on with `legs` after the last leg of the route; legs long done are forgotten.
    ///
    /// # Errors
    /// As [`Self::retarget`]; they begin at [`Self::end`].
    pub fn extend(&mut self, graph: &EssentialGraph, timeline: &Timeline, legs: &[Leg]) -> Result<(), WalkError> {
        end_of(legs, graph, timeline, self.end(graph))?;
        let done = self.index.saturating_sub(1);
        self.legs.drain(..done);
        self.index -= done;
        self.kept = self.kept.saturating_sub(done);
        self.legs.extend_from_slice(legs);
        Ok(())
    }

    /// The next step; `None` at the end of the route.
    #[must_use]
    pub fn next(&self, timeline: &Timeline) -> Option<Step> {
        match self.current()?.1 {
            Leg::Recorded { .. } => timeline.next(self.at).map(Step::Forward),
            Leg::Back { .. } => self.at.checked_sub(1).map(Step::Back),
            Leg::Synthetic(transition) => Some(Step::Node { transition, node: self.taken + 1 }),
        }
    }

    /// Takes the step that [`Self::next`] said.
    pub fn take(&mut self, graph: &EssentialGraph, timeline: &Timeline) {
        let (Some(step), Some((index, leg))) = (self.next(timeline), self.current()) else { return };
        self.index = index;
        self.taken += 1;
        let ended = self.taken >= leg.steps(graph);
        match step {
            Step::Forward(frame) | Step::Back(frame) => self.at = frame,
            Step::Node { .. } if ended => self.at = leg.ends(graph).map_or(self.at, |(_, to)| to),
            Step::Node { .. } => {}
        }
        if ended {
            self.index += 1;
            self.taken = 0;
        }
    }

    /// Whether the route has come to its end.
    #[must_use]
    pub fn has_arrived(&self) -> bool {
        self.current().is_none()
    }

    /// The transition that has begun and not ended, if any; its index.
    #[must_use]
    pub fn inside(&self) -> Option<u32> {
        self.legs.get(self.index).and_then(Leg::transition).filter(|_| self.taken > 0)
    }

    /// Steps of the leg under way that are taken.
    #[must_use]
    pub fn taken(&self) -> u32 {
        self.taken
    }

    /// What is left of the way to the next transition that has not begun, and that transition; `None` where there is none,
    /// or another one is under way.
    #[must_use]
    pub fn coming(&self) -> Option<(Vec<Leg>, u32)> {
        if self.inside().is_some() {
            return None;
        }
        let rest = self.legs.get(self.index..)?;
        let before = rest.iter().position(|leg| leg.transition().is_some())?;
        let mut way = rest[..before].to_vec();
        if let Some(Leg::Recorded { first, steps, .. } | Leg::Back { first, steps, .. }) = way.first_mut() {
            (*first, *steps) = (self.at, *steps - self.taken);
        }
        rest[before].transition().map(|transition| (way, transition))
    }

    /// The frame from which what comes next can be chosen freely: the end of a transition under way, or where it is.
    #[must_use]
    pub fn departure(&self, graph: &EssentialGraph) -> u32 {
        let transition = self.inside().and_then(|edge| graph.transitions().get(edge as usize));
        transition.map_or(self.at, |transition| transition.to)
    }

    /// The frame that the route ends with.
    #[must_use]
    pub fn end(&self, graph: &EssentialGraph) -> u32 {
        match self.legs.last() {
            Some(leg) if !self.has_arrived() => leg.ends(graph).map_or(self.at, |(_, last)| last),
            _ => self.at,
        }
    }

    /// The legs of the route, with the transition that was under way when it was chosen.
    #[must_use]
    pub fn legs(&self) -> &[Leg] {
        &self.legs
    }

    /// Index of the leg that the last step belongs to, and the part of it that is done.
    #[must_use]
    pub fn progress(&self, graph: &EssentialGraph) -> (usize, f32) {
        if self.taken == 0 && self.index > 0 {
            return (self.index - 1, 1.0);
        }
        let length = self.legs.get(self.index).map_or(1, |leg| leg.steps(graph)).max(1);
        (self.index, self.taken as f32 / length as f32)
    }

    /// Index of the leg that the last step belongs to among those that were asked for last; `None` before their first.
    #[must_use]
    pub fn leg(&self) -> Option<usize> {
        let begun = self.index + usize::from(self.taken > 0);
        begun.checked_sub(self.kept + 1)
    }

    /// Steps left.
    #[must_use]
    pub fn remaining(&self, graph: &EssentialGraph) -> u32 {
        let rest = self.legs.get(self.index..).unwrap_or_default();
        rest.iter().map(|leg| leg.steps(graph)).sum::<u32>().saturating_sub(self.taken)
    }

    /// The leg that the next step belongs to, and its index: legs without a step are passed over.
    fn current(&self) -> Option<(usize, Leg)> {
        let is_empty = |leg: &Leg| matches!(leg, Leg::Recorded { steps: 0, .. } | Leg::Back { steps: 0, .. });
        let mut rest = self.legs.iter().copied().enumerate().skip(self.index);
        rest.find(|(_, leg)| !is_empty(leg))
    }
}
