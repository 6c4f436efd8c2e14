//! How abruptly a body goes from one stretch of frames over into another: told by its bones alone, before any surface is made.
//!
//! A blend of surfaces turns each triangle the short way from the one pose to the other, both facing one way. Bones turn as their
//! triangles do; each counts as a point in the middle of its vertices, by how many there are. Where the short way changes from one side
//! to the other in the middle of a blend, as where an arm swings up on one side and back on the other, that is seen here, too.

use editing::Rigid;
use editing::rotation::{between, turn_by};
use glam::{Quat, Vec3};
use kernels::scalar::{atan2, half_turn};

use crate::body::Body;
use crate::smooth::ease;

/// By so much an edit may make a join more abrupt, in metres per second squared: that is not seen. Chosen by joins of some clips from some
/// frames (`docs/results`).
const UNSEEN: f32 = 0.5;

/// How abrupt a join is: means over the body, the largest of any frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Strain {
    /// In metres per second.
    pub speed: f32,
    /// In metres per second squared.
    pub acceleration: f32,
}

impl Strain {
    /// Whether a join that was edited is about as smooth as it is `without` the edit.
    #[must_use]
    pub fn is_as_smooth(&self, without: &Self) -> bool {
        self.acceleration <= without.acceleration + UNSEEN
    }
}

/// Where the bones of a body are, and how much of it each is.
#[derive(Clone, Debug)]
pub struct Masses {
    /// The middle of its vertices in the rest pose, in metres, and its share of all.
    bones: Vec<(Vec3, f32)>,
}

/// A frame of a body, as seen from itself.
struct Own {
    turns: Vec<Quat>,
    /// How high the middle between the hips is.
    height: f32,
    place: Vec3,
    heading: f32,
}

/// Two stretches of which the end of the first is blended with the beginning of the second.
pub struct Join<'a> {
    /// How the bones have moved from the rest pose in the frames before, and after.
    pub stretches: [&'a [Vec<Rigid>]; 2],
    /// How many of their frames are blended, evenly.
    pub blended: [usize; 2],
}

impl Masses {
    /// Of `body`.
    #[must_use]
    pub fn new(body: &Body) -> Self {
        let (rig, count) = (&body.rig, body.rig.bones().len());
        let mut bones = vec![(Vec3::ZERO, 0.0_f32); count];
        for (vertex, &point) in rig.rest().iter().enumerate() {
            let bone = &mut bones[rig.bone_of(vertex as u32)];
            *bone = (bone.0 + point, bone.1 + 1.0);
        }
        let all = rig.rest().len().max(1) as f32;
        let bones = bones.into_iter().map(|(sum, own)| (sum / own.max(1.0), own / all)).collect();
        Self { bones }
    }

    /// How abrupt `join` is, at `fps` frames a second.
    #[must_use]
    pub fn strain(&self, body: &Body, join: &Join<'_>, fps: f32) -> Strain {
        let shown = self.shown(body, join);
        let mean = |off: &dyn Fn(usize) -> Vec3| {
            self.bones.iter().enumerate().map(|(bone, (_, share))| share * off(bone).length()).sum::<f32>()
        };
        let speeds = shown.windows(2).map(|two| fps * mean(&|bone| two[1][bone] - two[0][bone]));
        let bends = shown
            .windows(3)
            .map(|three| fps * fps * mean(&|bone| three[0][bone] + three[2][bone] - 2.0 * three[1][bone]));
        Strain { speed: speeds.fold(0.0, f32::max), acceleration: bends.fold(0.0, f32::max) }
    }

    /// Where the bones' middles are in every frame of a join.
    fn shown(&self, body: &Body, join: &Join<'_>) -> Vec<Vec<Vec3>> {
        let [before, after] = join.stretches.map(|frames| frames.iter().map(|m| Own::new(body, m)).collect::<Vec<_>>());
        let blended = [join.blended[0].min(before.len()), join.blended[1].min(after.len())];
        let nodes = blended[0].max(blended[1]);
        let alone = before.len() - blended[0];
        let count = alone + nodes + after.len() - blended[1];
        // Which frames of both a frame is of, and how much of the second one it is.
        let at = |frame: usize| {
            let node = frame.saturating_sub(alone);
            let place = |length: usize| node.min(nodes) * length.saturating_sub(1) / nodes.saturating_sub(1).max(1);
            match frame {
                _ if frame < alone => ([frame, 0], 0.0),
                _ if node < nodes => {
                    let share = ease(node as f32 / nodes.saturating_sub(1).max(1) as f32);
                    ([alone + place(blended[0]), place(blended[1])], share)
                }
                _ => ([before.len().saturating_sub(1), blended[1] + node - nodes], 1.0),
            }
        };
        let mut ways: Vec<Vec<Vec3>> = Vec::with_capacity(count);
        let (mut place, mut heading) = (Vec3::ZERO, 0.0_f32);
        for frame in 0..count {
            let (now, share) = at(frame);
            let sides = [before.get(now[0]), after.get(now[1])];
            if frame > 0 {
                let (last, _) = at(frame - 1);
                let step = |own: &[Own], side: usize| match (own.get(last[side]), own.get(now[side])) {
                    (Some(last), Some(now)) => last.step(now),
                    _ => (Vec3::ZERO, 0.0),
                };
                let [(a, turn_a), (b, turn_b)] = [step(&before, 0), step(&after, 1)];
                place += turn_by(Vec3::Y * heading) * a.lerp(b, share);
                heading += turn_a + (turn_b - turn_a) * share;
            }
            let (turns, height) = match sides {
                [Some(a), Some(b)] => {
                    let turns = a.turns.iter().zip(&b.turns).map(|(a, b)| between(*a, *b, share)).collect();
                    (turns, a.height + (b.height - a.height) * share)
                }
                [Some(one), None] | [None, Some(one)] => (one.turns.clone(), one.height),
                [None, None] => return ways,
            };
            ways.push(self.placed(body, &turns, place + Vec3::Y * height, turn_by(Vec3::Y * heading)));
        }
        ways
    }

    /// Where the bones' middles are: the body turned by `facing`, the middle between its hips at `root`.
    fn placed(&self, body: &Body, turns: &[Quat], root: Vec3, facing: Quat) -> Vec<Vec3> {
        let bones = body.rig.bones();
        let mut places: Vec<Vec3> = Vec::with_capacity(bones.len());
        let joint = |bone: usize| if bone == 0 { body.middle } else { bones[bone].joint };
        for bone in 0..bones.len() {
            let parent = bones[bone].parent;
            let place = match places.get(parent) {
                Some(at) => *at + facing * turns[parent] * (joint(bone) - joint(parent)),
                None => root,
            };
            places.push(place);
        }
        let middle = |(bone, place): (usize, Vec3)| place + facing * turns[bone] * (self.bones[bone].0 - joint(bone));
        places.into_iter().enumerate().map(middle).collect()
    }
}

impl Own {
    fn new(body: &Body, motions: &[Rigid]) -> Self {
        let left = motions[0].rotation * (body.pelvis.axes * Vec3::X);
        let heading = atan2(-left.z, left.x);
        let back = turn_by(Vec3::Y * -heading);
        let root = motions[0].apply(body.middle);
        let turns = motions.iter().map(|motion| back * motion.rotation).collect();
        Self { turns, height: root.y, place: root.with_y(0.0), heading }
    }

    /// The way over the ground to `next`, as seen from here, and the turn.
    fn step(&self, next: &Self) -> (Vec3, f32) {
        let way = turn_by(Vec3::Y * -self.heading) * (next.place - self.place);
        (way, half_turn(next.heading - self.heading))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_seen_is_allowed_and_no_more() {
        let of = |acceleration| Strain { speed: 1.0, acceleration };
        assert!(of(9.0).is_as_smooth(&of(20.0)) && of(20.4).is_as_smooth(&of(20.0)));
        assert!(!of(20.6).is_as_smooth(&of(20.0)));
    }
}
