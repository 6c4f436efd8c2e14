//! Wandering: a seeded random walk over a few good transitions that shows everything, evenly and for a while at a time, and never
//! gets stuck.
//!
//! ```text
//! graph -> Order (the best first) -> Sparse (few transitions) -> Segments (what is shown together) -> Optimiser (probabilities) -> Stroll (the walk)
//! ```

mod order;
mod segments;
mod sparse;
mod stroll;

use super::components::main_component_of;
use super::meter;
use super::random::Optimiser;
use super::search_graph::SearchGraph;
use super::shortest::cheapest_walk_to;
use actor::graph::EssentialGraph;
use actor::timeline::Timeline;
use actor::walk::Walk;
use order::Order;
use segments::Segments;
use sparse::{Sparse, mean_distance};
use stroll::Stroll;

/// Transitions put in order, transitions taken out in order, and edges swept that count as an expanded state.
const GATHERED: usize = 64;
const ORDERED: usize = 16;
const SWEPT: usize = 64;
/// Expanded states that making a chain counts as.
const MAKING: usize = 200;

/// A wandering actor: transitions are chosen and their probabilities optimised in slices, then a walk of any length.
#[derive(Clone, Debug)]
pub struct Wander {
    weights: Vec<(usize, f64)>,
    stage: Progress,
    random: u64,
}

#[derive(Clone, Debug)]
enum Progress {
    /// The transitions before this one wait to be put in order.
    Gathering(Order, usize),
    Ordering(Order),
    Choosing(Box<Sparse>),
    Optimising(Box<Choices>),
    /// The graph has no loop at all.
    Stuck,
}

/// What can be chosen from where.
#[derive(Clone, Debug)]
struct Choices {
    segments: Segments,
    frames: Vec<u32>,
    inside: Vec<bool>,
    stroll: Stroll,
}

impl Wander {
    /// A wandering actor, nothing of which is known yet. `weights` are, for behaviours by their number in [`SearchGraph`], how much
    /// more or less often than others they are to be seen; `seed` decides which way is taken.
    #[must_use]
    pub fn new(weights: Vec<(usize, f64)>, seed: u64) -> Self {
        Self { weights, stage: Progress::Gathering(Order::default(), 0), random: seed }
    }

    /// Works on for about as long as `states` expanded states take; whether the probabilities are as good as they get.
    pub fn advance(
        &mut self,
        graph: &EssentialGraph,
        timeline: &Timeline,
        search_graph: &SearchGraph,
        states: u32,
    ) -> bool {
        let mut left = states as usize;
        while left > 0 {
            left -= 1;
            self.stage = match std::mem::replace(&mut self.stage, Progress::Stuck) {
                Progress::Gathering(mut order, next) => {
                    let end = (next + GATHERED).min(graph.transitions().len());
                    for index in next..end {
                        let transition = &graph.transitions()[index];
                        if search_graph.main[transition.from as usize] && search_graph.main[transition.to as usize] {
                            order.add(mean_distance(graph, index as u32), index as u32);
                        }
                    }
                    if end - next < GATHERED {
                        order.end();
                        Progress::Ordering(order)
                    } else {
                        Progress::Gathering(order, end)
                    }
                }
                Progress::Ordering(mut order) => match order.merge(ORDERED) {
                    Some(order) => Progress::Choosing(Box::new(Sparse::new(graph, timeline, search_graph, order))),
                    None => Progress::Ordering(order),
                },
                Progress::Choosing(mut sparse) => match sparse.advance(graph, timeline, search_graph) {
                    Some(states) => {
                        left = left.saturating_sub(states);
                        Progress::Choosing(sparse)
                    }
                    None => {
                        left = left.saturating_sub(MAKING);
                        let choices =
                            choices(graph, timeline, search_graph, &sparse.chosen(), &self.weights, &mut self.random);
                        choices.map_or(Progress::Stuck, |choices| Progress::Optimising(Box::new(choices)))
                    }
                },
                Progress::Optimising(mut choices) => {
                    left = left.saturating_sub(choices.segments.transitions.len() / SWEPT);
                    let ended = choices.segments.optimiser.advance(1);
                    self.stage = Progress::Optimising(choices);
                    if ended {
                        return true;
                    }
                    continue;
                }
                Progress::Stuck => return true,
            };
        }
        false
    }

    /// Whether the graph has no loop to wander in.
    #[must_use]
    pub fn is_stuck(&self) -> bool {
        matches!(self.stage, Progress::Stuck)
    }

    fn choices(&self) -> Option<&Choices> {
        match &self.stage {
            Progress::Optimising(choices) => Some(choices),
            _ => None,
        }
    }

    /// The probabilities, their stationary distribution and the objective; `None` before transitions are chosen, and where
    /// there is no loop. States are runs of frames that are always shown together.
    #[must_use]
    pub fn optimiser(&self) -> Option<&Optimiser> {
        self.choices().map(|choices| &choices.segments.optimiser)
    }

    /// The frames that it visits.
    #[must_use]
    pub fn frames(&self) -> &[u32] {
        self.choices().map_or(&[], |choices| &choices.frames)
    }

    /// A walk from `from` of at least `steps` steps; it first goes to where it can wander. Each call takes another way, and
    /// remembers what was shown before. `None` where nothing leads there, or where transitions are not chosen yet.
    #[must_use]
    pub fn walk(&mut self, graph: &EssentialGraph, timeline: &Timeline, from: u32, steps: u32) -> Option<Walk> {
        let mut random = self.random;
        let Progress::Optimising(choices) = &mut self.stage else { return None };
        let Choices { segments, inside, stroll, .. } = choices.as_mut();
        let is_inside = |frame: u32| inside.get(frame as usize).copied().unwrap_or(false);
        let mut walk = cheapest_walk_to(graph, timeline, from, &is_inside)?;
        let frame = walk.end(graph).unwrap_or(from);
        let steps = steps.saturating_sub(walk.steps(graph));
        walk.append(&stroll.walk(graph, segments, frame, steps, &mut || unit(&mut random))?);
        self.random = random;
        Some(walk)
    }
}

/// A number in [0, 1) (SplitMix64, Steele and others 2014).
fn unit(random: &mut u64) -> f64 {
    *random = random.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *random;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

/// The chain over what the `chosen` transitions keep connected; `None` where that is nothing.
fn choices(
    graph: &EssentialGraph,
    timeline: &Timeline,
    search_graph: &SearchGraph,
    chosen: &[u32],
    weights: &[(usize, f64)],
    random: &mut u64,
) -> Option<Choices> {
    let ends = |&index: &u32| {
        let transition = &graph.transitions()[index as usize];
        (transition.from, transition.to)
    };
    meter::count(chosen.len() + search_graph.main.len());
    let inside = main_component_of(timeline, &chosen.iter().map(ends).collect::<Vec<_>>()).main;
    let frames: Vec<u32> = (0..inside.len() as u32).filter(|&frame| inside[frame as usize]).collect();
    if frames.len() < 2 {
        return None;
    }
    let segments = Segments::new(graph, timeline, search_graph, chosen, &inside, weights)?;
    let stroll = Stroll::new(&segments, timeline, &mut || unit(random));
    Some(Choices { segments, frames, inside, stroll })
}
