//! Plans as the page reads them.

use actor::graph::EssentialGraph;
use actor::timeline::Timeline;
use actor::walk::Walk;
use searcher::report::{LegReport, report_legs};
use serde::Serialize;

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
