//! The warp of one transition, recomputed.

use actor::temporal_warp::{Move, TemporalWarp};
use actor::timeline::Timeline;

use super::keys::Keys;
use super::options::{TransitionError, TransitionOptions};
use crate::distance::DistanceMatrix;

/// The keys of a grid's nodes and the least keys to them.
struct Grid {
    columns: usize,
    nodes: Vec<f64>,
    least: Vec<f64>,
}

/// The warp of the transition of `li` frames from frame `from` to `lj` frames up to frame `to`: the path of the least
/// sum of distances, and of those the shortest. Where several are left, a diagonal step is preferred to straight steps
/// in the source, and those to straight steps in the destination, the fewer the better, from the end of the path.
///
/// # Errors
/// Options or frames that make no sense, or no such transition.
pub fn warp_of(
    distances: &DistanceMatrix,
    timeline: &Timeline,
    options: &TransitionOptions,
    from: u32,
    to: u32,
    li: usize,
    lj: usize,
) -> Result<TemporalWarp, TransitionError> {
    let keys = super::keys_of(distances, timeline, options)?;
    WarpFinder { distances, timeline, options, keys }.find(from, to, li, lj)
}

/// Recomputes many warps; see [`warp_of`].
pub struct WarpFinder<'a> {
    distances: &'a DistanceMatrix,
    timeline: &'a Timeline,
    options: &'a TransitionOptions,
    keys: Keys,
}

impl<'a> WarpFinder<'a> {
    /// A finder of the warps that [`super::optimal_transitions`] found with the same input.
    ///
    /// # Errors
    /// Options or distances that make no sense.
    pub fn new(
        distances: &'a DistanceMatrix,
        timeline: &'a Timeline,
        options: &'a TransitionOptions,
    ) -> Result<Self, TransitionError> {
        Ok(Self { distances, timeline, options, keys: super::keys_of(distances, timeline, options)? })
    }

    /// The warp of one transition; see [`warp_of`].
    ///
    /// # Errors
    /// No such transition.
    pub fn find(&self, from: u32, to: u32, li: usize, lj: usize) -> Result<TemporalWarp, TransitionError> {
        let missing = || TransitionError::NoTransition { from, to, li, lj };
        let mut grid = self.grid(from, to, li, lj).ok_or_else(missing)?;
        let moves = moves(self.options.slope);
        grid.fill(&moves);
        grid.trace_back(&moves).ok_or_else(missing)
    }

    fn grid(&self, from: u32, to: u32, li: usize, lj: usize) -> Option<Grid> {
        let lengths = self.options.lengths(self.timeline).ok()?;
        let allowed = |sequence: &actor::timeline::Sequence, length| {
            (1..=lengths.longest).contains(&length) && length <= sequence.frame_count as usize
        };
        if !(allowed(self.timeline.sequence_of(from)?, li) && allowed(self.timeline.sequence_of(to)?, lj)) {
            return None;
        }
        let mut nodes = Vec::with_capacity(li * lj);
        for k in 0..li {
            let row = self.distances.row(self.timeline.offset(from, k as i64)? as usize);
            for l in 0..lj {
                let column = self.timeline.offset(to, l as i64 + 1 - lj as i64)?;
                nodes.push(self.keys.of_distance(row[column as usize]));
            }
        }
        Some(Grid { columns: lj, least: vec![f64::INFINITY; nodes.len()], nodes })
    }
}

/// The moves of a slope limit, as advances in the source and in the destination, in order of preference.
fn moves(slope: Option<u8>) -> Vec<(usize, usize)> {
    match slope {
        None => vec![(1, 1), (1, 0), (0, 1)],
        Some(p) => {
            let p = usize::from(p);
            std::iter::once((1, 1)).chain((2..=p).map(|a| (a, 1))).chain((2..=p).map(|b| (1, b))).collect()
        }
    }
}

impl Grid {
    /// The least keys to all nodes (thesis equations 2.51 to 2.53).
    fn fill(&mut self, moves: &[(usize, usize)]) {
        self.least[0] = self.nodes[0];
        for place in 1..self.nodes.len() {
            let (k, l) = (place / self.columns, place % self.columns);
            let keys = moves.iter().filter_map(|&step| self.key_after(k, l, step));
            self.least[place] = keys.fold(f64::INFINITY, f64::min);
        }
    }

    /// The key at (k, l) of the least path that ends with `step`.
    fn key_after(&self, k: usize, l: usize, step: (usize, usize)) -> Option<f64> {
        let before = self.least[k.checked_sub(step.0)? * self.columns + l.checked_sub(step.1)?];
        // The diagonal step comes first, so that the nodes passed lie in the last row or the last column.
        let in_column = (0..step.0).map(|back| self.nodes[(k - back) * self.columns + l]);
        let in_row = (0..step.1).map(|back| self.nodes[k * self.columns + l - back]);
        Some(before + if step.0 >= step.1 { in_column.sum::<f64>() } else { in_row.sum::<f64>() })
    }

    fn trace_back(&self, moves: &[(usize, usize)]) -> Option<TemporalWarp> {
        let (mut k, mut l) = (self.nodes.len() / self.columns - 1, self.columns - 1);
        let mut path = Vec::new();
        while (k, l) != (0, 0) {
            let least = self.least[k * self.columns + l];
            let ends_path = |step: &&(usize, usize)| self.key_after(k, l, **step) == Some(least);
            let &step = moves.iter().filter(|_| least.is_finite()).find(ends_path)?;
            for _ in 1..step.0.max(step.1) {
                path.push(if step.0 > step.1 { Move::Source } else { Move::Destination });
            }
            path.push(match step {
                (1, 0) => Move::Source,
                (0, 1) => Move::Destination,
                _ => Move::Both,
            });
            (k, l) = (k - step.0, l - step.1);
        }
        path.reverse();
        Some(TemporalWarp::new(path))
    }
}
