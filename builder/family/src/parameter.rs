//! What tells the members of a family apart.

use std::fmt;

/// The number by which a family is asked for motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameter {
    /// Metres a second along the way.
    Speed,
    /// Turn per length of the way, in radians a metre; to the left (from +Z towards +X) is positive.
    Turn,
    /// How far the centre of mass rises in a jump above where it is while standing, in metres.
    Height,
    /// From where the feet leave to where they land, along the ground in metres.
    Length,
}

impl Parameter {
    /// Its unit.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Speed => "m/s",
            Self::Turn => "1/m",
            Self::Height | Self::Length => "m",
        }
    }

    /// Whether it is one of jumps; otherwise of steps that repeat.
    #[must_use]
    pub fn is_of_jumps(self) -> bool {
        matches!(self, Self::Height | Self::Length)
    }

    /// Values nearer than this are one.
    #[must_use]
    pub fn grain(self) -> f32 {
        match self {
            Self::Speed | Self::Turn => 0.05,
            Self::Height | Self::Length => 0.02,
        }
    }

    /// A value with its unit, as labels have it.
    #[must_use]
    pub fn told(self, value: f32) -> String {
        // No minus before what is nothing.
        let value = if value.abs() < 0.005 { 0.0 } else { value };
        format!("{value:.2} {}", self.unit())
    }
}

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Speed => "speed",
            Self::Turn => "turn",
            Self::Height => "height",
            Self::Length => "length",
        })
    }
}
