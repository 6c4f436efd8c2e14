//! One actor on a page that is driven by one clip after the other.

use editor::scene::Known;
use glam::Vec3;

use crate::actor::{Coming, DrivenActor};
use crate::clip::{DrivenClip, Exit};
use crate::error::DriverError;

/// How far the actor is known.
enum Stage {
    /// Some recorded frames are still to be seen.
    Coming(Box<Coming>),
    /// It can be driven.
    Ready(Box<DrivenActor>),
    /// It cannot.
    Failed(DriverError),
}

/// Drives one actor.
pub struct Session {
    stage: Stage,
    clip: Option<DrivenClip>,
}

/// What is known of a clip before its first frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Began {
    /// Frames.
    pub count: usize,
    /// The recorded frame whose looks it has.
    pub like: u32,
    /// Frame after frame, for each foot of the actor whether it stands.
    pub stands: Vec<bool>,
    /// Where the actor may go on afterwards, the best first.
    pub exits: Vec<Exit>,
    /// Sentences for whoever dropped it.
    pub notes: Vec<String>,
}

impl Session {
    /// Drives an actor; `rig` is the bundle's section.
    ///
    /// # Errors
    /// The actor has no rig, or one that cannot be used.
    pub fn new(known: Known, rig: &[u8]) -> Result<Self, DriverError> {
        Ok(Self { stage: Stage::Coming(Box::new(Coming::new(known, rig)?)), clip: None })
    }

    /// Frames whose recorded poses have to be given next, in this order; none once the actor can be driven, or never can.
    #[must_use]
    pub fn needs(&self) -> &[u32] {
        match &self.stage {
            Stage::Coming(coming) => coming.needs(),
            _ => &[],
        }
    }

    /// Takes the recorded pose of the first frame that is needed.
    ///
    /// # Errors
    /// A pose that is none of this mesh, or a rig that is no human's.
    pub fn give(&mut self, pose: Vec<Vec3>) -> Result<(), DriverError> {
        let Stage::Coming(coming) = &mut self.stage else { return Ok(()) };
        let given = coming.give(pose);
        if given.is_ok() && !coming.needs().is_empty() {
            return Ok(());
        }
        let coming = std::mem::replace(&mut self.stage, Stage::Failed(DriverError::Misfit));
        let Stage::Coming(coming) = coming else { return Ok(()) };
        match given.and_then(|()| coming.finish()) {
            Ok(actor) => self.stage = Stage::Ready(Box::new(actor)),
            Err(error) => {
                self.stage = Stage::Failed(error.clone());
                return Err(error);
            }
        }
        Ok(())
    }

    fn ready(&mut self) -> Result<(&mut DrivenActor, &mut Option<DrivenClip>), DriverError> {
        match &mut self.stage {
            Stage::Ready(actor) => Ok((actor, &mut self.clip)),
            Stage::Failed(error) => Err(error.clone()),
            Stage::Coming(_) => Err(DriverError::Misfit),
        }
    }

    /// Takes the clip in `files` in place of the one before.
    ///
    /// # Errors
    /// What is wrong with it; the one before stays.
    pub fn begin(&mut self, files: &[(&str, &[u8])]) -> Result<Began, DriverError> {
        let (actor, clip) = self.ready()?;
        let new = DrivenClip::new(actor, files)?;
        let began = Began {
            count: new.count(),
            like: new.like,
            stands: new.stands(actor),
            exits: new.exits(actor),
            notes: new.notes.clone(),
        };
        *clip = Some(new);
        Ok(began)
    }

    /// Vertex positions of a frame of the clip, in metres.
    ///
    /// # Errors
    /// There is no such frame, or it cannot be solved for.
    pub fn make(&mut self, frame: usize) -> Result<Vec<Vec3>, DriverError> {
        let (actor, clip) = self.ready()?;
        let clip = clip.as_ref().ok_or(DriverError::Misfit)?;
        clip.make(actor, frame)?.ok_or(DriverError::Misfit)
    }

    /// How many nodes a blend from the recorded `pose` to the clip's beginning has, and about how far both are apart in radians.
    ///
    /// # Errors
    /// There is no clip, or the pose is none of this mesh.
    pub fn entry(&mut self, pose: &[Vec3]) -> Result<(usize, f32), DriverError> {
        let (actor, clip) = self.ready()?;
        let fits = pose.len() == actor.known.topology.vertex_count();
        let clip = clip.as_ref().filter(|_| fits).ok_or(DriverError::Misfit)?;
        Ok(clip.entry(actor, pose))
    }
}
