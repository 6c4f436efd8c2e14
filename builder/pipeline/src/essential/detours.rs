//! Which transitions of a frame are cheaper than every path of two or more edges: a search from the frame.

use actor::timeline::Timeline;
use job::Stopped;
use rayon::prelude::*;

use super::candidates::Candidates;
use crate::transitions::TransitionCost;

/// Rows that are searched together, before what stays of them is put in order.
const ROWS: usize = 512;

/// Buckets of paths at most: with a very small alpha they get wider.
const MOST_BUCKETS: usize = 1 << 12;

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

    /// What [`Scratch::cheapest`] leaves of all rows of `candidates`; `told` now and then how many are done.
    pub(super) fn cheapest(
        &self,
        candidates: &Candidates,
        alpha: f64,
        told: &dyn Fn(u32) -> Result<(), Stopped>,
    ) -> Result<Candidates, Stopped> {
        let mut kept = Candidates::new();
        let frames: Vec<u32> = (0..candidates.frame_count()).collect();
        for frames in frames.chunks(ROWS) {
            told(frames[0])?;
            let rows: Vec<_> = frames.iter().map(|&frame| candidates.from(frame)).collect();
            self.cheapest_of_rows(alpha, frames[0], &rows).into_iter().for_each(|row| kept.push_row(row));
        }
        Ok(kept)
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
    /// Paths by their length in whole steps of `width`, some of them outdated: length and where they end.
    buckets: Vec<Vec<(f64, u32)>>,
    width: f64,
}

impl Scratch {
    fn new(frame_count: usize) -> Self {
        Self {
            lengths: vec![f64::INFINITY; frame_count],
            by_detour: vec![false; frame_count],
            touched: Vec::new(),
            own: Vec::new(),
            buckets: Vec::new(),
            width: 1.0,
        }
    }

    /// The transitions among `row`, those of `frame`, that are strictly cheaper than every path of two or more edges which
    /// begins with one of them or with an edge of `frame` and goes on over `edges`.
    ///
    /// Dijkstra's algorithm, no farther than to the dearest transition without a detour: a detour's parts are shorter than
    /// itself, and it counts only where it is no longer than the transition. Buckets instead of a heap (Denardo and Fox,
    /// "Shortest-route methods: 1. Reaching, pruning, and buckets", 1979): no edge is cheaper than alpha, so the paths of a
    /// bucket of that width are as short as they get once it is its turn. In wider ones, some are followed again.
    fn cheapest(
        &mut self,
        edges: &Edges,
        alpha: f64,
        frame: u32,
        row: &[(u32, TransitionCost)],
    ) -> Vec<(u32, TransitionCost)> {
        self.begin(edges, alpha, frame, row);
        let mut open = self.own.len();
        let (mut bucket, mut place) = (0, 0);
        while bucket < self.buckets.len() {
            let Some(&(length, node)) = self.buckets[bucket].get(place) else {
                (bucket, place) = (bucket + 1, 0);
                continue;
            };
            place += 1;
            while open > 0 && self.by_detour[self.own[open - 1].1 as usize] {
                open -= 1;
            }
            let Some(dearest) = open.checked_sub(1) else { break };
            let bound = self.own[dearest].0;
            if length > self.lengths[node as usize] || length >= bound {
                continue;
            }
            for &(cost, to) in edges.from(node) {
                let longer = length + cost;
                if longer > bound {
                    break;
                }
                if longer <= self.lengths[to as usize] {
                    self.shorten(to, longer);
                    self.by_detour[to as usize] = true;
                }
            }
        }
        let stays = |&&(to, transition): &&(u32, TransitionCost)| {
            !self.by_detour[to as usize] && transition.cost(alpha) <= self.lengths[to as usize]
        };
        row.iter().filter(stays).copied().collect()
    }

    /// Forgets the frame before; `row` and the edges of `frame` are the paths of one edge.
    fn begin(&mut self, edges: &Edges, alpha: f64, frame: u32, row: &[(u32, TransitionCost)]) {
        for frame in self.touched.drain(..) {
            self.lengths[frame as usize] = f64::INFINITY;
            self.by_detour[frame as usize] = false;
        }
        self.own.clear();
        self.own.extend(row.iter().map(|&(to, transition)| (transition.cost(alpha), to)));
        self.own.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let dearest = self.own.last().map_or(0.0, |&(cost, _)| cost);
        self.buckets.iter_mut().for_each(Vec::clear);
        self.width = alpha.max(dearest / MOST_BUCKETS as f64);
        self.buckets.resize((dearest / self.width) as usize + 1, Vec::new());
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

    fn shorten(&mut self, to: u32, length: f64) {
        let known = &mut self.lengths[to as usize];
        if length < *known {
            if *known == f64::INFINITY {
                self.touched.push(to);
            }
            *known = length;
            // One that is longer than all that is to be decided leads nowhere.
            if let Some(bucket) = self.buckets.get_mut((length / self.width) as usize) {
                bucket.push((length, to));
            }
        }
    }
}
