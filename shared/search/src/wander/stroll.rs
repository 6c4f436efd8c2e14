//! The walk itself: it goes where something was shown too seldom, by a way that shows as little again as can be.
//!
//! A Markov chain forgets. Its walks come back to what they have just shown, leave where they have just arrived, and in some
//! minutes some places are visited many times and others never, although all are equally likely in the long run. So the
//! walk keeps to what the chain is optimised for, not to its probabilities: it counts how often each segment was shown against
//! how often it is wanted, draws the next aim among those that lag behind and are not far, and takes the cheapest way there. A
//! way is dear where it blends, where it leaves a stretch before that has lasted for a second, where it shows again what was
//! shown within the last ten seconds, and where it shows what was shown too often already.

use super::segments::Segments;
use crate::meter;
use crate::queue::Queue;
use actor::graph::EssentialGraph;
use actor::timeline::Timeline;
use actor::walk::{Leg, Walk, steps_of};

/// Seconds that a recorded stretch lasts at least.
const STRETCH: f64 = 1.0;
/// Seconds after which something may be shown again.
const FORGETS: f64 = 10.0;
/// What a second of a way costs: one that is recorded, a synthetic one, one by which a stretch is too short, one that was shown
/// just now, and one that was shown a round too often.
const RECORDED: f64 = 0.15;
const SYNTHETIC: f64 = 1.0;
const SHORT: f64 = 20.0;
const AGAIN: f64 = 4.0;
const TOO_OFTEN: f64 = 1.0;
/// What a second costs of a run that repeats exactly what was shown, beyond the shortest stretch.
const REPEATS: f64 = 40.0;
/// What every aim costs beside its way: else the next segment would always be the best.
const AIM: f64 = 0.5;
/// By how much chance raises the worth of an aim at most.
const CHANCE: f64 = 0.5;
/// Rounds that a segment lags behind, beside those counted, for as long as it was never shown.
const NEVER: f64 = 4.0;
/// How often a segment is shown at least, as a share of how often the one of its sequence is that is shown most.
const BEHIND: f64 = 0.9;
/// Seconds that a transition costs beside its own, that was taken just now.
const SAME: f64 = 8.0;

/// What a walk remembers.
#[derive(Clone, Debug)]
pub(super) struct Stroll {
    /// How often each segment is to be shown, and how often it was, over that: its rounds.
    wanted: Vec<f64>,
    rounds: Vec<f64>,
    /// The sequence of each segment.
    sequences: Vec<u32>,
    /// Step at which each segment was shown last.
    shown: Vec<Option<u32>>,
    /// Step at which each edge was taken last.
    taken: Vec<Option<u32>>,
    /// Edges to the aim, the last one first.
    way: Vec<u32>,
    step: u32,
    /// Recorded steps since the last transition.
    stretch: u32,
    /// Steps in a row that were shown just so a short while ago.
    again: u32,
    /// Steps that a stretch lasts at least, and after which something may be shown again; steps a second.
    least: u32,
    forgets: u32,
    fps: f64,
}

/// The cheapest way to the end of a segment.
#[derive(Clone, Copy)]
struct Way {
    cost: f64,
    /// The edge that it ends with, and the state before.
    edge: u32,
    before: u32,
    /// Steps that it takes, and those since its last transition.
    steps: u32,
    stretch: u32,
    /// Steps in a row up to here that were shown just so a short while ago.
    again: u32,
}

impl Stroll {
    /// A walk that has shown nothing yet. What was shown before it begins is drawn from `random`, numbers in [0, 1): else all
    /// walks would visit the places of a small graph in the same order.
    pub(super) fn new(segments: &Segments, timeline: &Timeline, random: &mut dyn FnMut() -> f64) -> Self {
        let fps = f64::from(timeline.fps());
        let steps = |seconds: f64| (seconds * fps).ceil() as u32;
        let wanted = segments.optimiser.wanted();
        let mean = wanted.iter().sum::<f64>() / wanted.len().max(1) as f64;
        let sequence =
            |frame: u32| timeline.sequences().partition_point(|sequence| sequence.end_frame() <= frame) as u32;
        Self {
            sequences: segments.segments.iter().map(|segment| sequence(segment.first)).collect(),
            wanted: wanted.iter().map(|wanted| wanted / mean).collect(),
            rounds: wanted.iter().map(|_| random()).collect(),
            shown: vec![None; wanted.len()],
            taken: vec![None; segments.transitions.len()],
            way: Vec::new(),
            step: 0,
            stretch: 0,
            again: 0,
            least: steps(STRETCH),
            forgets: steps(FORGETS),
            fps,
        }
    }

    /// Walks on from `frame`, which is inside, for at least `steps` steps. `random` gives numbers in [0, 1).
    pub(super) fn walk(
        &mut self,
        graph: &EssentialGraph,
        segments: &Segments,
        frame: u32,
        steps: u32,
        random: &mut dyn FnMut() -> f64,
    ) -> Option<Walk> {
        let mut walk = Walk::default();
        let mut state = segments.segments.partition_point(|segment| segment.first <= frame).checked_sub(1)?;
        let mut frame = frame;
        self.way.clear();
        let end = self.step + steps;
        while self.step < end {
            let last = segments.segments.get(state)?.last;
            let recorded = last.checked_sub(frame)?;
            walk.push_recorded(frame, last, recorded);
            self.step += recorded;
            self.stretch += recorded;
            self.rounds[state] += 1.0 / self.wanted[state];
            self.shown[state] = Some(self.step);
            if self.way.is_empty() {
                self.aim(graph, segments, state, random);
            }
            let edge = self.way.pop()? as usize;
            let is_again = self.freshness(self.taken[edge], 0) > 0.0;
            self.taken[edge] = Some(self.step);
            state = segments.optimiser.chain().end(edge) as usize;
            let segment = segments.segments.get(state)?;
            let run = self.again + segment.last + 1 - segment.first;
            self.again = if is_again { run } else { 0 };
            frame = segment.first;
            match segments.transitions[edge] {
                None => {
                    walk.push_recorded(last, frame, 1);
                    self.step += 1;
                    self.stretch += 1;
                }
                Some(index) => {
                    walk.legs.push(Leg::Synthetic(index));
                    self.step += steps_of(graph.transitions().get(index as usize)?);
                    self.stretch = 0;
                }
            }
        }
        Walk::of_legs(walk.legs, graph).ok()
    }

    /// Finds the way to the next aim, from the end of `state`.
    fn aim(&mut self, graph: &EssentialGraph, segments: &Segments, state: usize, random: &mut dyn FnMut() -> f64) {
        let ways = self.ways(graph, segments, state);
        let levels = self.levels(segments);
        let worth: Vec<f64> = ways
            .iter()
            .zip(&segments.segments)
            .enumerate()
            .map(|(to, (way, segment))| {
                let never = if self.shown[to].is_none() { NEVER } else { 0.0 };
                let lags = (levels[self.sequences[to] as usize] + 1.0 + never - self.rounds[to]).max(0.0);
                let seconds = f64::from(segment.last + 1 - segment.first) / self.fps;
                if way.cost.is_finite() { seconds * self.wanted[to] * lags * lags / (AIM + way.cost) } else { 0.0 }
            })
            .collect();
        let mut drawn: Option<(usize, f64)> = None;
        for (to, &worth) in worth.iter().enumerate() {
            let worth = worth * (1.0 + CHANCE * random());
            if worth > drawn.map_or(0.0, |(_, best)| best) {
                drawn = Some((to, worth));
            }
        }
        // Where nothing lags behind, what comes first.
        let reached = || (0..ways.len()).find(|&to| ways[to].cost.is_finite());
        let Some(mut at) = drawn.map(|(to, _)| to).or_else(reached) else { return };
        loop {
            self.way.push(ways[at].edge);
            at = ways[at].before as usize;
            if at == state || self.way.len() > ways.len() {
                break;
            }
        }
    }

    /// How many rounds were shown so far, of all segments.
    fn level(&self, segments: &Segments) -> f64 {
        let (mut sum, mut weight) = (0.0, 0.0);
        for (state, segment) in segments.segments.iter().enumerate() {
            let wanted = self.wanted[state] * f64::from(segment.last + 1 - segment.first);
            sum += wanted * self.rounds[state];
            weight += wanted;
        }
        sum / weight
    }

    /// How many rounds the segments of each sequence are to be at: as many as all; more where others of the sequence were shown
    /// more often, for ways to everything lead through them.
    fn levels(&self, segments: &Segments) -> Vec<f64> {
        let mut levels = vec![self.level(segments); self.sequences.last().map_or(0, |&last| last as usize + 1)];
        for (&rounds, &sequence) in self.rounds.iter().zip(&self.sequences) {
            let level = &mut levels[sequence as usize];
            *level = level.max(rounds * BEHIND);
        }
        levels
    }

    /// How fresh the memory of a step will be in some `steps`: 1 just after it, 0 where it is forgotten.
    fn freshness(&self, step: Option<u32>, steps: u32) -> f64 {
        let ago = step.map_or(u32::MAX, |step| (self.step - step).saturating_add(steps));
        1.0 - f64::from(ago.min(self.forgets)) / f64::from(self.forgets)
    }

    /// The cheapest ways from the end of `from` to the ends of all segments, its own too.
    fn ways(&self, graph: &EssentialGraph, segments: &Segments, from: usize) -> Vec<Way> {
        let chain = segments.optimiser.chain();
        let level = self.level(segments);
        let nowhere = Way { cost: f64::INFINITY, edge: 0, before: 0, steps: 0, stretch: 0, again: 0 };
        let mut ways = vec![nowhere; segments.segments.len()];
        let mut queue = Queue::default();
        let begin = Way { cost: 0.0, stretch: self.stretch, again: self.again, ..nowhere };
        let mut taken = Some((begin, from));
        while let Some((way, state)) = taken {
            for (edge, to, _) in chain.edges(state) {
                let segment = &segments.segments[to as usize];
                let (synthetic, stretch) = match segments.transitions[edge] {
                    None => (0, way.stretch + 1),
                    Some(index) => (graph.transitions().get(index as usize).map_or(0, steps_of), 0),
                };
                let short = if synthetic > 0 { self.least.saturating_sub(way.stretch) } else { 0 };
                let arrives = way.steps + synthetic.max(1);
                let recorded = segment.last - segment.first;
                let again = self.freshness(self.shown[to as usize], arrives);
                let same = if synthetic > 0 { self.freshness(self.taken[edge], way.steps) } else { 0.0 };
                // In rounds of an ordinary segment: what is shown seldom has a long round.
                let too_often = (self.rounds[to as usize] - level).max(0.0) * self.wanted[to as usize].min(1.0);
                let is_again = self.freshness(self.taken[edge], way.steps) > 0.0;
                let runs = if is_again { way.again + synthetic + recorded + 1 } else { 0 };
                let long = runs.saturating_sub(self.least.max(way.again));
                let dear = RECORDED + AGAIN * again + TOO_OFTEN * too_often;
                let cost = SYNTHETIC * f64::from(synthetic) + SHORT * f64::from(short) + dear * f64::from(recorded + 1);
                let cost = way.cost + (cost + REPEATS * f64::from(long)) / self.fps + SAME * same;
                if cost < ways[to as usize].cost {
                    ways[to as usize] = Way {
                        cost,
                        edge: edge as u32,
                        before: state as u32,
                        steps: arrives + recorded,
                        stretch: stretch + recorded,
                        again: runs,
                    };
                    // Ways do not go on through where they begin.
                    if to as usize != from {
                        queue.push(cost, u64::from(to));
                    }
                }
            }
            let next = std::iter::from_fn(|| queue.pop()).find(|&(cost, state)| cost <= ways[state as usize].cost);
            taken = next.map(|(_, state)| (ways[state as usize], state as usize));
        }
        meter::count(chain.states());
        ways
    }
}
