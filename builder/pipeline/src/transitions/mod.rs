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

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use actor::timeline::Timeline;
use job::Job;
use job::rows::Rows;
use job::work::Key;
use rayon::prelude::*;

use self::grid::{Columns, Diagonal, Slope, Unlimited};
use self::keys::Keys;
pub use self::matrix::{TransitionCost, TransitionMatrix};
pub use self::options::{HASTE_SPEED, LengthChoice, Lengths, TransitionError, TransitionOptions};
use self::search::{Scratch, SearchRow};
pub use self::warp::{WarpFinder, warp_of};
use crate::distance::DistanceMatrix;
use kernels::simd::Level;

/// The optimal transition of every pair of frames: its deformation cost D, its duration L and its segment lengths.
///
/// A pair has none where a segment of the shortest length leaves its sequence. Sequences that are cyclic are wrapped
/// around, once at most. The result does not depend on the number of threads or on the processor. Rows that are found go
/// into the job's work folder.
///
/// # Errors
/// Options that make no sense, distances of another capture, or distances that are not; being stopped; a work folder that
/// cannot be written.
pub fn optimal_transitions(
    distances: &DistanceMatrix,
    timeline: &Timeline,
    options: &TransitionOptions,
    job: &Job,
) -> Result<TransitionMatrix, TransitionError> {
    transitions_at(Level::best(), distances, timeline, options, job)
}

fn transitions_at(
    level: Level,
    distances: &DistanceMatrix,
    timeline: &Timeline,
    options: &TransitionOptions,
    job: &Job,
) -> Result<TransitionMatrix, TransitionError> {
    let search = Search::new(level, distances, timeline, options, job)?;
    let mut matrix = TransitionMatrix::none(distances.frame_count());
    search.rows(0..distances.frame_count(), matrix.costs_mut())?;
    Ok(matrix)
}

/// Changes whenever other transitions come out of the same input.
const VERSION: u32 = 1;

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
    Keys::new(distances, lengths, timeline.fps())
}

/// A search for all transitions, row by row.
pub(crate) struct Search<'a> {
    level: Level,
    distances: &'a DistanceMatrix,
    timeline: &'a Timeline,
    options: &'a TransitionOptions,
    lengths: Lengths,
    keys: Keys,
    /// Rows found before, and where new ones go.
    kept: Option<Rows>,
    job: &'a Job<'a>,
    done: AtomicUsize,
}

impl<'a> Search<'a> {
    pub(crate) fn new(
        level: Level,
        distances: &'a DistanceMatrix,
        timeline: &'a Timeline,
        options: &'a TransitionOptions,
        job: &'a Job<'a>,
    ) -> Result<Self, TransitionError> {
        let keys = keys_of(distances, timeline, options)?;
        let frame_count = distances.frame_count();
        let kept = job.work().map(|work| {
            let sequences: Vec<_> =
                timeline.sequences().iter().map(|s| (s.first_frame, s.frame_count, s.cyclic)).collect();
            let key = Key::new("transitions", VERSION).told(options).told(&timeline.fps()).told(&sequences);
            let key = (0..frame_count).fold(key, |key, i| key.of(bytemuck::cast_slice(distances.row(i))));
            let row_bytes = frame_count * TransitionCost::BYTES;
            Rows::open(Some((work, &key)), frame_count, row_bytes, row_bytes)
        });
        let (lengths, done) = (options.lengths(timeline)?, AtomicUsize::new(0));
        Ok(Self { level, distances, timeline, options, lengths, keys, kept: kept.transpose()?, job, done })
    }

    /// Writes the transitions from the frames `rows` into `costs`, row after row.
    pub(crate) fn rows(&self, rows: Range<usize>, costs: &mut [TransitionCost]) -> Result<(), TransitionError> {
        match self.options.slope {
            None => self.search::<Unlimited>(rows, costs),
            Some(0 | 1) => self.search::<Diagonal>(rows, costs),
            Some(2) => self.search::<Columns<1>>(rows, costs),
            Some(3) => self.search::<Columns<2>>(rows, costs),
            Some(4) => self.search::<Columns<3>>(rows, costs),
            // No more than `TransitionOptions::MAX_SLOPE`.
            Some(_) => self.search::<Columns<4>>(rows, costs),
        }
    }

    fn search<S: Slope + Default>(
        &self,
        rows: Range<usize>,
        costs: &mut [TransitionCost],
    ) -> Result<(), TransitionError> {
        let frame_count = self.distances.frame_count().max(1);
        costs.par_chunks_mut(frame_count).zip(rows).try_for_each_init(Scratch::<S>::default, |scratch, task| {
            let (row, from) = task;
            if !self.take(from, row)? {
                self.level.run(SearchRow {
                    distances: self.distances,
                    timeline: self.timeline,
                    lengths: self.lengths,
                    choice: self.options.choice,
                    keys: self.keys,
                    from: from as u32,
                    scratch,
                    row,
                });
                self.keep(from, row)?;
            }
            let done = 1 + self.done.fetch_add(1, Ordering::Relaxed);
            Ok(self.job.tell("transitions", done as u64, frame_count as u64)?)
        })
    }

    /// Whether a row was found before; it is in `row` then.
    fn take(&self, from: usize, row: &mut [TransitionCost]) -> Result<bool, TransitionError> {
        let Some(kept) = self.kept.as_ref().filter(|kept| kept.has(from)) else { return Ok(false) };
        let mut bytes = vec![0; row.len() * TransitionCost::BYTES];
        kept.read(from, &mut bytes)?;
        for (cost, bytes) in row.iter_mut().zip(bytes.chunks_exact(TransitionCost::BYTES)) {
            *cost = TransitionCost::from_bytes(bytes);
        }
        Ok(true)
    }

    fn keep(&self, from: usize, row: &[TransitionCost]) -> Result<(), TransitionError> {
        let Some(kept) = &self.kept else { return Ok(()) };
        let bytes: Vec<u8> = row.iter().flat_map(|cost| cost.to_bytes()).collect();
        Ok(kept.write(from, &bytes)?)
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
        for choice in LengthChoice::ALL {
            let options = TransitionOptions { choice, ..Default::default() };
            let run = |level| transitions_at(level, &distances, &timeline, &options, &Job::silent()).unwrap();
            let first = run(Level::best());
            assert!(first.get(0, 160).is_some());
            assert!(Level::available().into_iter().all(|level| run(level) == first));
            let single = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
            assert!(single.install(|| run(Level::best())) == first);
        }
    }
}
