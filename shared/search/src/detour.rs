//! What it takes to come to a place facing a way, if any motion of the capture could follow any other: the guide of the search
//! for a place with a heading.
//!
//! An actor that stands at the place the wrong way round has to walk a loop, which a search that looks at distance and angle
//! only never begins. So one Dijkstra goes backwards from the goal, over places and headings on a grid, by short stretches
//! of the recordings.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3Swizzles};

use super::ground_pose::{GroundPose, angle, turn_of};
use super::meter;
use super::queue::Queue;
use super::search_graph::SearchGraph;
use kernels::sort;

/// Cells along each side of the grid, metres of one, and bins of headings.
const SIDE: i32 = 32;
const CELL: f32 = 0.25;
const BINS: i32 = 24;
/// Seconds of a stretch, long enough that a kick has swung back and is no turn, and how many there are a second of recording
/// to choose from.
const SECONDS: f64 = 0.8;
const STRETCHES: f64 = 5.0;
/// Cells that are settled in the time of an expanded state.
const CELLS_A_STATE: u32 = 8;
/// Fineness to which stretches are told apart.
const SAME_METRES: f32 = 0.1;
const SAME_RADIANS: f32 = 0.15;

/// The least cost from every cell.
#[derive(Clone, Debug)]
pub(super) struct Detour {
    place: Vec2,
    wanted: Vec2,
    least: Vec<f32>,
    queue: Queue,
    stretches: Vec<Stretch>,
    /// Cost of a stretch.
    cost: f64,
}

/// A short stretch of a recording as the body sees it that begins facing +Z.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    shift: Vec2,
    turn: f32,
}

impl Detour {
    /// Nothing is known yet. `wanted` is the way to face, a unit vector along (X, Z).
    pub fn new(search_graph: &SearchGraph, place: Vec2, wanted: Vec2, a_step: f64) -> Self {
        let cells = (SIDE * SIDE * BINS) as usize;
        let steps = ((SECONDS * search_graph.fps) as u32).max(1);
        let mut detour = Self {
            place,
            wanted,
            least: vec![f32::INFINITY; cells],
            queue: Queue::default(),
            stretches: stretches(search_graph, steps),
            cost: a_step * f64::from(steps),
        };
        detour.reach(Vec2::ZERO, 0.0, 0.0);
        detour
    }

    /// Settles cells for up to `states`, so many each; how many states that took, fewer than `states` once all are settled. It
    /// is the same sum however it is sliced.
    pub fn advance(&mut self, states: u32) -> u32 {
        for used in 0..states {
            for _ in 0..CELLS_A_STATE {
                let Some((cost, cell)) = self.queue.pop() else { return used };
                self.settle(cost, cell);
            }
        }
        states
    }

    fn settle(&mut self, cost: f64, cell: u64) {
        if cost as f32 > self.least[cell as usize] {
            return;
        }
        meter::count(self.stretches.len());
        let cell = cell as i32;
        let at = |index: i32| (index - SIDE / 2) as f32 * CELL;
        let (place, heading) = (Vec2::new(at(cell / BINS % SIDE), at(cell / BINS / SIDE)), (cell % BINS) as f32);
        for index in 0..self.stretches.len() {
            let stretch = self.stretches[index];
            let before = heading * (TAU / BINS as f32) - stretch.turn;
            let facing = GroundPose { turn: turn_of(before), shift: Vec2::ZERO };
            self.reach(place - facing.rotate(stretch.shift), before, cost + self.cost);
        }
    }

    fn reach(&mut self, place: Vec2, heading: f32, cost: f64) {
        let (cell, outside) = cell_of(place, heading);
        if outside > 0.0 || cost as f32 >= self.least[cell] {
            return;
        }
        self.least[cell] = cost as f32;
        self.queue.push(cost, cell as u64);
    }

    /// What it takes for a body at `point` that faces along `face`, where `a_metre` is what it takes to come from outside of
    /// the grid.
    pub fn from(&self, point: Vec2, face: Vec2, a_metre: f64) -> f64 {
        // As the goal sees it, which faces +Z.
        let goal = GroundPose { turn: Vec2::new(self.wanted.y, -self.wanted.x), shift: Vec2::ZERO };
        let (place, face) = (goal.rotate(point - self.place), goal.rotate(face));
        let (cell, outside) = cell_of(place, angle(face.x, face.y));
        f64::from(self.least[cell].min(1e3)) + f64::from(outside) * a_metre
    }
}

/// The nearest cell, and how many metres it is away for a place outside of the grid.
fn cell_of(place: Vec2, heading: f32) -> (usize, f32) {
    let most = (SIDE / 2 - 1) as f32 * CELL;
    let inside = place.clamp(Vec2::splat(-most), Vec2::splat(most));
    let index = |metres: f32| (metres / CELL).round() as i32 + SIDE / 2;
    let bin = ((heading * (BINS as f32 / TAU)).round() as i32).rem_euclid(BINS);
    (((index(inside.y) * SIDE + index(inside.x)) * BINS + bin) as usize, place.distance(inside))
}

/// Stretches of all recordings that are not alike.
fn stretches(search_graph: &SearchGraph, steps: u32) -> Vec<Stretch> {
    let mut keys = Vec::new();
    let bin = |value: f32, size: f32| ((value / size).round() as i32 + (1 << 16)) as u32;
    for frame in (0..search_graph.frame_count()).step_by((search_graph.fps / STRETCHES) as usize + 1) {
        let Some((point, _)) =
            search_graph.ahead(frame, GroundPose::IDENTITY, steps).filter(|_| search_graph.live[frame as usize])
        else {
            continue;
        };
        let (face, then) = (
            search_graph.face_at(frame, GroundPose::IDENTITY),
            search_graph.face_at(frame + steps, GroundPose::IDENTITY),
        );
        let body = GroundPose { turn: Vec2::new(face.y, -face.x), shift: Vec2::ZERO };
        let shift = body.rotate(point.xz() - search_graph.points[frame as usize].xz());
        let turn = body.rotate(then);
        keys.push(sort::key([
            bin(angle(turn.x, turn.y), SAME_RADIANS),
            bin(shift.x, SAME_METRES),
            bin(shift.y, SAME_METRES),
            0,
        ]));
    }
    sort::sort(&mut keys);
    keys.dedup();
    let value = |bin: u32, size: f32| (bin as i32 - (1 << 16)) as f32 * size;
    let stretch = |key: u128| {
        let [turn, x, z, _] = sort::numbers(key);
        Stretch { turn: value(turn, SAME_RADIANS), shift: Vec2::new(value(x, SAME_METRES), value(z, SAME_METRES)) }
    };
    keys.into_iter().map(stretch).collect()
}
