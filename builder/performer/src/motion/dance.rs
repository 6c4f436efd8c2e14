//! A step-touch from side to side with a bounce, arms swinging up and over; 120 beats a minute.

use super::keyed::{Keyed, stand};
use crate::curve::Curve;
use crate::feet::{FootTrack, Swing};
use crate::skeleton::{BodyState, Channel};
use geometry::sdf::smoothstep;
use glam::Vec3;
use std::f32::consts::TAU;

const BEAT: f32 = 0.5;
const STEP: f32 = 0.3;

pub(super) fn motion(seed: u64) -> impl Fn(f32) -> (BodyState, [bool; 2]) {
    let (feet, middle) = steps();
    let keyed = Keyed::new(&[], feet, seed);
    move |t| {
        let (mut state, planted) = keyed.at(t);
        let c = &mut state.controls;
        let bar = TAU * t / (4.0 * BEAT);
        let beat = TAU * t / BEAT;
        // The second bar is danced with more of everything.
        let more = smoothstep(1.2, 2.0, t);
        c[Channel::Left] += middle.at(t - 0.04) + 0.035 * (bar - 0.6).cos();
        c[Channel::Up] += -0.052 + 0.026 * beat.cos();
        c[Channel::PelvisRoll] += 6.0 * (bar - 0.5).cos();
        c[Channel::PelvisYaw] += (10.0 + 6.0 * more) * (bar - 0.2).sin();
        c[Channel::TrunkYaw] += -(16.0 + 10.0 * more) * (bar - 0.4).sin();
        c[Channel::TrunkRoll] += -9.0 * (bar - 0.6).cos();
        c[Channel::TrunkPitch] += 4.0 + 3.0 * (beat - 0.5).cos();
        c[Channel::HeadRoll] += 7.0 * (bar - 0.9).cos();
        c[Channel::HeadYaw] += 10.0 * (bar - 0.3).sin();
        c[Channel::HeadPitch] += 4.0 * (beat - 0.9).cos();
        for side in 0..2 {
            let sign = if side == 0 { 1.0 } else { -1.0 };
            let arm = |channel: Channel| channel as usize + side * 6;
            let up = 0.5 + 0.5 * sign * (bar - 0.35).cos();
            let up = up * up * (3.0 - 2.0 * up);
            c.0[arm(Channel::SpreadL)] += 12.0 + (58.0 + 48.0 * more) * up;
            c.0[arm(Channel::FlexL)] += 22.0 + 12.0 * (beat - 0.4).cos();
            c.0[arm(Channel::ElbowL)] += 46.0 - 26.0 * up + 10.0 * (beat - 0.7).cos();
            c.0[arm(Channel::TwistL)] += 16.0 - 52.0 * up;
            c.0[arm(Channel::HandL)] += 14.0 * (bar + sign * 1.2).sin();
        }
        c[Channel::KneeL] += 7.0;
        c[Channel::KneeR] += 7.0;
        (state, planted)
    }
}

/// Foot tracks of the step-touch, and the middle between the feet over time.
fn steps() -> ([FootTrack; 2], Curve) {
    let mut feet = [0, 1].map(|side| FootTrack::standing(stand(side), if side == 0 { 0.2 } else { -0.2 }));
    let mut middle = Vec::new();
    let aside = [0.0_f32, STEP];
    let mut at = 0;
    for bar in -3..12 {
        // On the first beat the leading foot steps aside, on the second the other one closes.
        let start = bar as f32 * 2.0 * BEAT;
        let goal = 1 - at;
        let lead = if aside[goal] > aside[at] { 0 } else { 1 };
        for (side, from) in [(lead, start - 0.2), (1 - lead, start + BEAT - 0.2)] {
            let swing = Swing {
                height: Curve::new(&[(0.0, 0.0), (0.45, 0.075), (1.0, 0.0)]),
                pitch: Curve::new(&[(0.0, 0.0), (0.3, 22.0), (0.75, 12.0), (1.0, 0.0)]),
                ..Swing::default()
            };
            let place = stand(side) + Vec3::X * aside[goal];
            let yaw = if side == 0 { 0.2 } else { -0.2 };
            let track = std::mem::take(&mut feet[side]);
            feet[side] = track.step(from, from + 0.32, place, yaw, swing);
        }
        middle.extend([(start - 0.2, aside[at]), (start + 0.4, aside[goal])]);
        at = goal;
    }
    (feet, Curve::new(&middle))
}
