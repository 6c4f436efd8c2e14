//! One actor on a page that is driven by one clip after the other.

use editor::scene::Known;
use glam::Vec3;
use kernels::align::Placement;

use crate::actor::{Coming, DrivenActor};
use crate::clip::DrivenClip;
use crate::error::DriverError;
use crate::joins::{Wanted, aims, middles};
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
    /// How the clip is to be performed.
    wanted: Option<Wanted>,
    performance: Option<Performance>,
    /// Whether clips are performed as they were driven, their ends not edited towards the recording.
    pub as_driven: bool,
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
        Ok(Self { stage, clip: None, wanted: None, performance: None, as_driven: false })
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
        self.wanted = None;
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

    /// Prepares to perform the clip from `frame`, of which `pose` is what was recorded: the recorded frames whose poses are needed. Where
    /// the clip was aimed from a frame or two before, it stays so.
    ///
    /// # Errors
    /// There is no clip, the pose is none of this mesh, or nothing recorded is long enough to go on in.
    pub fn prepare(&mut self, frame: u32, pose: &[Vec3]) -> Result<[Window; 2], DriverError> {
        let before = self.wanted.take();
        let (actor, clip) = self.ready()?;
        let fits = pose.len() == actor.known.topology.vertex_count();
        let clip = clip.as_ref().filter(|_| fits).ok_or(DriverError::Misfit)?;
        let exit = clip.exit(actor).ok_or(DriverError::NoWayBack)?;
        let kept = before.filter(|before| before.holds(&actor.known.timeline, frame, exit));
        let nodes = kept.as_ref().map_or_else(|| clip.entry(actor, pose), |kept| kept.nodes);
        let windows = windows(actor, clip.count(), frame, nodes, exit);
        self.wanted = Some(Wanted { windows, nodes, exit, aimed: kept.and_then(|kept| kept.aimed) });
        Ok(windows)
    }

    /// Edits the clip's ends towards the recorded frames that they are blended with: paper V-C. `recorded` are the poses of both windows
    /// that were prepared. How far the postures in the middle of the way in and of the way back are from each other, as driven and now, in
    /// metres; nothing where clips are performed as driven.
    ///
    /// # Errors
    /// It was not prepared, or the poses do not fit.
    pub fn aim(&mut self, recorded: &[Vec<Vec3>; 2]) -> Result<Vec<[f32; 2]>, DriverError> {
        let as_driven = self.as_driven;
        self.performance = None;
        let mut wanted = self.wanted.take().ok_or(DriverError::Misfit)?;
        let (actor, clip) = self.ready()?;
        let clip = clip.as_mut().ok_or(DriverError::Misfit)?;
        let (aims, motions) = aims(actor, clip, &wanted, recorded).ok_or(DriverError::Misfit)?;
        let apart = if as_driven { clip.edit(actor, &[], &[]) } else { clip.edit(actor, &aims, &motions) };
        wanted.aimed = Some(wanted.windows[0].first);
        self.wanted = Some(wanted);
        Ok(apart)
    }

    /// What is blended in the middle of the way in, and of the way back, as prepared: the recorded frame, and the clip's.
    #[must_use]
    pub fn keys(&self) -> Option<[[u32; 2]; 2]> {
        let (Stage::Ready(actor), Some(clip), Some(wanted)) = (&self.stage, &self.clip, &self.wanted) else {
            return None;
        };
        let [before, after] = middles(wanted, clip.count());
        let of = |window: usize, [step, frame]: [usize; 2]| {
            let first = wanted.windows[window].first;
            [actor.known.timeline.offset(first, step as i64).unwrap_or(first), frame as u32]
        };
        Some([of(0, before), of(1, after)])
    }

    /// How many frames of the clip the way in and the way back blend, as prepared.
    #[must_use]
    pub fn blended(&self) -> Option<[usize; 2]> {
        self.wanted.as_ref().map(|wanted| [wanted.nodes, wanted.windows[1].count as usize])
    }

    /// Makes one more frame that the blends at the clip's ends need, so that [`Self::perform`] has less to do; whether there was one to be
    /// made.
    ///
    /// # Errors
    /// A frame that cannot be made.
    pub fn make_ahead(&mut self) -> Result<bool, DriverError> {
        let Some(Wanted { nodes, exit, .. }) = self.wanted else { return Ok(false) };
        let (actor, clip) = self.ready()?;
        clip.as_mut().map_or(Ok(false), |clip| clip.make_ahead(actor, [nodes, exit.nodes]))
    }

    /// Begins to perform the clip where the actor stands, in the frame that it was prepared for, at `placement`; `recorded` are the
    /// poses of both windows. A clip that was not aimed is aimed now. The frame that it ends with, where that stands, and how many frames
    /// lead there.
    ///
    /// # Errors
    /// It was not prepared, or the poses do not fit.
    pub fn perform(
        &mut self,
        recorded: [Vec<Vec3>; 2],
        placement: Placement,
    ) -> Result<(u32, Placement, u32), DriverError> {
        if self.wanted.as_ref().is_some_and(|wanted| wanted.aimed.is_none()) {
            self.aim(&recorded)?;
        }
        let Wanted { windows, nodes, exit, .. } = self.wanted.take().ok_or(DriverError::Misfit)?;
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
