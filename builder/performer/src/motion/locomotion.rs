//! Walking, running and turning: routes for the gait.

use crate::curve::Curve;
use crate::gait::{Gait, Route};
use crate::skeleton::BodyState;
use kernels::random::{mix, signed};

type At = Box<dyn Fn(f32) -> (BodyState, [bool; 2]) + Send + Sync>;

/// From standing into a walk that bends a little.
pub(super) fn walk(seconds: f32, seed: u64) -> At {
    let bend = 9.0 * signed(seed, 40);
    go(
        seed,
        seconds,
        &[(0.1, 0.0), (0.7, 0.62), (1.5, 1.28), (9.0, 1.32)],
        &[(0.8, 0.0), (1.8, bend), (3.2, -bend)],
        true,
        false,
    )
}

/// From a walk into a run.
pub(super) fn run(seconds: f32, seed: u64) -> At {
    let bend = 7.0 * signed(seed, 41);
    go(seed, seconds, &[(0.25, 1.35), (1.15, 3.0), (9.0, 3.15)], &[(0.6, 0.0), (1.6, bend)], false, false)
}

/// Walking through a curve to the left.
pub(super) fn turn_left(seconds: f32, seed: u64) -> At {
    let speed = [(0.2, 1.3), (1.2, 1.12), (2.3, 1.3)];
    go(seed, seconds, &speed, &[(0.2, 0.0), (0.9, 82.0), (1.6, 82.0), (2.4, 0.0)], false, false)
}

/// Walking through a curve to the right, then coming to a stand.
pub(super) fn turn_right(seconds: f32, seed: u64) -> At {
    let speed = [(0.2, 1.3), (1.1, 1.15), (1.65, 1.1), (2.55, 0.0)];
    go(seed, seconds, &speed, &[(0.15, 0.0), (0.8, -84.0), (1.4, -84.0), (2.3, 0.0)], false, true)
}

/// At one speed in m/s, turning to the left by so many degrees a second.
pub(super) fn steady(seconds: f32, seed: u64, speed: f32, turn: f32) -> At {
    go(seed, seconds, &[(0.0, speed)], &[(0.0, turn)], false, false)
}

fn go(seed: u64, seconds: f32, speed: &[(f32, f32)], turn: &[(f32, f32)], starts: bool, stops: bool) -> At {
    let route = Route { speed: Curve::new(speed), turn: Curve::new(turn), seconds, starts, stops, seed: mix(seed, 42) };
    let gait = Gait::new(&route);
    Box::new(move |t| gait.at(t))
}
