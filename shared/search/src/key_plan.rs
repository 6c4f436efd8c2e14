//! Key poses, leg after leg.

use std::collections::VecDeque;

use super::answer::{Goal, KeyRow};
use super::keys::{KeyLeg, LegEnd};
use super::request::{KeysRequest, RequestError};
use super::scene::Scene;
use actor::walk::Walk;

/// Key poses that are being worked on.
#[derive(Clone, Debug)]
pub(super) struct KeyPlan {
    /// Those to come.
    to_do: VecDeque<Stop>,
    leg: Option<KeyLeg>,
    /// The walk so far, where it ends, and its steps.
    pub walk: Walk,
    frame: u32,
    taken: u32,
    pub rows: Vec<KeyRow>,
}

/// A frame to be at after so many steps.
#[derive(Clone, Copy, Debug)]
struct Stop {
    frame: u32,
    /// The frame that was asked for, where nothing leads to it.
    instead_of: Option<u32>,
    step: u32,
    /// Whether it was asked for, or is only a stop on a long way.
    has_row: bool,
}

impl KeyPlan {
    /// Nothing is done yet; the actor is in frame `from`.
    pub fn new(scene: &Scene, from: u32, request: &KeysRequest) -> Result<Self, RequestError> {
        // By time, then in the order given.
        let mut keys = Vec::new();
        for (index, key) in request.poses.iter().enumerate() {
            let frame = key.pose.find(scene.timeline)?;
            keys.push(kernels::sort::key([(key.time * scene.search_graph.fps).round() as u32, index as u32, frame, 0]));
        }
        kernels::sort::sort(&mut keys);
        let longest = KeyLeg::longest(scene.timeline.frame_count());
        let mut to_do = VecDeque::new();
        let mut before = 0;
        for [step, _, frame, _] in keys.into_iter().map(kernels::sort::numbers) {
            // A long leg is cut: the actor comes by its goal on the way.
            while step - before > longest && scene.search_graph.main[frame as usize] {
                before += longest;
                to_do.push_back(Stop { frame, instead_of: None, step: before, has_row: false });
            }
            to_do.push_back(Stop { frame, instead_of: None, step, has_row: true });
            before = step;
        }
        Ok(Self { to_do, leg: None, walk: Walk::default(), frame: from, taken: 0, rows: Vec::new() })
    }

    /// Looks at up to `budget` frames at a time; whether all legs are done.
    pub fn advance(&mut self, scene: &Scene, budget: u32) -> bool {
        let Some(&stop) = self.to_do.front() else { return true };
        let (graph, timeline) = (scene.graph, scene.timeline);
        // The error of the leg before is handed on: what is wanted is the time, not the duration.
        let wanted = stop.step.saturating_sub(self.taken);
        let leg = self.leg.get_or_insert_with(|| KeyLeg::new(graph, timeline, self.frame, stop.frame, wanted));
        if !leg.advance(graph, timeline, budget) {
            return false;
        }
        let end = leg.finish(graph, timeline);
        self.leg = None;
        let reached = match end {
            LegEnd::Walk(walk, steps) => {
                self.walk.append(&walk);
                self.taken += steps;
                self.frame = stop.frame;
                Some(self.taken)
            }
            LegEnd::NoWay => {
                let other = scene.search_graph.substitute(stop.frame).filter(|_| stop.instead_of.is_none());
                if let (Some(other), Some(front)) = (other, self.to_do.front_mut()) {
                    (front.frame, front.instead_of) = (other, Some(stop.frame));
                    return false;
                }
                None
            }
        };
        self.to_do.pop_front();
        if stop.has_row {
            let frame = stop.instead_of.unwrap_or(stop.frame);
            self.rows.push(KeyRow { frame, shown: stop.frame, wanted: stop.step, reached });
        }
        self.to_do.is_empty()
    }

    /// The table so far.
    pub fn goal(&self) -> Goal {
        let error = |row: &KeyRow| row.reached.map(|reached| f64::from(reached.abs_diff(row.wanted)));
        let errors: Vec<f64> = self.rows.iter().filter_map(error).collect();
        let mean_error = errors.iter().sum::<f64>() / errors.len().max(1) as f64;
        Goal::Keys { rows: self.rows.clone(), mean_error }
    }
}
