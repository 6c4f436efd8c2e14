//! Frames of a capture that a request names.

use super::{FrameRef, RequestError};
use crate::behaviours::UnknownBehaviour;
use actor::timeline::Timeline;

impl FrameRef {
    /// The frame's number over the whole capture.
    ///
    /// # Errors
    /// A frame or a sequence that does not exist.
    pub fn find(&self, timeline: &Timeline) -> Result<u32, RequestError> {
        match self {
            Self::Number(frame) if *frame < timeline.frame_count() => Ok(*frame),
            Self::Number(frame) => Err(RequestError::UnknownFrame(frame.to_string())),
            Self::Within(within) => {
                let wrong = |what: String| RequestError::UnknownFrame(format!("{what} of {:?}", within.sequence));
                let named = timeline.sequences().iter().find(|sequence| sequence.name == within.sequence);
                let sequence = named.ok_or_else(|| UnknownBehaviour {
                    name: within.sequence.clone(),
                    known: timeline.sequences().iter().map(|sequence| sequence.name.clone()).collect(),
                })?;
                let local = match (within.frame, within.time) {
                    (Some(frame), _) => frame,
                    (None, Some(time)) => (time * f64::from(timeline.fps())).round() as u32,
                    (None, None) => 0,
                };
                let exists = local < sequence.frame_count;
                exists.then(|| sequence.first_frame + local).ok_or_else(|| wrong(local.to_string()))
            }
        }
    }
}
