//! The walk that a click sets off on: the cheapest one, with steps back where no walk leads.
//!
//! A sequence's last frames have no transition, and none can arrive at its first ones. Going back along the recording, the
//! body moves on without a pop, and every pose stays within reach.

use actor::graph::EssentialGraph;
use actor::timeline::Timeline;
use actor::walk::{Leg, Walk};

use super::behaviour::walk_to_any;
use super::components::{reached, reaching};

/// The cheapest walk from `from` to the nearest of `targets`, in one search over all of them.
///
/// Where no walk leads to any of them, it first steps back along the recording, as few frames as it takes: out of a dead end.
/// Likewise it ends with steps back where no transition can arrive. `None` where even that does not help.
#[must_use]
pub fn plan_walk(graph: &EssentialGraph, timeline: &Timeline, from: u32, targets: &[u32]) -> Option<Walk> {
    if let Some(walk) = walk_out(graph, timeline, from, targets) {
        return Some(walk);
    }
    let beyond = |start| {
        let reached = reached(graph, timeline, start);
        let turn = |&to: &u32| {
            let later = to + 1..timeline.sequence_of(to)?.end_frame();
            later.into_iter().find(|&frame| reached[frame as usize]).map(|turn| (turn - to, to, turn))
        };
        targets.iter().filter_map(turn).min()
    };
    // Out of a dead end, whatever its sequence's first frame reaches can be reached too.
    let (_, to, turn) = beyond(from).or_else(|| beyond(timeline.sequence_of(from)?.first_frame))?;
    let mut walk = walk_out(graph, timeline, from, &[turn])?;
    walk.append(&steps_back(graph, turn, to)?);
    Some(walk)
}

/// The cheapest walk to any of `targets`, after as few steps back as it takes.
fn walk_out(graph: &EssentialGraph, timeline: &Timeline, from: u32, targets: &[u32]) -> Option<Walk> {
    if let Some(walk) = walk_to_any(graph, timeline, from, targets) {
        return Some(walk);
    }
    let sequence = timeline.sequence_of(from)?;
    let reaching = reaching(graph, timeline, targets);
    let leads = |frame: &u32| reaching.get(*frame as usize).copied().unwrap_or(false);
    let leave = (sequence.first_frame..from).rev().find(leads)?;
    let mut walk = steps_back(graph, from, leave)?;
    walk.append(&walk_to_any(graph, timeline, leave, targets)?);
    Some(walk)
}

/// Recorded frames back from `first` to `last`.
fn steps_back(graph: &EssentialGraph, first: u32, last: u32) -> Option<Walk> {
    Walk::of_legs(vec![Leg::Back { first, last, steps: first.checked_sub(last)? }], graph).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shortest::cheapest_walk;
    use actor::graph::Transition;
    use actor::temporal_warp::{Move, TemporalWarp};
    use actor::timeline::Sequence;
    use kernels::align::Placement;

    fn timeline(sequences: &[(u32, bool)]) -> Timeline {
        let mut first_frame = 0;
        let list = sequences.iter().map(|&(frame_count, cyclic)| {
            let name = format!("s{first_frame}");
            first_frame += frame_count;
            Sequence { name, labels: vec![], first_frame: first_frame - frame_count, frame_count, cyclic }
        });
        Timeline::new(25.0, list.collect()).unwrap()
    }

    /// Transitions of three frames between those of `edges` whose segments lie in their sequences.
    fn graph(timeline: &Timeline, edges: &[(u32, u32)]) -> EssentialGraph {
        let jump = |&(from, to): &(u32, u32)| {
            timeline.offset(from, 2)?;
            timeline.offset(to, -2)?;
            let warp = TemporalWarp::new(vec![Move::Both; 2]);
            Some(Transition { from, to, deformation: 0.125, warp, placement: Placement::IDENTITY, turn: 0.0 })
        };
        EssentialGraph::new(0.01, edges.iter().filter_map(jump).collect(), timeline).unwrap()
    }

    fn legs(graph: &EssentialGraph, timeline: &Timeline, from: u32, to: u32) -> Option<Vec<Leg>> {
        let walk = plan_walk(graph, timeline, from, &[to])?;
        assert_eq!(walk.check(graph, timeline, from), Ok(to));
        Some(walk.legs)
    }

    const fn back(first: u32, last: u32) -> Leg {
        Leg::Back { first, last, steps: first - last }
    }

    const fn on(first: u32, last: u32) -> Leg {
        Leg::Recorded { first, last, steps: last - first }
    }

    #[test]
    fn a_dead_end_is_left_backwards() {
        let timeline = timeline(&[(8, false), (8, false)]);
        let graph = graph(&timeline, &[(5, 11)]);
        let walk = plan_walk(&graph, &timeline, 7, &[12]).unwrap();
        assert_eq!(walk.legs, [back(7, 5), Leg::Synthetic(0), on(11, 12)]);
        assert_eq!(walk.steps(&graph), 2 + 2 + 1);
        assert!((walk.cost - (0.125 + 6.0 * graph.alpha())).abs() < 1e-12);
        assert_eq!(legs(&graph, &timeline, 12, 0), None);
        assert_eq!(plan_walk(&graph, &timeline, 99, &[0]), None);
        assert_eq!(plan_walk(&graph, &timeline, 0, &[99]), None);
        assert_eq!(plan_walk(&graph, &timeline, 0, &[]), None);
    }

    #[test]
    fn a_first_frame_is_reached_backwards() {
        let timeline = timeline(&[(8, false), (8, false)]);
        let graph = graph(&timeline, &[(5, 11)]);
        let legs = |from, to| legs(&graph, &timeline, from, to).unwrap();
        assert_eq!(legs(4, 9), [on(4, 5), Leg::Synthetic(0), back(11, 9)]);
        assert_eq!(legs(7, 10), [back(7, 5), Leg::Synthetic(0), back(11, 10)]);
        assert_eq!(legs(13, 11), [back(13, 11)]);
        assert_eq!(legs(6, 6), []);
    }

    #[test]
    fn one_search_over_all_targets_finds_the_cheapest() {
        let timeline = timeline(&[(10, false), (8, false), (7, true)]);
        let mut stuck = 0;
        for seed in 0..60_u32 {
            let edges: Vec<_> = (0..5).map(|k| ((seed * 7 + k * 5) % 25, (seed * 3 + k * 11) % 25)).collect();
            let mut edges: Vec<_> = edges.into_iter().filter(|(from, to)| from != to).collect();
            edges.sort_unstable();
            edges.dedup();
            let graph = graph(&timeline, &edges);
            for from in 0..25 {
                let targets: Vec<u32> = (0..25).filter(|frame| (frame * 5 + seed) % 7 == 0).collect();
                let walk = plan_walk(&graph, &timeline, from, &targets);
                let reachable = targets.iter().any(|&to| plan_walk(&graph, &timeline, from, &[to]).is_some());
                assert_eq!(walk.is_some(), reachable);
                let Some(walk) = walk else { continue };
                let end = walk.check(&graph, &timeline, from).unwrap();
                assert!(targets.contains(&end));
                // Steps back are taken where nothing else helps, and only there.
                let direct = targets.iter().filter_map(|&to| cheapest_walk(&graph, &timeline, from, to));
                let least = direct.map(|walk| walk.cost).min_by(f64::total_cmp);
                let is_back = walk.legs.iter().any(|leg| matches!(leg, Leg::Back { .. }));
                assert_eq!(is_back, least.is_none());
                assert!(least.is_none_or(|least| (walk.cost - least).abs() < 1e-12));
                stuck += u32::from(is_back);
            }
        }
        assert!(stuck > 50, "{stuck}");
    }
}
