//! One actor on a page that is driven by one clip after the other.

use editor::scene::Known;
use glam::Vec3;
use kernels::align::Placement;

use crate::actor::{Coming, DrivenActor};
use crate::clip::{DrivenClip, Exit};
use crate::error::DriverError;
use crate::perform::{Performance, Performed, Window, windows};

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
    /// How the clip is to be performed: windows, nodes of the way in, and where the actor goes on.
    wanted: Option<([Window; 2], usize, Exit)>,
    performance: Option<Performance>,
}

/// What is known of a clip before its first frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Began {
    /// Frames.
    pub count: usize,
    /// Sentences for whoever dropped it.
    pub notes: Vec<String>,
}

impl Session {
    /// Drives an actor; `rig` is the bundle's section.
    ///
    /// # Errors
    /// The actor has no rig, or one that cannot be used.
    pub fn new(known: Known, rig: &[u8]) -> Result<Self, DriverError> {
        let stage = Stage::Coming(Box::new(Coming::new(known, rig)?));
        Ok(Self { stage, clip: None, wanted: None, performance: None })
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
        let began = Began { count: new.count(), notes: new.notes.clone() };
        *clip = Some(new);
        self.performance = None;
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

    /// Prepares to perform the clip from `frame`, of which `pose` is what was recorded: the recorded frames whose poses are needed.
    ///
    /// # Errors
    /// There is no clip, the pose is none of this mesh, or nothing recorded is long enough to go on in.
    pub fn prepare(&mut self, frame: u32, pose: &[Vec3]) -> Result<[Window; 2], DriverError> {
        let (actor, clip) = self.ready()?;
        let fits = pose.len() == actor.known.topology.vertex_count();
        let clip = clip.as_ref().filter(|_| fits).ok_or(DriverError::Misfit)?;
        let exit = clip.exit(actor).ok_or(DriverError::NoWayBack)?;
        let nodes = clip.entry(actor, pose);
        let windows = windows(actor, clip.count(), frame, nodes, exit);
        self.wanted = Some((windows, nodes, exit));
        Ok(windows)
    }

    /// Makes one more frame that the blends at the clip's ends need, so that [`Self::perform`] has less to do; whether there was one to be
    /// made.
    ///
    /// # Errors
    /// A frame that cannot be made.
    pub fn make_ahead(&mut self) -> Result<bool, DriverError> {
        let Some((_, nodes, exit)) = self.wanted else { return Ok(false) };
        let (actor, clip) = self.ready()?;
        clip.as_mut().map_or(Ok(false), |clip| clip.make_ahead(actor, [nodes, exit.nodes]))
    }

    /// Begins to perform the clip where the actor stands, in the frame that it was prepared for, at `placement`; `recorded` are the
    /// poses of both windows. The frame that it ends with, where that stands, and how many frames lead there.
    ///
    /// # Errors
    /// It was not prepared, or the poses do not fit.
    pub fn perform(
        &mut self,
        recorded: [Vec<Vec3>; 2],
        placement: Placement,
    ) -> Result<(u32, Placement, u32), DriverError> {
        let (windows, nodes, exit) = self.wanted.take().ok_or(DriverError::Misfit)?;
        let (actor, clip) = self.ready()?;
        let clip = clip.as_ref().ok_or(DriverError::Misfit)?;
        let performance = Performance::begin((actor, clip), windows, recorded, (nodes, exit), placement)?;
        let told = (exit.to, performance.home, performance.length);
        self.performance = Some(performance);
        Ok(told)
    }

    /// The next frame of the performance; `None` at its end.
    ///
    /// # Errors
    /// A frame that cannot be made.
    pub fn next_frame(&mut self) -> Result<Option<Performed>, DriverError> {
        let (Stage::Ready(actor), Some(clip), Some(performance)) = (&mut self.stage, &self.clip, &mut self.performance)
        else {
            return Ok(None);
        };
        performance.next(actor, clip)
    }
}
