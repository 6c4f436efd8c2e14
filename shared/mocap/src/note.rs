//! What whoever drives should know of a clip.

use std::fmt;

/// What was assumed of a clip, or left out of it. Shown, it is a sentence without its end.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Note {
    /// Its files have no rate: so many frames a second are assumed.
    Rate(f32),
    /// The unit was told from how tall the skeleton would be.
    Unit {
        /// The unit's name.
        name: &'static str,
        /// How tall the skeleton is then, in metres.
        tall: f32,
    },
    /// Its first frame was left out.
    First,
}

impl Note {
    /// One word for its kind.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Self::Rate(_) => "rate",
            Self::Unit { .. } => "unit",
            Self::First => "first",
        }
    }
}

impl fmt::Display for Note {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Rate(rate) => write!(out, "AMC files have no rate: {rate} frames a second are assumed"),
            Self::Unit { name, tall } => {
                write!(out, "lengths are taken for {name}, for the skeleton is then {tall:.2} m tall")
            }
            Self::First => out
                .write_str("the first frame is no motion but the pose in which the skeleton was bound: it is left out"),
        }
    }
}
