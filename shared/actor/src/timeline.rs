//! The sequences of a capture, laid end to end on one count of frames.

use std::sync::Arc;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::families::{Family, FamilyMember};

/// One recorded sequence: a run of consecutive frames.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Sequence {
    /// Name, as the capture gives it; unique within a capture.
    pub name: String,
    /// Behaviours that the sequence shows, for example `walk`.
    pub labels: Vec<String>,
    /// Its first frame, counted over the whole capture.
    pub first_frame: u32,
    /// Number of frames, at least 1.
    pub frame_count: u32,
    /// Whether its last frame is followed by its first one, so that windows wrap around its end.
    pub cyclic: bool,
}

impl Sequence {
    /// The frame after the last one, counted over the whole capture.
    #[must_use]
    pub fn end_frame(&self) -> u32 {
        self.first_frame + self.frame_count
    }

    /// Whether `frame` lies in this sequence.
    #[must_use]
    pub fn contains(&self, frame: u32) -> bool {
        (self.first_frame..self.end_frame()).contains(&frame)
    }

    /// The frame `steps` frames after `frame` within this sequence (before it where negative), wrapping if cyclic.
    ///
    /// `None` where the sequence does not reach that far.
    #[must_use]
    pub fn offset(&self, frame: u32, steps: i64) -> Option<u32> {
        debug_assert!(self.contains(frame));
        let local = i64::from(frame) - i64::from(self.first_frame) + steps;
        let count = i64::from(self.frame_count);
        let local = if self.cyclic { local.rem_euclid(count) } else { local };
        (0..count).contains(&local).then(|| self.first_frame + local as u32)
    }
}

/// All sequences of a capture on one count of frames, at one frame rate.
#[derive(Clone, Debug, PartialEq)]
pub struct Timeline {
    fps: f32,
    sequences: Vec<Sequence>,
    sequence_of_frame: Vec<u32>,
    /// Shared, for the page has many timelines and makes no family.
    families: Arc<[Family]>,
}

/// Why a list of sequences is not a timeline.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum TimelineError {
    /// The frame rate is not a positive, finite number.
    #[error("the frame rate is not a positive number")]
    FrameRate,
    /// There is no sequence at all.
    #[error("there is no sequence")]
    NoSequence,
    /// A sequence has no frame.
    #[error("sequence {0} has no frame")]
    EmptySequence(usize),
    /// A sequence does not begin where the one before it ends.
    #[error("sequence {0} does not begin where the one before it ends")]
    Gap(usize),
    /// More frames than this library counts.
    #[error("the capture has more than {} frames", Timeline::MAX_FRAMES)]
    TooManyFrames,
    /// A family has a member that is no part of the capture.
    #[error("family {0} has a member that is none of the sequences")]
    Family(usize),
}

impl Timeline {
    /// The largest number of frames of a capture that can be handled.
    pub const MAX_FRAMES: u32 = 1 << 20;

    /// A timeline of `sequences`, which must be contiguous from frame 0.
    ///
    /// # Errors
    /// A frame rate that is not positive, no sequence, an empty one, a gap, or more than [`Self::MAX_FRAMES`].
    pub fn new(fps: f32, sequences: Vec<Sequence>) -> Result<Self, TimelineError> {
        if !(fps.is_finite() && fps > 0.0) {
            return Err(TimelineError::FrameRate);
        }
        if sequences.is_empty() {
            return Err(TimelineError::NoSequence);
        }
        let mut sequence_of_frame = Vec::new();
        for (index, sequence) in sequences.iter().enumerate() {
            if sequence.frame_count == 0 {
                return Err(TimelineError::EmptySequence(index));
            }
            if sequence.first_frame as usize != sequence_of_frame.len() {
                return Err(TimelineError::Gap(index));
            }
            let end = sequence_of_frame.len() + sequence.frame_count as usize;
            if end > Self::MAX_FRAMES as usize {
                return Err(TimelineError::TooManyFrames);
            }
            sequence_of_frame.resize(end, index as u32);
        }
        Ok(Self { fps, sequences, sequence_of_frame, families: Arc::default() })
    }

    /// The same with the families of its sequences.
    ///
    /// # Errors
    /// A member that is no part of the sequence that it names, or whose parameter is no number.
    pub fn with_families(self, families: Vec<Family>) -> Result<Self, TimelineError> {
        let fits = |member: &FamilyMember| {
            let [first, last] = member.frames;
            let found = self.sequences.iter().find(|sequence| sequence.name == member.sequence);
            found.is_some_and(|sequence| sequence.contains(first) && sequence.contains(last))
                && first <= last
                && member.value.is_finite()
        };
        match families.iter().position(|family| !family.members.iter().all(fits)) {
            Some(wrong) => Err(TimelineError::Family(wrong)),
            None => Ok(Self { families: families.into(), ..self }),
        }
    }

    /// The families of its sequences.
    #[must_use]
    pub fn families(&self) -> &[Family] {
        &self.families
    }

    /// Frames per second.
    #[must_use]
    pub fn fps(&self) -> f32 {
        self.fps
    }

    /// The sequences, in the order of their frames.
    #[must_use]
    pub fn sequences(&self) -> &[Sequence] {
        &self.sequences
    }

    /// Number of frames of the whole capture.
    #[must_use]
    pub fn frame_count(&self) -> u32 {
        self.sequence_of_frame.len() as u32
    }

    /// Index of the sequence that holds `frame`; `None` beyond the capture.
    #[must_use]
    pub fn sequence_index(&self, frame: u32) -> Option<usize> {
        self.sequence_of_frame.get(frame as usize).map(|&index| index as usize)
    }

    /// The sequence that holds `frame`; `None` beyond the capture.
    #[must_use]
    pub fn sequence_of(&self, frame: u32) -> Option<&Sequence> {
        self.sequence_index(frame).map(|index| &self.sequences[index])
    }

    /// The frame `steps` frames after `frame` in its own sequence (before it where negative), wrapping if cyclic.
    #[must_use]
    pub fn offset(&self, frame: u32, steps: i64) -> Option<u32> {
        self.sequence_of(frame)?.offset(frame, steps)
    }

    /// The frame that was recorded right after `frame`, if any.
    #[must_use]
    pub fn next(&self, frame: u32) -> Option<u32> {
        self.offset(frame, 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sequence(first_frame: u32, frame_count: u32, cyclic: bool) -> Sequence {
        Sequence { name: format!("s{first_frame}"), labels: vec![], first_frame, frame_count, cyclic }
    }

    #[test]
    fn windows_wrap_only_in_cyclic_sequences() {
        let timeline = Timeline::new(50.0, vec![sequence(0, 4, false), sequence(4, 3, true)]).unwrap();
        assert_eq!(timeline.next(2), Some(3));
        assert_eq!(timeline.next(3), None);
        assert_eq!(timeline.next(6), Some(4));
        assert_eq!(timeline.offset(4, -1), Some(6));
        assert_eq!(timeline.offset(4, 7), Some(5));
        assert_eq!(timeline.next(7), None);
        assert_eq!(timeline.sequence_index(5), Some(1));
    }

    #[test]
    fn refuses_what_is_no_timeline() {
        assert_eq!(Timeline::new(0.0, vec![sequence(0, 1, false)]), Err(TimelineError::FrameRate));
        assert_eq!(Timeline::new(25.0, vec![]), Err(TimelineError::NoSequence));
        assert_eq!(Timeline::new(25.0, vec![sequence(0, 0, false)]), Err(TimelineError::EmptySequence(0)));
        let gap = vec![sequence(0, 2, false), sequence(3, 2, false)];
        assert_eq!(Timeline::new(25.0, gap), Err(TimelineError::Gap(1)));
        let large = vec![sequence(0, u32::MAX, false)];
        assert_eq!(Timeline::new(25.0, large), Err(TimelineError::TooManyFrames));
    }
}
