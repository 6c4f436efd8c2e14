//! What a search over the ground looks for, so that the oracle and the tool search for the same thing.

use glam::Vec3;

use super::ground_pose::GroundPose;
use super::search_graph::SearchGraph;
use actor::walk::{Leg, Walk};

/// The end of a walk that is being extended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// The frame.
    pub frame: u32,
    /// Where its recorded frames stand: `world_from_recorded`.
    pub ground_pose: GroundPose,
    /// Metres travelled so far.
    pub travelled: f64,
    /// Steps so far.
    pub steps: u32,
    /// What the task's errors and the edges have cost so far: J_c of thesis equation 3.5, TVCG equation 11.
    pub cost: f64,
}

impl State {
    /// A walk that has not begun.
    #[must_use]
    pub fn start(frame: u32, ground_pose: GroundPose) -> Self {
        Self { frame, ground_pose, travelled: 0.0, steps: 0, cost: 0.0 }
    }
}

/// A search: which walks there are to choose from, and what they cost.
pub trait Task {
    /// Where walks may begin.
    fn starts(&self, search_graph: &SearchGraph) -> Vec<State>;

    /// `from` after the edge with this index, or `None` where the task forbids it. Costs never fall along a walk, and rise
    /// by at least [`LEAST_STEP_COST`] a step.
    fn follow(&self, search_graph: &SearchGraph, from: &State, edge: u32) -> Option<State>;

    /// A lower bound of what any walk from `state` on still adds until its end, with what ending costs: admissible, so that
    /// pruning by it loses nothing.
    fn remaining(&self, search_graph: &SearchGraph, state: &State) -> f64;

    /// What it costs to end at `state`; `None` where a walk cannot end there.
    fn ending(&self, search_graph: &SearchGraph, state: &State) -> Option<f64>;

    /// Whether a walk that has come to `state` must end there: the halting condition.
    fn halts(&self, search_graph: &SearchGraph, state: &State) -> bool;

    /// What is likely to be added from `state` on: it decides which states are expanded first, and prunes nothing.
    fn guess(&self, search_graph: &SearchGraph, state: &State, outlook: &Outlook) -> f64 {
        let _ = (search_graph, state, outlook);
        0.0
    }

    /// How far `state` is, in equal strides: states of one layer are compared with each other. It never falls along a walk.
    fn layer(&self, state: &State) -> usize;

    /// States of a layer are of several crowds, by number; none gets more than its share, one of so many parts, or what is
    /// cheap now would crowd out what turns out well.
    fn crowd(&self, search_graph: &SearchGraph, state: &State) -> (usize, usize) {
        (search_graph.sequence(state.frame), 4)
    }

    /// States of a layer with the same cell are alike, the more so the larger `fineness` is.
    fn cell(&self, search_graph: &SearchGraph, state: &State, fineness: u32) -> u64;
}

/// Standing still costs at least this much a step, so that no search goes on for nothing.
pub const LEAST_STEP_COST: f64 = 1e-7;

/// What the walks found so far say of what is to come.
#[derive(Clone, Debug, Default)]
pub struct Outlook {
    /// What the best walk so far cost from each layer on; empty where there is none.
    pub to_go: Vec<f64>,
    /// Number of the pass.
    pub pass: u32,
}

impl Outlook {
    /// The outlook of a pass after those that found `best`.
    pub(super) fn new(task: &impl Task, search_graph: &SearchGraph, best: Option<&Found>, pass: u32) -> Self {
        let mut to_go = Vec::new();
        if let Some(best) = best {
            for state in best.states(task, search_graph) {
                let layer = task.layer(&state);
                if layer >= to_go.len() {
                    to_go.resize(layer + 1, best.cost - state.cost);
                }
            }
        }
        Self { to_go, pass }
    }

    /// What the best walk so far cost from `layer` on, which may lie between two.
    #[must_use]
    pub fn after(&self, layer: f64) -> Option<f64> {
        let index = layer as usize;
        let here = *self.to_go.get(index)?;
        let next = self.to_go.get(index + 1).copied().unwrap_or(0.0);
        Some(here + (next - here) * (layer - index as f64))
    }
}

/// A walk that a search has found.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// Its cost with what its end costs.
    pub cost: f64,
    /// Where it begins.
    pub start: State,
    /// Its edges, by index in [`SearchGraph`].
    pub edges: Vec<u32>,
    /// Where it ends.
    pub end: State,
}

impl Found {
    /// The same as a walk through the graph.
    #[must_use]
    pub fn walk(&self, search_graph: &SearchGraph) -> Walk {
        walk_of(search_graph, self.start.frame, &self.edges)
    }

    /// The followed point after each step, from the start on; between two samples on a straight line.
    #[must_use]
    pub fn track(&self, search_graph: &SearchGraph) -> Vec<Vec3> {
        let mut ground_pose = self.start.ground_pose;
        let mut track = vec![search_graph.point_at(self.start.frame, ground_pose)];
        for &index in &self.edges {
            for sample in search_graph.samples(index) {
                let (from, to) = (track[track.len() - 1], ground_pose.apply(sample.point));
                track.extend((1..=sample.steps).map(|step| from.lerp(to, step as f32 / sample.steps as f32)));
            }
            ground_pose = ground_pose.after(&search_graph.edge(index).ground_pose);
        }
        track
    }

    /// Its states, from the start on: what following `task` along its edges gives.
    #[must_use]
    pub fn states(&self, task: &impl Task, search_graph: &SearchGraph) -> Vec<State> {
        let mut states = vec![self.start];
        for &edge in &self.edges {
            let Some(next) = states.last().and_then(|state| task.follow(search_graph, state, edge)) else { break };
            states.push(next);
        }
        states
    }
}

/// The walk that takes `indices` from frame `start`.
pub(super) fn walk_of(search_graph: &SearchGraph, start: u32, indices: &[u32]) -> Walk {
    let mut walk = Walk::default();
    let mut frame = start;
    for &index in indices {
        let edge = search_graph.edge(index);
        walk.cost += edge.cost;
        match edge.transition {
            None => {
                walk.push_recorded(frame, edge.to, 1);
                walk.duration += 1;
            }
            Some(transition) => {
                walk.legs.push(Leg::Synthetic(transition));
                walk.deformation += edge.deformation;
                walk.duration += edge.nodes;
            }
        }
        frame = edge.to;
    }
    walk
}

/// A cell of frames, headings and places: `sizes` are frames, radians and metres. Different cells may share a number.
pub(super) fn cell_of(state: &State, (frames, radians, metres): (u32, f32, f32)) -> u64 {
    let bin = |value: f32, size: f32| u64::from((value / size).floor() as i32 as u32);
    let parts = [
        u64::from(state.frame / frames.max(1)),
        // A heading's bin without its arc tangent: both components, which is as fine near the axes and finer between.
        bin(state.ground_pose.turn.x, radians) << 32 | bin(state.ground_pose.turn.y, radians),
        bin(state.ground_pose.shift.x, metres) << 32 | bin(state.ground_pose.shift.y, metres),
    ];
    // Multiplication and rotation as in FxHash, which spreads such keys well.
    parts.iter().fold(0, |hash: u64, &part| (hash.rotate_left(5) ^ part).wrapping_mul(0x517c_c1b7_2722_0a95))
}
