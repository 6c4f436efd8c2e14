//! Walks that are bent onto their path: no walk through the graph lies on a drawn curve; small turns and stretches of stride,
//! spread over it, bring it there.
//!
//! Not in the papers. A walk is taken to go on as it does, seen from the body: its steps are rolled off along the curve. What its
//! way turns more or less than the curve is added to its heading; what is then missing to the curve is added to its stride, and
//! the sway of its middle is taken off. All of it is rigid, one placement a step: what stands meanwhile is the player's to keep
//! (`shared/synthesis/src/bend.rs`). No step is changed by more than [`MOST_TURN`] and [`MOST_STRIDE`]; what that is not
//! enough for stays.

use glam::{Vec2, Vec3, Vec3Swizzles};
use kernels::align::Placement;
use kernels::scalar::exp;

use super::curve::Curve;
use super::ground_pose::{GroundPose, angle, half_turn, turn_of};

/// A step of the body is taken to last so many seconds.
const STEP: f32 = 0.5;
/// Radians by which a step may be turned: 10 degrees.
const MOST_TURN: f32 = 0.1745;
/// Metres by which a step may be moved.
const MOST_STRIDE: f32 = 0.1;
/// Slower than this, in metres a second, a body goes nowhere, and its heading stays as it is.
const STANDS: f32 = 0.15;
/// From this speed on a step may be changed by as much as may be; less at lower speeds.
const WALKS: f32 = 0.5;
/// Seconds over which sway evens out.
const SWAY: f32 = 0.3;
/// Seconds over which a body's middle is smooth.
const MIDDLE: f32 = 0.06;
/// Seconds over which turns and changes of stride are spread.
const SPREAD: f32 = 0.12;
/// Metres before and after a place of the curve that its direction is taken from.
const TANGENT: f64 = 0.08;
/// Metres within which a body comes back to the curve by turning.
const BACK: f32 = 0.5;
/// All strides may be longer or shorter by this share.
const STRETCH: f32 = 0.15;
/// How often headings are found anew from where they lead.
const PASSES: usize = 8;

/// How a walk is bent: where the frame after each step is put, in the world; the first one where the walk begins.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Bend(pub Vec<GroundPose>);

impl Bend {
    /// As a walk keeps it.
    pub fn placements(&self) -> impl Iterator<Item = [f32; 3]> + '_ {
        self.0.iter().map(|pose| {
            let Placement { heading, translation } = (*pose).into();
            [heading, translation.x, translation.y]
        })
    }

    /// Bends a walk whose middle is at `track` after each step, `fps` steps a second, onto `curve`, by the share `exactness`. Where
    /// it `is_free`, it may begin elsewhere.
    pub fn onto(curve: &Curve, track: &[Vec3], fps: f32, exactness: f32, is_free: bool) -> Self {
        if track.len() < 2 || exactness <= 0.0 {
            return Self::default();
        }
        let track: Vec<Vec2> = track.iter().map(|point| point.xz()).collect();
        let way = Way::of(&track, fps);
        let from = (!is_free).then_some(0.0);
        let mut turns = vec![0.0; track.len()];
        let total: f32 = way.steps.iter().map(|step| step.length()).sum();
        let mut stretch = (curve.length() as f32 / total.max(1e-3)).clamp(1.0 - STRETCH, 1.0 + STRETCH);
        let (mut lengths, mut gone) = (Vec::with_capacity(track.len()), 0.0);
        for step in 0..track.len() {
            lengths.push(f64::from(gone));
            gone += way.steps.get(step).map_or(0.0, |step| step.length() * stretch);
        }
        let mut aims: Vec<Vec2> = lengths.iter().map(|&length| curve.at(length).xz()).collect();
        for _ in 0..PASSES {
            turns = way.turns(curve, &lengths, &aims, from);
            lengths = way.lengths(curve, &turns, stretch);
            let end = lengths.last().map_or(0.0, |length| *length as f32).max(0.1);
            stretch = (stretch * curve.length() as f32 / end).clamp(1.0 - STRETCH, 1.0 + STRETCH);
            aims = way.aims(curve, &turns, &lengths, from);
        }
        let middle = smooth(&track, MIDDLE * fps);
        let pose = |step: usize| {
            let turn = GroundPose { turn: turn_of(turns[step]), shift: Vec2::ZERO };
            let aim = aims[step];
            // Sway along the way is how the body walks; what leads aside is taken off, once it is under way.
            let sway = turn.rotate(middle[step] - way.points[step]);
            let along = tangent(curve, lengths[step]);
            let aside = sway - along * sway.dot(along);
            let begun = if is_free { 1.0 } else { way.budget[step].min(1.0) };
            let aim = aim + sway - aside.clamp_length_max(MOST_STRIDE) * begun;
            moved(exactness * turns[step], middle[step], middle[step].lerp(aim, exactness))
        };
        Self((0..track.len()).map(pose).collect())
    }

    /// Where it puts the walk's beginning; from now on it begins there.
    pub fn begin(&mut self) -> GroundPose {
        let Some(&first) = self.0.first() else { return GroundPose::IDENTITY };
        let back = first.inverse();
        self.0.iter_mut().for_each(|pose| *pose = pose.after(&back));
        first
    }

    /// Bends a walk so that it ends at `place`, turned by `turn` more than it would be.
    pub fn to_place(place: Vec2, turn: f32, track: &[Vec3], fps: f32, exactness: f32) -> Self {
        if track.len() < 2 || exactness <= 0.0 {
            return Self::default();
        }
        let track: Vec<Vec2> = track.iter().map(|point| point.xz()).collect();
        let way = Way::of(&track, fps);
        let last = track.len() - 1;
        let steps = way.budget[last];
        let turn = exactness * turn.clamp(-MOST_TURN * steps, MOST_TURN * steps);
        // Turned evenly, step by step; then what is missing, as evenly.
        let share = |step: usize| way.budget[step] / steps.max(1e-6);
        let turns: Vec<f32> = (0..=last).map(|step| turn * share(step)).collect();
        let own = Way { steps: track.windows(2).map(|pair| pair[1] - pair[0]).collect(), points: track.clone(), ..way };
        let rolled = own.rolled(&turns);
        let wanted = track[last].lerp(place, exactness);
        let missing = (wanted - rolled[last]).clamp_length_max(MOST_STRIDE * steps);
        let share = |step: usize| own.budget[step] / steps.max(1e-6);
        let pose = |step: usize| moved(turns[step], track[step], rolled[step] + missing * share(step));
        Self((0..=last).map(pose).collect())
    }
}

/// A turn by `turn` about `from`, which is then at `to`.
fn moved(turn: f32, from: Vec2, to: Vec2) -> GroundPose {
    let turned = GroundPose { turn: turn_of(turn), shift: Vec2::ZERO };
    GroundPose { shift: to - turned.rotate(from), ..turned }
}

/// Which way a curve leads at an arc length: a unit vector.
fn tangent(curve: &Curve, length: f64) -> Vec2 {
    (curve.at(length + TANGENT) - curve.at(length - TANGENT)).xz().normalize_or(Vec2::Y)
}

/// A walk's way without its sway.
struct Way {
    points: Vec<Vec2>,
    /// From each point to the next.
    steps: Vec<Vec2>,
    /// Metres a second at each point.
    speeds: Vec<f32>,
    /// Steps of the body up to each point.
    budget: Vec<f32>,
    fps: f32,
}

impl Way {
    fn of(track: &[Vec2], fps: f32) -> Self {
        let points = smooth(track, SWAY * fps);
        let steps: Vec<Vec2> = points.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let last = steps.len() - 1;
        let speed = |at: usize| (steps[at.saturating_sub(1)] + steps[at.min(last)]).length() * fps / 2.0;
        let speeds: Vec<f32> = (0..points.len()).map(speed).collect();
        let mut budget = vec![0.0];
        for pair in speeds.windows(2) {
            let walks = ((pair[0] + pair[1]) / 2.0 / WALKS).min(1.0);
            budget.push(budget[budget.len() - 1] + walks / (STEP * fps));
        }
        Self { points, steps, speeds, budget, fps }
    }

    /// By how much the body is turned at each point so that it goes along the curve, where it is at these arc lengths, and back
    /// to it from where it is.
    fn turns(&self, curve: &Curve, lengths: &[f64], at: &[Vec2], from: Option<f32>) -> Vec<f32> {
        let last = self.steps.len() - 1;
        let mut wanted: Vec<Option<f32>> = Vec::with_capacity(lengths.len());
        let mut before = 0.0;
        for (at, (&length, place)) in lengths.iter().zip(at).enumerate() {
            let goes = self.steps[at.saturating_sub(1)] + self.steps[at.min(last)];
            let along = tangent(curve, length) + (curve.at(length).xz() - *place) / BACK;
            let turn = angle(along.x, along.y) - angle(goes.x, goes.y);
            wanted.push((self.speeds[at] > STANDS).then(|| {
                before += half_turn(turn - before);
                before
            }));
        }
        self.limited(&filled(&wanted, from), MOST_TURN, from)
    }

    /// Arc lengths at which the body is once it is turned so.
    fn lengths(&self, curve: &Curve, turns: &[f32], stretch: f32) -> Vec<f64> {
        let mut lengths = vec![0.0];
        for (at, step) in self.steps.iter().enumerate() {
            let length = lengths[at];
            let goes = GroundPose { turn: turn_of(turns[at]), shift: Vec2::ZERO }.rotate(*step);
            let along = goes.dot(tangent(curve, length)).max(0.0) * stretch;
            lengths.push((length + f64::from(along)).min(curve.length()));
        }
        lengths
    }

    /// Where the body is once it is turned so and brought as near to the curve as its strides may be changed.
    fn aims(&self, curve: &Curve, turns: &[f32], lengths: &[f64], from: Option<f32>) -> Vec<Vec2> {
        let rolled = self.rolled(turns);
        let limited = |of: fn(Vec2) -> f32| {
            let missing = rolled.iter().zip(lengths).map(|(point, &length)| of(curve.at(length).xz() - *point));
            // So much along each axis is as much as may be in between.
            self.limited(&missing.collect::<Vec<f32>>(), MOST_STRIDE * std::f32::consts::FRAC_1_SQRT_2, from)
        };
        let moved = limited(|missing| missing.x).into_iter().zip(limited(|missing| missing.y));
        rolled.iter().zip(moved).map(|(point, (x, z))| *point + Vec2::new(x, z)).collect()
    }

    /// Where the way leads once it is turned so.
    fn rolled(&self, turns: &[f32]) -> Vec<Vec2> {
        let mut rolled = vec![self.points[0]];
        for (at, step) in self.steps.iter().enumerate() {
            let turn = (turns[at] + turns[at + 1]) / 2.0;
            let goes = GroundPose { turn: turn_of(turn), shift: Vec2::ZERO }.rotate(*step);
            rolled.push(rolled[at] + goes);
        }
        rolled
    }

    /// Values near `values` that change by no more than `most` a step of the body, smooth; the first one is `from`, where that
    /// is said. The mean of the largest ones below and the smallest ones above that do so.
    fn limited(&self, values: &[f32], most: f32, from: Option<f32>) -> Vec<f32> {
        let mut values = values.to_vec();
        if let (Some(from), Some(first)) = (from, values.first_mut()) {
            *first = from;
        }
        let (mut low, mut high) = (values.clone(), values);
        let mut pass = |at: usize, beside: usize| {
            let room = most * (self.budget[at] - self.budget[beside]).abs();
            low[at] = low[at].max(low[beside] - room);
            high[at] = high[at].min(high[beside] + room);
        };
        (1..self.budget.len()).for_each(|at| pass(at, at - 1));
        (0..self.budget.len() - 1).rev().for_each(|at| pass(at, at + 1));
        let middle = |at: usize| {
            let middle = (low[at] + high[at]) / 2.0;
            let room = most * self.budget[at];
            Vec2::new(from.map_or(middle, |from| middle.clamp(from - room, from + room)), 0.0)
        };
        let middles: Vec<Vec2> = (0..self.budget.len()).map(middle).collect();
        smooth(&middles, SPREAD * self.fps).into_iter().map(|value| value.x).collect()
    }
}

/// Values between those that are known, on straight lines; `first`, where it is said, is known.
fn filled(values: &[Option<f32>], first: Option<f32>) -> Vec<f32> {
    let mut known: Vec<(usize, f32)> =
        values.iter().enumerate().filter_map(|(at, value)| Some((at, (*value)?))).collect();
    if let Some(first) = first
        && known.first().is_none_or(|known| known.0 > 0)
    {
        known.insert(0, (0, first));
    }
    let mut next = 0;
    (0..values.len())
        .map(|at| {
            while next < known.len() && known[next].0 < at {
                next += 1;
            }
            match (next.checked_sub(1).map(|before| known[before]), known.get(next)) {
                (Some((a, before)), Some(&(b, after))) => before + (after - before) * (at - a) as f32 / (b - a) as f32,
                (Some((_, value)), None) | (None, Some(&(_, value))) => value,
                (None, None) => 0.0,
            }
        })
        .collect()
}

/// Points, each the mean of those around it with the weights of a normal distribution; the ends stay, for beyond them points
/// are reflected.
fn smooth(points: &[Vec2], sigma: f32) -> Vec<Vec2> {
    let last = points.len() as isize - 1;
    let at = |index: isize| match index {
        ..0 => 2.0 * points[0] - points[index.unsigned_abs().min(last as usize)],
        _ if index > last => 2.0 * points[last as usize] - points[(2 * last - index).max(0) as usize],
        _ => points[index as usize],
    };
    let weights: Vec<f32> =
        (0..=(3.0 * sigma) as isize).map(|away| exp(-0.5 * (away as f32 / sigma).powi(2))).collect();
    let total = 2.0 * weights.iter().sum::<f32>() - weights[0];
    let mean = |index: isize| {
        let mut sum = at(index) * weights[0];
        for (away, &weight) in (1..).zip(&weights[1..]) {
            sum += (at(index - away) + at(index + away)) * weight;
        }
        sum / total
    };
    (0..=last).map(mean).collect()
}
