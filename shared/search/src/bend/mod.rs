//! Walks that are bent onto their path: no walk through the graph lies on a drawn curve; small turns and stretches of stride,
//! spread over it, bring it there.
//!
//! Not in the papers. Each step of a walk is turned and moved as little as brings the walk onto its curve ([`mod@fit`]), and the
//! sway of its middle is taken off. All of it is rigid, one placement a step: what stands meanwhile is the player's to keep
//! (`shared/synthesis/src/bend.rs`). Hardly a step is changed by more than [`MOST_TURN`] and [`MOST_STRIDE`]; what that is not
//! enough for stays. Searches look for walks that can be bent ([`super::steer`]).

mod fit;
pub(super) mod limits;
mod way;

use glam::{Vec2, Vec3, Vec3Swizzles};
use kernels::align::Placement;

use super::curve::Curve;
use super::ground_pose::{GroundPose, turn_of};
use fit::{Fit, Fitted};
use limits::{MOST_STRIDE, MOST_TURN};
use way::{Way, smooth};

/// Less exactness bends nothing: a tenth of a degree a step is not seen, and sums with such limits cannot be solved.
const LEAST: f32 = 0.01;
/// Seconds over which a body's middle is smooth.
const MIDDLE: f32 = 0.06;

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

/// A walk that is being bent onto a curve, some milliseconds at a time.
#[derive(Clone, Debug)]
pub(super) struct Bending {
    track: Vec<Vec2>,
    exactness: f32,
    is_free: bool,
    fit: Fit,
}

impl Bending {
    /// Of a walk whose middle is at `track` after each step, `fps` steps a second, onto `curve`, by the share `exactness` of what
    /// may be. Where it `is_free`, it may begin elsewhere. `None` where nothing is to be bent. All its functions want the same
    /// curve.
    pub fn new(curve: &Curve, track: &[Vec3], fps: f32, exactness: f32, is_free: bool) -> Option<Self> {
        if track.len() < 2 || exactness < LEAST {
            return None;
        }
        let track: Vec<Vec2> = track.iter().map(|point| point.xz()).collect();
        let fit = Fit::new(Way::of(&track, fps), curve, exactness, is_free);
        Some(Self { track, exactness, is_free, fit })
    }

    /// One pass; whether it was the last.
    pub fn advance(&mut self, curve: &Curve) -> bool {
        self.fit.advance(curve)
    }

    /// What came of it.
    pub fn finish(self, curve: &Curve) -> Bend {
        let Self { track, exactness, is_free, fit } = self;
        let (Fitted { places, turns, lengths }, way) = fit.finish(curve);
        let middle = smooth(&track, MIDDLE * way.fps);
        let pose = |step: usize| {
            let turn = GroundPose { turn: turn_of(turns[step]), shift: Vec2::ZERO };
            // Sway along the way is how the body walks; what leads aside is taken off, once it is under way.
            let sway = turn.rotate(middle[step] - way.points[step]);
            let along = curve.direction(lengths[step]);
            let aside = sway - along * sway.dot(along);
            let begun = if is_free { 1.0 } else { way.budget[step].min(1.0) };
            let aim = places[step] + sway - aside.clamp_length_max(MOST_STRIDE) * begun * exactness;
            moved(turns[step], middle[step], aim)
        };
        Bend((0..track.len()).map(pose).collect())
    }
}

/// A turn by `turn` about `from`, which is then at `to`.
fn moved(turn: f32, from: Vec2, to: Vec2) -> GroundPose {
    let turned = GroundPose { turn: turn_of(turn), shift: Vec2::ZERO };
    GroundPose { shift: to - turned.rotate(from), ..turned }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::Shape;
    use fixtures::Random;

    /// A way that turns now and then, stands now and then, and sways.
    fn random_track(random: &mut Random, fps: f32) -> Vec<Vec3> {
        let (mut place, mut heading, mut track) = (Vec2::ZERO, random.range(-0.5, 0.5), Vec::new());
        for _ in 0..3 + random.below(5) {
            let (turn, speed) = (random.range(-2.0, 2.0), random.range(-0.5, 1.8_f32).max(0.0));
            for _ in 0..(random.range(0.3, 1.5) * fps) as usize {
                heading += turn / fps;
                place += Vec2::new(heading.sin(), heading.cos()) * (speed / fps);
                let sway = 0.02 * (track.len() as f32 / fps * 12.0).sin();
                let aside = Vec2::new(heading.cos(), -heading.sin()) * sway;
                track.push(Vec3::new(place.x + aside.x, 1.0, place.y + aside.y));
            }
        }
        track
    }

    fn onto(curve: &Curve, track: &[Vec3], exactness: f32, is_free: bool) -> Bend {
        let Some(mut bending) = Bending::new(curve, track, 50.0, exactness, is_free) else { return Bend::default() };
        while !bending.advance(curve) {}
        bending.finish(curve)
    }

    /// Root of the mean square of distances, which is what is made least.
    fn off(curve: &Curve, points: impl Iterator<Item = Vec3>) -> f64 {
        let (mut sum, mut count) = (0.0, 0);
        for point in points {
            let length = curve.nearest_length(point.xz(), 0.0, curve.length());
            let off = curve.distance(point, length);
            (sum, count) = (sum + off * off, count + 1);
        }
        (sum / f64::from(count)).sqrt()
    }

    #[test]
    fn no_walk_is_bent_away_from_its_path() {
        let mut random = Random::new(11);
        for case in 0..60 {
            let track = random_track(&mut random, 50.0);
            // The way with corners cut.
            let corners: Vec<Vec3> = track
                .iter()
                .step_by(40)
                .map(|point| *point + Vec3::new(random.range(-0.15, 0.15), 0.0, random.range(-0.15, 0.15)))
                .collect();
            let shape = if case % 2 == 0 { Shape::Polyline } else { Shape::Spline };
            let curve = Curve::new(&corners, shape, true, None);
            for is_free in [false, true] {
                let bend = onto(&curve, &track, 1.0, is_free);
                let before = off(&curve, track.iter().copied());
                let after = off(&curve, track.iter().zip(&bend.0).map(|(point, pose)| pose.apply(*point)));
                assert!(after < before + 0.002, "case {case}: {before:?} before, {after:?} after");
                for exactness in [1e-40, 1e-9, 0.01, 1.0] {
                    let bend = onto(&curve, &track, exactness, is_free);
                    assert!(bend.0.iter().all(|pose| pose.shift.is_finite() && pose.turn.is_finite()), "{exactness}");
                }
            }
        }
    }
}
