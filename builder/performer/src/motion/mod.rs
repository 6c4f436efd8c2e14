//! What the performer does: one file for each behaviour. A motion is a function of time, defined before its beginning
//! and after its end, so that cloth can swing in and sequences may be longer or shorter.

mod dance;
mod duck;
mod idle;
mod jump;
mod keyed;
mod kick;
mod locomotion;
mod wave;

use super::skeleton::BodyState;

/// A behaviour in one take.
pub struct Motion {
    /// Name of the behaviour; also its label.
    pub name: &'static str,
    /// Its usual length in seconds.
    pub seconds: f32,
    /// The body at a time in seconds, and which feet stand still on the ground.
    pub at: Box<dyn Fn(f32) -> (BodyState, [bool; 2]) + Send + Sync>,
}

/// Names and usual lengths of the behaviours, in the order of the capture.
pub const BEHAVIOURS: [(&str, f32); 10] = [
    ("idle", 2.4),
    ("walk", 3.4),
    ("run", 2.5),
    ("turn_left", 2.5),
    ("turn_right", 3.0),
    ("jump", 2.2),
    ("kick", 2.0),
    ("duck", 2.2),
    ("wave", 2.3),
    ("dance", 3.4),
];

/// The behaviour number `behaviour` of [`BEHAVIOURS`] in a take of its own.
#[must_use]
pub fn make(behaviour: usize, seed: u64) -> Motion {
    let (name, seconds) = BEHAVIOURS[behaviour % BEHAVIOURS.len()];
    let at: Box<dyn Fn(f32) -> (BodyState, [bool; 2]) + Send + Sync> = match name {
        "walk" => locomotion::walk(seconds, seed),
        "run" => locomotion::run(seconds, seed),
        "turn_left" => locomotion::turn_left(seconds, seed),
        "turn_right" => locomotion::turn_right(seconds, seed),
        "jump" => Box::new(jump::motion(seed)),
        "kick" => Box::new(kick::motion(seed)),
        "duck" => Box::new(duck::motion(seed)),
        "wave" => Box::new(wave::motion(seed)),
        "dance" => Box::new(dance::motion(seed)),
        _ => Box::new(idle::motion(seed)),
    };
    Motion { name, seconds, at: Box::new(move |t| settle(at(t))) }
}

/// Steps at one speed in m/s, turning to the left by so many degrees a second: a walk, or a run. No behaviour of the capture,
/// but what lies between two of them.
#[must_use]
pub fn steady(seconds: f32, seed: u64, speed: f32, turn: f32) -> Motion {
    let at = locomotion::steady(seconds, seed, speed, turn);
    Motion { name: "steady", seconds, at: Box::new(move |t| settle(at(t))) }
}

/// A jump so many metres far, the feet `flight` seconds in the air; the capture's lasts 0.48 seconds.
#[must_use]
pub fn leap(seed: u64, distance: f32, flight: f32) -> Motion {
    let at = jump::leap(seed, distance, flight);
    Motion { name: "leap", seconds: 2.2 + flight - jump::FLIGHT, at: Box::new(move |t| settle(at(t))) }
}

/// Lowers the pelvis where a leg would not reach its foot.
fn settle((mut state, planted): (BodyState, [bool; 2])) -> (BodyState, [bool; 2]) {
    use super::skeleton::{Channel, NEUTRAL, ankle_of, joint, solve};
    let [thigh, shin] = [0, 1].map(|k| NEUTRAL[joint::LEG[0] + k].distance(NEUTRAL[joint::LEG[0] + k + 1]));
    let reach = (thigh + shin) * 0.996;
    for _ in 0..2 {
        let world = solve(&state);
        let mut drop = 0.0_f32;
        for side in 0..2 {
            let hip = world[joint::LEG[side]].translation;
            let ankle = ankle_of(&state.feet[side]).translation;
            let aside = (hip - ankle) * glam::Vec3::new(1.0, 0.0, 1.0);
            let highest = ankle.y + (reach * reach - aside.length_squared()).max(0.01).sqrt();
            drop = drop.max(hip.y - highest);
        }
        state.controls[Channel::Up] -= drop;
    }
    (state, planted)
}
