//! The best segment lengths for all destinations of one source frame.
//!
//! The grid of the start cell (i, c) holds the paths of all lengths from i and from c at once: its node (k, l) ends
//! the segments of li = k + 1 and lj = l + 1 frames, and with the latter arrives at frame j = c + l. So n grids serve
//! all pairs (i, .), eight neighbouring ones at a time.

use actor::timeline::{Sequence, Timeline};

use super::grid::{LANES, Lanes, Lowest, Nodes, Slope};
use super::keys::Keys;
use super::matrix::{TransitionCost, TransitionMatrix};
use super::options::{LengthChoice, Lengths};
use crate::distance::DistanceMatrix;
use kernels::simd::Kernel;

/// Start cells whose nodes are laid out together, so that they stay in a core's cache.
const GROUP: usize = 16 * LANES;

/// [`LengthChoice`]s, as paths are compared by them.
const TOTAL: u8 = 0;
const MEAN: u8 = 1;
const HASTE: u8 = 2;

/// What one thread needs, kept from one row to the next.
#[derive(Default)]
pub(super) struct Scratch<S> {
    slope: S,
    keys: Vec<f64>,
    best: Best,
}

/// Finds the transitions from frame `from`; `row` receives those to each frame.
pub(super) struct SearchRow<'a, S> {
    pub(super) distances: &'a DistanceMatrix,
    pub(super) timeline: &'a Timeline,
    pub(super) lengths: Lengths,
    pub(super) choice: LengthChoice,
    pub(super) keys: Keys,
    pub(super) from: u32,
    pub(super) scratch: &'a mut Scratch<S>,
    pub(super) row: &'a mut [TransitionCost],
}

impl<S: Slope> Kernel for SearchRow<'_, S> {
    type Output = ();

    #[inline(always)]
    fn run(mut self) {
        let timeline = self.timeline;
        for destination in timeline.sequences() {
            self.search(destination);
        }
    }
}

impl<S: Slope> SearchRow<'_, S> {
    #[inline(always)]
    fn search(&mut self, destination: &Sequence) {
        let Some(source) = self.timeline.sequence_of(self.from) else { return };
        let rows = self.lengths.longest_from(source, self.from);
        let starts = destination.frame_count as usize;
        let longest = self.lengths.longest.min(starts);
        if rows < self.lengths.shortest || longest < self.lengths.shortest {
            return;
        }
        self.scratch.best.reset(starts + self.lengths.longest + LANES);
        // From the last start to the first, so that each destination meets its short segments first: then few longer
        // ones improve on them, and improvements are what costs.
        for first in (0..starts).step_by(GROUP).rev() {
            let width = GROUP + longest;
            self.lay_out(source, destination, rows, first, width);
            for block in (0..GROUP.min(starts - first)).step_by(LANES).rev() {
                let columns = if destination.cyclic { longest } else { longest.min(starts - first - block) };
                match self.choice {
                    LengthChoice::Total => self.search_block::<TOTAL>(rows, columns, width, first, block),
                    LengthChoice::Mean => self.search_block::<MEAN>(rows, columns, width, first, block),
                    LengthChoice::Haste => self.search_block::<HASTE>(rows, columns, width, first, block),
                }
            }
        }
        self.write(destination);
    }

    /// Lays out the keys of `width` columns from start cell `first` of `destination`; beyond its end they wrap or are
    /// infinite.
    #[inline(always)]
    fn lay_out(&mut self, source: &Sequence, destination: &Sequence, rows: usize, first: usize, width: usize) {
        let count = destination.frame_count as usize;
        let keys = &mut self.scratch.keys;
        keys.clear();
        keys.resize(rows * width, f64::INFINITY);
        for (k, row) in keys.chunks_exact_mut(width).enumerate() {
            let Some(frame) = source.offset(self.from, k as i64) else { return };
            let distances = &self.distances.row(frame as usize)[destination.first_frame as usize..][..count];
            let (straight, wrapped) = row.split_at_mut(width.min(count - first));
            for (key, &distance) in straight.iter_mut().zip(&distances[first..]) {
                *key = self.keys.of_distance(distance);
            }
            if destination.cyclic {
                for (key, &distance) in wrapped.iter_mut().zip(distances.iter().cycle()) {
                    *key = self.keys.of_distance(distance);
                }
            }
        }
    }

    /// Searches the grids of the start cells `first + block ..`, of `columns` columns at most.
    #[inline(always)]
    fn search_block<const BY: u8>(&mut self, rows: usize, columns: usize, width: usize, first: usize, block: usize) {
        let Scratch { slope, keys, best } = &mut *self.scratch;
        let (numbers, shortest) = (self.keys, self.lengths.shortest);
        let nodes = Nodes { keys, width, rows };
        slope.reset(rows);
        for column in 0..columns {
            let mut low = Low::<BY>::new(numbers);
            // Columns of too short segments only lead to the others.
            let from = if column + 1 < shortest { rows } else { shortest - 1 };
            slope.fill(&nodes, block, column, from, &mut low);
            if column + 1 >= shortest {
                let ends = &slope.least()[shortest - 1..];
                best.offer::<BY>(numbers, first + block + column, column + 1, low.keys, ends, shortest);
            }
        }
    }

    /// Writes the best of each frame of `destination` into the row.
    #[inline(always)]
    fn write(&mut self, destination: &Sequence) {
        let count = destination.frame_count as usize;
        let best = &mut self.scratch.best;
        if destination.cyclic {
            for wrapped in count..best.keys.len() {
                match self.choice {
                    LengthChoice::Total => best.fold::<TOTAL>(self.keys, wrapped, wrapped % count),
                    LengthChoice::Mean => best.fold::<MEAN>(self.keys, wrapped, wrapped % count),
                    LengthChoice::Haste => best.fold::<HASTE>(self.keys, wrapped, wrapped % count),
                }
            }
        }
        for (frame, cost) in self.row[destination.first_frame as usize..][..count].iter_mut().enumerate() {
            *cost = if best.keys[frame].is_finite() {
                let (deformation, duration) = self.keys.split(best.keys[frame]);
                TransitionCost {
                    deformation: deformation as f32,
                    duration: duration as u16,
                    source_length: best.lengths[frame].0,
                    destination_length: best.lengths[frame].1,
                }
            } else {
                TransitionMatrix::NONE
            };
        }
    }
}

/// The best key of a column for each lane.
struct Low<const BY: u8> {
    keys: Lanes,
    /// The keys' sums and numbers of nodes, where means are compared; their hastes in place of sums, where those are.
    multiples: Lanes,
    nodes: Lanes,
    numbers: Keys,
}

impl<const BY: u8> Low<BY> {
    #[inline(always)]
    fn new(numbers: Keys) -> Self {
        Self { keys: [f64::INFINITY; LANES], multiples: [f64::INFINITY; LANES], nodes: [1.0; LANES], numbers }
    }
}

impl<const BY: u8> Lowest for Low<BY> {
    #[inline(always)]
    fn visit(&mut self, least: Lanes) {
        for lane in 0..LANES {
            let (old, new) = (self.keys[lane], least[lane]);
            if BY == MEAN {
                // As `Keys::smaller_mean`, without taking the old key apart again.
                let multiples = self.numbers.multiples_of(new);
                let nodes = self.numbers.nodes_of(new, multiples);
                let (left, right) = (multiples * self.nodes[lane], self.multiples[lane] * nodes);
                let smaller = (left < right) | ((left == right) & (new < old));
                self.keys[lane] = if smaller { new } else { old };
                self.multiples[lane] = if smaller { multiples } else { self.multiples[lane] };
                self.nodes[lane] = if smaller { nodes } else { self.nodes[lane] };
            } else if BY == HASTE {
                let (before, haste) = (self.multiples[lane], self.numbers.haste(new));
                let smaller = (haste < before) | ((haste == before) & (new < old));
                self.keys[lane] = if smaller { new } else { old };
                self.multiples[lane] = if smaller { haste } else { before };
            } else {
                self.keys[lane] = if new < old { new } else { old };
            }
        }
    }
}

/// Whether key `a` is better than key `b`.
#[inline(always)]
fn better<const BY: u8>(keys: Keys, a: f64, b: f64) -> bool {
    match BY {
        MEAN => keys.smaller_mean(a, b),
        HASTE => keys.smaller_haste(a, b),
        _ => a < b,
    }
}

/// The best path to each destination so far, by place in the sequence; places beyond its end are wrapped at the end.
#[derive(Default)]
struct Best {
    keys: Vec<f64>,
    /// (li, lj).
    lengths: Vec<(u16, u16)>,
}

impl Best {
    fn reset(&mut self, places: usize) {
        self.keys.clear();
        self.keys.resize(places, f64::INFINITY);
        self.lengths.clear();
        self.lengths.resize(places, (0, 0));
    }

    /// Takes the paths of keys `low` to the places `place ..` where they are better; their destination segments have
    /// `lj` frames, and their source segments `shortest` frames and so on in the rows of `column`.
    #[inline(always)]
    fn offer<const BY: u8>(
        &mut self,
        numbers: Keys,
        place: usize,
        lj: usize,
        low: Lanes,
        column: &[Lanes],
        shortest: usize,
    ) {
        let old: &[f64] = &self.keys[place..place + LANES];
        let mut improves = false;
        for lane in 0..LANES {
            improves |= low[lane] < f64::INFINITY && !better::<BY>(numbers, old[lane], low[lane]);
        }
        if !improves {
            return;
        }
        let mut row = [0.0; LANES];
        for (offset, least) in column.iter().enumerate().rev() {
            for lane in 0..LANES {
                row[lane] = if least[lane] == low[lane] { offset as f64 } else { row[lane] };
            }
        }
        for lane in 0..LANES {
            if low[lane] < f64::INFINITY {
                let lengths = (shortest as u16 + row[lane] as u16, lj as u16);
                self.take::<BY>(numbers, place + lane, low[lane], lengths);
            }
        }
    }

    fn take<const BY: u8>(&mut self, numbers: Keys, place: usize, key: f64, lengths: (u16, u16)) {
        let old = self.keys[place];
        if better::<BY>(numbers, key, old) || (key == old && lengths < self.lengths[place]) {
            self.keys[place] = key;
            self.lengths[place] = lengths;
        }
    }

    fn fold<const BY: u8>(&mut self, numbers: Keys, from: usize, to: usize) {
        let (key, lengths) = (self.keys[from], self.lengths[from]);
        if key.is_finite() {
            self.take::<BY>(numbers, to, key, lengths);
        }
    }
}
