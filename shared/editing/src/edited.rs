//! Recorded poses as whoever reads poses sees them: with edits.

use std::collections::VecDeque;

use actor::feet::Feet;
use actor::pose_source::{PoseError, PoseSource};
use actor::timeline::Timeline;
use glam::Vec3;

use crate::apply::{Edits, Recording};
use crate::document::EditDocument;
use crate::error::EditError;
use crate::error::PreparedError;
use crate::grab::Editor;

/// Frames that are kept: whoever reads one reads it again soon.
const KEPT: usize = 32;

/// Recorded poses with the edits of a document; as bit for bit as they were where no edit reaches.
pub struct EditedPoses<'a, S: PoseSource> {
    source: &'a mut S,
    timeline: &'a Timeline,
    feet: &'a Feet,
    edits: Edits,
    kept: VecDeque<(u32, Vec<Vec3>)>,
}

impl<'a, S: PoseSource> EditedPoses<'a, S> {
    /// The poses of `source` with the edits of `document`; `weights` are the topology's, `feet` say what stands.
    ///
    /// # Errors
    /// What the capture does not have, and in which edit.
    pub fn new(
        source: &'a mut S,
        (timeline, feet): (&'a Timeline, &'a Feet),
        weights: &[f32],
        editor: Editor,
        document: EditDocument,
    ) -> Result<Self, EditError> {
        let edits = Edits::new(timeline, weights, editor, document)?;
        Ok(Self { source, timeline, feet, edits, kept: VecDeque::new() })
    }

    /// Makes all edits of their own frames now; what is not as it was wanted, in sentences.
    ///
    /// # Errors
    /// A frame that cannot be read; edits that cannot be made.
    pub fn prepare(&mut self) -> Result<Vec<String>, PreparedError> {
        self.edits.prepare(&mut Recording { source: self.source, timeline: self.timeline, feet: self.feet })?;
        Ok(self.edits.notes())
    }
}

impl<S: PoseSource> PoseSource for EditedPoses<'_, S> {
    fn read(&mut self, frame: u32, pose: &mut [Vec3]) -> Result<(), PoseError> {
        if !self.edits.reaches(self.timeline, frame) {
            return self.source.read(frame, pose);
        }
        if let Some((_, kept)) = self.kept.iter().find(|(other, _)| *other == frame) {
            pose.copy_from_slice(kept);
            return Ok(());
        }
        self.source.read(frame, pose)?;
        let mut edited = pose.to_vec();
        let mut recording = Recording { source: self.source, timeline: self.timeline, feet: self.feet };
        self.edits.apply(&mut recording, frame, &mut edited).map_err(|error| match error {
            PreparedError::Pose(error) => error,
            // Edits were checked: what is left is a pose that is not finite.
            PreparedError::Edit(_) => PoseError::Damaged(frame),
        })?;
        pose.copy_from_slice(&edited);
        if self.kept.len() == KEPT {
            self.kept.pop_front();
        }
        self.kept.push_back((frame, edited));
        Ok(())
    }
}
