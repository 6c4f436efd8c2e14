//! Plans as the page reads them.

use actor::graph::EssentialGraph;
use actor::timeline::Timeline;
use actor::walk::{Leg, Walk, steps_of};
use serde::Serialize;

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

/// `legs` as the page reads them.
#[must_use]
pub fn report_legs(legs: &[Leg], graph: &EssentialGraph) -> Vec<LegReport> {
    let report = |leg: &Leg| match *leg {
        Leg::Back { first, last, steps } => Some(LegReport::Recorded { first, last, steps, back: true }),
        Leg::Recorded { first, last, steps } => Some(LegReport::Recorded { first, last, steps, back: false }),
        Leg::Synthetic(edge) => graph.transitions().get(edge as usize).map(|transition| LegReport::Synthetic {
            from: transition.from,
            to: transition.to,
            frames: steps_of(transition),
            deformation: transition.deformation,
            edge,
        }),
    };
    legs.iter().filter_map(report).collect()
}

impl PlanReport {
    /// `walk`, which leads to `to`, as the page reads it.
    #[must_use]
    pub fn new(walk: &Walk, to: u32, graph: &EssentialGraph, timeline: &Timeline) -> Self {
        let frames = walk.steps(graph);
        Self {
            to,
            cost: walk.cost,
            deformation: walk.deformation,
            frames,
            seconds: f64::from(frames) / f64::from(timeline.fps()),
            transitions: walk.transition_count(),
            legs: report_legs(&walk.legs, graph),
        }
    }
}
