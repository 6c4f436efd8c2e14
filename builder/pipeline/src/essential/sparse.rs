//! The essential graph from candidates instead of all transitions.
//!
//! Nearly all transitions of a capture are beaten by a neighbour: arriving one frame earlier and playing on, or playing on
//! and leaving one frame later, costs no more. What is left is a sparser graph with the same shortest paths. Up to 4,096
//! frames all shortest paths of it are found, O(n^3). A longer capture, which resembles itself, has candidates for a third
//! of all pairs of frames: there they are thinned out while their rows come in ([`Thinning`]), and a search from each frame
//! decides about the rest ([`by_searches`]).
//!
//! *Why this is exact.* A transition is essential if and only if it is strictly cheaper than every path of two or more edges
//! (of all transitions and recorded steps). Whatever is taken away here equals or exceeds such a path, so it is not essential:
//! the essential ones are among what is left, at any time and in whatever order. And what is left decides as all would.
//! Costs are positive, for alpha is; so each edge of a path of two or more edges that costs no more than a transition is
//! strictly cheaper than it, and is essential or, by induction over costs, equals or exceeds a path of essential edges. Put
//! together, these are a path of two or more essential edges that costs no more than the transition, and it is found.
//!
//! Time O(n^2) for the rows and O(n m log n) for the searches, with m the transitions that are left: less, for a search goes
//! no farther than what is undecided. Memory O(m).

use actor::timeline::Timeline;
use job::{Job, Stopped};
use kernels::simd::Level;
use rayon::prelude::*;

pub use super::candidates::{Candidates, row_candidates};
use super::detours::Edges;
use super::paths::PathLengths;
use crate::distance::DistanceMatrix;
use crate::transitions::{Search, TransitionCost, TransitionError, TransitionMatrix, TransitionOptions};

/// Rows of transitions that are held at once.
const BAND: usize = 256;
/// Transitions that are held whatever they are, 16 bytes each and 16 more while they are searched.
const MORE: usize = 1 << 20;

/// The optimal transitions that may stay in an essential graph of each of `alphas` ([`row_candidates`]), of the same search as
/// [`crate::transitions::optimal_transitions`], without ever holding all of them: memory is that of the candidates and of a few rows.
/// The search is done once for all.
///
/// # Errors
/// As [`crate::transitions::optimal_transitions`].
pub fn candidate_transitions(
    distances: &DistanceMatrix,
    timeline: &Timeline,
    options: &TransitionOptions,
    alphas: &[f64],
    job: &Job,
) -> Result<Vec<Candidates>, TransitionError> {
    let search = Search::new(Level::best(), distances, timeline, options, job)?;
    let frame_count = distances.frame_count();
    let mut candidates = vec![Candidates::new(); alphas.len()];
    let mut thinnings: Vec<_> = alphas.iter().map(|&alpha| Thinning::new(timeline, alpha, MORE, job)).collect();
    let mut costs = Vec::new();
    for start in (0..frame_count).step_by(BAND) {
        let end = (start + BAND).min(frame_count);
        costs.clear();
        costs.resize((end - start) * frame_count, TransitionMatrix::NONE);
        search.rows(start..end, &mut costs)?;
        let row = |from: usize| &costs[(from - start) * frame_count..][..frame_count];
        for ((&alpha, candidates), thinning) in alphas.iter().zip(&mut candidates).zip(&mut thinnings) {
            let rows: Vec<Vec<_>> = (start..end)
                .into_par_iter()
                .map(|from| {
                    let next =
                        timeline.next(from as u32).map(|next| next as usize).filter(|next| (start..end).contains(next));
                    row_candidates(timeline, alpha, from as u32, row(from), next.map(row))
                })
                .collect();
            match frame_count <= ALL_PATHS {
                true => rows.into_iter().for_each(|row| candidates.push_row(row)),
                false => thinning.push(&rows)?,
            }
        }
    }
    Ok(if frame_count <= ALL_PATHS { candidates } else { thinnings.into_iter().map(Thinning::left).collect() })
}

/// The essential ones among `candidates`, for an `alpha` that is a multiple of [`actor::graph::ALPHA_RESOLUTION`] and not 0.
///
/// # Errors
/// Being stopped.
pub fn essential_of(
    candidates: &Candidates,
    timeline: &Timeline,
    alpha: f64,
    job: &Job,
) -> Result<Candidates, Stopped> {
    match candidates.frame_count() as usize <= ALL_PATHS {
        true => Ok(by_all_paths(candidates, timeline, alpha)),
        false => by_searches(candidates, timeline, alpha, job),
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
        edges.from(from as u32).iter().for_each(|&(cost, to)| row[to as usize] = row[to as usize].min(cost));
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
    let mut essential = Candidates::new();
    for from in 0..frame_count {
        let row = candidates.from(from).iter().copied();
        essential.push_row(row.filter(|&(to, _)| kept.binary_search(&(from, to)).is_ok()));
    }
    essential
}

/// Whether a path over some node costs at most `cost`.
fn has_detour(from: &[f64], to: &[f64], cost: f64) -> bool {
    from.iter().zip(to).any(|(a, b)| a + b <= cost)
}

/// Decides by a search from each frame, as far as its dearest transition that stays: O(n m log n) for m candidates, and no
/// memory for pairs of frames.
///
/// # Errors
/// Being stopped.
pub fn by_searches(candidates: &Candidates, timeline: &Timeline, alpha: f64, job: &Job) -> Result<Candidates, Stopped> {
    let told = |done| job.tell("essential graph", u64::from(done), u64::from(candidates.frame_count()));
    Edges::new(candidates, timeline, alpha).cheapest(candidates, alpha, &told)
}

/// Candidates that are thinned out while they come in, so that few are ever held.
///
/// Rows that are new are searched over those before them, and all again whenever their number has doubled. Whatever is
/// known when, a transition goes only where a path of two or more edges costs no more.
pub struct Thinning<'a> {
    timeline: &'a Timeline,
    alpha: f64,
    job: &'a Job<'a>,
    left: Candidates,
    edges: Edges,
    /// Transitions at which all are searched again.
    most: usize,
    /// What `most` is more than twice of what was left.
    more: usize,
}

impl<'a> Thinning<'a> {
    /// No row yet; `more` is a number of transitions that is worth no search.
    #[must_use]
    pub fn new(timeline: &'a Timeline, alpha: f64, more: usize, job: &'a Job<'a>) -> Self {
        let left = Candidates::new();
        let edges = Edges::new(&left, timeline, alpha);
        Self { timeline, alpha, job, left, edges, most: more, more }
    }

    /// Takes what [`row_candidates`] leaves of the next frames' rows.
    ///
    /// # Errors
    /// Being stopped.
    pub fn push(&mut self, rows: &[Vec<(u32, TransitionCost)>]) -> Result<(), Stopped> {
        let rows: Vec<_> = rows.iter().map(Vec::as_slice).collect();
        let rows = self.edges.cheapest_of_rows(self.alpha, self.left.frame_count(), &rows);
        rows.into_iter().for_each(|row| self.left.push_row(row));
        self.edges = Edges::new(&self.left, self.timeline, self.alpha);
        if self.left.len() > self.most {
            let (seen, all) = (self.left.frame_count().into(), self.timeline.frame_count().into());
            let told = |_| self.job.tell("transitions", seen, all);
            self.left = self.edges.cheapest(&self.left, self.alpha, &told)?;
            self.edges = Edges::new(&self.left, self.timeline, self.alpha);
            self.most = 2 * self.left.len() + self.more;
        }
        Ok(())
    }

    /// What is left of them: all that are essential, and few others.
    #[must_use]
    pub fn left(self) -> Candidates {
        self.left
    }
}
