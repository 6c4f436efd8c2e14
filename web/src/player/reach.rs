//! Which frames reach which: the frames that lead to a target, and the largest set of frames that all reach each other
//! (Prada and others, 7), in which the actor never gets stuck.

use shared::graph::EssentialGraph;
use shared::timeline::Timeline;

/// The graph's edges without their costs, both ways round.
struct Edges {
    first: Vec<u32>,
    ends: Vec<u32>,
}

impl Edges {
    /// All edges; each as (from, to), or turned around.
    fn new(graph: &EssentialGraph, timeline: &Timeline, backwards: bool) -> Self {
        let frames = timeline.frame_count();
        let recorded = (0..frames).filter_map(|frame| Some((frame, timeline.next(frame)?)));
        let synthetic = graph.transitions().iter().map(|transition| (transition.from, transition.to));
        let turned = recorded.chain(synthetic).map(|(a, b)| if backwards { (b, a) } else { (a, b) });
        let edges: Vec<_> = turned.filter(|&(a, b)| a < frames && b < frames).collect();
        let mut first = vec![0; frames as usize + 1];
        for &(from, _) in &edges {
            first[from as usize + 1] += 1;
        }
        for frame in 0..frames as usize {
            first[frame + 1] += first[frame];
        }
        let (mut next, mut ends) = (first.clone(), vec![0; edges.len()]);
        for (from, to) in edges {
            let at = &mut next[from as usize];
            ends[*at as usize] = to;
            *at += 1;
        }
        Self { first, ends }
    }

    fn of(&self, frame: u32) -> &[u32] {
        &self.ends[self.first[frame as usize] as usize..self.first[frame as usize + 1] as usize]
    }

    /// Marks in `reached` what can be reached from `start`, and gives it in the order in which it was left for good.
    fn search(&self, start: u32, reached: &mut [bool]) -> Vec<u32> {
        let mut left = Vec::new();
        if std::mem::replace(&mut reached[start as usize], true) {
            return left;
        }
        let mut way = vec![(start, 0)];
        while let Some((frame, next)) = way.last_mut() {
            match self.of(*frame).get(*next) {
                Some(&end) => {
                    *next += 1;
                    if !std::mem::replace(&mut reached[end as usize], true) {
                        way.push((end, 0));
                    }
                }
                None => {
                    left.push(*frame);
                    way.pop();
                }
            }
        }
        left
    }
}

/// For every frame, whether a walk leads from it to `to`.
#[must_use]
pub fn reaching(graph: &EssentialGraph, timeline: &Timeline, to: u32) -> Vec<bool> {
    let mut reached = vec![false; timeline.frame_count() as usize];
    if (to as usize) < reached.len() {
        Edges::new(graph, timeline, true).search(to, &mut reached);
    }
    reached
}

/// For every frame, whether a walk leads to it from `from`.
#[must_use]
pub fn reached(graph: &EssentialGraph, timeline: &Timeline, from: u32) -> Vec<bool> {
    let mut reached = vec![false; timeline.frame_count() as usize];
    if (from as usize) < reached.len() {
        Edges::new(graph, timeline, false).search(from, &mut reached);
    }
    reached
}

/// For every frame, whether it is in the largest strongly connected component (the first of equally large ones).
///
/// Kosaraju and Sharir's algorithm. A frame that reaches itself in no way is a component of its own.
#[must_use]
pub fn main_component(graph: &EssentialGraph, timeline: &Timeline) -> Vec<bool> {
    let frames = timeline.frame_count();
    let forwards = Edges::new(graph, timeline, false);
    let mut reached = vec![false; frames as usize];
    let order: Vec<_> = (0..frames).flat_map(|frame| forwards.search(frame, &mut reached)).collect();
    let backwards = Edges::new(graph, timeline, true);
    reached.fill(false);
    let mut largest = Vec::new();
    for &frame in order.iter().rev() {
        let component = backwards.search(frame, &mut reached);
        let earlier = component.iter().min() < largest.iter().min();
        if component.len() > largest.len() || component.len() == largest.len() && earlier {
            largest = component;
        }
    }
    let mut inside = vec![false; frames as usize];
    for frame in largest {
        inside[frame as usize] = true;
    }
    inside
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::player::tests::{jump, timeline};
    use shared::search::cheapest_walk;

    #[test]
    fn agrees_with_the_search() {
        let timeline = timeline(&[(8, false), (6, false), (5, true)]);
        for seed in 0..40_u32 {
            let mut edges: Vec<_> = (0..6).map(|k| (seed * 7 + k * 5, seed * 3 + k * 11)).collect();
            edges.iter_mut().for_each(|edge| *edge = (edge.0 % 18, edge.1 % 18));
            edges.sort_unstable();
            edges.dedup();
            let transitions = edges.into_iter().filter_map(|(from, to)| jump(&timeline, from, to)).collect();
            let graph = EssentialGraph::new(0.01, transitions, &timeline).unwrap();
            let walks = |a, b| cheapest_walk(&graph, &timeline, a, b).is_some();
            let component = main_component(&graph, &timeline);
            let size = component.iter().filter(|&&inside| inside).count();
            for a in 0..19 {
                let reach = reaching(&graph, &timeline, a);
                let mut mutual = 0;
                for b in 0..19 {
                    assert_eq!(reach[b as usize], walks(b, a), "{b} to {a}");
                    mutual += usize::from(walks(a, b) && walks(b, a));
                }
                assert!(mutual <= size);
                assert!(!component[a as usize] || mutual == size);
            }
        }
    }
}
