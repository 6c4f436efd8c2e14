//! Where a sequence jumps: nothing stands, and the body rises and falls.

use glam::Vec3;
use kernels::align::centre_of_mass;

use crate::cycle::FLICKER;
use crate::recorded::{Recorded, Track};

/// Shorter flights are steps, in seconds.
const SHORTEST: f32 = 0.14;
/// The body rises at least so far above both ends of the flight, in body heights: 3.6 cm of 1.8 m.
const RISES: f32 = 0.02;
/// Something stands at least so long before and after, in seconds.
const STANDS: f32 = 0.12;

/// A flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jump {
    /// The last place on the track at which something stands.
    pub off: usize,
    /// The first one at which something stands again.
    pub land: usize,
    /// How far the centre of mass rises above the ends of the flight, in metres.
    pub rise: f32,
    /// Places before and after that belong to it: something stands there.
    pub around: (usize, usize),
}

/// All jumps of a track, in order.
#[must_use]
pub fn jumps(recorded: &Recorded, track: &Track) -> Vec<Jump> {
    let least = recorded.frames(FLICKER);
    let mut stands = vec![false; track.len()];
    for foot in 0..recorded.feet.count() {
        for (first, last) in track.stances(recorded.feet, foot, least) {
            stands[first..=last].fill(true);
        }
    }
    let mut found: Vec<Jump> = Vec::new();
    let mut at = track.own().start;
    while let Some(off) = (at + 1..track.own().end).find(|&k| stands[k - 1] && !stands[k]).map(|k| k - 1) {
        let Some(land) = (off + 1..track.own().end).find(|&k| stands[k]) else { break };
        at = land;
        let before = (0..=off).rev().take_while(|&k| stands[k]).count();
        let after = (land..track.len()).take_while(|&k| stands[k]).count();
        let rise = rise(recorded, track, off, land);
        let long = land - off >= recorded.frames(SHORTEST) && before.min(after) >= recorded.frames(STANDS);
        if long && rise > RISES * recorded.body() {
            found.push(Jump { off, land, rise, around: (before, after) });
        }
    }
    found
}

fn rise(recorded: &Recorded, track: &Track, off: usize, land: usize) -> f32 {
    let height = |pose: &[Vec3]| centre_of_mass(pose, recorded.topology.weights()).y;
    let at = |at: usize| height(&track.pose(recorded, at));
    let highest = (off..=land).map(at).fold(f32::NEG_INFINITY, f32::max);
    highest - at(off).max(at(land))
}
