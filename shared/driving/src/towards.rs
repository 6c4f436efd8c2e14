//! A clip's beginning and end edited towards the recording (paper V-C, by III-C): in one frame the body stands as a recorded one
//! does, and around it that fades.
//!
//! The clip's bones are given as they are before feet are planted, so that soles stand afterwards as they do in any clip. What is
//! faded is how much farther each bone is turned, as a rotation vector: trunk, head and arms against what they hang on, pelvis and
//! legs against the way that the body faces; and how much higher the hips are. Place and heading stay the clip's. A leg that stands
//! stays as it is, and one that swings is edited within that swing alone.

use std::ops::Range;

use editing::Rigid;
use editing::reach::logarithm;
use editing::rotation::turn_by;
use glam::{Quat, Vec3};
use kernels::scalar::atan2;

use crate::body::Body;
use crate::contacts::Contacts;
use crate::join::{Look, apart};
use crate::pose::Pose;
use crate::smooth::ease;

/// Time that a leg's edit takes after its foot has left the ground, and before it comes back, in seconds.
const SWING: f32 = 0.5;
/// How much longer an edit takes to fade than a blend of the two postures.
const FADES: f32 = 1.6;

/// A recorded posture that the body is to have in one frame of a clip.
#[derive(Clone, Debug, PartialEq)]
pub struct Aim {
    /// The clip's frame.
    pub frame: usize,
    /// How many frames from there on, or back from there, the edit takes to fade. To the other side it stays in full.
    pub fades: usize,
    /// Whether this is the way into the clip; else the way out.
    pub inwards: bool,
    /// How much of it is done: 1 where the body stands there as recorded.
    pub strength: f32,
    /// How each bone is turned from the rest pose in the recorded frame.
    turns: Vec<Quat>,
    /// How high the middle of the hips is there, in metres.
    height: f32,
}

impl Aim {
    /// In the clip's frame `frame` the body is to stand as where its bones have moved from the rest pose by `recorded`, in place of
    /// `driven`.
    #[must_use]
    pub fn new(body: &Body, [recorded, driven]: [&[Rigid]; 2], (frame, fps): (usize, f32), inwards: bool) -> Self {
        let [a, b] = [recorded, driven].map(|motions| Look::new(body, motions));
        let fades = (FADES * apart([[&a; 2], [&b; 2]], 1.0).blend(fps) as f32).round() as usize;
        let turns = recorded.iter().map(|motion| motion.rotation).collect();
        Self { frame, fades, inwards, strength: 1.0, turns, height: recorded[0].apply(body.middle).y }
    }

    /// The same edit of which so much is done.
    #[must_use]
    pub fn with(&self, strength: f32) -> Self {
        Self { strength, ..self.clone() }
    }

    /// How much of the edit a frame has: 1 at the aim and beyond it, 0 where it has faded.
    fn share(&self, frame: usize) -> f32 {
        let away = if self.inwards { frame.saturating_sub(self.frame) } else { self.frame.saturating_sub(frame) };
        self.strength * (1.0 - ease(away as f32 / self.fades.max(1) as f32))
    }
}

/// The turn about +Y of a body whose pelvis is turned so.
fn heading(body: &Body, pelvis: Quat) -> Quat {
    let left = pelvis * (body.pelvis.axes * Vec3::X);
    turn_by(Vec3::Y * atan2(-left.z, left.x))
}

/// What bone `bone` is turned against.
fn reference(body: &Body, legs: &[Option<usize>], turns: &[Quat], bone: usize) -> Quat {
    if bone == 0 || legs[bone].is_some() { heading(body, turns[0]) } else { turns[body.rig.bones()[bone].parent] }
}

/// Of each bone the leg that it is of, the left one 0.
fn legs(body: &Body) -> Vec<Option<usize>> {
    let mut legs = vec![None; body.rig.bones().len()];
    for (side, leg) in body.legs.iter().enumerate() {
        for bone in [leg.bones.bones[0], leg.bones.bones[1], leg.foot.bone] {
            legs[bone] = Some(side);
        }
    }
    legs
}

/// Edits `poses`, of feet that stand as `contacts` say, towards the recorded postures of `aims`.
pub fn towards(body: &Body, poses: &mut [Pose], contacts: &[Contacts; 2], aims: &[Aim], fps: f32) {
    let legs = legs(body);
    let free: Vec<Pose> = poses.to_vec();
    for aim in aims.iter().filter(|aim| aim.strength > 0.0 && aim.frame < free.len() && aim.turns.len() == legs.len()) {
        let at = &free[aim.frame];
        let off = |(bone, &wanted): (usize, &Quat)| {
            let own = reference(body, &legs, &at.turns, bone).conjugate() * at.turns[bone];
            let wanted = reference(body, &legs, &aim.turns, bone).conjugate() * wanted;
            logarithm(wanted * own.conjugate())
        };
        let off: Vec<Vec3> = aim.turns.iter().enumerate().map(off).collect();
        let higher = aim.height - at.root.y;
        let swings = [0, 1].map(|side| Swing::around(aim.frame, &contacts[side]));
        for frame in reached(aim, free.len()) {
            let share = aim.share(frame);
            let of_leg = swings.each_ref().map(|swing| share * swing.share(frame, fps));
            turn(body, &legs, &mut poses[frame].turns, &off, (share, of_leg));
            poses[frame].root.y += share * higher;
        }
    }
}

/// The frames that an edit changes.
fn reached(aim: &Aim, count: usize) -> Range<usize> {
    let fades = aim.fades.max(1);
    if aim.inwards { 0..(aim.frame + fades).min(count) } else { (aim.frame + 1).saturating_sub(fades)..count }
}

/// Turns the bones by these shares of `off`: of the body, and of each leg.
fn turn(body: &Body, legs: &[Option<usize>], turns: &mut [Quat], off: &[Vec3], (share, of_leg): (f32, [f32; 2])) {
    let before = turns.to_vec();
    for bone in 0..turns.len() {
        // Bones come after what they hang on, which has been turned already.
        let was = reference(body, legs, &before, bone);
        let is = reference(body, legs, turns, bone);
        let share = legs[bone].map_or(share, |side| of_leg[side]);
        // The pelvis may not turn its own reference.
        let is = if bone == 0 || legs[bone].is_some() { was } else { is };
        turns[bone] = is * turn_by(off[bone] * share) * (was.conjugate() * before[bone]);
    }
}

/// The time in which a foot is in the air around an aim.
struct Swing {
    /// Nothing where the foot stands at the aim.
    frames: Option<Range<usize>>,
    count: usize,
}

impl Swing {
    fn around(frame: usize, contacts: &Contacts) -> Self {
        let count = contacts.heel.len();
        let stands = |frame: &usize| contacts.stands(*frame);
        let frames = (frame < count && !contacts.stands(frame)).then(|| {
            let begin = (0..frame).rev().find(stands).map_or(0, |last| last + 1);
            begin..(frame..count).find(stands).unwrap_or(count)
        });
        Self { frames, count }
    }

    /// How much of its leg's edit a frame has.
    fn share(&self, frame: usize, fps: f32) -> f32 {
        let Some(swing) = self.frames.as_ref().filter(|swing| swing.contains(&frame)) else { return 0.0 };
        let ramp = (SWING * fps).max(1.0);
        let since = if swing.start == 0 { 1.0 } else { ease((frame + 1 - swing.start) as f32 / ramp) };
        let until = if swing.end == self.count { 1.0 } else { ease((swing.end - frame) as f32 / ramp) };
        since.min(until)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A foot that stands but for some frames.
    fn swinging(count: usize, swing: Range<usize>) -> Contacts {
        let stands: Vec<bool> = (0..count).map(|frame| !swing.contains(&frame)).collect();
        Contacts { heel: stands.clone(), ball: stands }
    }

    #[test]
    fn a_leg_is_edited_within_its_swing_alone() {
        let contacts = swinging(40, 10..30);
        let swing = Swing::around(20, &contacts);
        let shares: Vec<f32> = (0..40).map(|frame| swing.share(frame, 10.0)).collect();
        assert!(shares[..10].iter().chain(&shares[30..]).all(|&share| share == 0.0));
        assert!((shares[20] - 1.0).abs() < 1e-6 && shares[10] > 0.0 && shares[10] < 0.2);
        assert!(shares.windows(2).all(|two| (two[1] - two[0]).abs() < 0.35));
        // One that stands is not edited at all.
        assert!((0..40).all(|frame| Swing::around(5, &contacts).share(frame, 10.0) == 0.0));
        // What is in the air at the clip's beginning is edited from there.
        assert_eq!(Swing::around(0, &swinging(40, 0..9)).share(0, 10.0), 1.0);
    }

    #[test]
    fn an_edit_is_whole_beyond_its_frame_and_fades_to_the_other_side() {
        let aim = |inwards| Aim { frame: 10, fades: 5, inwards, strength: 1.0, turns: Vec::new(), height: 0.0 };
        let (inwards, out) = (aim(true), aim(false));
        assert_eq!([0, 10, 15, 30].map(|frame| inwards.share(frame)), [1.0, 1.0, 0.0, 0.0]);
        assert_eq!([0, 5, 10, 30].map(|frame| out.share(frame)), [0.0, 0.0, 1.0, 1.0]);
        assert_eq!((reached(&inwards, 40), reached(&out, 40)), (0..15, 6..40));
        assert!(inwards.share(12) > 0.0 && inwards.share(12) < 1.0);
    }
}
