//! Plans: the walk from where the actor is to where it shall be, and what is left of it.

mod report;
mod route;
#[cfg(test)]
mod tests;

pub use report::{LegReport, PlanReport, report_legs};
pub use route::{Goal, Route, Step};

use actor::graph::EssentialGraph;
use actor::timeline::Timeline;
use actor::walk::{Leg, Walk, steps_of};
use search::{cheapest_walk, reached, reaching};

/// A stretch of a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stretch {
    /// A leg of a walk through the graph.
    Walk(Leg),
    /// `steps` recorded frames back from frame `first`.
    Back {
        /// The frame that it begins with.
        first: u32,
        /// Steps back.
        steps: u32,
    },
}

impl Stretch {
    /// Steps that it takes.
    #[must_use]
    pub fn length(&self, graph: &EssentialGraph) -> u32 {
        match *self {
            Self::Back { steps, .. } | Self::Walk(Leg::Recorded { steps, .. }) => steps,
            Self::Walk(Leg::Synthetic(edge)) => graph.transitions().get(edge as usize).map_or(0, steps_of),
        }
    }
}

/// A way from one frame to another.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plan {
    /// The frame that it begins with.
    pub start: u32,
    /// Its stretches, in order.
    pub stretches: Vec<Stretch>,
    /// J: the sum of the edges' costs; a step back costs as much as one forwards.
    pub cost: f64,
    /// Sum of the transitions' surface deformation costs.
    pub deformation: f64,
    /// Steps from frame to frame.
    pub duration: u32,
}

impl Plan {
    /// `walk`, begun at frame `start`.
    #[must_use]
    pub fn of_walk(start: u32, walk: &Walk, graph: &EssentialGraph) -> Self {
        let stretches: Vec<_> = walk.legs.iter().copied().map(Stretch::Walk).collect();
        let duration = stretches.iter().map(|stretch| stretch.length(graph)).sum();
        Self { start, stretches, cost: walk.cost, deformation: walk.deformation, duration }
    }

    /// It, and then `steps` recorded frames back from frame `first`, with which it ends (or begins, where it is empty).
    fn and_back(mut self, first: u32, steps: u32, graph: &EssentialGraph) -> Self {
        if self.stretches.is_empty() {
            self.start = first;
        }
        self.stretches.push(Stretch::Back { first, steps });
        self.cost += f64::from(steps) * graph.alpha();
        self.duration += steps;
        self
    }

    /// The part of it that is a walk through the graph: all but steps back.
    #[must_use]
    pub fn walk(&self) -> Walk {
        let leg = |stretch: &Stretch| match *stretch {
            Stretch::Walk(leg) => Some(leg),
            Stretch::Back { .. } => None,
        };
        let legs = self.stretches.iter().filter_map(leg).collect();
        Walk { legs, cost: self.cost, deformation: self.deformation, duration: self.duration }
    }
}

/// The cheapest walk from `from` to `to`.
///
/// From a dead end (a sequence's last frames have no transition) the plan first steps back along the recording, as few
/// frames as it takes; likewise it ends with steps back where no transition can arrive (a sequence's first frames). The
/// body moves on without a pop, and every pose stays within reach. `None` where even that does not help.
#[must_use]
pub fn plan(graph: &EssentialGraph, timeline: &Timeline, from: u32, to: u32) -> Option<Plan> {
    if let Some(plan) = plan_out(graph, timeline, from, to) {
        return Some(plan);
    }
    let sequence = timeline.sequence_of(to)?;
    if sequence.contains(from) && to < from {
        return Some(Plan::default().and_back(from, from - to, graph));
    }
    let beyond = |start| {
        let reached = reached(graph, timeline, start);
        (to + 1..sequence.end_frame()).find(|&frame| reached[frame as usize])
    };
    // Out of a dead end, whatever its sequence's first frame reaches can be reached too.
    let turn = beyond(from).or_else(|| beyond(timeline.sequence_of(from)?.first_frame))?;
    let plan = plan_out(graph, timeline, from, turn)?;
    Some(plan.and_back(turn, turn - to, graph))
}

/// The cheapest walk from `from` to `to`, after as few steps back as it takes.
fn plan_out(graph: &EssentialGraph, timeline: &Timeline, from: u32, to: u32) -> Option<Plan> {
    if let Some(walk) = cheapest_walk(graph, timeline, from, to) {
        return Some(Plan::of_walk(from, &walk, graph));
    }
    let sequence = timeline.sequence_of(from)?;
    let reaching = reaching(graph, timeline, to);
    let is_way = |frame: &u32| reaching.get(*frame as usize).copied().unwrap_or(false);
    let leave = (sequence.first_frame..from).rev().find(is_way)?;
    let mut plan = Plan::default().and_back(from, from - leave, graph);
    let rest = Plan::of_walk(from, &cheapest_walk(graph, timeline, leave, to)?, graph);
    plan.stretches.extend(rest.stretches);
    plan.cost += rest.cost;
    plan.deformation = rest.deformation;
    plan.duration += rest.duration;
    Some(plan)
}
