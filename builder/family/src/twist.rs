//! A move over the ground by a steady turn and step: what repeats from cycle to cycle.

use glam::Vec2;
use kernels::align::{Placement, rotate};

/// Turn and step over one cycle, both at a steady rate: an arc, or a straight line where there is no turn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Twist {
    /// Turn about +Y in radians.
    pub turn: f32,
    /// Step in metres along (X, Z), in axes that turn along.
    pub step: Vec2,
}

/// Turns smaller than this are none, in radians.
const NO_TURN: f32 = 1e-4;

impl Twist {
    /// The one that leads to `end` by less than half a turn.
    #[must_use]
    pub fn to(end: &Placement) -> Self {
        use std::f32::consts::{PI, TAU};
        let turn = (end.heading + PI).rem_euclid(TAU) - PI;
        let (along, aside) = parts(turn);
        let (t, norm) = (end.translation, along * along + aside * aside);
        let step = Vec2::new(along * t.x - aside * t.y, aside * t.x + along * t.y) / norm;
        Self { turn, step }
    }

    /// Where it has led to; `self` times a share of the cycle is where it has led to by then.
    #[must_use]
    pub fn placement(&self) -> Placement {
        let (along, aside) = parts(self.turn);
        let Vec2 { x, y: z } = self.step;
        Placement { heading: self.turn, translation: Vec2::new(along * x + aside * z, along * z - aside * x) }
    }

    /// A share of it.
    #[must_use]
    pub fn times(&self, share: f32) -> Self {
        Self { turn: self.turn * share, step: self.step * share }
    }

    /// Both, one after the other in small pieces by turns.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self { turn: self.turn + other.turn, step: self.step + other.step }
    }

    /// The same move seen in axes turned by `heading`.
    #[must_use]
    pub fn turned(&self, heading: f32) -> Self {
        Self { step: rotate(heading, self.step), ..*self }
    }
}

/// Integrals of the cosine and the sine over a turn: how much of a step leads on, and aside.
fn parts(turn: f32) -> (f32, f32) {
    if turn.abs() < NO_TURN { (1.0, turn / 2.0) } else { (turn.sin() / turn, (1.0 - turn.cos()) / turn) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn small_steps_add_up_to_the_placement() {
        for turn in [0.0, 1e-5, 0.8, -2.5] {
            let end = Placement { heading: turn, translation: Vec2::new(0.4, 1.3) };
            let twist = Twist::to(&end);
            let small = twist.times(1e-2).placement();
            let steps = (0..100).fold(Placement::IDENTITY, |at, _| at.after(&small));
            for found in [steps, twist.placement()] {
                let apart = found.apply(Vec3::ONE).distance(end.apply(Vec3::ONE));
                assert!(apart < 1e-4, "{turn}: {apart}");
            }
        }
    }
}
