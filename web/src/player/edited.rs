//! Edited frames: positions that the page gives in place of recorded ones. Whatever reads a pose gets them, so that blends that
//! pass there begin or end in them.

use actor::pose_source::PoseSource;
use glam::Vec3;
use kernels::align::Placement;
use synthesis::FrameKind;

use super::{Player, PlayerError};

impl Player {
    /// From now on `pose` (metres, as the frame was recorded) stands in for `frame`; without one, the recorded pose again.
    ///
    /// # Errors
    /// There is no such frame, or the pose is none of this mesh.
    pub fn set_edited(&mut self, frame: u32, pose: Option<Vec<Vec3>>) -> Result<(), PlayerError> {
        let actor = self.loading.actor.as_ref().ok_or(PlayerError::NotLoaded)?;
        let is_pose = |pose: &Vec<Vec3>| {
            pose.len() == actor.topology.vertex_count() && pose.iter().all(|point| point.is_finite())
        };
        if frame >= actor.timeline.frame_count() || !pose.as_ref().is_none_or(is_pose) {
            return Err(PlayerError::NoFrame(frame));
        }
        let edited = &mut self.loading.source.edited;
        let before = edited.iter().position(|(other, _)| *other == frame);
        match (before, pose) {
            (Some(at), Some(pose)) => edited[at].1 = pose,
            (None, Some(pose)) => edited.push((frame, pose)),
            (Some(at), None) => drop(edited.swap_remove(at)),
            (None, None) => return Ok(()),
        }
        self.producer.forget_poses();
        self.show_anew(frame)
    }

    /// No frame is edited any more.
    ///
    /// # Errors
    /// A frame that is shown cannot be read.
    pub fn clear_edited(&mut self) -> Result<(), PlayerError> {
        while let Some(&(frame, _)) = self.loading.source.edited.last() {
            self.set_edited(frame, None)?;
        }
        Ok(())
    }

    /// The recorded frame that is shown, alone from now on, and where it stands; `None` in a transition and in a clip. A walk under way is
    /// kept.
    pub fn hold(&mut self) -> Option<(u32, Placement)> {
        let last = self.last.as_ref()?;
        let FrameKind::Recorded { frame } = last.kind else { return None };
        if self.is_given() {
            return None;
        }
        let placement = last.placement;
        self.playing = false;
        self.changed |= self.clock.weight() > 0.0;
        self.clock.set_weight(0.0);
        Some((frame, placement))
    }

    /// What is shown of `frame` is another pose now; it stands where it stood.
    fn show_anew(&mut self, frame: u32) -> Result<(), PlayerError> {
        let shown = [self.last.clone(), self.next.clone()];
        let [last, next] = shown.map(|shown| {
            let Some(shown) = shown else { return Ok(None) };
            if shown.kind != (FrameKind::Recorded { frame }) {
                return Ok(Some(shown));
            }
            self.changed = true;
            let mut anew = self.recorded(frame, shown.placement)?;
            // The camera stays where it is.
            anew.ground = shown.ground;
            Ok::<_, PlayerError>(Some(anew))
        });
        (self.last, self.next) = (last?, next?);
        Ok(())
    }

    /// The pose of `frame` in the place where it was recorded, edited where it is.
    ///
    /// # Errors
    /// A frame that does not exist, has not arrived, or is damaged.
    pub fn pose_of(&mut self, frame: u32) -> Result<Vec<Vec3>, PlayerError> {
        let actor = self.loading.actor.as_ref().ok_or(PlayerError::NotLoaded)?;
        let mut pose = vec![Vec3::ZERO; actor.topology.vertex_count()];
        self.loading.source.read(frame, &mut pose)?;
        Ok(pose)
    }
}
