//! The actor as it is driven: its body once enough recorded frames were seen, and those frames.

use bundle::decode_rig;
use driving::{Body, Look, Looker, Masses, Seen, Solver, Surface};
use editing::{Rig, StoredRig};
use editor::scene::Known;
use glam::Vec3;

use crate::error::DriverError;

/// An actor that is being looked at.
pub struct Coming {
    known: Known,
    stored: Option<StoredRig>,
    rig: Option<(Rig, Looker)>,
    /// Frames that were asked for and are still to come.
    due: Vec<u32>,
    seen: Vec<(u32, Seen)>,
}

/// An actor that can be driven.
pub struct DrivenActor {
    /// Timeline, mesh and feet.
    pub known: Known,
    /// Its body.
    pub body: Body,
    /// How much of it each bone is.
    pub masses: Masses,
    /// Its surface.
    pub surface: Surface,
    /// Solves for it.
    pub solver: Solver,
    /// Recorded frames in ascending order: the bones, and the body as seen from itself.
    pub recorded: Vec<(u32, Seen, Look)>,
    /// The bone that each of its feet moves with: the left leg's foot is 0, the right one's 1, others are none.
    pub sides: Vec<Option<usize>>,
}

impl Coming {
    /// An actor whose rig is the bundle's section `rig`.
    ///
    /// # Errors
    /// There is none, or it is damaged.
    pub fn new(known: Known, rig: &[u8]) -> Result<Self, DriverError> {
        if rig.is_empty() {
            return Err(DriverError::NoRig);
        }
        let (vertices, frames) = (known.topology.vertex_count(), known.timeline.frame_count());
        let stored = decode_rig(rig, vertices, frames).map_err(|reason| DriverError::Rig(reason.into()))?;
        let due = vec![stored.rest_frame];
        Ok(Self { known, stored: Some(stored), rig: None, due, seen: Vec::new() })
    }

    /// Frames whose recorded poses have to be given next.
    #[must_use]
    pub fn needs(&self) -> &[u32] {
        &self.due
    }

    /// Takes the recorded pose of the first frame that is needed.
    ///
    /// # Errors
    /// It is none of this mesh, or the rig is no human's.
    pub fn give(&mut self, pose: Vec<Vec3>) -> Result<(), DriverError> {
        if pose.len() != self.known.topology.vertex_count() || !pose.iter().all(|point| point.is_finite()) {
            return Err(DriverError::Misfit);
        }
        if let Some(stored) = self.stored.take() {
            let rig = stored.rig(pose).map_err(|error| DriverError::Rig(error.to_string()))?;
            let looker = Looker::new(&rig)?;
            self.rig = Some((rig, looker));
            self.due = Looker::samples(self.known.timeline.frame_count() as usize).collect();
        } else if let Some((rig, looker)) = &self.rig
            && !self.due.is_empty()
        {
            self.seen.push((self.due.remove(0), looker.see(rig, &pose)));
        }
        Ok(())
    }

    /// The actor, once all that is needed was given.
    ///
    /// # Errors
    /// A rig that is no human's, a mesh that cannot be factorised.
    pub fn finish(self) -> Result<DrivenActor, DriverError> {
        let Self { known, rig: Some((rig, _)), seen, .. } = self else { return Err(DriverError::Misfit) };
        let own: Vec<Seen> = seen.iter().map(|(_, seen)| seen.clone()).collect();
        let body = Body::new(rig, &own)?;
        let solver = Solver::new(&known.topology, known.order.as_deref())?;
        let look = |(frame, seen): (u32, Seen)| {
            let look = Look::new(&body, &seen.motions);
            (frame, seen, look)
        };
        let recorded = seen.into_iter().map(look).collect();
        let sides = (0..known.feet.count()).map(|foot| side(&body, &known, foot)).collect();
        Ok(DrivenActor {
            masses: Masses::new(&body),
            surface: Surface::new(&body),
            solver,
            recorded,
            sides,
            body,
            known,
        })
    }
}

/// Which leg's foot most of the soles' vertices of foot `foot` belong to.
fn side(body: &Body, known: &Known, foot: usize) -> Option<usize> {
    let soles = || known.feet.vertices(foot).iter().filter(|vertex| vertex.sole > 0);
    (0..2).find(|&side| {
        let bone = body.legs[side].foot.bone;
        2 * soles().filter(|vertex| body.rig.bone_of(vertex.vertex) == bone).count() > soles().count()
    })
}
