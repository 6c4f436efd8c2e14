//! From a few key poses of each sequence to pairs for all frames between them (thesis section 5.5.1).
//!
//! A linear map from the keys says how probable it is that two frames belong together (equations 5.4 to 5.8); the way of most
//! probable pairs through the keys is found by dynamic time warping. The map is then learned again from all these pairs, and the ways looked
//! for again without the inner keys: what keys got wrong by some frames, the rest of the motion corrects.

use std::collections::BTreeMap;

use job::Job;
use learn::dense::Matrix;
use learn::linear_map::LinearMap;
use rayon::prelude::*;

use crate::agreement::{Row, agreement};
use crate::dtw::{path, rows_of_columns};
use crate::error::TransferError;
use crate::frame_map::{Costs, FrameMap};
use crate::limbs::matching;
use crate::pair::{Key, Pair, TransferOptions};
use crate::space::{Space, between, numbers, spaces};
use crate::subject::Subject;

/// The noise of poses in the linear map, relative to the body's size: 3 mm of 1.8 m.
const NOISE: f64 = 0.0017;
/// Rounds in which the map is learned from all pairs.
const REFITS: usize = 3;
/// Maps of time are smoothed over so many frames.
const SMOOTH: usize = 5;
/// A key that is off by more frames looks wrong.
const WRONG: f64 = 2.0;

/// A key that looks wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Doubt {
    /// The key.
    pub key: Key,
    /// The source's frame that looks right, of the whole capture.
    pub better: f64,
    /// How far off that is, in frames of the target.
    pub off: f64,
}

/// What came of keys.
#[derive(Clone, Debug, PartialEq)]
pub struct Dense {
    /// A pair for each frame of the target from the first key of its sequence to the last.
    pub pairs: Vec<Pair>,
    /// Keys that look wrong.
    pub doubts: Vec<Doubt>,
    /// How much of what the target's poses vary by some pairs foretell of others: 1 where all is, 0 or less where the mean pose
    /// would do as well. `None` of too few pairs.
    pub agreement: Option<f64>,
    /// What was found in each stretch, to be shown.
    pub maps: Vec<FrameMap>,
}

/// A stretch of two sequences between its first and its last key.
struct Stretch {
    keys: Vec<Key>,
    /// Frames of the source, as many a second as the target has.
    rows: Vec<f64>,
    /// Numbers of all parts at these, and in the target's frames.
    source: Vec<Vec<Vec<f64>>>,
    target: Vec<Vec<Vec<f64>>>,
}

/// Pairs of all frames between keys.
///
/// # Errors
/// Too few keys, keys that contradict each other, or being asked to stop.
pub fn densify(
    source: &Subject,
    target: &Subject,
    keys: &[Key],
    options: &TransferOptions,
    job: &Job<'_>,
) -> Result<Dense, TransferError> {
    let groups = groups(source, target, keys)?;
    job.begin("matching frames")?;
    let pairs: Vec<Pair> = groups.iter().flatten().map(Pair::of_key).collect();
    if pairs.len() < TransferError::FEWEST {
        return Err(TransferError::FewPairs(pairs.len()));
    }
    let order = if options.whole { None } else { matching(source, target, &pairs) };
    let frames = |of: fn(&Key) -> u32| -> Vec<u32> {
        let span = |group: &Vec<Key>| of(&group[0])..=group.last().map_or(0, of);
        groups.iter().flat_map(span).collect()
    };
    let target_spaces = spaces(target, &frames(|key| key.target), order.is_none());
    let own = spaces(source, &frames(|key| key.source), order.is_none());
    let source_spaces: Vec<Space> = match &order {
        Some(order) => order.iter().map(|&part| own[part].clone()).collect(),
        None => own,
    };
    let stretches: Vec<Stretch> =
        groups.into_iter().map(|keys| Stretch::of((source, &source_spaces), (target, &target_spaces), keys)).collect();
    let noise = (NOISE * f64::from(target.size)).powi(2);
    let known: Vec<Vec<f64>> = stretches.iter().map(|stretch| vec![f64::NAN; stretch.target.len()]).collect();
    let (mut ways, mut costs) = (known, Vec::new());
    for (way, stretch) in ways.iter_mut().zip(&stretches) {
        stretch.keys.iter().for_each(|key| way[(key.target - stretch.keys[0].target) as usize] = stretch.row_of(key));
    }
    for round in 0..=REFITS {
        job.tell("matching frames", round as u64, REFITS as u64 + 1)?;
        let maps = maps(&stretches, &ways, noise).ok_or(TransferError::Still("source"))?;
        let held = round == 0;
        let found = stretches
            .par_iter()
            .map(|stretch| stretch.way(&maps, held, source, target))
            .collect::<Result<Vec<_>, TransferError>>()?;
        (ways, costs) = found.into_iter().unzip();
    }
    let (x, y) = matched(&stretches, &ways);
    let agreement = agreement(&x, &y, noise);
    let mut dense = Dense { pairs: Vec::new(), doubts: Vec::new(), agreement, maps: Vec::new() };
    for ((stretch, way), costs) in stretches.iter().zip(&ways).zip(costs) {
        stretch.tell((way, costs), source, target, &mut dense);
    }
    Ok(dense)
}

/// Keys by sequences and stretches, in order, each once.
fn groups(source: &Subject, target: &Subject, keys: &[Key]) -> Result<Vec<Vec<Key>>, TransferError> {
    let mut groups: BTreeMap<(Option<usize>, Option<usize>, u32), Vec<Key>> = BTreeMap::new();
    for key in keys {
        for (which, subject, frame) in [("source", source, key.source), ("target", target, key.target)] {
            let count = subject.timeline.frame_count();
            if frame >= count {
                return Err(TransferError::Frame { which, frame, count });
            }
        }
        let sequences = (source.timeline.sequence_index(key.source), target.timeline.sequence_index(key.target));
        groups.entry((sequences.0, sequences.1, key.stretch)).or_default().push(*key);
    }
    for group in groups.values_mut() {
        group.sort_unstable_by_key(|key| (key.target, key.source));
        group.dedup();
        for pair in group.windows(2) {
            if pair[1].source <= pair[0].source || pair[1].target == pair[0].target {
                return Err(named(source, target, [pair[0], pair[1]], true));
            }
        }
    }
    Ok(groups.into_values().collect())
}

/// An error about two keys, with their frames as the sequences count them.
fn named(source: &Subject, target: &Subject, keys: [Key; 2], contradict: bool) -> TransferError {
    let name = |subject: &Subject, frame: u32| {
        let index = subject.timeline.sequence_index(frame).unwrap_or_default();
        let sequence = &subject.timeline.sequences()[index];
        (sequence.name.clone(), frame - sequence.first_frame)
    };
    let [(source_name, first_source), (_, second_source)] = keys.map(|key| name(source, key.source));
    let [(target_name, first_target), (_, second_target)] = keys.map(|key| name(target, key.target));
    if contradict {
        TransferError::Contradiction {
            source_name,
            target_name,
            first_source,
            first_target,
            second_source,
            second_target,
        }
    } else {
        TransferError::TooFast { source_name, target_name, first_source, first_target, second_source, second_target }
    }
}

/// Numbers of both sides of all pairs, from the rows of the source that `ways` have for the target's frames (not a number: none).
fn matched<'a>(stretches: &'a [Stretch], ways: &[Vec<f64>]) -> (Vec<Row>, Vec<&'a Row>) {
    let (mut x, mut y) = (Vec::new(), Vec::new());
    for (stretch, way) in stretches.iter().zip(ways) {
        for (frame, &row) in way.iter().enumerate().filter(|(_, row)| row.is_finite()) {
            x.push(stretch.numbers(row));
            y.push(&stretch.target[frame]);
        }
    }
    (x, y)
}

/// The linear maps of all parts, from all pairs.
fn maps(stretches: &[Stretch], ways: &[Vec<f64>], noise: f64) -> Option<Vec<LinearMap>> {
    let (x, y) = matched(stretches, ways);
    let map = |part: usize| {
        let inputs = Matrix::from_fn(x.len(), x[0][part].len(), |row, k| x[row][part][k]);
        let outputs = Matrix::from_fn(y.len(), y[0][part].len(), |row, k| y[row][part][k]);
        LinearMap::fit(&inputs, &outputs, noise)
    };
    (0..x.first()?.len()).map(map).collect()
}

impl Stretch {
    fn of(source: (&Subject, &[Space]), target: (&Subject, &[Space]), keys: Vec<Key>) -> Self {
        let ((source, source_spaces), (target, target_spaces)) = (source, target);
        let (first, last) = (keys[0], keys[keys.len() - 1]);
        let length = f64::from(last.source - first.source);
        let steps = (length * f64::from(target.timeline.fps() / source.timeline.fps())).round().max(1.0);
        let count = if keys.len() == 1 { 1 } else { steps as usize + 1 };
        let rows: Vec<f64> = (0..count).map(|row| f64::from(first.source) + length * row as f64 / steps).collect();
        let all: Vec<Vec<Vec<f64>>> =
            (first.source..=last.source).into_par_iter().map(|frame| numbers(source, source_spaces, frame)).collect();
        let at = |&row: &f64| {
            let off = row - f64::from(first.source);
            let before = (off as usize).min(all.len() - 1);
            between(&all[before], &all[(before + 1).min(all.len() - 1)], off - before as f64)
        };
        let own = |frame: u32| numbers(target, target_spaces, frame);
        Self {
            source: rows.iter().map(at).collect(),
            target: (first.target..=last.target).into_par_iter().map(own).collect(),
            keys,
            rows,
        }
    }

    /// The row of a key's frame of the source.
    fn row_of(&self, key: &Key) -> f64 {
        let (first, last) = (self.rows[0], self.rows[self.rows.len() - 1]);
        let share = (f64::from(key.source) - first) / (last - first).max(1e-9);
        (share * (self.rows.len() - 1) as f64).round()
    }

    fn numbers(&self, row: f64) -> Vec<Vec<f64>> {
        let before = (row as usize).min(self.source.len() - 1);
        between(&self.source[before], &self.source[(before + 1).min(self.source.len() - 1)], row - before as f64)
    }

    /// The rows of the most probable way, and the costs that it was found among; `held` has it go through all keys, not only the
    /// first and the last.
    fn way(
        &self,
        maps: &[LinearMap],
        held: bool,
        source: &Subject,
        target: &Subject,
    ) -> Result<(Vec<f64>, Costs), TransferError> {
        let predicted: Vec<Vec<(Vec<f64>, f64)>> =
            self.source.iter().map(|x| maps.iter().zip(x).map(|(map, x)| map.predict(x)).collect()).collect();
        let costs = Matrix::from_fn(self.source.len(), self.target.len(), |i, j| {
            let parts = predicted[i].iter().zip(&self.target[j]);
            parts.map(|((mean, variance), y)| improbable(mean, *variance, y)).sum()
        });
        let cell = |key: &Key| (self.row_of(key) as usize, (key.target - self.keys[0].target) as usize);
        let keys: Vec<(usize, usize)> = if held { self.keys.iter().map(cell).collect() } else { Vec::new() };
        let way = path(&costs, &keys).ok_or_else(|| named(source, target, self.fastest(), false))?;
        Ok((rows_of_columns(&way, SMOOTH), Costs::of(&costs)))
    }

    /// The keys between which one side is fastest beside the other.
    fn fastest(&self) -> [Key; 2] {
        let ratio = |pair: &[Key]| {
            let rows = (self.row_of(&pair[1]) - self.row_of(&pair[0])).max(1e-3);
            (rows / f64::from(pair[1].target - pair[0].target)).ln().abs()
        };
        let worst = self.keys.windows(2).max_by(|a, b| ratio(a).total_cmp(&ratio(b)));
        worst.map_or([self.keys[0]; 2], |pair| [pair[0], pair[1]])
    }

    /// Says which pairs there are, and which keys look wrong.
    fn tell(&self, (way, costs): (&[f64], Costs), source: &Subject, target: &Subject, dense: &mut Dense) {
        let step = f64::from(source.timeline.fps() / target.timeline.fps());
        let frame = |row: f64| {
            let before = (row as usize).min(self.rows.len() - 1);
            let after = (before + 1).min(self.rows.len() - 1);
            self.rows[before] + (self.rows[after] - self.rows[before]) * (row - before as f64)
        };
        let (first, last) = (self.keys[0], self.keys[self.keys.len() - 1]);
        let path: Vec<f64> = way.iter().map(|&row| frame(row)).collect();
        for (offset, &source) in (0..).zip(&path) {
            dense.pairs.push(Pair { source, target: first.target + offset });
        }
        dense.maps.push(FrameMap {
            stretch: first.stretch,
            source: [first.source, last.source],
            target: [first.target, last.target],
            path,
            costs,
        });
        for &key in &self.keys {
            let better = frame(way[(key.target - self.keys[0].target) as usize]);
            let off = (better - f64::from(key.source)).abs() / step;
            if off > WRONG {
                dense.doubts.push(Doubt { key, better, off });
            }
        }
    }
}

/// How improbable a part's numbers are (5.8), as the negative logarithm of their density without its constant.
fn improbable(mean: &[f64], variance: f64, numbers: &[f64]) -> f64 {
    let off = mean.iter().zip(numbers).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
    off / (2.0 * variance) + 0.5 * mean.len() as f64 * variance.ln()
}
