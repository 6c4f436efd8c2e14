//! Plans: the walk from where the actor is to where it shall be, and what is left of it.

use serde::Serialize;
use shared::graph::{EssentialGraph, Transition};
use shared::search::{Leg, Walk, cheapest_walk, reached, reaching};
use shared::timeline::Timeline;

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

/// Steps from the frame that `transition` leaves to the one that it arrives at: its first node is the frame left.
fn steps_of(transition: &Transition) -> u32 {
    (transition.warp.duration() as u32).saturating_sub(1).max(1)
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

/// A leg as the page reads it.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum LegReport {
    /// Recorded frames; backwards where `last` is before `first` in a sequence that is not cyclic.
    Recorded {
        /// First frame.
        first: u32,
        /// Last frame.
        last: u32,
        /// Steps between them.
        steps: u32,
        /// Whether it is walked backwards.
        back: bool,
    },
    /// A synthesised transition.
    Synthetic {
        /// Frame left.
        from: u32,
        /// Frame reached.
        to: u32,
        /// Steps that it takes.
        frames: u32,
        /// Its surface deformation cost.
        deformation: f32,
        /// Its index in the graph.
        edge: u32,
    },
}

/// A plan as the page reads it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlanReport {
    /// The target.
    pub to: u32,
    /// J: the sum of the edges' costs.
    pub cost: f64,
    /// Sum of the transitions' surface deformation costs.
    pub deformation: f64,
    /// Duration in frames.
    pub frames: u32,
    /// Duration in seconds at normal speed.
    pub seconds: f64,
    /// Number of transitions.
    pub transitions: usize,
    /// Its legs.
    pub legs: Vec<LegReport>,
}

/// `stretches` as the page reads them.
#[must_use]
pub fn report_legs(stretches: &[Stretch], graph: &EssentialGraph) -> Vec<LegReport> {
    let report = |stretch: &Stretch| match *stretch {
        Stretch::Back { first, steps } => {
            Some(LegReport::Recorded { first, last: first.saturating_sub(steps), steps, back: true })
        }
        Stretch::Walk(Leg::Recorded { first, last, steps }) => {
            Some(LegReport::Recorded { first, last, steps, back: false })
        }
        Stretch::Walk(Leg::Synthetic(edge)) => {
            graph.transitions().get(edge as usize).map(|transition| LegReport::Synthetic {
                from: transition.from,
                to: transition.to,
                frames: steps_of(transition),
                deformation: transition.deformation,
                edge,
            })
        }
    };
    stretches.iter().filter_map(report).collect()
}

impl Plan {
    /// The plan as the page reads it.
    #[must_use]
    pub fn report(&self, to: u32, graph: &EssentialGraph, timeline: &Timeline) -> PlanReport {
        let synthetic = |stretch: &&Stretch| matches!(stretch, Stretch::Walk(Leg::Synthetic(_)));
        PlanReport {
            to,
            cost: self.cost,
            deformation: self.deformation,
            frames: self.duration,
            seconds: f64::from(self.duration) / f64::from(timeline.fps()),
            transitions: self.stretches.iter().filter(synthetic).count(),
            legs: report_legs(&self.stretches, graph),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::player::tests::{jump, timeline};
    use shared::search::components;

    fn graph(timeline: &Timeline, edges: &[(u32, u32)]) -> EssentialGraph {
        let transitions = edges.iter().map(|&(from, to)| jump(timeline, from, to).unwrap()).collect();
        EssentialGraph::new(0.01, transitions, timeline).unwrap()
    }

    /// All steps of the route that are left.
    fn steps(mut route: Route, graph: &EssentialGraph, timeline: &Timeline) -> Vec<Step> {
        let mut steps = Vec::new();
        let all = route.remaining(graph) as usize;
        while let Some(step) = route.next(timeline) {
            assert_eq!(route.remaining(graph) as usize + steps.len(), all);
            route.take(graph, timeline);
            steps.push(step);
        }
        assert_eq!(steps.len(), all);
        steps
    }

    const fn node(node: u32) -> Step {
        Step::Synthetic { edge: 0, node }
    }

    #[test]
    fn a_route_takes_every_step_once() {
        let timeline = timeline(&[(8, false), (8, false)]);
        let graph = graph(&timeline, &[(2, 11), (12, 4)]);
        let route = Route::new(&plan(&graph, &timeline, 0, 13).unwrap(), Goal::Target(13));
        let wanted = [Step::Recorded(1), Step::Recorded(2), node(1), node(2), Step::Recorded(12), Step::Recorded(13)];
        assert_eq!(steps(route, &graph, &timeline), wanted);
    }

    #[test]
    fn a_dead_end_is_left_backwards() {
        let timeline = timeline(&[(8, false), (8, false)]);
        let graph = graph(&timeline, &[(5, 11)]);
        let from_end = plan(&graph, &timeline, 7, 12).unwrap();
        let report = from_end.report(12, &graph, &timeline);
        assert_eq!(report.legs[0], LegReport::Recorded { first: 7, last: 5, steps: 2, back: true });
        assert_eq!(report.frames, 2 + 2 + 1);
        let all = steps(Route::new(&from_end, Goal::Target(12)), &graph, &timeline);
        assert_eq!(all[..2], [Step::Back(6), Step::Back(5)]);
        assert_eq!(all.last(), Some(&Step::Recorded(12)));
        assert_eq!(plan(&graph, &timeline, 12, 0), None);
        assert_eq!(plan(&graph, &timeline, 99, 0), None);
    }

    #[test]
    fn a_first_frame_is_reached_backwards() {
        let timeline = timeline(&[(8, false), (8, false)]);
        let graph = graph(&timeline, &[(5, 11)]);
        let to_start = plan(&graph, &timeline, 4, 9).unwrap();
        let all = steps(Route::new(&to_start, Goal::Target(9)), &graph, &timeline);
        let wanted = [Step::Recorded(5), node(1), node(2), Step::Back(10), Step::Back(9)];
        assert_eq!(all, wanted);
        let both_ends =
            steps(Route::new(&plan(&graph, &timeline, 7, 10).unwrap(), Goal::Target(10)), &graph, &timeline);
        assert_eq!(both_ends, [Step::Back(6), Step::Back(5), node(1), node(2), Step::Back(10)]);
        let within = steps(Route::new(&plan(&graph, &timeline, 13, 11).unwrap(), Goal::Target(11)), &graph, &timeline);
        assert_eq!(within, [Step::Back(12), Step::Back(11)]);
    }

    #[test]
    fn a_transition_under_way_is_finished_before_another_way() {
        let timeline = timeline(&[(8, false), (8, false)]);
        let graph = graph(&timeline, &[(2, 11)]);
        let mut route = Route::new(&plan(&graph, &timeline, 2, 13).unwrap(), Goal::Target(13));
        assert_eq!((route.inside(), route.departure(&graph)), (None, 2));
        route.take(&graph, &timeline);
        assert_eq!((route.inside(), route.departure(&graph)), (Some(0), 11));
        let other = plan(&graph, &timeline, 11, 12).unwrap();
        let redirected = route.redirected(&other, Goal::Target(12));
        assert_eq!(steps(redirected, &graph, &timeline), [node(2), Step::Recorded(12)]);
        let stopped = route.redirected(&Plan { start: 11, ..Plan::default() }, Goal::Stop);
        assert_eq!(steps(stopped, &graph, &timeline), [node(2)]);
    }

    #[test]
    fn what_reaches_what_agrees_with_the_search() {
        let timeline = timeline(&[(8, false), (6, false), (5, true)]);
        for seed in 0..40_u32 {
            let mut edges: Vec<_> = (0..6).map(|k| (seed * 7 + k * 5, seed * 3 + k * 11)).collect();
            edges.iter_mut().for_each(|edge| *edge = (edge.0 % 18, edge.1 % 18));
            edges.sort_unstable();
            edges.dedup();
            let transitions = edges.into_iter().filter_map(|(from, to)| jump(&timeline, from, to)).collect();
            let graph = EssentialGraph::new(0.01, transitions, &timeline).unwrap();
            let walks = |a, b| cheapest_walk(&graph, &timeline, a, b).is_some();
            let component = components(&graph, &timeline).main;
            let size = component.iter().filter(|&&inside| inside).count();
            for a in 0..19 {
                let reach = reaching(&graph, &timeline, a);
                let mut mutual = 0;
                for b in 0..19 {
                    assert_eq!(reach[b as usize], walks(b, a), "{b} to {a}");
                    mutual += usize::from(walks(a, b) && walks(b, a));
                }
                assert!(mutual <= size);
                assert!(!component[a as usize] || mutual == size);
            }
        }
    }
}
