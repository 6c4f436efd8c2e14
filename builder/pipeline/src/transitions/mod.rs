//! Optimal transitions between all pairs of frames.
//!
//! Boukhayma and Boyer, TVCG section 3.3; thesis section 2.5. The transition from frame i to frame j blends the segment
//! [i, i + li - 1] into [j - lj + 1, j] along a dynamic time warping path, for all segment lengths li and lj. Done
//! naively, that is a grid for each pair of frames and of lengths; here, one grid for each start cell (i, j - lj + 1)
//! serves all of them, and vectors hold eight grids.

mod grid;
mod keys;
mod matrix;
mod options;
mod search;
mod warp;

use std::sync::atomic::{AtomicUsize, Ordering};

use actor::timeline::Timeline;
use rayon::prelude::*;

use self::grid::{Columns, Diagonal, Slope, Unlimited};
use self::keys::Keys;
pub use self::matrix::{TransitionCost, TransitionMatrix};
pub use self::options::{LengthChoice, Lengths, TransitionError, TransitionOptions};
use self::search::{Scratch, SearchRow};
pub use self::warp::{WarpFinder, warp_of};
use crate::distance::DistanceMatrix;
use kernels::simd::Level;

/// The optimal transition of every pair of frames: its deformation cost D, its duration L and its segment lengths.
///
/// A pair has none where a segment of the shortest length leaves its sequence. Sequences that are cyclic are wrapped
/// around, once at most. `progress` is told the share that is done, in [0, 1]. The result does not depend on the number
/// of threads or on the processor.
///
/// # Errors
/// Options that make no sense, distances of another capture, or distances that are not.
pub fn optimal_transitions(
    distances: &DistanceMatrix,
    timeline: &Timeline,
    options: &TransitionOptions,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<TransitionMatrix, TransitionError> {
    transitions_at(Level::best(), distances, timeline, options, progress)
}

fn transitions_at(
    level: Level,
    distances: &DistanceMatrix,
    timeline: &Timeline,
    options: &TransitionOptions,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<TransitionMatrix, TransitionError> {
    let job = Job { level, distances, timeline, options, keys: keys_of(distances, timeline, options)?, progress };
    match options.slope {
        None => job.search_all::<Unlimited>(),
        Some(0 | 1) => job.search_all::<Diagonal>(),
        Some(2) => job.search_all::<Columns<1>>(),
        Some(3) => job.search_all::<Columns<2>>(),
        Some(4) => job.search_all::<Columns<3>>(),
        // No more than `TransitionOptions::MAX_SLOPE`.
        Some(_) => job.search_all::<Columns<4>>(),
    }
}

/// The keys of a search, once its input is known to make sense.
fn keys_of(
    distances: &DistanceMatrix,
    timeline: &Timeline,
    options: &TransitionOptions,
) -> Result<Keys, TransitionError> {
    let lengths = options.lengths(timeline)?;
    let frames = timeline.frame_count() as usize;
    if distances.frame_count() != frames {
        return Err(TransitionError::FrameCount { distances: distances.frame_count(), frames });
    }
    Keys::new(distances, lengths)
}

struct Job<'a> {
    level: Level,
    distances: &'a DistanceMatrix,
    timeline: &'a Timeline,
    options: &'a TransitionOptions,
    keys: Keys,
    progress: &'a (dyn Fn(f64) + Sync),
}

impl Job<'_> {
    fn search_all<S: Slope + Default>(&self) -> Result<TransitionMatrix, TransitionError> {
        let lengths = self.options.lengths(self.timeline)?;
        let frame_count = self.distances.frame_count();
        let mut matrix = TransitionMatrix::none(frame_count);
        let done = AtomicUsize::new(0);
        matrix.costs_mut().par_chunks_mut(frame_count).enumerate().for_each_init(
            Scratch::<S>::default,
            |scratch, task| {
                let (from, row) = task;
                self.level.run(SearchRow {
                    distances: self.distances,
                    timeline: self.timeline,
                    lengths,
                    choice: self.options.choice,
                    keys: self.keys,
                    from: from as u32,
                    scratch,
                    row,
                });
                let done = 1 + done.fetch_add(1, Ordering::Relaxed);
                (self.progress)(done as f64 / frame_count as f64);
            },
        );
        Ok(matrix)
    }
}

#[cfg(test)]
mod tests {
    use actor::timeline::Sequence;

    use super::*;

    #[test]
    fn threads_and_instruction_sets_do_not_change_a_bit() {
        let sequence = |first_frame: u32, frame_count, cyclic| {
            let name = first_frame.to_string();
            Sequence { name, labels: vec![], first_frame, frame_count, cyclic }
        };
        let timeline = Timeline::new(10.0, vec![sequence(0, 150, false), sequence(150, 37, true)]).unwrap();
        let distances = DistanceMatrix::from_fn(187, |i, j| (0.1 * (i as f32 - 1.3 * j as f32)).sin().abs());
        for choice in [LengthChoice::Total, LengthChoice::Mean] {
            let options = TransitionOptions { choice, ..Default::default() };
            let run = |level| transitions_at(level, &distances, &timeline, &options, &|_| ()).unwrap();
            let first = run(Level::best());
            assert!(first.get(0, 160).is_some());
            assert!(Level::available().into_iter().all(|level| run(level) == first));
            let single = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
            assert!(single.install(|| run(Level::best())) == first);
        }
    }
}
