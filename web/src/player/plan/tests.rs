//! Plans and routes on small graphs.

use actor::graph::EssentialGraph;
use actor::timeline::Timeline;
use search::{cheapest_walk, components, reaching};

use super::{Goal, LegReport, Plan, Route, Step, plan};
use crate::player::tests::{jump, timeline};

fn graph(timeline: &Timeline, edges: &[(u32, u32)]) -> EssentialGraph {
    let transitions = edges.iter().map(|&(from, to)| jump(timeline, from, to).unwrap()).collect();
    EssentialGraph::new(0.01, transitions, timeline).unwrap()
}

/// All steps of the route that are left.
fn steps(mut route: Route, graph: &EssentialGraph, timeline: &Timeline) -> Vec<Step> {
    let mut steps = Vec::new();
    let all = route.remaining(graph) as usize;
    while let Some(step) = route.next(timeline) {
        assert_eq!(route.remaining(graph) as usize + steps.len(), all);
        route.take(graph, timeline);
        steps.push(step);
    }
    assert_eq!(steps.len(), all);
    steps
}

const fn node(node: u32) -> Step {
    Step::Synthetic { edge: 0, node }
}

#[test]
fn a_route_takes_every_step_once() {
    let timeline = timeline(&[(8, false), (8, false)]);
    let graph = graph(&timeline, &[(2, 11), (12, 4)]);
    let route = Route::new(&plan(&graph, &timeline, 0, 13).unwrap(), Goal::Target(13));
    let wanted = [Step::Recorded(1), Step::Recorded(2), node(1), node(2), Step::Recorded(12), Step::Recorded(13)];
    assert_eq!(steps(route, &graph, &timeline), wanted);
}

#[test]
fn a_dead_end_is_left_backwards() {
    let timeline = timeline(&[(8, false), (8, false)]);
    let graph = graph(&timeline, &[(5, 11)]);
    let from_end = plan(&graph, &timeline, 7, 12).unwrap();
    let report = from_end.report(12, &graph, &timeline);
    assert_eq!(report.legs[0], LegReport::Recorded { first: 7, last: 5, steps: 2, back: true });
    assert_eq!(report.frames, 2 + 2 + 1);
    let all = steps(Route::new(&from_end, Goal::Target(12)), &graph, &timeline);
    assert_eq!(all[..2], [Step::Back(6), Step::Back(5)]);
    assert_eq!(all.last(), Some(&Step::Recorded(12)));
    assert_eq!(plan(&graph, &timeline, 12, 0), None);
    assert_eq!(plan(&graph, &timeline, 99, 0), None);
}

#[test]
fn a_first_frame_is_reached_backwards() {
    let timeline = timeline(&[(8, false), (8, false)]);
    let graph = graph(&timeline, &[(5, 11)]);
    let to_start = plan(&graph, &timeline, 4, 9).unwrap();
    let all = steps(Route::new(&to_start, Goal::Target(9)), &graph, &timeline);
    let wanted = [Step::Recorded(5), node(1), node(2), Step::Back(10), Step::Back(9)];
    assert_eq!(all, wanted);
    let both_ends = steps(Route::new(&plan(&graph, &timeline, 7, 10).unwrap(), Goal::Target(10)), &graph, &timeline);
    assert_eq!(both_ends, [Step::Back(6), Step::Back(5), node(1), node(2), Step::Back(10)]);
    let within = steps(Route::new(&plan(&graph, &timeline, 13, 11).unwrap(), Goal::Target(11)), &graph, &timeline);
    assert_eq!(within, [Step::Back(12), Step::Back(11)]);
}

#[test]
fn a_transition_under_way_is_finished_before_another_way() {
    let timeline = timeline(&[(8, false), (8, false)]);
    let graph = graph(&timeline, &[(2, 11)]);
    let mut route = Route::new(&plan(&graph, &timeline, 2, 13).unwrap(), Goal::Target(13));
    assert_eq!((route.inside(), route.departure(&graph)), (None, 2));
    route.take(&graph, &timeline);
    assert_eq!((route.inside(), route.departure(&graph)), (Some(0), 11));
    let other = plan(&graph, &timeline, 11, 12).unwrap();
    let redirected = route.redirected(&other, Goal::Target(12));
    assert_eq!(steps(redirected, &graph, &timeline), [node(2), Step::Recorded(12)]);
    let stopped = route.redirected(&Plan { start: 11, ..Plan::default() }, Goal::Stop);
    assert_eq!(steps(stopped, &graph, &timeline), [node(2)]);
}

#[test]
fn what_reaches_what_agrees_with_the_search() {
    let timeline = timeline(&[(8, false), (6, false), (5, true)]);
    for seed in 0..40_u32 {
        let mut edges: Vec<_> = (0..6).map(|k| (seed * 7 + k * 5, seed * 3 + k * 11)).collect();
        edges.iter_mut().for_each(|edge| *edge = (edge.0 % 18, edge.1 % 18));
        edges.sort_unstable();
        edges.dedup();
        let transitions = edges.into_iter().filter_map(|(from, to)| jump(&timeline, from, to)).collect();
        let graph = EssentialGraph::new(0.01, transitions, &timeline).unwrap();
        let walks = |a, b| cheapest_walk(&graph, &timeline, a, b).is_some();
        let component = components(&graph, &timeline).main;
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
