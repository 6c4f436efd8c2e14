//! What wandering can choose from where: runs of recorded frames within which there is no choice are single states.
//!
//! Prada and others (2016, section 7) drop all nodes of degree one and one before they decide on probabilities. All frames of
//! a segment are shown equally often, so a distribution that is uniform over segments is uniform over frames.

use crate::random::{Chain, Optimiser};
use crate::search_graph::SearchGraph;
use actor::graph::EssentialGraph;
use actor::timeline::Timeline;
use actor::walk::steps_of;
use kernels::sort;

/// The share of synthetic steps that sequences may lead to by how often they are shown.
const SYNTHETIC: f64 = 0.2;
/// How much less often than others a sequence is shown at least, if it is too short for that.
const RAREST: f64 = 1.0 / 6.0;

/// Recorded frames in a row that are always shown together.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    /// Its first frame, and its last one.
    pub first: u32,
    pub last: u32,
}

/// A graph of segments.
#[derive(Clone, Debug)]
pub(super) struct Segments {
    pub segments: Vec<Segment>,
    /// The transition of each edge of the chain; `None` where the recording goes on.
    pub transitions: Vec<Option<u32>>,
    pub optimiser: Optimiser,
}

impl Segments {
    /// The segments between the `chosen` transitions of the frames `inside`, which all reach each other by them; `weights` are
    /// those of behaviours. `None` where they do not.
    pub(super) fn new(
        graph: &EssentialGraph,
        timeline: &Timeline,
        search_graph: &SearchGraph,
        chosen: &[u32],
        inside: &[bool],
        weights: &[(usize, f64)],
    ) -> Option<Self> {
        let is_inside = |frame: u32| inside.get(frame as usize).copied().unwrap_or(false);
        let taken: Vec<u32> = chosen
            .iter()
            .copied()
            .filter(|&index| {
                let transition = &graph.transitions()[index as usize];
                is_inside(transition.from) && is_inside(transition.to)
            })
            .collect();
        let (mut leaves, mut arrives) = (vec![false; inside.len()], vec![false; inside.len()]);
        for &index in &taken {
            let transition = &graph.transitions()[index as usize];
            leaves[transition.from as usize] = true;
            arrives[transition.to as usize] = true;
        }
        let mut segments: Vec<Segment> = Vec::new();
        let mut segment_of_frame = vec![u32::MAX; inside.len()];
        for frame in (0..inside.len() as u32).filter(|&frame| is_inside(frame)) {
            let goes_on = frame > 0
                && is_inside(frame - 1)
                && timeline.next(frame - 1) == Some(frame)
                && !leaves[frame as usize - 1]
                && !arrives[frame as usize];
            match segments.last_mut() {
                Some(segment) if goes_on => segment.last = frame,
                _ => segments.push(Segment { first: frame, last: frame }),
            }
            segment_of_frame[frame as usize] = segments.len() as u32 - 1;
        }
        // From, to and the transition plus 1, or 0 where the recording goes on.
        let mut keys = Vec::new();
        for (state, segment) in segments.iter().enumerate() {
            if let Some(next) = timeline.next(segment.last).filter(|&next| is_inside(next)) {
                keys.push(sort::key([state as u32, segment_of_frame[next as usize], 0, 0]));
            }
        }
        for &index in &taken {
            let transition = &graph.transitions()[index as usize];
            let [from, to] = [transition.from, transition.to].map(|frame| segment_of_frame[frame as usize]);
            keys.push(sort::key([from, to, index + 1, 0]));
        }
        sort::sort(&mut keys);
        let edges: Vec<[u32; 4]> = keys.into_iter().map(sort::numbers).collect();
        let pairs: Vec<(u32, u32)> = edges.iter().map(|edge| (edge[0], edge[1])).collect();
        let chain = Chain::even(segments.len() as u32, &pairs)?;
        let transitions: Vec<Option<u32>> = edges.iter().map(|edge| edge[2].checked_sub(1)).collect();
        let rarities = rarities(graph, timeline, search_graph, &taken, inside);
        let wanted: Vec<f64> = segments
            .iter()
            .map(|segment| {
                let shown = weights.iter().filter(|(behaviour, _)| search_graph.shows(*behaviour, segment.first));
                let weight = shown.map(|weight| weight.1).product::<f64>();
                (rarities[search_graph.sequence(segment.first)] * weight).clamp(1e-3, 1e3)
            })
            .collect();
        Some(Self { segments, transitions, optimiser: Optimiser::new(chain, &wanted) })
    }
}

/// How often each sequence is to be shown: less often where a visit takes longer in transitions than it lasts, no more than
/// needs be. A visit that shows R recorded steps of a sequence takes the T steps of a transition.
fn rarities(
    graph: &EssentialGraph,
    timeline: &Timeline,
    search_graph: &SearchGraph,
    taken: &[u32],
    inside: &[bool],
) -> Vec<f64> {
    let steps = |&index: &u32| f64::from(steps_of(&graph.transitions()[index as usize]));
    let transition = taken.iter().map(steps).sum::<f64>() / taken.len().max(1) as f64;
    let mut recorded = vec![0.0_f64; timeline.sequences().len()];
    for frame in (0..inside.len()).filter(|&frame| inside[frame]) {
        recorded[search_graph.sequence(frame as u32)] += 1.0;
    }
    let longest = recorded.iter().copied().fold(1.0, f64::max);
    // Powers of a quarter at a time: a power function of its own would weigh kilobytes on the page.
    let quarters: Vec<f64> = recorded.iter().map(|steps| (steps / longest).sqrt().sqrt()).collect();
    let synthetic = |rarities: &[f64]| {
        let sum = |of: &dyn Fn(f64) -> f64| -> f64 {
            recorded
                .iter()
                .zip(rarities)
                .filter(|(steps, _)| **steps > 0.0)
                .map(|(steps, rarity)| rarity * of(*steps))
                .sum()
        };
        let blended = sum(&|_| transition);
        blended / (blended + sum(&|steps| steps))
    };
    let mut found = vec![1.0; recorded.len()];
    for _ in 0..16 {
        if synthetic(&found) <= SYNTHETIC {
            break;
        }
        found.iter_mut().zip(&quarters).for_each(|(found, quarter)| *found = (*found * quarter).max(RAREST));
    }
    found
}
