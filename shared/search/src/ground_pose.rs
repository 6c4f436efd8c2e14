//! Placements as searches add them up: the turn as cosine and sine, so that no edge costs a trigonometric function.

use glam::{Vec2, Vec3};

use kernels::align::Placement;
use kernels::scalar::sin_cos;
pub(super) use kernels::scalar::{atan2 as angle, half_turn};

/// A [`Placement`] with its turn as (cosine, sine) of the heading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundPose {
    /// Cosine and sine of the heading.
    pub turn: Vec2,
    /// Translation in metres along (X, Z).
    pub shift: Vec2,
}

impl GroundPose {
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

    /// What takes everything back.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let back = Self { turn: Vec2::new(self.turn.x, -self.turn.y), shift: Vec2::ZERO };
        Self { shift: -back.rotate(self.shift), ..back }
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

impl From<&Placement> for GroundPose {
    fn from(placement: &Placement) -> Self {
        Self { turn: turn_of(placement.heading), shift: placement.translation }
    }
}

impl From<GroundPose> for Placement {
    fn from(ground_pose: GroundPose) -> Self {
        Self { heading: ground_pose.heading(), translation: ground_pose.shift }
    }
}

/// Cosine and sine of an angle in radians. Not the platform's, which need not agree to the last bit: plans are the same in
/// a browser and outside.
#[must_use]
pub(super) fn turn_of(angle: f32) -> Vec2 {
    let (sin, cos) = sin_cos(angle);
    Vec2::new(cos, sin)
}
