//! A plan under way, step by step.

use actor::graph::EssentialGraph;
use actor::timeline::Timeline;
use actor::walk::Leg;

use super::{Plan, Stretch};

/// A step of a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Show this frame, recorded right after the present one.
    Recorded(u32),
    /// Show this frame, recorded right before the present one.
    Back(u32),
    /// Show node `node` of transition `edge`, from 1: node 0 is the frame that it leaves.
    Synthetic {
        /// Index of the transition in the graph.
        edge: u32,
        /// Index of the node in the transition's warp.
        node: u32,
    },
}

/// What happens at the end of a route.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Goal {
    /// The actor has arrived, and stands.
    Target(u32),
    /// It plays on.
    PlayOn,
    /// It stands.
    Stop,
}

/// A way under way: which stretch, and how many of its steps are taken.
#[derive(Clone, Debug, PartialEq)]
pub struct Route {
    /// What happens at its end.
    pub goal: Goal,
    stretches: Vec<Stretch>,
    index: usize,
    taken: u32,
    /// The frame that it has come to; within a transition the one that it left.
    at: u32,
}

impl Route {
    /// At the beginning of `plan`.
    #[must_use]
    pub fn new(plan: &Plan, goal: Goal) -> Self {
        Self { goal, stretches: plan.stretches.clone(), index: 0, taken: 0, at: plan.start }
    }

    /// The next step; `None` at the end.
    #[must_use]
    pub fn next(&self, timeline: &Timeline) -> Option<Step> {
        match *self.stretches.get(self.index)? {
            Stretch::Back { .. } => self.at.checked_sub(1).map(Step::Back),
            Stretch::Walk(Leg::Recorded { .. }) => timeline.next(self.at).map(Step::Recorded),
            Stretch::Walk(Leg::Synthetic(edge)) => Some(Step::Synthetic { edge, node: self.taken + 1 }),
        }
    }

    /// Takes the step that [`Self::next`] said.
    pub fn take(&mut self, graph: &EssentialGraph, timeline: &Timeline) {
        let (Some(step), Some(stretch)) = (self.next(timeline), self.stretches.get(self.index)) else { return };
        self.taken += 1;
        let ended = self.taken >= stretch.length(graph);
        match step {
            Step::Recorded(frame) | Step::Back(frame) => self.at = frame,
            Step::Synthetic { edge, .. } if ended => {
                self.at = graph.transitions().get(edge as usize).map_or(self.at, |transition| transition.to);
            }
            Step::Synthetic { .. } => {}
        }
        if ended {
            self.index += 1;
            self.taken = 0;
        }
    }

    /// The transition that has begun and not ended, if any; its index.
    #[must_use]
    pub fn inside(&self) -> Option<u32> {
        match self.stretches.get(self.index) {
            Some(&Stretch::Walk(Leg::Synthetic(edge))) if self.taken > 0 => Some(edge),
            _ => None,
        }
    }

    /// The next transition on the way that has not begun.
    #[must_use]
    pub fn coming(&self) -> Option<u32> {
        let begun = usize::from(self.inside().is_some());
        self.stretches.get(self.index + begun..)?.iter().find_map(|stretch| match *stretch {
            Stretch::Walk(Leg::Synthetic(edge)) => Some(edge),
            _ => None,
        })
    }

    /// The frame from which what comes next can be chosen freely: the end of a transition under way, or where it is.
    #[must_use]
    pub fn departure(&self, graph: &EssentialGraph) -> u32 {
        let transition = self.inside().and_then(|edge| graph.transitions().get(edge as usize));
        transition.map_or(self.at, |transition| transition.to)
    }

    /// Leaves for the end of `plan`, which begins at [`Self::departure`]; a transition under way is finished first.
    #[must_use]
    pub fn redirected(&self, plan: &Plan, goal: Goal) -> Self {
        let mut route = Self::new(plan, goal);
        if let Some(edge) = self.inside() {
            route.stretches.insert(0, Stretch::Walk(Leg::Synthetic(edge)));
            route.taken = self.taken;
            route.at = self.at;
        }
        route
    }

    /// Goes on with these stretches after its last one; those long done are forgotten.
    pub fn extend(&mut self, stretches: impl IntoIterator<Item = Stretch>) {
        let done = self.index.saturating_sub(1);
        self.stretches.drain(..done);
        self.index -= done;
        self.stretches.extend(stretches);
    }

    /// Its stretches.
    #[must_use]
    pub fn stretches(&self) -> &[Stretch] {
        &self.stretches
    }

    /// Index of the stretch that the last step belongs to, and the part of it that is done.
    #[must_use]
    pub fn progress(&self, graph: &EssentialGraph) -> (usize, f32) {
        if self.taken == 0 && self.index > 0 {
            return (self.index - 1, 1.0);
        }
        let length = self.stretches.get(self.index).map_or(1, |stretch| stretch.length(graph)).max(1);
        (self.index, self.taken as f32 / length as f32)
    }

    /// Steps left.
    #[must_use]
    pub fn remaining(&self, graph: &EssentialGraph) -> u32 {
        let rest = self.stretches.get(self.index..).unwrap_or_default();
        rest.iter().map(|stretch| stretch.length(graph)).sum::<u32>().saturating_sub(self.taken)
    }
}
