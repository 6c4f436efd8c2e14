//! Wandering: a seeded random walk over a few good transitions that never repeats itself and never gets stuck.

use super::components::components_of;
use super::random::{Chain, Optimiser};
use super::shortest::{Measure, to_targets, walk_down};
use super::walk::{Leg, Walk, steps_of};
use super::ways::Ways;
use crate::graph::EssentialGraph;
use crate::timeline::Timeline;

/// Seconds between two transitions that wandering may leave by, and between two that it may arrive by, where the graph
/// allows it: an actor that blends all the time is never quite itself.
const APART: f64 = 0.5;
/// Share of the main component's frames that the chosen transitions have to keep within reach.
const COVERED: f64 = 0.9;

/// Indices of the cheapest transitions no two of which leave, or arrive, within `apart` frames of each other.
#[must_use]
pub fn sparse_transitions(graph: &EssentialGraph, ways: &Ways, apart: u32) -> Vec<u32> {
    let mut order: Vec<u32> = (0..graph.transitions().len() as u32).collect();
    let cost = |index: u32| graph.transitions()[index as usize].cost(graph.alpha());
    order.sort_by(|&a, &b| cost(a).total_cmp(&cost(b)).then(a.cmp(&b)));
    let frames = ways.frame_count();
    let (mut leaves, mut arrives) = (vec![false; frames as usize], vec![false; frames as usize]);
    let block = |taken: &mut [bool], frame: u32| {
        let end = frame.saturating_add(apart + 1).min(frames);
        taken[frame.saturating_sub(apart) as usize..end as usize].fill(true);
    };
    let mut chosen = Vec::new();
    for index in order {
        let transition = &graph.transitions()[index as usize];
        let (from, to) = (transition.from as usize, transition.to as usize);
        if ways.main[from] && ways.main[to] && !leaves[from] && !arrives[to] {
            block(&mut leaves, transition.from);
            block(&mut arrives, transition.to);
            chosen.push(index);
        }
    }
    chosen.sort_unstable();
    chosen
}

/// A wandering actor: transition probabilities that are optimised in slices, then a walk of any length.
#[derive(Clone, Debug)]
pub struct Wander {
    /// The frame of each state.
    frames: Vec<u32>,
    state_of_frame: Vec<u32>,
    /// The transition of each edge of the chain; `None` for a recorded step.
    transitions: Vec<Option<u32>>,
    optimiser: Optimiser,
    random: u64,
}

const NO_STATE: u32 = u32::MAX;

impl Wander {
    /// A wandering actor. `weights` are, for behaviours by their number in [`Ways`], how much more or less often than
    /// others they are to be seen; `seed` decides which way is taken. `None` where the graph has no loop at all.
    #[must_use]
    pub fn new(
        graph: &EssentialGraph,
        timeline: &Timeline,
        ways: &Ways,
        weights: &[(usize, f64)],
        seed: u64,
    ) -> Option<Self> {
        let chosen = chosen_transitions(graph, timeline, ways)?;
        let ends = |&index: &u32| {
            let transition = &graph.transitions()[index as usize];
            (transition.from, transition.to)
        };
        let inside = components_of(timeline, chosen.iter().map(ends).collect()).main;
        let mut state_of_frame = vec![NO_STATE; inside.len()];
        let mut frames = Vec::new();
        for frame in (0..inside.len()).filter(|&frame| inside[frame]) {
            state_of_frame[frame] = frames.len() as u32;
            frames.push(frame as u32);
        }
        let mut edges = Vec::new();
        for &frame in &frames {
            let state = state_of_frame[frame as usize];
            if let Some(next) = timeline.next(frame).filter(|&next| inside[next as usize]) {
                edges.push((state, state_of_frame[next as usize], None));
            }
        }
        for &index in &chosen {
            let (from, to) = ends(&index);
            if inside[from as usize] && inside[to as usize] {
                edges.push((state_of_frame[from as usize], state_of_frame[to as usize], Some(index)));
            }
        }
        edges.sort_unstable();
        let pairs: Vec<(u32, u32)> = edges.iter().map(|edge| (edge.0, edge.1)).collect();
        let chain = Chain::even(frames.len() as u32, &pairs)?;
        let wanted: Vec<f64> = frames
            .iter()
            .map(|&frame| {
                let weight = weights.iter().filter(|(behaviour, _)| ways.shows(*behaviour, frame)).map(|w| w.1);
                weight.product::<f64>().clamp(1e-3, 1e3)
            })
            .collect();
        let transitions = edges.iter().map(|edge| edge.2).collect();
        let optimiser = Optimiser::new(chain, &wanted);
        Some(Self { frames, state_of_frame, transitions, optimiser, random: seed })
    }

    /// Improves the probabilities by some rounds; whether they are as good as they get. A round takes well below a
    /// millisecond at first, and a few later on.
    pub fn advance(&mut self, rounds: u32) -> bool {
        self.optimiser.advance(rounds)
    }

    /// The probabilities, their stationary distribution and the objective.
    #[must_use]
    pub fn optimiser(&self) -> &Optimiser {
        &self.optimiser
    }

    /// The frames that it visits.
    #[must_use]
    pub fn frames(&self) -> &[u32] {
        &self.frames
    }

    /// A walk from `from` of at least `steps` steps; it first goes to where it can wander. Each call takes another way.
    /// `None` where nothing leads there.
    #[must_use]
    pub fn walk(&mut self, graph: &EssentialGraph, timeline: &Timeline, from: u32, steps: u32) -> Option<Walk> {
        let costs = to_targets(graph, timeline, &self.frames, Measure::Cost);
        let mut walk = walk_down(graph, timeline, &costs, from)?;
        let mut frame = walk.end(graph).unwrap_or(from);
        let mut taken = walk.steps(graph);
        let mut legs = Walk { legs: std::mem::take(&mut walk.legs), ..Walk::default() };
        while taken < steps {
            let state = *self.state_of_frame.get(frame as usize)?;
            let (edge, end) = self.choose(state)?;
            let to = *self.frames.get(end as usize)?;
            match self.transitions[edge] {
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
        Walk::of_legs(legs.legs, graph).ok()
    }

    fn choose(&mut self, state: u32) -> Option<(usize, u32)> {
        if state == NO_STATE {
            return None;
        }
        let mut left = self.unit();
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

    /// A number in [0, 1) (SplitMix64, Steele and others 2014).
    fn unit(&mut self) -> f64 {
        self.random = self.random.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.random;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Sparse transitions that keep nearly all of the main component within reach: as far apart as that allows.
fn chosen_transitions(graph: &EssentialGraph, timeline: &Timeline, ways: &Ways) -> Option<Vec<u32>> {
    let count = |inside: &[bool]| inside.iter().filter(|&&inside| inside).count();
    let all = count(&ways.main);
    if all < 2 {
        return None;
    }
    let mut apart = (APART * ways.fps) as u32;
    loop {
        let chosen = sparse_transitions(graph, ways, apart);
        let ends = chosen.iter().map(|&index| {
            let transition = &graph.transitions()[index as usize];
            (transition.from, transition.to)
        });
        if count(&components_of(timeline, ends.collect()).main) as f64 >= COVERED * all as f64 {
            return Some(chosen);
        }
        if apart == 0 {
            return Some((0..graph.transitions().len() as u32).collect());
        }
        apart /= 2;
    }
}
