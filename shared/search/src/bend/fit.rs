//! The least change of a way that brings it onto a curve.
//!
//! Unknown are the place of the body's middle after each step and by how much it is turned there. Wanted are places on the
//! curve; each step's turn and each step's shift from where the turned step would lead count in shares of what a step may be
//! changed by, more and more above that; and both come and go softly. Where along the curve a place belongs is where it is
//! nearest, found anew after each least-squares solution (Gauss and Newton's method, as in the registration of scans).

use glam::{DVec2, Vec2, Vec3Swizzles};
use kernels::band::Band;

use super::limits::{MOST_STRIDE, MOST_TURN, STEP};
use super::way::Way;
use crate::curve::Curve;
use crate::ground_pose::turn_of;

/// Solutions before the places on the curve are taken to be known.
const PASSES: usize = 12;
/// Metres off the curve that count as much as a step that is changed by as much as may be.
const OFF: f64 = 0.012;
/// The same for the ends along the curve.
const END_OFF: f64 = 0.03;
/// Metres along the curve to both sides in which the nearest point is looked for.
const WINDOW: f64 = 0.5;
/// Metres by which no place moves any more once they are known.
const ENOUGH: f64 = 5e-4;
/// Seconds in which changes come and go.
const SOFT: f64 = 0.12;
/// Standing bodies are changed by this share of what walking ones are.
const STANDING: f32 = 0.02;
/// How steeply what is above the limits counts.
const STEEP: i32 = 6;
/// What a start that is given counts as: it stays.
const FIXED: f64 = 1e5;

/// Where the body's middle is after each step, and by how much it is turned.
pub(super) struct Fitted {
    pub places: Vec<Vec2>,
    pub turns: Vec<f32>,
    /// Where along the curve it is.
    pub lengths: Vec<f64>,
}

/// A way that is being fitted onto a curve, a pass at a time.
#[derive(Clone, Debug)]
pub(super) struct Fit {
    way: Way,
    is_free: bool,
    pass: usize,
    places: Vec<DVec2>,
    turns: Vec<f64>,
    lengths: Vec<f64>,
    /// By how much each step may be changed, as a share of a whole step of a body that walks.
    rooms: Vec<f64>,
    /// How much the turn and the shift of each step count.
    weights: Vec<[f64; 2]>,
}

impl Fit {
    /// Of `way` onto `curve` by the share `exactness` of what steps may be changed by; where it is not `is_free`, it begins as
    /// it does. All its functions want the same curve.
    pub fn new(way: Way, curve: &Curve, exactness: f32, is_free: bool) -> Self {
        let gone: Vec<f64> = way
            .steps
            .iter()
            .scan(0.0, |gone, step| {
                *gone += f64::from(step.length());
                Some(*gone)
            })
            .collect();
        let total = gone.last().copied().unwrap_or(0.0).max(1e-3);
        let stretch = (curve.length() / total).clamp(0.8, 1.25);
        let lengths = std::iter::once(0.0).chain(gone).map(|gone| (gone * stretch).min(curve.length())).collect();
        let least = STANDING / (STEP * way.fps);
        Self {
            is_free,
            pass: 0,
            places: way.points.iter().map(|point| point.as_dvec2()).collect(),
            turns: vec![0.0; way.points.len()],
            lengths,
            rooms: way.budget.windows(2).map(|pair| f64::from(exactness * (pair[1] - pair[0]).max(least))).collect(),
            weights: vec![[1.0; 2]; way.steps.len()],
            way,
        }
    }

    /// One pass; whether it was the last.
    pub fn advance(&mut self, curve: &Curve) -> bool {
        self.project(curve);
        let enough = self.solve(curve) < ENOUGH && self.pass > 2;
        self.pass += 1;
        enough || self.pass >= PASSES
    }

    /// What came of it.
    pub fn finish(mut self, curve: &Curve) -> (Fitted, Way) {
        self.project(curve);
        let fitted = Fitted {
            places: self.places.iter().map(|place| place.as_vec2()).collect(),
            turns: self.turns.iter().map(|&turn| turn as f32).collect(),
            lengths: self.lengths,
        };
        (fitted, self.way)
    }

    /// Where along the curve each place is nearest, near where it was, and never further back than the one before.
    fn project(&mut self, curve: &Curve) {
        let mut before = 0.0;
        for (place, length) in self.places.iter().zip(&mut self.lengths) {
            let from = (*length - WINDOW).max(before);
            let to = (*length + WINDOW).min(curve.length()).max(from);
            *length = curve.nearest_length(place.as_vec2(), from, to);
            before = *length;
        }
    }

    fn turned(&self, step: usize) -> (DVec2, DVec2) {
        let turn = turn_of(((self.turns[step] + self.turns[step + 1]) / 2.0) as f32).as_dvec2();
        let way = self.way.steps[step].as_dvec2();
        let goes = DVec2::new(turn.x * way.x + turn.y * way.y, turn.x * way.y - turn.y * way.x);
        // By the angle.
        (goes, DVec2::new(goes.y, -goes.x))
    }

    fn shift(&self, step: usize) -> DVec2 {
        self.places[step + 1] - self.places[step] - self.turned(step).0
    }

    /// One solution; the largest change of a place in metres.
    fn solve(&mut self, curve: &Curve) -> f64 {
        let count = self.places.len();
        let soft = SOFT * f64::from(self.way.fps);
        let mut band = Band::new(3 * count);
        for at in 0..count {
            let along = curve.direction(self.lengths[at]).as_dvec2();
            let off = self.places[at] - curve.at(self.lengths[at]).xz().as_dvec2();
            let aside = along.perp();
            band.add(3 * at, &[aside.x, aside.y, 0.0], aside.dot(off), 1.0 / OFF);
            let is_end = at + 1 == count || at == 0 && self.is_free;
            if is_end {
                let end = curve.at(if at == 0 { 0.0 } else { curve.length() }).xz().as_dvec2();
                let missing = along.dot(self.places[at] - end);
                // What cannot be reached pulls no harder than what can.
                let weight = (f64::from(self.way.fps) / 2.0).sqrt() / missing.abs().max(END_OFF);
                band.add(3 * at, &[along.x, along.y, 0.0], missing, weight);
            }
        }
        if !self.is_free {
            for (unknown, residual) in [
                self.places[0].x - f64::from(self.way.points[0].x),
                self.places[0].y - f64::from(self.way.points[0].y),
                self.turns[0],
            ]
            .into_iter()
            .enumerate()
            {
                band.add(unknown, &[1.0], residual, FIXED);
            }
        }
        for step in 0..count - 1 {
            let [turn, shift] = self.limits(step);
            let [of_turn, of_shift] = self.weights[step];
            let turned = self.turns[step + 1] - self.turns[step];
            band.add(3 * step + 2, &[-1.0, 0.0, 0.0, 1.0], turned, of_turn / turn);
            let now = Rows::of(self, step);
            now.add(&mut band, 3 * step, of_shift / shift);
            if step + 2 < count {
                let next = self.limits(step + 1);
                let turned = self.turns[step + 2] - self.turns[step + 1] - turned;
                let softly = [soft / turn.max(next[0]), soft / shift.max(next[1])];
                band.add(3 * step + 2, &[1.0, 0.0, 0.0, -2.0, 0.0, 0.0, 1.0], turned, softly[0]);
                now.minus(&Rows::of(self, step + 1)).add(&mut band, 3 * step, softly[1]);
            }
        }
        let found = band.solve();
        let mut most = 0.0_f64;
        for (at, change) in found.chunks_exact(3).enumerate() {
            let moved = DVec2::new(change[0], change[1]);
            most = most.max(moved.length_squared());
            self.places[at] += moved;
            self.turns[at] += change[2];
        }
        for step in 0..count - 1 {
            let [turn, shift] = self.limits(step);
            let used = [(self.turns[step + 1] - self.turns[step]).abs() / turn, self.shift(step).length() / shift];
            for (weight, used) in self.weights[step].iter_mut().zip(used) {
                // Half way, or solutions would go to and fro.
                *weight = (*weight * (1.0 + used.powi(STEEP)).min(1e4)).sqrt().max(1.0);
            }
        }
        most.sqrt()
    }

    fn limits(&self, step: usize) -> [f64; 2] {
        [f64::from(MOST_TURN) * self.rooms[step], f64::from(MOST_STRIDE) * self.rooms[step]]
    }
}

/// A shift and what it changes by with the unknowns of three places in a row: along x and along z.
struct Rows {
    value: DVec2,
    of: [[f64; 9]; 2],
}

impl Rows {
    /// The shift of a step.
    fn of(fit: &Fit, step: usize) -> Self {
        let by_turn = fit.turned(step).1 / 2.0;
        let mut of = [[0.0; 9]; 2];
        for (axis, row) in of.iter_mut().enumerate() {
            (row[axis], row[3 + axis]) = (-1.0, 1.0);
            (row[2], row[5]) = (-by_turn[axis], -by_turn[axis]);
        }
        Self { value: fit.shift(step), of }
    }

    /// The next step's less this one's.
    fn minus(&self, next: &Self) -> Self {
        let mut of = [[0.0; 9]; 2];
        for axis in 0..2 {
            for column in 0..9 {
                let later = if column >= 3 { next.of[axis][column - 3] } else { 0.0 };
                of[axis][column] = later - self.of[axis][column];
            }
        }
        Self { value: next.value - self.value, of }
    }

    fn add(&self, band: &mut Band, first: usize, weight: f64) {
        for axis in 0..2 {
            let known = self.of[axis].iter().rposition(|&value| value != 0.0).map_or(0, |last| last + 1);
            band.add(first, &self.of[axis][..known], self.value[axis], weight);
        }
    }
}
