//! Searches that count on bends: while a walk is looked for, each of its steps is turned and moved towards the path by what a
//! bend may change it, so that what is found is what can be brought onto the path.

use glam::{Vec2, Vec3Swizzles};
use kernels::scalar::{atan2, sin_cos};

use super::bend::limits::{MOST_STRIDE, MOST_TURN, STEP, WALKS};
use super::curve::Curve;
use super::ground_pose::GroundPose;
use super::search_graph::SearchGraph;
use super::task::State;

/// The share of what a bend may change that searches count on: it spreads changes over time, which takes some.
const SHARE: f64 = 0.7;
/// Seconds ahead at which the recording shall be on the path, too.
const AHEAD: f64 = 0.4;
/// Metres off the path that are sway.
const SWAY: f32 = 0.02;
/// Metre-seconds that a second of as much change as may be costs.
const PRICE: f64 = 0.02;

/// How much a step may be changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Steering {
    /// Radians and metres a step of the graph, at a walk.
    turn: f32,
    shift: f32,
    fps: f64,
}

impl Steering {
    /// What walks that are bent by the share `exactness` may count on.
    pub fn new(exactness: f64, fps: f64) -> Self {
        let steps = f64::from(STEP) * fps;
        let share = SHARE * exactness / steps.max(1e-6);
        Self { turn: (f64::from(MOST_TURN) * share) as f32, shift: (f64::from(MOST_STRIDE) * share) as f32, fps }
    }

    /// Metres by which a step of the graph may come nearer to the path beside what it walks.
    pub fn shift(&self) -> f64 {
        f64::from(self.shift)
    }

    /// Turns and moves the end of an edge, which went `way` metres in `steps` steps, towards `curve`; and what that costs, in
    /// metre-seconds.
    pub fn apply(&self, curve: &Curve, search_graph: &SearchGraph, state: &mut State, way: f32, steps: u32) -> f64 {
        let walks = (way * self.fps as f32 / (steps.max(1) as f32 * WALKS)).min(1.0);
        let room = walks * steps as f32;
        if room <= 0.0 || self.shift <= 0.0 {
            return 0.0;
        }
        let here = search_graph.point_at(state.frame, state.ground_pose).xz();
        let off = curve.at(state.travelled).xz() - here;
        let length = off.length();
        let shift = off / length.max(1e-6) * (length - SWAY).clamp(0.0, self.shift * room);
        let glance = ((AHEAD * self.fps) as u32).max(1);
        let mut turn = 0.0;
        if let Some((point, [ahead, _])) = search_graph.ahead(state.frame, state.ground_pose, glance) {
            let goes = point.xz() - here;
            let leads = curve.at(state.travelled + f64::from(ahead)).xz() - here - shift;
            if goes.length_squared().min(leads.length_squared()) > 1e-3 {
                // Headings turn from Z to X.
                let angle = atan2(leads.perp_dot(goes), leads.dot(goes));
                turn = angle.clamp(-self.turn * room, self.turn * room);
            }
        }
        let (sin, cos) = sin_cos(turn);
        let turned = GroundPose { turn: Vec2::new(cos, sin), shift: Vec2::ZERO };
        let moved = GroundPose { shift: here + shift - turned.rotate(here), ..turned };
        state.ground_pose = moved.after(&state.ground_pose);
        let used = (shift.length() / self.shift).max(turn.abs() / self.turn);
        PRICE * f64::from(used) / self.fps
    }
}
