//! From a clip to poses of the actor: the whole way.

use actor::capture::Poses;
use glam::Vec3;
use kernels::topology::Topology;
use thiserror::Error;

use crate::body::Body;
use crate::clip::{Clip, ClipError};
use crate::contacts::Contacts;
use crate::mapping::Mapping;
use crate::measure::{Measures, measure};
use crate::nearest::nearest;
use crate::plant::{bones, ever_stands, plant};
use crate::posture::Posture;
use crate::source::Source;
use crate::surface::{Surface, SurfaceError};

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
    let clip = clip.resampled(fps)?;
    let source = Source::new(&clip, mapping, body.leg_length());
    let postures: Vec<Posture> = (0..clip.len()).map(|frame| source.posture(frame)).collect();
    let contacts = [0, 1].map(|side| {
        let way = |of: fn(&Posture, usize) -> Vec3| postures.iter().map(|p| of(p, side)).collect::<Vec<_>>();
        Contacts::find(&way(|p, side| p.legs[side].ankle), &way(|p, side| p.legs[side].ball), fps)
    });
    let planted = plant(body, &postures, &contacts, fps);
    let surface = Surface::new(body, topology, order);
    let driven = surface.deform(&planted)?;
    let measures = measure(body, topology, poses, &driven, &planted);
    Ok(Driven {
        poses: driven,
        nearest: nearest(body.rig, poses, &bones(body, &planted)),
        stands: ever_stands(&contacts),
        measures,
    })
}
