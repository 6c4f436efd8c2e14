//! Which transitions of a frame are cheaper than every path of two or more edges: a search from the frame.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use actor::timeline::Timeline;
use rayon::prelude::*;

use super::candidates::Candidates;
use crate::transitions::TransitionCost;

/// Rows that are searched together, before what stays of them is put in order.
const ROWS: usize = 1024;

/// Candidates and recorded steps with their costs, laid out for searching: those of a frame by cost.
pub(super) struct Edges {
    first: Vec<usize>,
    /// Cost and destination.
    edges: Vec<(f64, u32)>,
}

impl Edges {
    /// The recorded steps of all frames and the candidates of those whose rows were seen.
    pub(super) fn new(candidates: &Candidates, timeline: &Timeline, alpha: f64) -> Self {
        let (mut first, mut edges) = (vec![0], Vec::with_capacity(candidates.len() + timeline.frame_count() as usize));
        for frame in 0..timeline.frame_count() {
            let start = edges.len();
            edges.extend(timeline.next(frame).filter(|&next| next != frame).map(|next| (alpha, next)));
            if frame < candidates.frame_count() {
                edges.extend(candidates.from(frame).iter().map(|&(to, transition)| (transition.cost(alpha), to)));
            }
            edges[start..].sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
            first.push(edges.len());
        }
        Self { first, edges }
    }

    /// Costs and destinations of the edges that leave from `frame`, the cheapest first.
    pub(super) fn from(&self, frame: u32) -> &[(f64, u32)] {
        &self.edges[self.first[frame as usize]..self.first[frame as usize + 1]]
    }

    /// What [`Scratch::cheapest`] leaves of all rows of `candidates`.
    pub(super) fn cheapest(&self, candidates: &Candidates, alpha: f64) -> Candidates {
        let mut kept = Candidates::new();
        let frames: Vec<u32> = (0..candidates.frame_count()).collect();
        for frames in frames.chunks(ROWS) {
            let rows: Vec<_> = frames.iter().map(|&frame| candidates.from(frame)).collect();
            self.cheapest_of_rows(alpha, frames[0], &rows).into_iter().for_each(|row| kept.push_row(row));
        }
        kept
    }

    /// What [`Scratch::cheapest`] leaves of the rows of the frames from `first` on; in parallel.
    pub(super) fn cheapest_of_rows(
        &self,
        alpha: f64,
        first: u32,
        rows: &[&[(u32, TransitionCost)]],
    ) -> Vec<Vec<(u32, TransitionCost)>> {
        let scratch = || Scratch::new(self.first.len() - 1);
        let rows = rows.par_iter().zip(first..first + rows.len() as u32);
        rows.map_init(scratch, |scratch, (row, frame)| scratch.cheapest(self, alpha, frame, row)).collect()
    }
}

/// What a thread needs, kept from frame to frame.
struct Scratch {
    /// Length of the shortest path found to each frame; infinite where none is.
    lengths: Vec<f64>,
    /// Whether a path of two or more edges is as short as that.
    by_detour: Vec<bool>,
    touched: Vec<u32>,
    /// A frame's own transitions: cost and destination, the cheapest first.
    own: Vec<(f64, u32)>,
    queue: BinaryHeap<Reverse<(u64, u32)>>,
}

impl Scratch {
    fn new(frame_count: usize) -> Self {
        Self {
            lengths: vec![f64::INFINITY; frame_count],
            by_detour: vec![false; frame_count],
            touched: Vec::new(),
            own: Vec::new(),
            queue: BinaryHeap::new(),
        }
    }

    /// The transitions among `row`, those of `frame`, that are strictly cheaper than every path of two or more edges which
    /// begins with one of them or with an edge of `frame` and goes on over `edges`.
    ///
    /// Dijkstra's algorithm, no farther than to the dearest transition without a detour: a detour's parts are shorter than
    /// itself, and it counts only where it is no longer than the transition.
    fn cheapest(
        &mut self,
        edges: &Edges,
        alpha: f64,
        frame: u32,
        row: &[(u32, TransitionCost)],
    ) -> Vec<(u32, TransitionCost)> {
        self.begin(edges, alpha, frame, row);
        let mut open = self.own.len();
        loop {
            while open > 0 && self.by_detour[self.own[open - 1].1 as usize] {
                open -= 1;
            }
            let (Some(dearest), Some(Reverse((bits, node)))) = (open.checked_sub(1), self.queue.pop()) else { break };
            let (bound, length) = (self.own[dearest].0, f64::from_bits(bits));
            if length >= bound {
                break;
            }
            if length > self.lengths[node as usize] {
                continue;
            }
            for &(cost, to) in edges.from(node) {
                let longer = length + cost;
                if longer > bound {
                    break;
                }
                self.detour(to, longer);
            }
        }
        let stays = |&&(to, transition): &&(u32, TransitionCost)| {
            !self.by_detour[to as usize] && transition.cost(alpha) <= self.lengths[to as usize]
        };
        row.iter().filter(stays).copied().collect()
    }

    /// Forgets the frame before; `row` and the recorded step are the paths of one edge.
    fn begin(&mut self, edges: &Edges, alpha: f64, frame: u32, row: &[(u32, TransitionCost)]) {
        for frame in self.touched.drain(..) {
            self.lengths[frame as usize] = f64::INFINITY;
            self.by_detour[frame as usize] = false;
        }
        self.queue.clear();
        self.own.clear();
        self.own.extend(row.iter().map(|&(to, transition)| (transition.cost(alpha), to)));
        self.own.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        // No way back to where it begins is a detour.
        self.lengths[frame as usize] = 0.0;
        self.touched.push(frame);
        for place in 0..self.own.len() {
            let (cost, to) = self.own[place];
            self.shorten(to, cost);
        }
        // Where the row was seen before, these are no others.
        edges.from(frame).iter().for_each(|&(cost, to)| self.shorten(to, cost));
    }

    fn detour(&mut self, to: u32, length: f64) {
        if length <= self.lengths[to as usize] {
            self.shorten(to, length);
            self.by_detour[to as usize] = true;
        }
    }

    fn shorten(&mut self, to: u32, length: f64) {
        let known = &mut self.lengths[to as usize];
        if length < *known {
            if *known == f64::INFINITY {
                self.touched.push(to);
            }
            *known = length;
            // Lengths are not negative, and such floats order as their bits do.
            self.queue.push(Reverse((length.to_bits(), to)));
        }
    }
}
