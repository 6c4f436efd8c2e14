//! The motion graph, a baseline to compare the essential graph with.

use actor::graph::rounded_alpha;
use actor::timeline::Timeline;

use super::costs::Costs;
use crate::transitions::TransitionMatrix;

/// The transitions of a motion graph: where E(i, j) is strictly less than at its eight neighbours within the matrix of
/// its pair of sequences, whatever its value (Kovar and others 2002, without the threshold, as in thesis section
/// 3.3.4); sorted.
#[must_use]
pub fn motion_graph(transitions: &TransitionMatrix, timeline: &Timeline, alpha: f64) -> Vec<(u32, u32)> {
    let costs = Costs { transitions, timeline, alpha: rounded_alpha(alpha) };
    let frames = 0..timeline.frame_count();
    let pairs = frames.clone().flat_map(|i| frames.clone().map(move |j| (i, j)));
    pairs.filter(|&(i, j)| is_minimum(&costs, i, j)).collect()
}

fn is_minimum(costs: &Costs, i: u32, j: u32) -> bool {
    let cost = costs.synthetic(i, j);
    let neighbours = (-1..=1).flat_map(|di| (-1..=1).map(move |dj| (di, dj))).filter(|&step| step != (0, 0));
    cost < costs.recorded(i, j)
        && neighbours
            .filter_map(|(di, dj)| Some((costs.timeline.offset(i, di)?, costs.timeline.offset(j, dj)?)))
            .all(|neighbour| neighbour == (i, j) || cost < costs.edge(neighbour.0, neighbour.1))
}
