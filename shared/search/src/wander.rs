//! Wandering: a seeded random walk over a few good transitions that never repeats itself and never gets stuck.

use super::components::main_component_of;
use super::meter;
use super::queue::Queue;
use super::random::{Chain, Optimiser};
use super::shortest::cheapest_walk_to;
use super::ways::Ways;
use actor::graph::EssentialGraph;
use actor::timeline::Timeline;
use actor::walk::{Leg, Walk, steps_of};
use kernels::sort;

/// Seconds between two transitions that wandering may leave by, and between two that it may arrive by, where the graph
/// allows it: an actor that blends all the time is never quite itself.
const APART: f64 = 0.5;
/// Share of the main component's frames that the chosen transitions have to keep within reach.
const COVERED: f64 = 0.9;

/// Transitions put in order, transitions taken out in order, and edges swept that count as an expanded state.
const GATHERED: usize = 64;
const ORDERED: usize = 16;
const SWEPT: usize = 64;
/// Expanded states that choosing transitions and making a chain of them counts as.
const CHOICE: u32 = 1000;

/// A wandering actor: transitions are chosen and their probabilities optimised in slices, then a walk of any length.
#[derive(Clone, Debug)]
pub struct Wander {
    weights: Vec<(usize, f64)>,
    stage: Stage,
    random: u64,
}

#[derive(Clone, Debug)]
enum Stage {
    /// The transitions before this one wait to be ordered by cost.
    Gathering(Queue, usize),
    /// Those that are in order.
    Ordering(Queue, Vec<u32>),
    /// All in order, to be chosen with so many frames between two.
    Choosing(Vec<u32>, u32),
    Optimising(Box<Choices>),
    /// The graph has no loop at all.
    Stuck,
}

/// What can be chosen from where.
#[derive(Clone, Debug)]
struct Choices {
    /// The frame of each state.
    frames: Vec<u32>,
    state_of_frame: Vec<u32>,
    /// The transition of each edge of the chain; `None` for a recorded step.
    transitions: Vec<Option<u32>>,
    optimiser: Optimiser,
}

const NO_STATE: u32 = u32::MAX;

impl Wander {
    /// A wandering actor, nothing of which is known yet. `weights` are, for behaviours by their number in [`Ways`], how much
    /// more or less often than others they are to be seen; `seed` decides which way is taken.
    #[must_use]
    pub fn new(weights: Vec<(usize, f64)>, seed: u64) -> Self {
        Self { weights, stage: Stage::Gathering(Queue::default(), 0), random: seed }
    }

    /// Works on for about as long as `states` expanded states take; whether the probabilities are as good as they get.
    pub fn advance(&mut self, graph: &EssentialGraph, timeline: &Timeline, ways: &Ways, states: u32) -> bool {
        let mut left = states as usize;
        while left > 0 {
            left -= 1;
            self.stage = match std::mem::replace(&mut self.stage, Stage::Stuck) {
                Stage::Gathering(mut queue, next) => {
                    let end = (next + GATHERED).min(graph.transitions().len());
                    for index in next..end {
                        let transition = &graph.transitions()[index];
                        if ways.main[transition.from as usize] && ways.main[transition.to as usize] {
                            queue.push(transition.cost(graph.alpha()), index as u64);
                        }
                    }
                    match end - next < GATHERED {
                        true => Stage::Ordering(queue, Vec::new()),
                        false => Stage::Gathering(queue, end),
                    }
                }
                Stage::Ordering(mut queue, mut order) => {
                    order.extend((0..ORDERED).map_while(|_| queue.pop()).map(|(_, index)| index as u32));
                    match queue.len() {
                        0 => Stage::Choosing(order, (APART * ways.fps) as u32),
                        _ => Stage::Ordering(queue, order),
                    }
                }
                Stage::Choosing(order, apart) => {
                    left = left.saturating_sub(CHOICE as usize);
                    choose(graph, timeline, ways, order, apart, &self.weights)
                }
                Stage::Optimising(mut choices) => {
                    left = left.saturating_sub(choices.transitions.len() / SWEPT);
                    let ended = choices.optimiser.advance(1);
                    self.stage = Stage::Optimising(choices);
                    if ended {
                        return true;
                    }
                    continue;
                }
                Stage::Stuck => return true,
            };
        }
        false
    }

    /// Whether the graph has no loop to wander in.
    #[must_use]
    pub fn is_stuck(&self) -> bool {
        matches!(self.stage, Stage::Stuck)
    }

    fn choices(&self) -> Option<&Choices> {
        match &self.stage {
            Stage::Optimising(choices) => Some(choices),
            _ => None,
        }
    }

    /// The probabilities, their stationary distribution and the objective; `None` before transitions are chosen, and where
    /// there is no loop.
    #[must_use]
    pub fn optimiser(&self) -> Option<&Optimiser> {
        self.choices().map(|choices| &choices.optimiser)
    }

    /// The frames that it visits.
    #[must_use]
    pub fn frames(&self) -> &[u32] {
        self.choices().map_or(&[], |choices| &choices.frames)
    }

    /// A walk from `from` of at least `steps` steps; it first goes to where it can wander. Each call takes another way.
    /// `None` where nothing leads there, or where transitions are not chosen yet.
    #[must_use]
    pub fn walk(&mut self, graph: &EssentialGraph, timeline: &Timeline, from: u32, steps: u32) -> Option<Walk> {
        let mut random = self.random;
        let choices = self.choices()?;
        let is_inside = |frame: u32| choices.state_of_frame.get(frame as usize).is_some_and(|&state| state != NO_STATE);
        let walk = cheapest_walk_to(graph, timeline, from, &is_inside)?;
        let mut frame = walk.end(graph).unwrap_or(from);
        let mut taken = walk.steps(graph);
        let mut legs = walk;
        while taken < steps {
            let state = *choices.state_of_frame.get(frame as usize)?;
            let (edge, end) = choices.choose(state, unit(&mut random))?;
            let to = *choices.frames.get(end as usize)?;
            match choices.transitions[edge] {
                None => {
                    legs.push_recorded(frame, to, 1);
                    taken += 1;
                }
                Some(index) => {
                    legs.legs.push(Leg::Synthetic(index));
                    taken += steps_of(graph.transitions().get(index as usize)?);
                }
            }
            frame = to;
        }
        self.random = random;
        Walk::of_legs(legs.legs, graph).ok()
    }
}

impl Choices {
    /// The edge and the state that a number from [0, 1) chooses.
    fn choose(&self, state: u32, number: f64) -> Option<(usize, u32)> {
        let mut left = number;
        let mut last = None;
        for (edge, end, probability) in self.optimiser.chain().edges(state as usize) {
            last = Some((edge, end));
            left -= probability;
            if left < 0.0 {
                break;
            }
        }
        last
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

/// Chooses transitions that keep nearly all of the main component within reach; where that takes more, they are to be closer
/// together the next time.
fn choose(
    graph: &EssentialGraph,
    timeline: &Timeline,
    ways: &Ways,
    order: Vec<u32>,
    apart: u32,
    weights: &[(usize, f64)],
) -> Stage {
    let count = |inside: &[bool]| inside.iter().filter(|&&inside| inside).count();
    let all = count(&ways.main);
    if all < 2 {
        return Stage::Stuck;
    }
    let chosen = match apart {
        0 => order.clone(),
        _ => sparse_transitions(graph, ways.frame_count(), &order, apart),
    };
    meter::count(order.len() + chosen.len());
    let ends = |&index: &u32| {
        let transition = &graph.transitions()[index as usize];
        (transition.from, transition.to)
    };
    let inside = main_component_of(timeline, &chosen.iter().map(ends).collect::<Vec<_>>()).main;
    if apart > 0 && (count(&inside) as f64) < COVERED * all as f64 {
        return Stage::Choosing(order, apart / 2);
    }
    match choices(graph, timeline, ways, &chosen, &inside, weights) {
        Some(choices) => Stage::Optimising(Box::new(choices)),
        None => Stage::Stuck,
    }
}

/// Of `order`, the first transitions no two of which leave, or arrive, within `apart` frames of each other.
fn sparse_transitions(graph: &EssentialGraph, frames: u32, order: &[u32], apart: u32) -> Vec<u32> {
    let (mut leaves, mut arrives) = (vec![false; frames as usize], vec![false; frames as usize]);
    let block = |taken: &mut [bool], frame: u32| {
        let end = frame.saturating_add(apart + 1).min(frames);
        taken[frame.saturating_sub(apart) as usize..end as usize].fill(true);
    };
    let mut chosen = Vec::new();
    for &index in order {
        let transition = &graph.transitions()[index as usize];
        if !leaves[transition.from as usize] && !arrives[transition.to as usize] {
            block(&mut leaves, transition.from);
            block(&mut arrives, transition.to);
            chosen.push(index);
        }
    }
    chosen
}

/// The chain over the frames `inside` with recorded steps and the `chosen` transitions.
fn choices(
    graph: &EssentialGraph,
    timeline: &Timeline,
    ways: &Ways,
    chosen: &[u32],
    inside: &[bool],
    weights: &[(usize, f64)],
) -> Option<Choices> {
    let frames: Vec<u32> = (0..inside.len() as u32).filter(|&frame| inside[frame as usize]).collect();
    let mut state_of_frame = vec![NO_STATE; inside.len()];
    for (state, &frame) in frames.iter().enumerate() {
        state_of_frame[frame as usize] = state as u32;
    }
    // From, to and the transition plus 1, or 0 for a recorded step.
    let mut keys = Vec::new();
    let mut join = |from: u32, to: u32, edge: u32| {
        let [from, to] = [from, to].map(|frame| state_of_frame[frame as usize]);
        if from != NO_STATE && to != NO_STATE {
            keys.push(sort::key([from, to, edge, 0]));
        }
    };
    for &frame in &frames {
        if let Some(next) = timeline.next(frame) {
            join(frame, next, 0);
        }
    }
    for &index in chosen {
        let transition = &graph.transitions()[index as usize];
        join(transition.from, transition.to, index + 1);
    }
    sort::sort(&mut keys);
    let edges: Vec<[u32; 4]> = keys.into_iter().map(sort::numbers).collect();
    let pairs: Vec<(u32, u32)> = edges.iter().map(|edge| (edge[0], edge[1])).collect();
    let chain = Chain::even(frames.len() as u32, &pairs)?;
    let weight = |&frame: &u32| {
        let shown = weights.iter().filter(|(behaviour, _)| ways.shows(*behaviour, frame));
        shown.map(|weight| weight.1).product::<f64>().clamp(1e-3, 1e3)
    };
    let wanted: Vec<f64> = frames.iter().map(weight).collect();
    let transitions = edges.iter().map(|edge| edge[2].checked_sub(1)).collect();
    Some(Choices { frames, state_of_frame, transitions, optimiser: Optimiser::new(chain, &wanted) })
}
