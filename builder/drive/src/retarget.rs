//! From a clip to poses of the actor: the whole way. The number of threads changes nothing.

use actor::capture::Poses;
use driving::plant::{Free, Planted, bones};
use driving::{
    Aim, Body, BodyError, Clip, ClipError, Likeness, Looker, Mapping, Plan, Seen, Solver, Surface, SurfaceError,
};
use editing::Rig;
use glam::Vec3;
use kernels::cholesky::elimination_order;
use kernels::topology::Topology;
use rayon::prelude::*;
use thiserror::Error;

use crate::measure::{Measures, measure};

/// Frames that are made by one thread after another.
const BATCH: usize = 32;

/// What came of a clip.
#[derive(Clone, Debug)]
pub struct Driven {
    /// Vertex positions of all frames, in metres.
    pub poses: Vec<Vec<Vec3>>,
    /// The recorded frame that resembles them most: whose looks they have.
    pub nearest: u32,
    /// Whether a foot stands in any frame.
    pub stands: bool,
    /// How good they are.
    pub measures: Measures,
    /// When and where their feet stand.
    pub planted: Planted,
    /// What they do before the feet are planted.
    pub free: Free,
}

impl Driven {
    /// The frames with their ends edited towards the recorded postures of `aims`, and where feet stand then. Frames that no edit changes
    /// stay as they are, bit for bit.
    ///
    /// # Errors
    /// A surface that cannot be solved for.
    pub fn towards(
        &self,
        aims: &[Aim],
        body: &Body,
        (topology, order): (&Topology, Option<&[u32]>),
    ) -> Result<(Planted, Vec<Vec<Vec3>>), SurfaceError> {
        let planted = self.free.planted(body, aims);
        let changes = |&frame: &usize| planted.frames[frame] != self.planted.frames[frame];
        let changed: Vec<usize> = (0..planted.frames.len()).filter(changes).collect();
        let frames = changed.iter().map(|&frame| planted.frames[frame].clone()).collect();
        let mut poses = self.poses.clone();
        for (frame, pose) in changed.into_iter().zip(deform(body, &Planted { frames }, topology, order)?) {
            poses[frame] = pose;
        }
        Ok((planted, poses))
    }
}

/// Why an actor cannot be driven.
#[derive(Clone, Debug, Error)]
#[non_exhaustive]
pub enum DriveError {
    /// The clip cannot be had at the actor's rate.
    #[error(transparent)]
    Clip(#[from] ClipError),
    /// The actor's surface cannot be solved for.
    #[error(transparent)]
    Surface(#[from] SurfaceError),
}

/// The body of `rig`, as the recorded `poses` show it.
///
/// # Errors
/// A rig without the bones of two legs.
pub fn body(rig: &Rig, poses: &Poses) -> Result<Body, BodyError> {
    let looker = Looker::new(rig)?;
    let frames: Vec<u32> = Looker::samples(poses.len()).collect();
    let seen: Vec<Seen> = frames.par_iter().map(|&frame| looker.see(rig, poses.frame(frame))).collect();
    Body::new(rig.clone(), &seen)
}

/// The actor `body`, whose recording is `poses` at `fps` frames a second, does what `clip` shows.
///
/// # Errors
/// A clip that is too long at the actor's rate, or a surface that cannot be solved for.
pub fn retarget(
    (clip, mapping): (&Clip, &Mapping),
    body: &Body,
    (topology, order): (&Topology, Option<&[u32]>),
    (poses, fps): (&Poses, f32),
) -> Result<Driven, DriveError> {
    let Plan { free, planted, stands } = Plan::new((clip, mapping), body, fps)?;
    let driven = deform(body, &planted, topology, order)?;
    let measures = measure(body, topology, poses, &driven, &planted);
    Ok(Driven { poses: driven, nearest: nearest(body, poses, &planted), stands, measures, planted, free })
}

/// Vertex positions of all frames in metres.
fn deform(
    body: &Body,
    planted: &Planted,
    topology: &Topology,
    order: Option<&[u32]>,
) -> Result<Vec<Vec<Vec3>>, SurfaceError> {
    let found;
    let order = match order {
        Some(order) => order,
        None => {
            found = elimination_order(topology);
            &found
        }
    };
    let surface = Surface::new(body);
    let batch = |frames: &[_]| -> Result<Vec<Vec<Vec3>>, SurfaceError> {
        let mut solver = Solver::new(topology, Some(order))?;
        frames.iter().map(|frame| surface.frame(body, frame, &mut solver)).collect()
    };
    let batches: Vec<_> = planted.frames.par_chunks(BATCH).map(batch).collect::<Result<_, _>>()?;
    Ok(batches.into_iter().flatten().collect())
}

/// The recorded frame that resembles the clip most on average.
fn nearest(body: &Body, poses: &Poses, planted: &Planted) -> u32 {
    let likeness = Likeness::new(&body.rig, &bones(body, planted));
    let frames: Vec<u32> = Likeness::samples(poses.len()).collect();
    let apart = |&frame: &u32| likeness.apart(&body.rig, &body.rig.fit(poses.frame(frame)));
    let sums: Vec<f32> = frames.par_iter().map(apart).collect();
    let best = (1..sums.len()).fold(0, |best, k| if sums[k] < sums[best] { k } else { best });
    frames.get(best).copied().unwrap_or(0)
}
