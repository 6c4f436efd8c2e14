//! Feet are planted: standing soles are put on the floor and stay there, legs bend after them, the body sinks where a leg is
//! too short.

use std::ops::Range;

use editing::Rigid;
use editing::rotation::{rotation_vector, turn_by};
use glam::{Quat, Vec3};
use kernels::scalar::atan2;

use crate::body::{Body, Leg};
use crate::contacts::Contacts;
use crate::foot::Foot;
use crate::pose::{Pose, farthest, reach};
use crate::posture::Posture;
use crate::smooth::{dilated, ease, gaussian, quantile};
use crate::steps::{Print, Step, steps};
use crate::towards::{Aim, towards};

/// How the pitch of a standing foot is smoothed, in seconds.
const PITCH: f32 = 0.035;
/// How the body's sinking is smoothed, in seconds.
const SINK: f32 = 0.08;
/// How long toes take to straighten once they have left the ground, in seconds.
const STRAIGHTEN: f32 = 0.15;
/// Where no foot ever stands, the floor is at this share of the feet's heights.
const NEVER: f32 = 0.1;
/// Toes bend no farther than this, in radians.
const MOST_BEND: f32 = 1.1;

/// A foot in one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Standing {
    /// Whether its heel stands, and its ball.
    pub heel: bool,
    /// Whether its ball stands.
    pub ball: bool,
    /// Where and how it stands: a rigid motion of the foot that lies flat, from the rest pose.
    pub flat: Option<Flat>,
    /// How far its toes are bent upwards, in radians.
    pub bend: f32,
}

/// A foot that lies flat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flat {
    /// Its rotation from the rest pose.
    pub rotation: Quat,
    /// Its translation in metres.
    pub translation: Vec3,
}

/// A frame of the actor.
#[derive(Clone, Debug, PartialEq)]
pub struct PlantedFrame {
    /// Its bones.
    pub pose: Pose,
    /// Its feet.
    pub feet: [Standing; 2],
}

/// All frames of the actor.
#[derive(Clone, Debug, PartialEq)]
pub struct Planted {
    /// Frames.
    pub frames: Vec<PlantedFrame>,
}

/// The rigid motions of the bones in all frames, from the rest pose.
#[must_use]
pub fn bones(body: &Body, planted: &Planted) -> Vec<Vec<Rigid>> {
    planted.frames.iter().map(|frame| body.motions(&frame.pose)).collect()
}

/// Where a foot is to be: its rotation from the rest pose, and its ankle.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Goal {
    turn: Quat,
    ankle: Vec3,
}

/// What a body does before its feet are planted.
#[derive(Clone, Debug, PartialEq)]
pub struct Free {
    poses: Vec<Pose>,
    /// What both knees bend about, in the world, where that is known.
    hinges: Vec<[Option<Vec3>; 2]>,
    contacts: [Contacts; 2],
    fps: f32,
}

impl Free {
    /// The body does what `postures` say; in the middle of all frames the soles that stand are on the floor.
    #[must_use]
    pub fn new(body: &Body, postures: &[Posture], contacts: [Contacts; 2], fps: f32) -> Self {
        let mut poses: Vec<Pose> = postures
            .iter()
            .map(|posture| Pose { root: posture.root + body.floor * Vec3::Y, turns: body.turns(posture) })
            .collect();
        settle(body, &mut poses, &contacts);
        let hinges = postures.iter().map(|posture| posture.legs.map(|leg| leg.bent.hinge)).collect();
        Self { poses, hinges, contacts, fps }
    }

    /// Frames.
    #[must_use]
    pub fn count(&self) -> usize {
        self.poses.len()
    }

    /// These frames alone: what is planted of them is about what is planted of them among all.
    #[must_use]
    pub fn part(&self, frames: Range<usize>) -> Self {
        let of = |stands: &[bool]| stands[frames.clone()].to_vec();
        let contacts = |own: &Contacts| Contacts { heel: of(&own.heel), ball: of(&own.ball) };
        Self {
            poses: self.poses[frames.clone()].to_vec(),
            hinges: self.hinges[frames.clone()].to_vec(),
            contacts: self.contacts.each_ref().map(contacts),
            fps: self.fps,
        }
    }

    /// All frames with their feet planted, edited towards the recorded postures of `aims` before.
    #[must_use]
    pub fn planted(&self, body: &Body, aims: &[Aim]) -> Planted {
        if aims.iter().all(|aim| aim.strength == 0.0) {
            return plant(body, self.poses.clone(), &self.hinges, (&self.contacts, self.fps));
        }
        let (mut poses, mut hinges) = (self.poses.clone(), self.hinges.clone());
        towards(body, &mut poses, &self.contacts, aims, self.fps);
        for (frame, hinges) in hinges.iter_mut().enumerate() {
            for (side, hinge) in hinges.iter_mut().enumerate() {
                let thigh = body.legs[side].bones.bones[0];
                let turned = poses[frame].turns[thigh] * self.poses[frame].turns[thigh].conjugate();
                *hinge = hinge.map(|hinge| turned * hinge);
            }
        }
        plant(body, poses, &hinges, (&self.contacts, self.fps))
    }
}

/// The body goes through `poses`, its feet standing as `contacts` say, its knees bending about `hinges`.
fn plant(
    body: &Body,
    mut poses: Vec<Pose>,
    hinges: &[[Option<Vec3>; 2]],
    (contacts, fps): (&[Contacts; 2], f32),
) -> Planted {
    let mut feet = vec![[Standing::default(); 2]; poses.len()];
    let mut goals: [Vec<Goal>; 2] = [Vec::new(), Vec::new()];
    for side in 0..2 {
        goals[side] = foot(body, side, &poses, &contacts[side], fps, &mut feet);
    }
    sink(body, &mut poses, &goals, fps);
    for (frame, pose) in poses.iter_mut().enumerate() {
        for (side, leg) in body.legs.iter().enumerate() {
            bend(body, leg, pose, &goals[side][frame], hinges[frame][side]);
        }
    }
    Planted { frames: poses.into_iter().zip(feet).map(|(pose, feet)| PlantedFrame { pose, feet }).collect() }
}

/// Whether a foot stands in any frame: in walks on the spot none does.
#[must_use]
pub fn ever_stands(contacts: &[Contacts; 2]) -> bool {
    contacts.iter().any(|contacts| (0..contacts.heel.len()).any(|frame| contacts.stands(frame)))
}

/// Raises or lowers all frames so that standing soles are on the floor, in the middle of all.
fn settle(body: &Body, poses: &mut [Pose], contacts: &[Contacts; 2]) {
    let mut heights = Vec::new();
    let ever = ever_stands(contacts);
    for (frame, pose) in poses.iter().enumerate() {
        let motions = body.motions(pose);
        for (_, leg) in body.legs.iter().enumerate().filter(|(side, _)| !ever || contacts[*side].stands(frame)) {
            let foot = &motions[leg.foot.bone];
            heights.push(foot.apply(leg.foot.heel).y.min(foot.apply(leg.foot.ball).y) - body.floor);
        }
    }
    let off = quantile(heights, if ever { 0.5 } else { NEVER });
    poses.iter_mut().for_each(|pose| pose.root.y -= off);
}

/// Where one foot is to be in all frames; how it stands goes to `feet`.
fn foot(
    body: &Body,
    side: usize,
    poses: &[Pose],
    contacts: &Contacts,
    fps: f32,
    feet: &mut [[Standing; 2]],
) -> Vec<Goal> {
    let leg = &body.legs[side];
    let (foot, ankle) = (&leg.foot, leg.bones.joints[2]);
    let free: Vec<Goal> = poses
        .iter()
        .map(|pose| {
            let motion = body.motions(pose)[foot.bone];
            Goal { turn: motion.rotation, ankle: motion.apply(ankle) }
        })
        .collect();
    let prints: Vec<Print> = free.iter().map(|goal| print(foot, ankle, goal)).collect();
    let steps = steps(contacts, &prints, fps);
    let mut goals = free.clone();
    for step in &steps {
        stand(body, foot, ankle, step, (&free, contacts, fps), &mut goals, &mut |frame, standing| {
            feet[frame][side] = standing;
        });
    }
    between(&steps, &free, &mut goals);
    let standing: Vec<Standing> = feet.iter().map(|feet| feet[side]).collect();
    straighten(&standing, fps, &mut |frame, bend| feet[frame][side].bend = bend);
    for frame in 0..goals.len() {
        if feet[frame][side].flat.is_none() {
            let lowest = lowest(body, foot, ankle, &goals[frame], feet[frame][side].bend);
            goals[frame].ankle.y += (body.floor - lowest).max(0.0);
        }
    }
    goals
}

fn print(foot: &Foot, ankle: Vec3, goal: &Goal) -> Print {
    let middle = goal.ankle + goal.turn * (0.5 * (foot.heel + foot.ball) - ankle);
    Print::of(middle, goal.turn * (foot.axes * Vec3::Z))
}

/// How far the heel is up against the ball, as an angle.
fn pitch(foot: &Foot, goal: &Goal) -> f32 {
    let ahead = goal.turn * (foot.axes * Vec3::Z);
    atan2(-ahead.y, (ahead.x * ahead.x + ahead.z * ahead.z).sqrt())
}

/// The goals of a standing foot: it turns over its heel or its ball, and these stay where they are.
fn stand(
    body: &Body,
    foot: &Foot,
    ankle: Vec3,
    step: &Step,
    (free, contacts, fps): (&[Goal], &Contacts, f32),
    goals: &mut [Goal],
    tell: &mut dyn FnMut(usize, Standing),
) {
    let heading = Quat::from_rotation_y(atan2(step.print.ahead.x, step.print.ahead.y));
    let rotation = heading * foot.axes.conjugate();
    let middle = 0.5 * (foot.heel + foot.ball);
    let place = Vec3::new(step.print.place.x, body.floor, step.print.place.y);
    let flat = Flat { rotation, translation: place - rotation * middle };
    let wanted: Vec<f32> = step
        .frames
        .clone()
        .map(|frame| {
            let pitch = pitch(foot, &free[frame]);
            match (contacts.heel[frame], contacts.ball[frame]) {
                (true, true) => 0.0,
                (true, false) => pitch.min(0.0),
                _ => pitch.max(0.0),
            }
        })
        .collect();
    for (frame, pitch) in step.frames.clone().zip(gaussian(&wanted, PITCH * fps)) {
        let pivot = if pitch > 0.0 { foot.ball } else { foot.heel };
        let turn = heading * turn_by(Vec3::X * pitch) * foot.axes.conjugate();
        goals[frame] = Goal { turn, ankle: rotation * pivot + flat.translation + turn * (ankle - pivot) };
        // A heel that is off by less than a degree or so still stands.
        let (heel, ball) = (pitch < 0.02, pitch > -0.02);
        tell(frame, Standing { heel, ball, flat: Some(flat), bend: pitch.clamp(0.0, MOST_BEND) });
    }
}

/// Between steps the change that standing makes goes over from that of the one to that of the other.
fn between(steps: &[Step], free: &[Goal], goals: &mut [Goal]) {
    let change = |frame: usize, goals: &[Goal]| {
        let turn = goals[frame].turn * free[frame].turn.conjugate();
        let turn = if turn.w < 0.0 { -turn } else { turn };
        (goals[frame].ankle - free[frame].ankle, rotation_vector(turn))
    };
    let changes: Vec<_> = steps
        .iter()
        .map(|step| (step.frames.clone(), change(step.frames.start, goals), change(step.frames.end - 1, goals)))
        .collect();
    let (Some(first), Some(last)) = (changes.first(), changes.last()) else { return };
    let mut put = |frame: usize, (shift, turn): (Vec3, Vec3)| {
        goals[frame] = Goal { turn: turn_by(turn) * free[frame].turn, ankle: free[frame].ankle + shift };
    };
    (0..first.0.start).for_each(|frame| put(frame, first.1));
    (last.0.end..free.len()).for_each(|frame| put(frame, last.2));
    for pair in changes.windows(2) {
        let (from, to) = (pair[0].0.end - 1, pair[1].0.start);
        for frame in from + 1..to {
            let u = ease((frame - from) as f32 / (to - from) as f32);
            put(frame, (pair[0].2.0.lerp(pair[1].1.0, u), pair[0].2.1.lerp(pair[1].1.1, u)));
        }
    }
}

/// Toes that have left the ground straighten.
fn straighten(standing: &[Standing], fps: f32, put: &mut dyn FnMut(usize, f32)) {
    let last = (STRAIGHTEN * fps).max(1.0);
    let mut left: Option<(usize, f32)> = None;
    for (frame, standing) in standing.iter().enumerate() {
        if standing.flat.is_some() {
            left = Some((frame, standing.bend));
        } else if let Some((from, bend)) = left {
            put(frame, bend * (1.0 - ease((frame - from) as f32 / last)));
        }
    }
}

/// The lowest point of a sole, whose toes are bent by `bend`.
fn lowest(body: &Body, foot: &Foot, ankle: Vec3, goal: &Goal, bend: f32) -> f32 {
    let rest = body.rig.rest();
    let lifted = foot.lifted(bend);
    let height = |vertex: u32| {
        let point = rest[vertex as usize];
        let point = point.lerp(lifted.apply(point), foot.toe_share(point));
        (goal.ankle + goal.turn * (point - ankle)).y
    };
    foot.sole().map(height).fold(f32::INFINITY, f32::min)
}

/// Lowers the body where a leg would be too short.
fn sink(body: &Body, poses: &mut [Pose], goals: &[Vec<Goal>; 2], fps: f32) {
    let needed: Vec<f32> = poses
        .iter()
        .enumerate()
        .map(|(frame, pose)| {
            let motions = body.motions(pose);
            let short = |(side, leg): (usize, &Leg)| {
                let hip = motions[leg.bones.bones[0]].apply(leg.bones.joints[0]);
                let to = hip - goals[side][frame].ankle;
                let reach = farthest(&leg.bones);
                let aside = to.x * to.x + to.z * to.z;
                (to.y - (reach * reach - aside).max(0.0).sqrt()).max(0.0)
            };
            body.legs.iter().enumerate().map(short).fold(0.0, f32::max)
        })
        .collect();
    let sigma = SINK * fps;
    let sunk = gaussian(&dilated(&needed, (1.5 * sigma).ceil() as usize), sigma);
    poses.iter_mut().zip(sunk).for_each(|(pose, sunk)| pose.root.y -= sunk);
}

/// Bends a leg so that its foot is where it is to be.
fn bend(body: &Body, leg: &Leg, pose: &mut Pose, goal: &Goal, hinge: Option<Vec3>) {
    let motions = body.motions(pose);
    let hip = motions[leg.bones.bones[0]].apply(leg.bones.joints[0]);
    let hinge = hinge.unwrap_or(motions[0].rotation * (body.pelvis.axes * Vec3::X));
    let [thigh, shin] = reach(&leg.bones, hip, goal.ankle, hinge);
    pose.turns[leg.bones.bones[0]] = thigh;
    pose.turns[leg.bones.bones[1]] = shin;
    pose.turns[leg.foot.bone] = goal.turn;
}
