//! A clip as postures: what its parts do against how they are where the skeleton stands upright.

use glam::{Quat, Vec3};

use crate::clip::{Clip, Stance};
use crate::frames::{level, upright};
use crate::mapping::Mapping;
use crate::posture::{Bent, LegPosture, Posture};
use crate::role::Role;
use crate::smooth::quantile;

/// The share of frames in which the skeleton stands tallest.
const TALLEST: f32 = 0.25;
/// A rest pose is upright where trunk and legs are as near to the vertical as this cosine.
const UPRIGHT: f32 = 0.85;
/// A limb that never bends more than this sine, on average, has no hinge.
const BENDS: f32 = 0.05;
/// Where a skeleton has no ball of the foot: how far ahead of the ankle it is and how far below, in shares of the leg.
const BALL_AHEAD: f32 = 0.15;
const BALL_BELOW: f32 = 0.08;

/// What is known of a clip before its frames are looked at one by one.
pub struct Source<'a> {
    clip: &'a Clip,
    mapping: &'a Mapping,
    /// Metres of the actor for one of the clip.
    scale: f32,
    /// Axes of pelvis, chest and head, in their own joints' axes.
    trunk: [Option<Quat>; 3],
    /// Axes of the feet in those of the ankles.
    feet: [Quat; 2],
    /// Where the ball is in the axes of the ankle, where the skeleton has none.
    balls: [Vec3; 2],
    /// Hinges in the axes of the limbs' first joints: both legs, both arms.
    hinges: [Option<Vec3>; 4],
    floor: f32,
}

fn joint(mapping: &Mapping, role: Role) -> usize {
    // Roles of legs are there: the mapping was checked.
    mapping.joint(role).unwrap_or(0)
}

impl<'a> Source<'a> {
    /// The source `clip`, for an actor with legs of `leg_length` metres.
    #[must_use]
    pub fn new(clip: &'a Clip, mapping: &'a Mapping, leg_length: f32) -> Self {
        let leg = |roles: [Role; 4]| {
            let [hip, knee, ankle] = [0, 1, 2].map(|k| joint(mapping, roles[k]));
            let at = clip.positions(0);
            at[hip].distance(at[knee]) + at[knee].distance(at[ankle])
        };
        let length = 0.5 * (leg(Role::LEGS[0]) + leg(Role::LEGS[1]));
        let scale = if length > 1e-6 { leg_length / length } else { 1.0 };
        let mut source = Self {
            clip,
            mapping,
            scale,
            trunk: [None; 3],
            feet: [Quat::IDENTITY; 2],
            balls: [Vec3::ZERO; 2],
            hinges: [None; 4],
            floor: 0.0,
        };
        source.trunk = [Role::Pelvis, Role::Chest, Role::Head].map(|role| source.axes(mapping.joint(role)?));
        source.find_feet(length);
        let limbs = [Role::HipL, Role::KneeL, Role::AnkleL, Role::HipR, Role::KneeR, Role::AnkleR];
        let arms = Role::ARMS.concat();
        source.hinges = [&limbs[..3], &limbs[3..], &arms[..3], &arms[3..]]
            .map(|roles| source.hinge([roles[0], roles[1], roles[2]]));
        let lows = (0..clip.len()).map(|frame| {
            let at = |side: usize| source.ball(frame, side).y;
            at(0).min(at(1))
        });
        source.floor = quantile(lows.collect(), 0.1);
        source
    }

    /// The frame's posture.
    #[must_use]
    pub fn posture(&self, frame: usize) -> Posture {
        let (at, turns) = (self.clip.positions(frame), self.clip.rotations(frame));
        let place = |role| at[joint(self.mapping, role)];
        let scaled = |place: Vec3| self.scale * (place - self.floor * Vec3::Y);
        let trunk = |part: usize, role: Role| Some(turns[self.mapping.joint(role)?] * self.trunk[part]?);
        let leg = |side: usize| {
            let [hip, knee, ankle, _] = Role::LEGS[side];
            LegPosture {
                bent: self.bent(frame, [hip, knee, ankle], self.hinges[side]),
                foot: turns[joint(self.mapping, ankle)] * self.feet[side],
                ankle: scaled(place(ankle)),
                ball: scaled(self.ball(frame, side)),
            }
        };
        let arm = |side: usize| {
            let roles = Role::ARMS[side];
            let known = roles.iter().all(|&role| self.mapping.joint(role).is_some());
            known.then(|| self.bent(frame, roles, self.hinges[2 + side]))
        };
        Posture {
            root: scaled(0.5 * (place(Role::HipL) + place(Role::HipR))),
            pelvis: trunk(0, Role::Pelvis).unwrap_or_default(),
            chest: trunk(1, Role::Chest),
            head: trunk(2, Role::Head),
            legs: [leg(0), leg(1)],
            arms: [arm(0), arm(1)],
        }
    }

    fn bent(&self, frame: usize, roles: [Role; 3], hinge: Option<Vec3>) -> Bent {
        let at = roles.map(|role| self.clip.positions(frame)[joint(self.mapping, role)]);
        let turn = self.clip.rotations(frame)[joint(self.mapping, roles[0])];
        Bent {
            upper: (at[1] - at[0]).normalize_or(Vec3::NEG_Y),
            lower: (at[2] - at[1]).normalize_or(Vec3::NEG_Y),
            hinge: hinge.map(|hinge| turn * hinge),
        }
    }

    /// Where the ball of a foot is, in metres of the clip.
    fn ball(&self, frame: usize, side: usize) -> Vec3 {
        let [_, _, ankle, ball] = Role::LEGS[side];
        let (at, ankle) = (self.clip.positions(frame), joint(self.mapping, ankle));
        self.mapping
            .joint(ball)
            .map_or_else(|| at[ankle] + self.clip.rotations(frame)[ankle] * self.balls[side], |ball| at[ball])
    }

    /// The rest pose, where the skeleton stands upright in it.
    fn upright_rest(&self) -> Option<&'a Stance> {
        let rest = self.clip.rest()?;
        let at = |role: Role| rest.positions[joint(self.mapping, role)];
        let top = self.mapping.joint(Role::Head).or(self.mapping.joint(Role::Chest));
        let hips = 0.5 * (at(Role::HipL) + at(Role::HipR));
        let trunk = top.map_or(Vec3::Y, |top| (rest.positions[top] - hips).normalize_or_zero());
        let leg = |hip, ankle| (at(hip) - at(ankle)).normalize_or_zero().y;
        let legs = leg(Role::HipL, Role::AnkleL).min(leg(Role::HipR, Role::AnkleR));
        (trunk.y > UPRIGHT && legs > UPRIGHT).then_some(rest)
    }

    /// Axes of a joint, in its own: left, up and forwards where the skeleton stands upright.
    fn axes(&self, of: usize) -> Option<Quat> {
        let across = |at: &[Vec3]| {
            level(at[joint(self.mapping, Role::HipL)] - at[joint(self.mapping, Role::HipR)]).normalize_or_zero()
        };
        if let Some(rest) = self.upright_rest() {
            return Some(rest.rotations[of].conjugate() * upright(Vec3::Y, across(&rest.positions)));
        }
        let top = self.mapping.joint(Role::Head).or(self.mapping.joint(Role::Chest));
        let top = top.unwrap_or_else(|| joint(self.mapping, Role::Pelvis));
        let height = |frame: usize| {
            let at = self.clip.positions(frame);
            let ankle = |role| at[joint(self.mapping, role)].y;
            at[top].y - ankle(Role::AnkleL).min(ankle(Role::AnkleR))
        };
        let least = quantile((0..self.clip.len()).map(height).collect(), 1.0 - TALLEST);
        let (mut up, mut left) = (Vec3::ZERO, Vec3::ZERO);
        for frame in (0..self.clip.len()).filter(|&frame| height(frame) >= least) {
            let back = self.clip.rotations(frame)[of].conjugate();
            up += back * Vec3::Y;
            left += back * across(self.clip.positions(frame));
        }
        Some(upright(up, left))
    }

    /// Axes of the feet: what is up and ahead where they stand, low and slow.
    fn find_feet(&mut self, leg: f32) {
        for (side, [_, _, ankle, ball]) in Role::LEGS.into_iter().enumerate() {
            let ankle = joint(self.mapping, ankle);
            let Some(ball) = self.mapping.joint(ball) else {
                // Without a ball: as the pelvis faces where the skeleton stands upright.
                let own = self.axes(ankle).unwrap_or_default();
                self.feet[side] = own;
                self.balls[side] = own * Vec3::new(0.0, -BALL_BELOW * leg, BALL_AHEAD * leg);
                continue;
            };
            let ways = [ankle, ball].map(|joint| {
                (0..self.clip.len()).map(|frame| self.scale * self.clip.positions(frame)[joint]).collect::<Vec<_>>()
            });
            let contacts = crate::contacts::Contacts::find(&ways[0], &ways[1], self.clip.rate());
            let (mut up, mut ahead) = (Vec3::ZERO, Vec3::ZERO);
            for frame in (0..self.clip.len()).filter(|&frame| contacts.heel[frame] && contacts.ball[frame]) {
                let back = self.clip.rotations(frame)[ankle].conjugate();
                up += back * Vec3::Y;
                ahead += back * level(ways[1][frame] - ways[0][frame]).normalize_or_zero();
            }
            self.feet[side] = match self.upright_rest() {
                _ if up.length() > 0.5 => upright(up, up.cross(ahead)),
                Some(rest) => {
                    let ahead = level(rest.positions[ball] - rest.positions[ankle]);
                    rest.rotations[ankle].conjugate() * upright(Vec3::Y, Vec3::Y.cross(ahead))
                }
                None => self.axes(ankle).unwrap_or_default(),
            };
        }
    }

    /// What a limb bends about, in the axes of its first joint.
    fn hinge(&self, roles: [Role; 3]) -> Option<Vec3> {
        let [first, second, third] =
            [self.mapping.joint(roles[0])?, self.mapping.joint(roles[1])?, self.mapping.joint(roles[2])?];
        let bend = |frame: usize| {
            let at = self.clip.positions(frame);
            let upper = (at[second] - at[first]).normalize_or_zero();
            let lower = (at[third] - at[second]).normalize_or_zero();
            self.clip.rotations(frame)[first].conjugate() * upper.cross(lower)
        };
        let sum: Vec3 = (0..self.clip.len()).map(bend).sum();
        (sum.length() > BENDS * self.clip.len() as f32).then(|| sum.normalize())
    }
}
