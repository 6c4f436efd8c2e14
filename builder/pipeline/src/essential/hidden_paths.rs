//! The essential graph by the hidden-paths algorithm, to compare with blocked Floyd and Warshall.
//!
//! Karger, Koller and Phillips, "Finding the hidden path: time bounds for all-pairs shortest paths" (1993): shortest
//! paths of all pairs are found in the order of their lengths, each being an optimal path extended by an optimal edge,
//! so that only the m* edges that are kept are ever extended: O(n m* + n^2 log n).

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use actor::graph::rounded_alpha;
use actor::timeline::Timeline;

use crate::essential::Costs;
use crate::transitions::TransitionMatrix;

/// The transitions of the essential graph, as (from, to), sorted; the same as
/// [`crate::essential::essential_edges`] finds, for an `alpha` that it takes.
#[must_use]
pub fn hidden_paths(transitions: &TransitionMatrix, timeline: &Timeline, alpha: f64) -> Vec<(u32, u32)> {
    let n = timeline.frame_count();
    let costs = Costs { transitions, timeline, alpha: rounded_alpha(alpha) };
    let mut search = Search::new(n as usize);
    let mut direct: Vec<(f64, u32, u32)> = Vec::new();
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).filter(|(i, j)| i != j) {
        let cost = edge(&costs, i, j);
        if cost < f64::INFINITY {
            direct.push((cost, i, j));
        }
    }
    direct.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let mut edges = Vec::new();
    let mut next = direct.into_iter().peekable();
    loop {
        // Of equal lengths, detours come first: an edge that a detour equals is not kept.
        let path = search.shortest();
        let takes_edge = match (next.peek(), path) {
            (None, None) => break,
            (Some(edge), Some((length, ..))) => edge.0 < length,
            (edge, _) => edge.is_some(),
        };
        if !takes_edge {
            if let Some((length, i, j)) = search.take() {
                search.settle(length, i, j);
            }
        } else if let Some((cost, i, j)) = next.next()
            && search.is_open(i, j)
        {
            if timeline.next(i) != Some(j) || costs.synthetic(i, j) < costs.recorded(i, j) {
                edges.push((i, j));
            }
            search.settle(cost, i, j);
            search.keep(cost, i, j);
        }
    }
    edges.sort_unstable();
    edges
}

/// The cost of the edge itself: a transition, or a single recorded step.
fn edge(costs: &Costs, i: u32, j: u32) -> f64 {
    let step = if costs.timeline.next(i) == Some(j) { costs.recorded(i, j) } else { f64::INFINITY };
    costs.synthetic(i, j).min(step)
}

/// Paths found so far.
struct Search {
    nodes: usize,
    /// Lengths of shortest paths; infinite where not yet found.
    lengths: Vec<f64>,
    /// Least length of a path of two or more edges seen so far.
    detours: Vec<f64>,
    /// Detours by length, some of them outdated.
    queue: BinaryHeap<Reverse<(u64, u32, u32)>>,
    /// Edges kept that leave each node.
    kept: Vec<Vec<(u32, f64)>>,
    /// Nodes from which a path to each node was found.
    found_to: Vec<Vec<u32>>,
}

impl Search {
    fn new(nodes: usize) -> Self {
        Self {
            nodes,
            lengths: vec![f64::INFINITY; nodes * nodes],
            detours: vec![f64::INFINITY; nodes * nodes],
            queue: BinaryHeap::new(),
            kept: vec![Vec::new(); nodes],
            found_to: vec![Vec::new(); nodes],
        }
    }

    fn is_open(&self, i: u32, j: u32) -> bool {
        self.lengths[i as usize * self.nodes + j as usize] == f64::INFINITY
    }

    /// The shortest detour that settles a pair, left in the queue.
    fn shortest(&mut self) -> Option<(f64, u32, u32)> {
        while let Some(&Reverse((bits, i, j))) = self.queue.peek() {
            if self.is_open(i, j) {
                return Some((f64::from_bits(bits), i, j));
            }
            self.queue.pop();
        }
        None
    }

    fn take(&mut self) -> Option<(f64, u32, u32)> {
        // Lengths are not negative, and such floats order as their bits do.
        self.queue.pop().map(|Reverse((bits, i, j))| (f64::from_bits(bits), i, j))
    }

    /// The shortest path from i to j is known; extend it by the edges kept that leave j.
    fn settle(&mut self, length: f64, i: u32, j: u32) {
        self.lengths[i as usize * self.nodes + j as usize] = length;
        self.found_to[j as usize].push(i);
        for place in 0..self.kept[j as usize].len() {
            let (to, cost) = self.kept[j as usize][place];
            self.offer(length + cost, i, to);
        }
    }

    /// The edge from i to j is kept; extend the paths that were found to i.
    fn keep(&mut self, cost: f64, i: u32, j: u32) {
        self.kept[i as usize].push((j, cost));
        for place in 0..self.found_to[i as usize].len() {
            let from = self.found_to[i as usize][place];
            let length = self.lengths[from as usize * self.nodes + i as usize] + cost;
            self.offer(length, from, j);
        }
    }

    fn offer(&mut self, length: f64, i: u32, j: u32) {
        let place = i as usize * self.nodes + j as usize;
        if i != j && self.lengths[place] == f64::INFINITY && length < self.detours[place] {
            self.detours[place] = length;
            self.queue.push(Reverse((length.to_bits(), i, j)));
        }
    }
}
