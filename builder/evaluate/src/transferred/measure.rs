//! How far the target is from the truth when it moves as the source does.

use actor::timeline::Sequence;
use glam::{DMat3, DVec3, Vec3, Vec3Swizzles};
use job::Job;
use kernels::align::align_heading;
use kernels::random::{mix, signed};
use kernels::rotation::best_rotation;
use rayon::prelude::*;
use transfer::{Key, Model, Pair, Subject, TransferError, TransferOptions, densify};

use super::performed::Performed;

/// Every so many frames are looked at.
const EVERY: usize = 6;

/// Two performers who do the same.
pub struct Both<'a> {
    /// Who moves so: the truth.
    pub target: &'a Performed,
    /// The source, and the target as transfer sees it: it has only the takes that are learned from, which come first in the truth, too.
    pub subjects: [&'a Subject<'a>; 2],
}

/// Frames of the truth, by sequence: those of the takes that are learned from, of other takes of these, and of what is not learned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    /// The takes that are learned from.
    Seen,
    /// Other takes of the same.
    Take,
    /// Other motions.
    Unseen,
}

impl Both<'_> {
    /// Frames of one kind.
    pub fn frames(&self, which: Which) -> Vec<u32> {
        let own = self.target.timeline.sequences().iter().filter(|sequence| kind(sequence) == which);
        own.flat_map(|sequence| sequence.first_frame..sequence.end_frame()).collect()
    }

    /// All true pairs of what is learned from.
    pub fn pairs(&self) -> Vec<Pair> {
        self.frames(Which::Seen).into_iter().map(|frame| Pair { source: f64::from(frame), target: frame }).collect()
    }

    /// Root of the mean square of how far vertices are off in these frames, in millimetres.
    pub fn error(&self, model: &Model, frames: &[u32]) -> Result<f64, TransferError> {
        let off = |&frame: &u32| -> Result<f64, TransferError> {
            let pose = model.still(f64::from(frame))?;
            Ok(self.target.off(frame, &pose).powi(2))
        };
        let squares = frames.par_iter().map(off).collect::<Result<Vec<f64>, _>>()?;
        Ok(1000.0 * (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt())
    }

    /// The same of shapes, once they are turned and moved onto the truth in any way: without how the body leans.
    pub fn shape_error(&self, model: &Model, which: Which) -> Result<f64, TransferError> {
        let off = |&frame: &u32| -> Result<f64, TransferError> {
            Ok(fitted(&model.still(f64::from(frame))?, self.target.poses.frame(frame)))
        };
        let frames: Vec<u32> = self.frames(which).into_iter().step_by(EVERY).collect();
        let squares = frames.par_iter().map(off).collect::<Result<Vec<f64>, _>>()?;
        Ok(1000.0 * (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt())
    }

    /// The same of every few frames of one kind.
    pub fn error_of(&self, model: &Model, which: Which) -> Result<f64, TransferError> {
        let frames: Vec<u32> = self.frames(which).into_iter().step_by(EVERY).collect();
        self.error(model, &frames)
    }

    pub fn learn(&self, pairs: &[Pair], options: &TransferOptions, job: &Job) -> Result<Model<'_>, TransferError> {
        Model::learn(self.subjects[0], self.subjects[1], pairs, options, job)
    }
}

/// Mean square of how far a shape is from another one, once it is turned and moved onto it, in square metres.
fn fitted(shape: &[Vec3], truth: &[Vec3]) -> f64 {
    let count = truth.len().max(1) as f64;
    let middle = |of: &[Vec3]| of.iter().map(|point| point.as_dvec3()).sum::<DVec3>() / count;
    let (own, other) = (middle(shape), middle(truth));
    let both = || shape.iter().zip(truth).map(|(a, b)| (a.as_dvec3() - own, b.as_dvec3() - other));
    let turn = both().fold(DMat3::ZERO, |sum, (a, b)| sum + DMat3::from_cols(b * a.x, b * a.y, b * a.z));
    let turn = best_rotation(&turn);
    both().map(|(a, b)| (turn * a).distance_squared(b)).sum::<f64>() / count
}

/// What a sequence is there for.
pub fn kind(sequence: &Sequence) -> Which {
    let is_learned = super::performed::LEARNED.iter().any(|name| sequence.labels.iter().any(|label| label == name));
    // Its seed is the second word: those of odd seeds are the takes that are learned from.
    let seed = sequence.name.split(' ').nth(1).and_then(|seed| seed.parse::<u64>().ok());
    match (is_learned, seed.is_some_and(|seed| seed % 2 == 1)) {
        (true, true) => Which::Seen,
        (true, false) => Which::Take,
        (false, _) => Which::Unseen,
    }
}

/// `count` keys of each sequence of a target whose time is warped, even in time; the source's frames are off by up to `wrong`.
pub fn keys(source: &Performed, target: &Performed, count: usize, wrong: f64) -> Vec<Key> {
    let mut keys = Vec::new();
    for (sequence, original) in target.timeline.sequences().iter().zip(source.timeline.sequences()) {
        let (last, mut next) = (sequence.frame_count - 1, 0);
        for k in 0..count as u32 {
            let even = k * last / (count as u32 - 1);
            // A frame beside it that the source has, too.
            let near = even.saturating_sub(1)..=(even + 1).min(last);
            let time = |frame: u32| target.times[(sequence.first_frame + frame) as usize];
            let off = |frame: &u32| (time(*frame) - time(*frame).round()).abs();
            let is_end = k == 0 || k + 1 == count as u32;
            let chosen = if is_end { even } else { near.min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(even) };
            let slip = wrong * f64::from(signed(mix(7, u64::from(sequence.first_frame)), u64::from(k)));
            let frame = (time(chosen) + slip).round().clamp(f64::from(next), f64::from(original.frame_count - 1));
            next = frame as u32 + 1;
            let source = original.first_frame + frame as u32;
            keys.push(Key { source, target: sequence.first_frame + chosen, stretch: 0 });
        }
    }
    keys
}

/// Mean of how far pairs are off in time, in frames of the target.
pub fn time_error(source: &Performed, target: &Performed, pairs: &[Pair]) -> f64 {
    let off = |pair: &Pair| {
        let sequence = target.timeline.sequence_index(pair.target).unwrap_or_default();
        let first = f64::from(source.timeline.sequences()[sequence].first_frame);
        (pair.source - first - target.times[pair.target as usize]).abs()
    };
    pairs.iter().map(off).sum::<f64>() / pairs.len().max(1) as f64
}

/// Pairs between keys by time alone.
pub fn by_time(target: &Performed, keys: &[Key]) -> Vec<Pair> {
    let mut pairs = Vec::new();
    for two in keys.windows(2) {
        if target.timeline.sequence_index(two[0].target) == target.timeline.sequence_index(two[1].target) {
            let length = f64::from(two[1].target - two[0].target);
            pairs.extend((two[0].target..two[1].target).map(|frame| {
                let share = f64::from(frame - two[0].target) / length;
                let source = f64::from(two[0].source) + share * (f64::from(two[1].source) - f64::from(two[0].source));
                Pair { source, target: frame }
            }));
        }
    }
    pairs
}

/// What densifying comes to.
pub fn dense(subjects: [&Subject; 2], keys: &[Key], job: &Job) -> Result<Vec<Pair>, TransferError> {
    Ok(densify(subjects[0], subjects[1], keys, &TransferOptions::default(), job)?.pairs)
}

/// How a whole sequence goes beside the truth.
#[derive(Clone, Debug)]
pub struct Way {
    pub name: String,
    /// Metres that the truth goes.
    pub length: f64,
    /// How far the end is off, in metres.
    pub drift: f64,
    /// How far the end is turned, in degrees.
    pub turn: f64,
    /// Millimetres that soles slide a frame, before holding them and after.
    pub slide: [f64; 2],
}

/// How the sequence `sequence` goes by a model that holds soles, and by one that does not.
pub fn way(both: &Both, models: [&Model; 2], sequence: &Sequence, job: &Job) -> Result<Way, TransferError> {
    let times = models[0].times(sequence);
    let free = models[0].frames(&times, job)?;
    let held = models[1].frames(&times, job)?;
    let weights = both.target.topology.weights();
    let (first, last) = (sequence.first_frame, sequence.end_frame() - 1);
    let truth = [both.target.poses.frame(first), both.target.poses.frame(last)];
    let own = [&held[0], &held[held.len() - 1]];
    // The truth laid onto the beginning.
    let begin = align_heading(truth[0], own[0], weights);
    let centre = |pose: &[Vec3]| kernels::align::centre_of_mass(pose, weights).xz();
    let goes = kernels::align::rotate(begin, centre(own[1]) - centre(own[0]));
    let wanted = centre(truth[1]) - centre(truth[0]);
    let end = align_heading(truth[1], own[1], weights) - begin;
    let end = (end.to_degrees() + 180.0).rem_euclid(360.0) - 180.0;
    let length: f32 = (first..last)
        .map(|k| centre(both.target.poses.frame(k)).distance(centre(both.target.poses.frame(k + 1))))
        .sum();
    let slide = |model: &Model, poses: &[Vec<Vec3>]| model.slide(&times, poses).map_or(0.0, |s| 1e3 * f64::from(s));
    Ok(Way {
        name: sequence.name.clone(),
        length: f64::from(length),
        drift: f64::from(goes.distance(wanted)),
        turn: f64::from(end.abs()),
        slide: [slide(models[0], &free), slide(models[1], &held)],
    })
}
