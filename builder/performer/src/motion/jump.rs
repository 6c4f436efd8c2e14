//! A jump forwards: crouch with the arms back, extend, fly a parabola with tucked legs, land and give.

use super::keyed::{Keyed, stand};
use crate::curve::Curve;
use crate::feet::{FootTrack, Swing};
use crate::skeleton::{BodyState, Channel};
use glam::Vec3;

const OFF: f32 = 0.86;
const DOWN: f32 = 1.34;
const GRAVITY: f32 = 9.81;
/// Height of the pelvis against standing when the toes leave and when they touch again.
const EDGE: f32 = 0.035;
const DISTANCE: f32 = 0.62;

/// The jump of the capture.
pub(super) fn motion(seed: u64) -> impl Fn(f32) -> (BodyState, [bool; 2]) {
    leap(seed, DISTANCE, DOWN - OFF)
}

/// Seconds that the feet of the capture's jump are in the air.
pub(super) const FLIGHT: f32 = DOWN - OFF;

/// The same so many metres far, the feet `time` seconds in the air.
pub(super) fn leap(seed: u64, distance: f32, time: f32) -> impl Fn(f32) -> (BodyState, [bool; 2]) {
    let later = time - (DOWN - OFF);
    let down = DOWN + later;
    // The feet fly the body's parabola, tucked under it.
    let height: Vec<(f32, f32)> = (0..=12)
        .map(|k| {
            let u = k as f32 / 12.0;
            let t = u * time;
            let tuck = 0.15 * (u * (1.0 - u) * 4.0).powi(2);
            (u, 0.5 * GRAVITY * t * (time - t) + tuck)
        })
        .collect();
    let feet = [0, 1].map(|side| {
        let swing = Swing {
            height: Curve::new(&height),
            pitch: Curve::new(&[(0.0, 48.0), (0.25, 55.0), (0.75, 8.0), (1.0, 18.0)]),
            ballistic: true,
            ..Swing::default()
        };
        let yaw = if side == 0 { 0.12 } else { -0.12 };
        let landing = stand(side) + Vec3::Z * distance;
        FootTrack::standing(stand(side), yaw)
            .rolling(&[(100.0 + OFF - 0.24, 0.0), (100.0 + OFF - 0.1, 12.0), (100.0 + OFF, 48.0)])
            .step(OFF, DOWN, landing, yaw, swing)
            .rolling(&[(0.0, 18.0), (0.07, 0.0)])
    });
    let keys: &[super::keyed::Keys] = &[
        (
            Channel::PelvisPitch,
            &[(0.1, 0.0), (0.62, 26.0), (0.86, 4.0), (1.1, 8.0), (1.34, 10.0), (1.52, 26.0), (2.1, 0.0)],
        ),
        (
            Channel::TrunkPitch,
            &[(0.1, 0.0), (0.62, 24.0), (0.86, -8.0), (1.1, 6.0), (1.34, 8.0), (1.54, 24.0), (2.1, 0.0)],
        ),
        (Channel::HeadPitch, &[(0.1, 0.0), (0.62, -26.0), (0.9, -4.0), (1.2, 10.0), (1.55, -22.0), (2.1, 0.0)]),
        (
            Channel::FlexL,
            &[(0.0, 0.0), (0.58, -52.0), (0.88, 128.0), (1.1, 110.0), (1.4, 34.0), (1.6, 12.0), (2.1, 0.0)],
        ),
        (
            Channel::FlexR,
            &[(0.0, 0.0), (0.6, -50.0), (0.9, 124.0), (1.1, 108.0), (1.42, 36.0), (1.62, 12.0), (2.12, 0.0)],
        ),
        (Channel::SpreadL, &[(0.2, 0.0), (0.6, 8.0), (0.9, 16.0), (1.2, 22.0), (1.5, 30.0), (2.1, 0.0)]),
        (Channel::SpreadR, &[(0.2, 0.0), (0.6, 8.0), (0.9, 16.0), (1.2, 22.0), (1.5, 30.0), (2.1, 0.0)]),
        (Channel::ElbowL, &[(0.1, 0.0), (0.6, 8.0), (0.88, 22.0), (1.4, 34.0), (2.1, 0.0)]),
        (Channel::ElbowR, &[(0.1, 0.0), (0.6, 8.0), (0.88, 22.0), (1.4, 34.0), (2.1, 0.0)]),
        (Channel::KneeL, &[(0.2, 0.0), (0.6, 8.0), (0.9, 2.0), (1.52, 10.0), (2.1, 0.0)]),
        (Channel::KneeR, &[(0.2, 0.0), (0.6, 8.0), (0.9, 2.0), (1.52, 10.0), (2.1, 0.0)]),
    ];
    let keyed = Keyed::new(keys, feet, seed);
    let crouch = Curve::new(&[(0.05, 0.0), (0.56, -0.27), (0.66, -0.27)]);
    let land = Curve::new(&[(1.54, -0.23), (2.1, 0.0)]);
    let forward_after = Curve::new(&[(1.5, 0.02), (2.1, 0.0)]);
    // Limbs do in the air what they do in the capture's jump, as much faster or slower.
    let as_keyed = move |t: f32| {
        if later == 0.0 || t < OFF {
            t
        } else if t < down {
            OFF + (t - OFF) * (DOWN - OFF) / time
        } else {
            t - later
        }
    };
    move |t| {
        let (mut state, planted) = keyed.at(as_keyed(t));
        // Speed at take-off: half of the flight's time upwards.
        let rise = 0.5 * GRAVITY * time;
        state.controls[Channel::Up] += if t < 0.66 {
            crouch.at(t)
        } else if t < OFF {
            join(0.66, -0.27, 0.0, OFF, EDGE, rise, t)
        } else if t < down {
            let s = t - OFF;
            EDGE + 0.5 * GRAVITY * s * (time - s)
        } else if t < 1.54 + later {
            join(down, EDGE, -rise, 1.54 + later, -0.23, 0.0, t)
        } else {
            land.at(t - later)
        };
        let speed = distance / time * 0.82;
        let (push, touch) = (0.03, distance - 0.075);
        state.controls[Channel::Forward] += if t < 0.6 {
            -0.03 * ramp(0.05, 0.6, t)
        } else if t < OFF {
            join(0.6, -0.03, 0.0, OFF, push + 0.05, speed, t)
        } else if t < down {
            push + 0.05 + (touch - push - 0.05) * (t - OFF) / time
        } else if t < 1.6 + later {
            join(down, touch, (touch - push - 0.05) / time, 1.6 + later, distance + 0.02, 0.0, t)
        } else {
            distance + forward_after.at(t - later)
        };
        (state, planted)
    }
}

/// The cubic from value and slope at `t0` to value and slope at `t1`.
#[allow(clippy::too_many_arguments, reason = "two ends of three numbers each, and the time")]
fn join(t0: f32, v0: f32, s0: f32, t1: f32, v1: f32, s1: f32, t: f32) -> f32 {
    let w = t1 - t0;
    let u = ((t - t0) / w).clamp(0.0, 1.0);
    let (u2, u3) = (u * u, u * u * u);
    v0 * (2.0 * u3 - 3.0 * u2 + 1.0) + v1 * (3.0 * u2 - 2.0 * u3) + w * (s0 * (u3 - 2.0 * u2 + u) + s1 * (u3 - u2))
}

fn ramp(from: f32, to: f32, t: f32) -> f32 {
    geometry::sdf::smoothstep(from, to, t)
}
