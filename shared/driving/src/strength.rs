//! How much of an edit of a clip's end is done: as much as makes the join with the recording no more abrupt than it is without.
//!
//! The paper (V-C) edits in full. Where the body does in the recorded frames what the clip does not, as in a jump, an edit brings the one
//! frame near and makes those around it worse.

use editing::Rigid;

use crate::body::Body;
use crate::plant::{Free, bones};
use crate::strain::{Join, Masses};
use crate::towards::Aim;

/// What is tried, the most first.
pub const STRENGTHS: [f32; 4] = [1.0, 0.75, 0.5, 0.25];
/// Frames beside those that are looked at which are planted with them, in seconds.
const BESIDE: f32 = 1.0;

/// One end of a clip, where it is joined to the recording.
#[derive(Clone, Copy, Debug)]
pub struct End<'a> {
    /// How bones have moved from the rest pose in the recorded frames, all of which are blended.
    pub recorded: &'a [Vec<Rigid>],
    /// Frames of the clip that are blended with them: its first ones from `first` on, or its last ones up to it.
    pub nodes: usize,
    /// The first frame of the clip in the blend on the way in; on the way out the one after the last.
    pub first: usize,
}

/// How much of `aim`, the edit of this end of what `body` does in `free`, is done: 0 to 1.
#[must_use]
pub fn strength((body, masses): (&Body, &Masses), (free, fps): (&Free, f32), aim: &Aim, end: &End<'_>) -> f32 {
    let beside = (BESIDE * fps) as usize;
    let count = free.count();
    // What is looked at: the blend, and as far as the edit reaches.
    let seen = if aim.inwards {
        end.first.min(count)..(end.first + end.nodes).max(aim.frame + aim.fades + 1).min(count)
    } else {
        end.first.saturating_sub(end.nodes).min(aim.frame.saturating_sub(aim.fades))..end.first.min(count)
    };
    let made = seen.start.saturating_sub(beside)..(seen.end + beside).min(count);
    if seen.is_empty() || !made.contains(&aim.frame) {
        return 1.0;
    }
    let part = free.part(made.clone());
    let strain = |strength: f32| {
        let mut tried = aim.with(strength);
        tried.frame -= made.start;
        let motions = bones(body, &part.planted(body, &[tried]));
        let clip = &motions[seen.start - made.start..seen.end - made.start];
        let join = if aim.inwards {
            Join { stretches: [end.recorded, clip], blended: [end.recorded.len(), end.nodes] }
        } else {
            Join { stretches: [clip, end.recorded], blended: [end.nodes, end.recorded.len()] }
        };
        masses.strain(body, &join, fps)
    };
    let without = strain(0.0);
    STRENGTHS.into_iter().find(|&strength| strain(strength).is_as_smooth(&without)).unwrap_or(0.0)
}
