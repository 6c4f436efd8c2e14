//! A family: its members in the order of their parameter, the table of what lies between them, and samples by value.

use job::Job;
use kernels::poisson::PoissonInterpolator;
use rayon::prelude::*;

use crate::cycle::{Cycle, cycles};
use crate::error::FamilyError;
use crate::jump::{Jump, jumps};
use crate::member::{Cut, Member};
use crate::pair::Pair;
use crate::parameter::Parameter;
use crate::phase::face;
use crate::recorded::{Recorded, Track};
use crate::sample::{Sample, sample};

/// Seconds before and after the flight of a jump, at most.
const AROUND: [f32; 2] = [0.7, 0.8];
/// Blends between two members whose parameter is measured: at every quarter.
const QUARTERS: usize = 4;
/// Corrections of a weight at most, until the parameter is met to a part in so many.
const ROUNDS: usize = 4;
const MET: f32 = 0.004;

/// A sequence of the capture, by its number, and the frames within which its cycle or jump is looked for, where that is said: the first
/// one and the last one, from 0.
pub type Part = (usize, Option<(u32, u32)>);

/// What is made a family.
#[derive(Clone, Debug, PartialEq)]
pub struct Wanted {
    /// By which number.
    pub parameter: Parameter,
    /// Where its members are.
    pub sequences: Vec<Part>,
}

/// A family.
pub struct Family<'a> {
    recorded: Recorded<'a>,
    parameter: Parameter,
    /// In the order of the parameter.
    members: Vec<Member>,
    /// Rows of the table: the weight, counted on from member to member, and what was measured.
    table: Vec<(f32, f32)>,
    /// What is seen of each member's ends: how far they are apart, in metres.
    apart: Vec<f32>,
    /// How far members are from each other at the same phase, at most, in metres.
    unlike: f32,
    order: Vec<u32>,
}

impl<'a> Family<'a> {
    /// Finds and cuts the cycles of `wanted`, and measures what lies between them.
    ///
    /// # Errors
    /// See [`FamilyError`].
    pub fn new(recorded: Recorded<'a>, wanted: &Wanted, job: &Job) -> Result<Self, FamilyError> {
        job.begin("cycles")?;
        let mut poisson = PoissonInterpolator::new(recorded.topology, None)?;
        let order = poisson.elimination_order().to_vec();
        let (cut, unlike) = cut(&recorded, wanted, &mut poisson)?;
        let name = |member: &Member| recorded.timeline.sequences()[member.sequence].name.clone();
        let mut valued = Vec::new();
        for (member, apart) in cut {
            let own = Pair::new([&member, &member]).map_err(|why| FamilyError::NoCycle { name: name(&member), why })?;
            let value = sample(&recorded, &own, 0.0, &mut poisson)?.measured.value(wanted.parameter);
            valued.push((value, member, apart));
        }
        valued.sort_by(|a, b| a.0.total_cmp(&b.0));
        for pair in valued.windows(2) {
            if pair[1].0 - pair[0].0 < wanted.parameter.grain() {
                let value = wanted.parameter.told(pair[0].0);
                let (one, other) = (name(&pair[0].1), name(&pair[1].1));
                return Err(FamilyError::Alike { one, other, parameter: wanted.parameter, value });
            }
        }
        let apart = valued.iter().map(|valued| valued.2).collect();
        let members = valued.into_iter().map(|valued| valued.1).collect();
        let mut family =
            Self { recorded, parameter: wanted.parameter, members, table: Vec::new(), apart, unlike, order };
        family.table = family.measure(job)?;
        Ok(family)
    }

    /// What it is asked by.
    #[must_use]
    pub fn parameter(&self) -> Parameter {
        self.parameter
    }

    /// Its members in the order of the parameter, and how far the ends of each are apart, in metres.
    pub fn members(&self) -> impl Iterator<Item = (&Member, f32)> {
        self.members.iter().zip(self.apart.iter().copied())
    }

    /// How far members are from the first one at the same phase, once they face one way: root of the mean square over vertices and
    /// phases, of the one that is least like it, in metres.
    #[must_use]
    pub fn unlike(&self) -> f32 {
        self.unlike
    }

    /// The table: weights, counted on from member to member, and the parameter that was measured there.
    #[must_use]
    pub fn table(&self) -> &[(f32, f32)] {
        &self.table
    }

    /// The parameter of each member, as its own sample has it.
    #[must_use]
    pub fn member_values(&self) -> Vec<f32> {
        self.table.iter().step_by(QUARTERS).map(|row| row.1).collect()
    }

    /// Least and greatest value.
    #[must_use]
    pub fn range(&self) -> (f32, f32) {
        let values = || self.table.iter().map(|row| row.1);
        (values().fold(f32::INFINITY, f32::min), values().fold(f32::NEG_INFINITY, f32::max))
    }

    /// Whether the parameter grows with the weight all the way.
    #[must_use]
    pub fn is_monotone(&self) -> bool {
        self.table.windows(2).all(|pair| pair[1].1 > pair[0].1)
    }

    /// So many values at even distances, from the least to the greatest.
    #[must_use]
    pub fn values(&self, count: usize) -> Vec<f32> {
        let (low, high) = self.range();
        (0..count).map(|k| low + (high - low) * k as f32 / (count - 1).max(1) as f32).collect()
    }

    fn measure(&self, job: &Job) -> Result<Vec<(f32, f32)>, FamilyError> {
        let rows = (self.members.len() - 1) * QUARTERS + 1;
        let row = |k: usize| {
            job.tell("family", k as u64, rows as u64)?;
            let weight = k as f32 / QUARTERS as f32;
            Ok((weight, self.at(weight)?.measured.value(self.parameter)))
        };
        (0..rows).into_par_iter().map(row).collect()
    }

    /// The sample at a weight, counted on from member to member.
    ///
    /// # Errors
    /// Poses that cannot be interpolated; members that do not match.
    pub fn at(&self, weight: f32) -> Result<Sample, FamilyError> {
        let last = self.members.len() - 2;
        let index = (weight.max(0.0) as usize).min(last);
        let [one, other] = [&self.members[index], &self.members[index + 1]];
        let name = |member: &Member| self.recorded.timeline.sequences()[member.sequence].name.clone();
        let pair =
            Pair::new([one, other]).map_err(|why| FamilyError::Unlike { one: name(one), other: name(other), why })?;
        let mut poisson = PoissonInterpolator::new(self.recorded.topology, Some(&self.order))?;
        let lambda = (weight - index as f32).clamp(0.0, 1.0);
        Ok(Sample { member: index, ..sample(&self.recorded, &pair, lambda, &mut poisson)? })
    }

    /// The sample whose measured parameter is `value`, or the nearest that there is.
    ///
    /// # Errors
    /// As [`Self::at`].
    pub fn ask(&self, value: f32) -> Result<Sample, FamilyError> {
        let (mut low, mut high) = self.bracket(value);
        let weight_between = |low: (f32, f32), high: (f32, f32)| {
            let share = (value - low.1) / (high.1 - low.1);
            low.0 + (high.0 - low.0) * if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 }
        };
        let off = |sample: &Sample| (sample.measured.value(self.parameter) - value).abs();
        let mut best = self.at(weight_between(low, high))?;
        let mut weight = weight_between(low, high);
        let near = MET * value.abs().max(self.parameter.grain());
        let mut found = best.measured.value(self.parameter);
        for _ in 0..ROUNDS {
            if off(&best) < near {
                break;
            }
            if (found < value) == (low.1 < high.1) {
                low = (weight, found)
            } else {
                high = (weight, found)
            }
            let next = weight_between(low, high);
            // Durations are whole frames: where one is gained or lost, the parameter leaps, and there is nothing nearer.
            if (next - weight).abs() < 1e-4 {
                break;
            }
            weight = next;
            let sample = self.at(weight)?;
            found = sample.measured.value(self.parameter);
            if off(&sample) < off(&best) {
                best = sample;
            }
        }
        Ok(best)
    }

    /// The rows of the table that a value lies between.
    fn bracket(&self, value: f32) -> ((f32, f32), (f32, f32)) {
        let between = |pair: &&[(f32, f32)]| {
            let (low, high) = (pair[0].1.min(pair[1].1), pair[0].1.max(pair[1].1));
            (low..=high).contains(&value)
        };
        let nearest = || {
            let off = |row: &(f32, f32)| (row.1 - value).abs();
            let row = self.table.iter().copied().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or_default();
            (row, row)
        };
        self.table.windows(2).find(between).map_or_else(nearest, |pair| (pair[0], pair[1]))
    }
}

/// The members of a family with how far their ends are apart, facing one way, and how unlike they are, in metres.
fn cut(
    recorded: &Recorded,
    wanted: &Wanted,
    poisson: &mut PoissonInterpolator,
) -> Result<(Vec<(Member, f32)>, f32), FamilyError> {
    if recorded.feet.count() == 0 {
        return Err(FamilyError::NoContacts);
    }
    if wanted.sequences.len() < 2 {
        return Err(FamilyError::TooFew(wanted.sequences.len()));
    }
    check_frames(recorded, wanted)?;
    let mut cut: Vec<(Member, f32)> = if wanted.parameter.is_of_jumps() {
        cut_jumps(recorded, wanted)?.into_iter().map(|member| (member, 0.0)).collect()
    } else {
        cut_cycles(recorded, wanted, poisson)?
    };
    let name = |member: &Member| recorded.timeline.sequences()[member.sequence].name.clone();
    let mut unlike = 0.0_f32;
    if let Some((first, others)) = cut.split_first_mut() {
        for (other, _) in others {
            let apart = face(recorded, &first.0, other).map_err(|why| FamilyError::Unlike {
                one: name(&first.0),
                other: name(other),
                why,
            })?;
            unlike = unlike.max(apart);
        }
    }
    Ok((cut, unlike))
}

/// How unlike the members of a family would be, as [`Family::unlike`] has it.
///
/// # Errors
/// As [`Family::new`].
pub(crate) fn how_unlike(recorded: &Recorded, wanted: &Wanted) -> Result<f32, FamilyError> {
    let mut poisson = PoissonInterpolator::new(recorded.topology, None)?;
    cut(recorded, wanted, &mut poisson).map(|cut| cut.1)
}

/// Frames that are named have to be there.
fn check_frames(recorded: &Recorded, wanted: &Wanted) -> Result<(), FamilyError> {
    for &(sequence, frames) in &wanted.sequences {
        let own = &recorded.timeline.sequences()[sequence];
        let last = own.frame_count - 1;
        if let Some((from, to)) = frames.filter(|(from, to)| from >= to || *to > last) {
            return Err(FamilyError::Frames { name: own.name.clone(), from, to, last });
        }
    }
    Ok(())
}

/// The best cycles of all sequences, by one foot.
fn cut_cycles(
    recorded: &Recorded,
    wanted: &Wanted,
    poisson: &mut PoissonInterpolator,
) -> Result<Vec<(Member, f32)>, FamilyError> {
    let tracks: Vec<Track> = wanted.sequences.iter().map(|&(sequence, _)| recorded.track(sequence)).collect();
    let by_foot = |foot: usize| -> Vec<Result<Cycle, FamilyError>> {
        let best = |(track, &(sequence, frames)): (&Track, &Part)| {
            best_cycle(recorded, track, foot, wanted.parameter, frames).ok_or_else(|| no_cycle(recorded, sequence))
        };
        tracks.iter().zip(&wanted.sequences).map(best).collect()
    };
    let mut feet: Vec<Vec<Result<Cycle, FamilyError>>> = (0..recorded.feet.count()).map(by_foot).collect();
    let apart = |found: &[Result<Cycle, FamilyError>]| {
        found.iter().map(|cycle| cycle.as_ref().map_or(f32::INFINITY, |cycle| cycle.apart)).sum::<f32>()
    };
    feet.sort_by(|a, b| apart(a).total_cmp(&apart(b)));
    let best: Result<Vec<Cycle>, FamilyError> = feet.swap_remove(0).into_iter().collect();
    let cut = |(k, cycle): (usize, Cycle)| {
        let cut = Cut { recorded, track: &tracks[k], sequence: wanted.sequences[k].0 };
        Ok((cut.cycle(&cycle, poisson)?, cycle.apart))
    };
    best?.into_iter().enumerate().map(cut).collect()
}

/// The cycle of a track, or of some frames of its sequence, that meets itself best; of turns that which turns most.
#[must_use]
pub fn best_cycle(
    recorded: &Recorded,
    track: &Track,
    foot: usize,
    parameter: Parameter,
    frames: Option<(u32, u32)>,
) -> Option<Cycle> {
    let own = track.own();
    let inside = |cycle: &Cycle| {
        let within =
            |(from, to): (u32, u32)| own.start + from as usize <= cycle.from && cycle.to <= own.start + to as usize;
        own.contains(&cycle.from) && frames.is_none_or(within)
    };
    let all: Vec<Cycle> = cycles(recorded, track, foot).into_iter().filter(inside).collect();
    let least = all.iter().map(|cycle| cycle.apart).fold(f32::INFINITY, f32::min);
    let turn = |cycle: &Cycle| cycle.twist.turn.abs();
    match parameter {
        // A curve is never met as well as a straight line: up to a thirtieth of the body more is no matter.
        Parameter::Turn => all
            .into_iter()
            .filter(|cycle| cycle.apart < 2.0 * least + recorded.body() / 30.0)
            .max_by(|a, b| turn(a).total_cmp(&turn(b))),
        _ => all.into_iter().min_by(|a, b| a.apart.total_cmp(&b.apart)),
    }
}

fn no_cycle(recorded: &Recorded, sequence: usize) -> FamilyError {
    let name = recorded.timeline.sequences()[sequence].name.clone();
    let why = "no foot lands twice within its frames with every other foot once between; it must hold two landings of one foot"
        .into();
    FamilyError::NoCycle { name, why }
}

/// The highest jump of each sequence, all cut as long as the shortest allows.
fn cut_jumps(recorded: &Recorded, wanted: &Wanted) -> Result<Vec<Member>, FamilyError> {
    let tracks: Vec<Track> = wanted.sequences.iter().map(|&(sequence, _)| recorded.track(sequence)).collect();
    let highest = |(track, &(sequence, frames)): (&Track, &Part)| {
        let first = track.own().start;
        let within = |jump: &Jump| {
            frames.is_none_or(|(from, to)| first + from as usize <= jump.off && jump.land <= first + to as usize)
        };
        let all = jumps(recorded, track).into_iter().filter(within);
        all.max_by(|a, b| a.rise.total_cmp(&b.rise)).ok_or_else(|| {
            let name = recorded.timeline.sequences()[sequence].name.clone();
            let why = "nothing within its frames stands, leaves the ground, rises, and stands again".into();
            FamilyError::NoCycle { name, why }
        })
    };
    let found: Vec<Jump> = tracks.iter().zip(&wanted.sequences).map(highest).collect::<Result<_, _>>()?;
    let [before, after] = AROUND.map(|seconds| recorded.frames(seconds));
    let before = found.iter().map(|jump| (jump.around.0 - 1).min(jump.off)).fold(before, usize::min);
    let after = found.iter().map(|jump| jump.around.1 - 1).fold(after, usize::min);
    let cut = |(k, jump): (usize, &Jump)| {
        Cut { recorded, track: &tracks[k], sequence: wanted.sequences[k].0 }.jump(jump, (before, after))
    };
    Ok(found.iter().enumerate().map(cut).collect())
}
