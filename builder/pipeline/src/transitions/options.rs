//! How transitions are chosen, and their lengths in frames.

use actor::timeline::{Sequence, Timeline};
use job::Stopped;
use thiserror::Error;

/// Which segment lengths (li, lj) a pair of frames gets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LengthChoice {
    /// Those of the least sum of pose distances (TVCG equation 8; thesis equation 2.57). Ties: the shorter transition,
    /// then the shorter source segment, then the shorter destination segment.
    #[default]
    Total,
    /// Those of the least mean, the sum over the number of nodes (thesis equation 2.50). Ties as above, after the sum.
    Mean,
    /// Those of the least haste: what the blend adds to the motion, with the time it takes ([`HASTE_SPEED`]). Ties: the
    /// smaller sum, then as above. Not in the papers.
    Haste,
}

/// The speed w in radians a second by which a blend may move the surface from one side to the other: with d the mean
/// distance along a warp and T its seconds, [`LengthChoice::Haste`] takes the least d^2 / (w^2 T) + T, so that T is d / w
/// where d does not depend on the length.
///
/// With the weight's derivative lambda', what a blend adds to the motion is lambda' d radians a second (`docs/method.md`).
/// Its square over the whole transition is 6/5 d^2 / T.
pub const HASTE_SPEED: f64 = 0.7;

impl LengthChoice {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Total, Self::Mean, Self::Haste];

    /// A word for it.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Total => "sum",
            Self::Mean => "mean",
            Self::Haste => "haste",
        }
    }
}

/// How transitions are chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransitionOptions {
    /// Shortest segment in seconds; a part of a frame counts as a frame.
    pub shortest_seconds: f32,
    /// Longest segment in seconds; a part of a frame does not count.
    pub longest_seconds: f32,
    /// The slope limit p >= 1 of thesis equation 2.53: after a diagonal step at most p - 1 straight ones. `None` for
    /// paths without a limit (thesis equation 2.52).
    pub slope: Option<u8>,
    /// Which lengths a pair gets.
    pub choice: LengthChoice,
}

impl Default for TransitionOptions {
    /// Segments of 0.3 to 2 seconds (the papers' 15 to 100 frames at 50 fps, 8 to 48 at 24 fps) and p = 3.
    fn default() -> Self {
        Self { shortest_seconds: 0.3, longest_seconds: 2.0, slope: Some(3), choice: LengthChoice::Total }
    }
}

/// Why there are no transitions.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum TransitionError {
    /// The distances are of another capture.
    #[error("there are distances of {distances} frames, but the capture has {frames}")]
    FrameCount {
        /// Frames of the distance matrix.
        distances: usize,
        /// Frames of the capture.
        frames: usize,
    },
    /// The segment lengths are not lengths.
    #[error("segments of {shortest} to {longest} seconds: both must be positive, the first not above the second")]
    Lengths {
        /// Shortest segment in seconds.
        shortest: f32,
        /// Longest segment in seconds.
        longest: f32,
    },
    /// The longest segment has too many frames.
    #[error("segments of {0} frames are too long: at most {max} frames", max = Lengths::MAX)]
    TooLong(f32),
    /// The slope limit is zero or beyond what is meant by a limit.
    #[error("a slope limit of {0}: it must be between 1 and {max}", max = TransitionOptions::MAX_SLOPE)]
    Slope(u8),
    /// A distance is negative, not a number or absurdly large.
    #[error("the distance between frames {0} and {1} is negative, not a number or too large")]
    Distance(usize, usize),
    /// It was asked to stop.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// What was found cannot be kept in the work folder.
    #[error("cannot use the work folder: {0}")]
    Work(#[from] std::io::Error),
    /// No path of the slope limit joins the corners of a grid of these lengths, or the segments leave their sequences.
    #[error("there is no transition of {li} to {lj} frames from frame {from} to frame {to}")]
    NoTransition {
        /// Frame i.
        from: u32,
        /// Frame j.
        to: u32,
        /// Source length in frames.
        li: usize,
        /// Destination length in frames.
        lj: usize,
    },
}

impl TransitionOptions {
    /// The largest slope limit; beyond it, take none.
    pub const MAX_SLOPE: u8 = 5;

    /// The segment lengths in frames.
    ///
    /// # Errors
    /// Options that make no sense.
    pub fn lengths(&self, timeline: &Timeline) -> Result<Lengths, TransitionError> {
        let (shortest, longest) = (self.shortest_seconds, self.longest_seconds);
        if !(shortest > 0.0 && shortest <= longest && longest.is_finite()) {
            return Err(TransitionError::Lengths { shortest, longest });
        }
        if let Some(slope) = self.slope.filter(|slope| !(1..=Self::MAX_SLOPE).contains(slope)) {
            return Err(TransitionError::Slope(slope));
        }
        // 0.3 s is 15 frames at 50 fps, whatever 0.3 is in binary.
        let slack = 1e-3;
        let least = (shortest * timeline.fps() - slack).ceil().max(1.0);
        let most = (longest * timeline.fps() + slack).floor().max(least);
        if most > Lengths::MAX as f32 {
            return Err(TransitionError::TooLong(most));
        }
        Ok(Lengths { shortest: least as usize, longest: most as usize })
    }
}

/// Segment lengths in frames, both ends included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lengths {
    /// The shortest segment.
    pub shortest: usize,
    /// The longest segment.
    pub longest: usize,
}

impl Lengths {
    /// The longest segment that can be handled.
    pub const MAX: usize = 1000;

    /// The longest segment within `sequence` that starts at `frame`; cyclic sequences wrap, once around at most.
    pub(super) fn longest_from(self, sequence: &Sequence, frame: u32) -> usize {
        let rest = if sequence.cyclic { sequence.frame_count } else { sequence.end_frame() - frame };
        self.longest.min(rest as usize)
    }
}
