//! From a clip to where the bones of the actor are, its feet planted: all but the surface.

use glam::Vec3;

use crate::body::Body;
use crate::clip::{Clip, ClipError};
use crate::contacts::Contacts;
use crate::mapping::Mapping;
use crate::plant::{Free, Planted, ever_stands};
use crate::posture::Posture;
use crate::source::Source;

/// What an actor's bones do in a clip.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// What they do before the feet are planted: what an edit towards the recording begins with.
    pub free: Free,
    /// Its frames, at the actor's rate.
    pub planted: Planted,
    /// Whether a foot stands in any of them: in walks on the spot none does.
    pub stands: bool,
}

impl Plan {
    /// The actor `body`, at `fps` frames a second, does what `clip` shows.
    ///
    /// # Errors
    /// A clip that is too long at the actor's rate.
    pub fn new((clip, mapping): (&Clip, &Mapping), body: &Body, fps: f32) -> Result<Self, ClipError> {
        let clip = clip.resampled(fps)?;
        let source = Source::new(&clip, mapping, body.leg_length());
        let postures: Vec<Posture> = (0..clip.len()).map(|frame| source.posture(frame)).collect();
        let contacts = [0, 1].map(|side| {
            let way = |of: fn(&Posture, usize) -> Vec3| postures.iter().map(|p| of(p, side)).collect::<Vec<_>>();
            Contacts::find(&way(|p, side| p.legs[side].ankle), &way(|p, side| p.legs[side].ball), fps)
        });
        let stands = ever_stands(&contacts);
        let free = Free::new(body, &postures, contacts, fps);
        Ok(Self { planted: free.planted(body, &[]), free, stands })
    }
}
