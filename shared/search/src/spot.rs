//! Placements as searches add them up: the turn as cosine and sine, so that no edge costs a trigonometric function.

use glam::{Vec2, Vec3};

use kernels::align::Placement;

/// A [`Placement`] with its turn as (cosine, sine) of the heading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Cosine and sine of the heading.
    pub turn: Vec2,
    /// Translation in metres along (X, Z).
    pub shift: Vec2,
}

impl Spot {
    /// Leaves everything where it is.
    pub const IDENTITY: Self = Self { turn: Vec2::X, shift: Vec2::ZERO };

    /// `v`, an (X, Z) vector, turned.
    #[must_use]
    pub fn rotate(&self, v: Vec2) -> Vec2 {
        let Vec2 { x: cos, y: sin } = self.turn;
        Vec2::new(cos * v.x + sin * v.y, cos * v.y - sin * v.x)
    }

    /// Where `point` goes.
    #[must_use]
    pub fn apply(&self, point: Vec3) -> Vec3 {
        let ground = self.rotate(Vec2::new(point.x, point.z)) + self.shift;
        Vec3::new(ground.x, point.y, ground.y)
    }

    /// First `inner`, then `self`.
    #[must_use]
    pub fn after(&self, inner: &Self) -> Self {
        let Vec2 { x: cos, y: sin } = self.turn;
        let turn = Vec2::new(cos * inner.turn.x - sin * inner.turn.y, sin * inner.turn.x + cos * inner.turn.y);
        Self { turn, shift: self.rotate(inner.shift) + self.shift }
    }

    /// The heading in radians, between -pi and pi.
    #[must_use]
    pub fn heading(&self) -> f32 {
        angle(self.turn.y, self.turn.x)
    }

    /// A turn by `heading` about the vertical line through `from`, then a move that takes `from` to `to`; both (X, Z).
    #[must_use]
    pub fn turning(heading: f32, from: Vec2, to: Vec2) -> Self {
        Self::from(&Placement::turning(heading, from, to))
    }
}

impl From<&Placement> for Spot {
    fn from(placement: &Placement) -> Self {
        Self { turn: turn_of(placement.heading), shift: placement.translation }
    }
}

impl From<Spot> for Placement {
    fn from(spot: Spot) -> Self {
        Self { heading: spot.heading(), translation: spot.shift }
    }
}

/// The same angle between -pi and pi.
#[must_use]
pub fn half_turn(angle: f32) -> f32 {
    let turns = (angle / std::f32::consts::TAU).round();
    angle - turns * std::f32::consts::TAU
}

/// Cosine and sine of an angle in radians. Not the platform's, which need not agree to the last bit: plans are the same in
/// a browser and outside.
#[must_use]
pub(super) fn turn_of(angle: f32) -> Vec2 {
    use std::f64::consts::FRAC_PI_2;
    let quarters = (f64::from(angle) / FRAC_PI_2).round();
    let x = f64::from(angle) - quarters * FRAC_PI_2;
    let square = x * x;
    let series = |first: f64, terms: [f64; 4]| terms.iter().rev().fold(0.0, |sum, term| (sum + term) * square) + first;
    let sin = x * series(1.0, [-1.0 / 6.0, 1.0 / 120.0, -1.0 / 5040.0, 1.0 / 362_880.0]);
    let cos = series(1.0, [-0.5, 1.0 / 24.0, -1.0 / 720.0, 1.0 / 40_320.0]);
    let (cos, sin) = match (quarters as i64).rem_euclid(4) {
        0 => (cos, sin),
        1 => (-sin, cos),
        2 => (-cos, -sin),
        _ => (sin, -cos),
    };
    Vec2::new(cos as f32, sin as f32)
}

/// The angle whose tangent is y / x, between -pi and pi.
///
/// This work is based on: Abramowitz and Stegun, Handbook of Mathematical Functions, 4.4.49 (error below 2e-8).
#[must_use]
pub(super) fn angle(y: f32, x: f32) -> f32 {
    use std::f64::consts::{FRAC_PI_2, PI};
    const TERMS: [f64; 8] = [
        -0.333_331_452_8,
        0.199_935_508_5,
        -0.142_088_994_4,
        0.106_562_639_3,
        -0.075_289_640_0,
        0.042_909_613_8,
        -0.016_165_736_7,
        0.002_866_225_7,
    ];
    let (y, x) = (f64::from(y), f64::from(x));
    let (least, most) = (x.abs().min(y.abs()), x.abs().max(y.abs()));
    let tangent = if most > 0.0 { least / most } else { 0.0 };
    let square = tangent * tangent;
    let first = tangent * (TERMS.iter().rev().fold(0.0, |sum, term| (sum + term) * square) + 1.0);
    let first = if y.abs() > x.abs() { FRAC_PI_2 - first } else { first };
    let half = if x < 0.0 { PI - first } else { first };
    (if y < 0.0 { -half } else { half }) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_the_platforms() {
        for step in -2000..2000 {
            let heading = step as f32 * 0.01;
            let turn = turn_of(heading);
            assert!((turn.y - heading.sin()).abs() < 3e-7 && (turn.x - heading.cos()).abs() < 3e-7, "{heading}");
            assert!(
                (angle(turn.y, turn.x) - half_turn(heading)).abs() < 2e-6
                    || half_turn(heading).abs() > std::f32::consts::PI - 1e-3
            );
            let (y, x) = (heading, 3.0 - heading * heading);
            assert!((angle(y, x) - y.atan2(x)).abs() < 3e-7, "{y} {x}");
        }
        assert_eq!(angle(0.0, 0.0), 0.0);
    }
}
