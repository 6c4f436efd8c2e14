//! Going to a place, and facing a way there.

use glam::{Vec2, Vec2Swizzles, Vec3Swizzles};

use super::bend::Bend;
use super::detour::Detour;
use super::ground_pose::{angle, turn_of};
use super::search_graph::{Edge, SearchGraph};
use super::tail::Tail;
use super::task::{Found, LEAST_STEP_COST, Outlook, State, Task, cell_of};

/// Seconds that a metre off the place is worth.
const METRE_OFF: f64 = 40.0;
/// Seconds that a radian off the heading is worth.
const RADIAN_OFF: f64 = 16.0;
/// A walk gives up when it has been under way for as long as it takes at this speed, in metres a second, and
/// [`PATIENCE`] seconds more.
const SLOWEST: f64 = 0.4;
const PATIENCE: f64 = 8.0;
/// What walking a metre, turning by a radian on the way and a transition's J usually cost: only for [`Task::guess`].
const A_METRE: f64 = 1.2;
const A_RADIAN: f64 = 1.0;
/// How much more is left than if any motion could follow any other: passes that err in different ways find what the others
/// miss. Every fourth goes straight there.
const TRUST: [f64; 4] = [1.5, 1.0, 2.0, 1.2];
const STRAIGHT: u32 = 1;
const A_TRANSITION: f64 = 4.0;
/// Seconds that [`Task::guess`] takes an end somewhat off to be better by than another try, which comes out somewhere, too: states
/// whose recording passes right through the place come first. Of 0.3 to 10, more was better on the performer.
const ANOTHER_TRY: f64 = 10.0;
/// Looks ahead a second, and how many.
const GLANCES: f64 = 4.0;
const MOST_GLANCES: u32 = 8;
/// Layers a second.
const LAYERS: f64 = 8.0;

/// The task of coming to a place.
///
/// The cost is the time it takes in seconds, plus `realism` times the walk's cost J in the graph, plus what is missing at
/// its end.
#[derive(Clone, Debug)]
pub struct PlaceTask {
    /// Where the followed point shall be, in metres along (X, Z).
    pub place: Vec2,
    /// Which way the body shall face: radians about +Y from +Z.
    pub heading: Option<f32>,
    /// The same as a unit vector along (X, Z).
    wanted: Option<Vec2>,
    /// What coming there that way takes, once [`Self::prepare`] is done.
    detour: Option<Detour>,
    /// How the pose that it shall end in is reached from every frame, once [`Self::prepare`] is done.
    tail: Option<Tail>,
    /// Where the actor is.
    pub start: State,
    /// Weight of the graph's cost against seconds.
    pub realism: f64,
    /// How far the walk is bent so that it ends there, from 0 (not at all) to 1. Searches do not depend on it.
    pub exactness: f64,
    seconds_per_step: f64,
    /// Steps after which a walk gives up.
    pub most_steps: u32,
    step_cost: f64,
    steps_in_layer: u32,
}

/// How well a walk reaches a place.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct PlaceReport {
    /// Distance in metres between the place and where the walk ends.
    pub distance: f64,
    /// Angle in radians between the heading wanted and reached; `None` where none is wanted.
    pub turn: Option<f64>,
    /// The frame that it ends in, where a pose is wanted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frame: Option<u32>,
}

impl PlaceTask {
    /// Going from `start` to `place`.
    #[must_use]
    pub fn new(search_graph: &SearchGraph, start: State, place: Vec2, heading: Option<f32>, realism: f64) -> Self {
        let wanted = heading.map(|heading| turn_of(heading).yx());
        let a_step = 1.0 / search_graph.fps + (realism * search_graph.alpha).max(LEAST_STEP_COST);
        let distance = f64::from(search_graph.point_at(start.frame, start.ground_pose).xz().distance(place));
        Self {
            place,
            heading,
            wanted,
            detour: wanted.map(|wanted| Detour::new(search_graph, place, wanted, a_step)),
            tail: None,
            start,
            realism,
            exactness: 0.0,
            seconds_per_step: 1.0 / search_graph.fps,
            step_cost: a_step,
            most_steps: ((PATIENCE + distance / SLOWEST) * search_graph.fps).min(1e6) as u32,
            steps_in_layer: ((search_graph.fps / LAYERS) as u32).max(1),
        }
    }

    /// The same, ending in the pose of `frame`, which must exist.
    #[must_use]
    pub fn in_pose(mut self, search_graph: &SearchGraph, frame: u32) -> Self {
        self.tail = Some(Tail::new(search_graph, frame));
        self
    }

    /// Learns what detours facing a way takes, and what leads to the pose to end in, for as long as expanding up to so many
    /// `states` does; how many it took, fewer than `states` once that is done. A search that begins before finds the way all the
    /// same, later.
    pub fn prepare(&mut self, search_graph: &SearchGraph, states: u32) -> u32 {
        let (price, mut taken) = (self.price(), 0);
        if let Some(tail) = &mut self.tail {
            taken = tail.advance(search_graph, states, price);
        }
        taken + self.detour.as_mut().map_or(0, |detour| detour.advance(states - taken))
    }

    /// What following an edge adds to the cost.
    fn price(&self) -> impl Fn(&Edge) -> f64 + use<> {
        let (a_step, realism, least) = (self.seconds_per_step, self.realism, self.step_cost);
        move |edge| {
            let steps = f64::from(edge.steps);
            (steps * a_step + realism * edge.cost).max(steps * least)
        }
    }

    /// Where a walk that has come to `state` ends, if it then goes to the pose that it shall end in, and what that costs; `None`
    /// where no walk leads to that.
    fn after_tail(&self, state: &State) -> Option<State> {
        let Some(tail) = &self.tail else { return Some(*state) };
        let (cost, ground_pose) = tail.from(state.frame, state.ground_pose)?;
        Some(State { frame: tail.to, ground_pose, cost: state.cost + cost, ..*state })
    }

    /// A walk that was found, on to the pose that it shall end in.
    #[must_use]
    pub fn completed(&self, search_graph: &SearchGraph, found: &Found) -> Found {
        let mut found = found.clone();
        let Some(tail) = &self.tail else { return found };
        for edge in tail.edges(search_graph, found.end.frame) {
            let Some(end) = self.follow(search_graph, &found.end, edge) else { break };
            found.end = end;
            found.edges.push(edge);
        }
        found
    }

    /// Metres off the place and radians off the heading.
    fn missing(&self, search_graph: &SearchGraph, state: &State) -> (f64, f64) {
        let off = f64::from(search_graph.point_at(state.frame, state.ground_pose).xz().distance(self.place));
        let turn = self.wanted.map_or(0.0, |wanted| {
            let face = search_graph.face_at(state.frame, state.ground_pose);
            f64::from(angle(face.perp_dot(wanted), face.dot(wanted)).abs())
        });
        (off, turn)
    }

    /// What ending costs after the walk from there to the pose to end in.
    fn ending_in_pose(&self, search_graph: &SearchGraph, state: State) -> Option<f64> {
        let end = self.after_tail(&State { cost: 0.0, ..state })?;
        let (off, turn) = self.missing(search_graph, &end);
        Some(end.cost + off * METRE_OFF + turn * RADIAN_OFF)
    }

    /// What ending costs where the recording passes nearest, between one glance and the next.
    fn passing(&self, before: Option<(Vec2, Vec2)>, (point, face): (Vec2, Vec2)) -> f64 {
        let (mut nearest, mut facing) = (point, face);
        if let Some((from, faced)) = before {
            let way = point - from;
            let share = ((self.place - from).dot(way) / way.length_squared().max(1e-9)).clamp(0.0, 1.0);
            (nearest, facing) = (from + share * way, faced.lerp(face, share));
        }
        let turn =
            self.wanted.map_or(0.0, |wanted| f64::from(angle(facing.perp_dot(wanted), facing.dot(wanted)).abs()));
        f64::from(nearest.distance(self.place)) * METRE_OFF + turn * RADIAN_OFF
    }

    /// How a walk that was found is bent so that it ends at the place.
    pub(super) fn bend(&self, search_graph: &SearchGraph, found: &Found) -> Bend {
        if self.exactness <= 0.0 {
            return Bend::default();
        }
        let turn = self.wanted.map_or(0.0, |wanted| {
            let face = search_graph.face_at(found.end.frame, found.end.ground_pose);
            angle(-face.perp_dot(wanted), face.dot(wanted))
        });
        let (track, fps) = (found.track(search_graph), search_graph.fps as f32);
        Bend::to_place(self.place, turn, &track, fps, self.exactness as f32)
    }

    /// How well a walk that was found reaches the place as it is.
    #[must_use]
    pub fn judge(&self, search_graph: &SearchGraph, found: &Found) -> PlaceReport {
        self.judge_bent(search_graph, found, &Bend::default())
    }

    /// The same once it is bent.
    pub(super) fn judge_bent(&self, search_graph: &SearchGraph, found: &Found, bend: &Bend) -> PlaceReport {
        let bent = bend.0.last().map(|pose| State { ground_pose: pose.after(&found.end.ground_pose), ..found.end });
        let (distance, turn) = self.missing(search_graph, &bent.unwrap_or(found.end));
        let frame = self.tail.as_ref().map(|_| found.end.frame);
        PlaceReport { distance, turn: self.heading.map(|_| turn), frame }
    }
}

impl Task for PlaceTask {
    fn starts(&self, _: &SearchGraph) -> Vec<State> {
        vec![self.start]
    }

    fn follow(&self, search_graph: &SearchGraph, from: &State, index: u32) -> Option<State> {
        let way = search_graph.edge(index);
        let cost = self.price()(way);
        Some(State {
            frame: way.to,
            ground_pose: from.ground_pose.after(&way.ground_pose),
            travelled: from.travelled,
            steps: from.steps + way.steps,
            cost: from.cost + cost,
        })
    }

    /// Coming nearer takes steps at the best speed, turning takes steps at the fastest turn, and both may be done at once.
    fn remaining(&self, search_graph: &SearchGraph, state: &State) -> f64 {
        let (off, turn) = self.missing(search_graph, state);
        let price = |missing: f64, worth: f64, a_step: f64| match a_step > 0.0 {
            true => missing * worth.min(self.step_cost / a_step),
            false => missing * worth,
        };
        price(off, METRE_OFF, search_graph.best_speed).max(price(turn, RADIAN_OFF, search_graph.best_turn))
    }

    /// The recording goes on for as long as that pays, and ends where it passes the place; or what is then left takes what it
    /// takes if any motion could follow any other, and a little more.
    fn guess(&self, search_graph: &SearchGraph, state: &State, outlook: &Outlook) -> f64 {
        let trust = TRUST[outlook.pass as usize % TRUST.len()];
        let stride = ((search_graph.fps / GLANCES) as u32).max(1);
        let mut least = f64::INFINITY;
        let mut before = None;
        for glance in 0..=MOST_GLANCES {
            let steps = glance * stride;
            let Some((point, _)) = search_graph.ahead(state.frame, state.ground_pose, steps) else { break };
            let (point, face) = (point.xz(), search_graph.face_at(state.frame + steps, state.ground_pose));
            let left = match self.detour.as_ref().filter(|_| outlook.pass % 4 != STRAIGHT) {
                Some(detour) => detour.from(point, face, A_METRE),
                None => {
                    let away = self.place - point;
                    let off = f64::from(away.length());
                    // Up to pi as the angle does, without its arc tangent.
                    let turn = (1.0 - f64::from(face.dot(away.normalize_or_zero()))) * std::f64::consts::FRAC_PI_2;
                    let then = self.wanted.map_or(0.0, |wanted| {
                        (1.0 - f64::from(face.dot(wanted))) * std::f64::consts::FRAC_PI_2 * (1.0 - 0.7 * off.min(1.0))
                    });
                    off * A_METRE + (off.min(1.0) * turn + then) * A_RADIAN
                }
            };
            let goes_on = trust * left + self.realism * A_TRANSITION + ANOTHER_TRY;
            let ends = if self.tail.is_some() {
                let there = State { frame: state.frame + steps, ..*state };
                self.ending_in_pose(search_graph, there).unwrap_or(f64::INFINITY)
            } else {
                self.passing(before.replace((point, face)), (point, face))
            };
            least = least.min(f64::from(steps) * self.step_cost + goes_on.min(ends));
        }
        least
    }

    fn ending(&self, search_graph: &SearchGraph, state: &State) -> Option<f64> {
        self.ending_in_pose(search_graph, *state)
    }

    fn halts(&self, _: &SearchGraph, state: &State) -> bool {
        state.steps >= self.most_steps
    }

    fn layer(&self, state: &State) -> usize {
        (state.steps / self.steps_in_layer) as usize
    }

    /// The eighths of the compass that bodies face: who stands at the place the wrong way round must not crowd out who turns.
    fn crowd(&self, search_graph: &SearchGraph, state: &State) -> (usize, usize) {
        let face = search_graph.face_at(state.frame, state.ground_pose);
        let eighth = [face.x > 0.0, face.y > 0.0, face.x.abs() > face.y.abs()];
        (eighth.iter().fold(0, |number, &bit| 2 * number + usize::from(bit)), 3)
    }

    fn cell(&self, _: &SearchGraph, state: &State, fineness: u32) -> u64 {
        let finer = (1 << fineness.min(8)) as f32;
        cell_of(state, (8 >> fineness.min(3), 0.2 / finer, 0.2 / finer))
    }
}
