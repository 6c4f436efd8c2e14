//! The essential graph from candidates instead of all transitions.
//!
//! Nearly all transitions of a capture are beaten by a neighbour: arriving one frame earlier and playing on, or playing on
//! and leaving one frame later, costs no more. What is left is a sparse graph with the same shortest paths. Up to 4,096
//! frames all of these decide about the rest, O(n^3). Beyond that, two-edge detours thin it further, and a search from each
//! frame, no farther than its dearest transition, decides.
//!
//! A transition that is taken away equals or exceeds a path of two or more edges, each cheaper than itself. By induction
//! over costs, those that stay have the same shortest paths, whatever the order: rounds are made in parallel. Costs are
//! positive, for alpha is. Time O(n^2) for the rows and, with searches, O(n m log n) for m transitions that are left to
//! decide; memory O(m).

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use actor::timeline::Timeline;
use job::Job;
use kernels::simd::Level;
use rayon::prelude::*;

use super::paths::PathLengths;
use crate::distance::DistanceMatrix;
use crate::transitions::{Search, TransitionCost, TransitionError, TransitionMatrix, TransitionOptions};

/// A two-edge round is worth its time where the one before took away this share of the transitions.
const WORTHWHILE: f64 = 0.1;

/// Transitions that may be essential: by source frame, then by destination.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Candidates {
    /// Where those of each frame begin; one more than there are frames.
    first: Vec<usize>,
    /// Destination and transition.
    transitions: Vec<(u32, TransitionCost)>,
}

impl Candidates {
    /// Those whose rows are not yet seen come later, by [`Self::push_row`].
    #[must_use]
    pub fn new() -> Self {
        Self { first: vec![0], transitions: Vec::new() }
    }

    /// Appends what [`row_candidates`] leaves of the next frame's row.
    pub fn push_row(&mut self, row: impl IntoIterator<Item = (u32, TransitionCost)>) {
        self.transitions.extend(row);
        self.first.push(self.transitions.len());
    }

    /// The transitions that leave from `frame`, by destination.
    #[must_use]
    pub fn from(&self, frame: u32) -> &[(u32, TransitionCost)] {
        &self.transitions[self.first[frame as usize]..self.first[frame as usize + 1]]
    }

    /// The transition between two frames, where it is among them.
    #[must_use]
    pub fn get(&self, from: u32, to: u32) -> Option<TransitionCost> {
        let row = self.from(from);
        row.binary_search_by_key(&to, |&(to, _)| to).ok().map(|place| row[place].1)
    }

    /// Number of frames whose rows were seen.
    #[must_use]
    pub fn frame_count(&self) -> u32 {
        (self.first.len() - 1) as u32
    }

    /// Number of transitions.
    #[must_use]
    pub fn len(&self) -> usize {
        self.transitions.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.transitions.is_empty()
    }

    /// Those for which `keeps(frame, destinations)` says so, asked for all frames in parallel.
    fn filtered(&self, keeps: impl Fn(u32, &mut Scratch) -> Vec<bool> + Sync) -> Self {
        let rows: Vec<Vec<bool>> = (0..self.frame_count())
            .into_par_iter()
            .map_init(|| Scratch::new(self.frame_count() as usize), |scratch, frame| keeps(frame, scratch))
            .collect();
        let mut kept = Self::new();
        for (frame, row) in rows.iter().enumerate() {
            kept.push_row(self.from(frame as u32).iter().zip(row).filter(|(_, kept)| **kept).map(|(edge, _)| *edge));
        }
        kept
    }
}

/// What of the transitions from frame `from` may be essential: `row` holds those to all frames, and `next` those from the
/// frame recorded after it, where that is known. `cost` is E of a transition that exists, or infinity.
pub fn row_candidates(
    timeline: &Timeline,
    alpha: f64,
    from: u32,
    row: &[TransitionCost],
    next: Option<&[TransitionCost]>,
) -> Vec<(u32, TransitionCost)> {
    let cost = |cost: &TransitionCost| if cost.duration > 0 { cost.cost(alpha) } else { f64::INFINITY };
    let mut kept = Vec::new();
    for sequence in timeline.sequences() {
        for to in sequence.first_frame..sequence.end_frame() {
            let own = cost(&row[to as usize]);
            if to == from || own == f64::INFINITY || own >= recorded(timeline, alpha, from, to) {
                continue;
            }
            let before = timeline.offset(to, -1).filter(|&before| timeline.next(before) == Some(to));
            let earlier = before.map_or(f64::INFINITY, |before| {
                let arrival = if before == from { 0.0 } else { cost(&row[before as usize]) };
                arrival.min(recorded(timeline, alpha, from, before)) + alpha
            });
            let later = match (timeline.next(from), next) {
                (Some(after), Some(next)) if after != to => {
                    alpha + cost(&next[to as usize]).min(recorded(timeline, alpha, after, to))
                }
                _ => f64::INFINITY,
            };
            if own < earlier && own < later {
                kept.push((to, row[to as usize]));
            }
        }
    }
    kept
}

/// alpha times the recorded steps from i to j, or infinity.
fn recorded(timeline: &Timeline, alpha: f64, i: u32, j: u32) -> f64 {
    let Some(sequence) = timeline.sequence_of(i).filter(|sequence| sequence.contains(j)) else {
        return f64::INFINITY;
    };
    let steps = i64::from(j) - i64::from(i);
    match (steps >= 0, sequence.cyclic) {
        (true, _) => alpha * steps as f64,
        (false, true) => alpha * (steps + i64::from(sequence.frame_count)) as f64,
        (false, false) => f64::INFINITY,
    }
}

/// Rows of transitions that are held at once.
const BAND: usize = 256;

/// The optimal transitions that may stay in an essential graph of `alpha` ([`row_candidates`]), of the same search as
/// [`crate::transitions::optimal_transitions`], without ever holding all of them: memory is that of the candidates and of a few rows.
///
/// # Errors
/// As [`crate::transitions::optimal_transitions`].
pub fn candidate_transitions(
    distances: &DistanceMatrix,
    timeline: &Timeline,
    options: &TransitionOptions,
    alpha: f64,
    job: &Job,
) -> Result<Candidates, TransitionError> {
    let search = Search::new(Level::best(), distances, timeline, options, job)?;
    let frame_count = distances.frame_count();
    let mut candidates = Candidates::new();
    let mut costs = Vec::new();
    for start in (0..frame_count).step_by(BAND) {
        let end = (start + BAND).min(frame_count);
        costs.clear();
        costs.resize((end - start) * frame_count, TransitionMatrix::NONE);
        search.rows(start..end, &mut costs)?;
        let row = |from: usize| &costs[(from - start) * frame_count..][..frame_count];
        let rows: Vec<_> = (start..end)
            .into_par_iter()
            .map(|from| {
                let next =
                    timeline.next(from as u32).map(|next| next as usize).filter(|next| (start..end).contains(next));
                row_candidates(timeline, alpha, from as u32, row(from), next.map(row))
            })
            .collect();
        rows.into_iter().for_each(|row| candidates.push_row(row));
    }
    Ok(candidates)
}

/// The essential ones among `candidates`, for an `alpha` that is a multiple of [`actor::graph::ALPHA_RESOLUTION`] and not 0.
#[must_use]
pub fn essential_of(candidates: &Candidates, timeline: &Timeline, alpha: f64) -> Candidates {
    match candidates.frame_count() as usize <= ALL_PATHS {
        true => by_all_paths(candidates, timeline, alpha),
        false => by_searches(candidates, timeline, alpha),
    }
}

/// Frames up to which the lengths of all shortest paths are cheaper to find than what decides single transitions.
const ALL_PATHS: usize = 4096;
/// Destinations whose columns are laid out together.
const GROUP: usize = 64;

/// Decides by the lengths of all shortest paths: O(n^3), whatever the candidates are.
#[must_use]
pub fn by_all_paths(candidates: &Candidates, timeline: &Timeline, alpha: f64) -> Candidates {
    let edges = Edges::new(candidates, timeline, alpha);
    // No edge from a node to itself: then every path over a node in between is a true detour.
    let paths = PathLengths::of_rows(Level::best(), candidates.frame_count() as usize, |from, row| {
        edges.from(from as u32).for_each(|(to, cost)| row[to as usize] = row[to as usize].min(cost));
    });
    let frame_count = candidates.frame_count();
    // As many lists as there are groups of destinations, each by source, so that columns are laid out once.
    let groups: Vec<Vec<(u32, u32)>> = (0..frame_count)
        .step_by(GROUP)
        .collect::<Vec<u32>>()
        .into_par_iter()
        .map(|first| {
            let group = first..(first + GROUP as u32).min(frame_count);
            let columns: Vec<Vec<f64>> =
                group.clone().map(|j| (0..frame_count as usize).map(|k| paths.from(k)[j as usize]).collect()).collect();
            let mut kept = Vec::new();
            for from in 0..frame_count {
                let (row, lengths) = (candidates.from(from), paths.from(from as usize));
                let begin = row.partition_point(|&(to, _)| to < group.start);
                for &(to, transition) in row[begin..].iter().take_while(|&&(to, _)| to < group.end) {
                    let cost = transition.cost(alpha);
                    if cost <= lengths[to as usize] && !has_detour(lengths, &columns[(to - first) as usize], cost) {
                        kept.push((from, to));
                    }
                }
            }
            kept
        })
        .collect();
    let mut kept: Vec<(u32, u32)> = groups.into_iter().flatten().collect();
    kept.sort_unstable();
    candidates.filtered(|from, _| {
        candidates.from(from).iter().map(|&(to, _)| kept.binary_search(&(from, to)).is_ok()).collect()
    })
}

/// Whether a path over some node costs at most `cost`.
fn has_detour(from: &[f64], to: &[f64], cost: f64) -> bool {
    from.iter().zip(to).any(|(a, b)| a + b <= cost)
}

/// Decides by two-edge detours and searches from each frame: O(n m log n) for m candidates that the former leave, and no
/// memory for pairs of frames.
#[must_use]
pub fn by_searches(candidates: &Candidates, timeline: &Timeline, alpha: f64) -> Candidates {
    let mut left = candidates.clone();
    loop {
        let edges = Edges::new(&left, timeline, alpha);
        let fewer = left.filtered(|frame, scratch| two_edge_detours(&edges, &left, alpha, frame, scratch));
        let taken = left.len() - fewer.len();
        let worthwhile = taken as f64 > WORTHWHILE * left.len() as f64;
        left = fewer;
        if !worthwhile {
            break;
        }
    }
    let edges = Edges::new(&left, timeline, alpha);
    left.filtered(|frame, scratch| detours(&edges, &left, alpha, frame, scratch))
}

/// Candidates and recorded steps with their costs, laid out for searching.
struct Edges {
    first: Vec<usize>,
    to: Vec<u32>,
    cost: Vec<f64>,
}

impl Edges {
    fn new(candidates: &Candidates, timeline: &Timeline, alpha: f64) -> Self {
        let (mut first, mut to, mut cost) = (vec![0], Vec::new(), Vec::new());
        for frame in 0..candidates.frame_count() {
            if let Some(next) = timeline.next(frame).filter(|&next| next != frame) {
                to.push(next);
                cost.push(alpha);
            }
            for (destination, transition) in candidates.from(frame) {
                to.push(*destination);
                cost.push(transition.cost(alpha));
            }
            first.push(to.len());
        }
        Self { first, to, cost }
    }

    fn from(&self, frame: u32) -> impl Iterator<Item = (u32, f64)> {
        let range = self.first[frame as usize]..self.first[frame as usize + 1];
        self.to[range.clone()].iter().copied().zip(self.cost[range].iter().copied())
    }
}

/// What a thread needs, kept from frame to frame.
struct Scratch {
    /// Length of the shortest path found to each frame.
    lengths: Vec<f64>,
    /// The same of paths of two or more edges.
    detours: Vec<f64>,
    touched: Vec<u32>,
    queue: BinaryHeap<Reverse<(u64, u32)>>,
}

impl Scratch {
    fn new(frame_count: usize) -> Self {
        let infinite = || vec![f64::INFINITY; frame_count];
        Self { lengths: infinite(), detours: infinite(), touched: Vec::new(), queue: BinaryHeap::new() }
    }

    fn reset(&mut self) {
        for frame in self.touched.drain(..) {
            self.lengths[frame as usize] = f64::INFINITY;
            self.detours[frame as usize] = f64::INFINITY;
        }
        self.queue.clear();
    }

    fn detour(&mut self, to: u32, length: f64) {
        let (known, slot) = (self.lengths[to as usize], &mut self.detours[to as usize]);
        if *slot == f64::INFINITY && known == f64::INFINITY {
            self.touched.push(to);
        }
        *slot = slot.min(length);
    }
}

/// Which candidates of `frame` are cheaper than all paths of two edges.
fn two_edge_detours(
    edges: &Edges,
    candidates: &Candidates,
    alpha: f64,
    frame: u32,
    scratch: &mut Scratch,
) -> Vec<bool> {
    let own = candidates.from(frame);
    let dearest = own.iter().map(|(_, transition)| transition.cost(alpha)).fold(0.0, f64::max);
    scratch.reset();
    for (between, first) in edges.from(frame).filter(|&(_, first)| first < dearest) {
        for (to, second) in edges.from(between) {
            if first + second <= dearest {
                scratch.detour(to, first + second);
            }
        }
    }
    own.iter().map(|(to, transition)| transition.cost(alpha) < scratch.detours[*to as usize]).collect()
}

/// Which candidates of `frame` are cheaper than all paths of two or more edges: Dijkstra's algorithm as far as they reach.
fn detours(edges: &Edges, candidates: &Candidates, alpha: f64, frame: u32, scratch: &mut Scratch) -> Vec<bool> {
    let own = candidates.from(frame);
    let dearest = own.iter().map(|(_, transition)| transition.cost(alpha)).fold(0.0, f64::max);
    scratch.reset();
    let settle = |scratch: &mut Scratch, to: u32, length: f64| {
        if length < scratch.lengths[to as usize] {
            if scratch.lengths[to as usize] == f64::INFINITY && scratch.detours[to as usize] == f64::INFINITY {
                scratch.touched.push(to);
            }
            scratch.lengths[to as usize] = length;
            // Lengths are not negative, and such floats order as their bits do.
            scratch.queue.push(Reverse((length.to_bits(), to)));
        }
    };
    for (to, cost) in edges.from(frame) {
        settle(scratch, to, cost);
    }
    while let Some(Reverse((bits, node))) = scratch.queue.pop() {
        let length = f64::from_bits(bits);
        if length >= dearest {
            break;
        }
        if length > scratch.lengths[node as usize] || node == frame {
            continue;
        }
        for (to, cost) in edges.from(node) {
            let longer = length + cost;
            if longer <= dearest {
                scratch.detour(to, longer);
                settle(scratch, to, longer);
            }
        }
    }
    own.iter().map(|(to, transition)| transition.cost(alpha) < scratch.detours[*to as usize]).collect()
}
