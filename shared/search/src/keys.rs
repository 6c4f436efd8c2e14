//! Key poses at given times: from one pose to the next in a given number of steps (thesis section 3.5.2 and
//! figure 3.18; TVCG section 4.3.2 and table 2).
//!
//! Where the papers search depth-first, this is exact: the cheapest walk to every frame in every number of steps, a table
//! filled from the start and pruned from the end, as both ends are known. Time errors are handed on by the caller, who
//! knows when the leg before arrived.

use super::meter;
use super::shortest::{Measure, to_targets};
use actor::graph::EssentialGraph;
use actor::timeline::Timeline;
use actor::walk::{Leg, Walk, steps_of};

/// What a step too early or too late costs, in units of J: so much realism may be given up for being on time.
pub(super) const STEP_OFF: f64 = 0.5;
/// Steps beyond the wanted time that are looked at.
const LATEST: u32 = 25;
/// Cells that nothing leads to which count as one that is looked at.
const EMPTY_CELLS: usize = 256;
/// Most cells of the table: 8 bytes each.
const MOST_CELLS: usize = 8 << 20;

/// How a leg ended.
#[derive(Clone, Debug, PartialEq)]
pub enum LegEnd {
    /// The best walk, and the steps it takes.
    Walk(Walk, u32),
    /// No walk leads there, in whatever time; an actor can be in the first frames of a sequence only where it begins there.
    NoWay,
}

/// The search for one leg between two key poses.
#[derive(Clone, Debug)]
pub struct KeyLeg {
    from: u32,
    to: u32,
    wanted: u32,
    frames: usize,
    /// Steps that the table holds, 0 included.
    columns: usize,
    /// Least steps from each frame to `to`: the pruning from the end.
    least: Vec<f64>,
    costs: Vec<f32>,
    /// The edge that each cell was reached by: 0 for a recorded step, else the transition's index plus 1.
    edges: Vec<u32>,
    /// The next cell to be expanded.
    cell: usize,
}

impl KeyLeg {
    /// The longest leg in steps that a table can hold for a capture of so many frames.
    #[must_use]
    pub fn longest(frame_count: u32) -> u32 {
        (MOST_CELLS / frame_count.max(1) as usize) as u32 / 2
    }

    /// From frame `from` to frame `to` in `wanted` steps, which are taken to be at most [`Self::longest`]. Frames that do
    /// not exist have no way.
    #[must_use]
    pub fn new(graph: &EssentialGraph, timeline: &Timeline, from: u32, to: u32, wanted: u32) -> Self {
        let frames = timeline.frame_count();
        let wanted = wanted.min(Self::longest(frames));
        let least = to_targets(graph, timeline, &[to], Measure::Steps);
        let quickest = least.get(from as usize).copied().unwrap_or(f64::INFINITY);
        // A time that is too short to be met is met as closely as the graph allows.
        let columns = match quickest.is_finite() {
            true => (wanted + LATEST).max(quickest as u32) as usize + 1,
            false => 0,
        };
        let cells = columns * frames as usize;
        let mut leg = Self {
            from,
            to,
            wanted,
            frames: frames as usize,
            columns,
            least,
            costs: vec![f32::INFINITY; cells],
            edges: vec![0; cells],
            cell: 0,
        };
        if let Some(first) = leg.costs.get_mut(from as usize) {
            *first = 0.0;
        }
        leg
    }

    /// Looks at up to `budget` frames at a time; whether the table is full.
    pub fn advance(&mut self, graph: &EssentialGraph, timeline: &Timeline, budget: u32) -> bool {
        let mut left = budget;
        // Cells that nothing leads to cost little, but there are many.
        let end = self.cell.saturating_add(budget as usize * EMPTY_CELLS).min(self.costs.len());
        while self.cell < end && left > 0 {
            let (step, frame) = (self.cell / self.frames, (self.cell % self.frames) as u32);
            let cost = self.costs[self.cell];
            self.cell += 1;
            if !cost.is_finite() {
                continue;
            }
            left -= 1;
            meter::count(graph.transitions_from(frame).len() + 1);
            if let Some(next) = timeline.next(frame) {
                self.reach(step + 1, next, cost + graph.alpha() as f32, 0);
            }
            for index in graph.transitions_from(frame) {
                let transition = &graph.transitions()[index];
                let then = step + steps_of(transition) as usize;
                self.reach(then, transition.to, cost + transition.cost(graph.alpha()) as f32, index as u32 + 1);
            }
        }
        self.cell >= self.costs.len()
    }

    fn reach(&mut self, step: usize, frame: u32, cost: f32, edge: u32) {
        // From the end: who cannot arrive in time any more is not worth going on with.
        if step >= self.columns || step as f64 + self.least[frame as usize] >= self.columns as f64 {
            return;
        }
        let cell = step * self.frames + frame as usize;
        if cost < self.costs[cell] {
            self.costs[cell] = cost;
            self.edges[cell] = edge;
        }
    }

    /// The best walk, once the table is full: of all arrivals the one with the least cost and time error together.
    #[must_use]
    pub fn finish(&self, graph: &EssentialGraph, timeline: &Timeline) -> LegEnd {
        let price = |step: usize| {
            let cost = self.costs[step * self.frames + self.to as usize];
            f64::from(cost) + STEP_OFF * (step as f64 - f64::from(self.wanted)).abs()
        };
        let arrivals = (0..self.columns).filter(|&step| price(step).is_finite());
        let Some(step) = arrivals.min_by(|&a, &b| price(a).total_cmp(&price(b))) else { return LegEnd::NoWay };
        match self.trace(graph, timeline, step) {
            Some(walk) => LegEnd::Walk(walk, step as u32),
            None => LegEnd::NoWay,
        }
    }

    fn trace(&self, graph: &EssentialGraph, timeline: &Timeline, steps: usize) -> Option<Walk> {
        let (mut step, mut frame) = (steps, self.to);
        let mut edges = Vec::new();
        while step > 0 {
            let edge = self.edges[step * self.frames + frame as usize];
            edges.push((edge, frame));
            match edge.checked_sub(1) {
                None => {
                    step -= 1;
                    frame = timeline.offset(frame, -1)?;
                }
                Some(index) => {
                    let transition = graph.transitions().get(index as usize)?;
                    step = step.checked_sub(steps_of(transition) as usize)?;
                    frame = transition.from;
                }
            }
        }
        debug_assert_eq!(frame, self.from);
        let mut walk = Walk::default();
        let mut here = self.from;
        for &(edge, to) in edges.iter().rev() {
            match edge.checked_sub(1) {
                None => walk.push_recorded(here, to, 1),
                Some(index) => walk.legs.push(Leg::Synthetic(index)),
            }
            here = to;
        }
        Walk::of_legs(walk.legs, graph).ok()
    }
}
