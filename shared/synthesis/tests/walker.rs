//! Routes on small graphs, step by step.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

use actor::graph::{EssentialGraph, Transition};
use actor::temporal_warp::{Move, TemporalWarp};
use actor::timeline::{Sequence, Timeline};
use actor::walk::{Leg, WalkError};
use kernels::align::Placement;
use synthesis::{Step, Walker};

/// Two sequences of eight frames and transitions of three.
fn scene(edges: &[(u32, u32)]) -> (Timeline, EssentialGraph) {
    let sequence = |first_frame| Sequence {
        name: format!("s{first_frame}"),
        labels: vec![],
        first_frame,
        frame_count: 8,
        cyclic: false,
    };
    let timeline = Timeline::new(25.0, vec![sequence(0), sequence(8)]).unwrap();
    let jump = |&(from, to): &(u32, u32)| Transition {
        from,
        to,
        deformation: 0.125,
        warp: TemporalWarp::new(vec![Move::Both; 2]),
        placement: Placement::IDENTITY,
        turn: 0.0,
    };
    let graph = EssentialGraph::new(0.01, edges.iter().map(jump).collect(), &timeline).unwrap();
    (timeline, graph)
}

fn on(first: u32, last: u32) -> Leg {
    Leg::Recorded { first, last, steps: last - first }
}

fn back(first: u32, last: u32) -> Leg {
    Leg::Back { first, last, steps: first - last }
}

const fn node(node: u32) -> Step {
    Step::Node { transition: 0, node }
}

/// All steps that are left, each counted.
fn steps(walker: &mut Walker, graph: &EssentialGraph, timeline: &Timeline) -> Vec<Step> {
    let mut steps = Vec::new();
    let all = walker.remaining(graph) as usize;
    while let Some(step) = walker.next(timeline) {
        assert_eq!(walker.remaining(graph) as usize + steps.len(), all);
        walker.take(graph, timeline);
        steps.push(step);
    }
    assert_eq!(steps.len(), all);
    assert!(walker.has_arrived());
    steps
}

fn walker(start: u32, legs: &[Leg], (timeline, graph): (&Timeline, &EssentialGraph)) -> Walker {
    let mut walker = Walker::standing(start);
    walker.retarget(graph, timeline, legs).unwrap();
    walker
}

#[test]
fn a_route_takes_every_step_once() {
    let (timeline, graph) = scene(&[(2, 11), (12, 4)]);
    let legs = [on(0, 2), Leg::Synthetic(0), on(11, 11), on(11, 13), back(13, 12)];
    let mut walker = walker(0, &legs, (&timeline, &graph));
    let wanted =
        [Step::Forward(1), Step::Forward(2), node(1), node(2), Step::Forward(12), Step::Forward(13), Step::Back(12)];
    assert_eq!(walker.end(&graph), 12);
    assert_eq!(steps(&mut walker, &graph, &timeline), wanted);
    assert_eq!((walker.departure(&graph), walker.end(&graph), walker.inside()), (12, 12, None));
    let mut standing = Walker::standing(3);
    assert!(standing.next(&timeline).is_none() && standing.has_arrived());
    standing.take(&graph, &timeline);
    assert_eq!((standing.departure(&graph), standing.progress(&graph)), (3, (0, 0.0)));
}

#[test]
fn a_route_knows_how_far_it_is() {
    let (timeline, graph) = scene(&[(2, 11)]);
    let legs = [on(0, 2), Leg::Synthetic(0), on(11, 11), on(11, 12)];
    let mut walker = walker(0, &legs, (&timeline, &graph));
    let mut told = vec![(walker.progress(&graph), walker.leg(), walker.coming())];
    while walker.next(&timeline).is_some() {
        walker.take(&graph, &timeline);
        told.push((walker.progress(&graph), walker.leg(), walker.coming()));
    }
    let wanted = [
        ((0, 0.0), None, Some((vec![on(0, 2)], 0))),
        ((0, 0.5), Some(0), Some((vec![on(1, 2)], 0))),
        ((0, 1.0), Some(0), Some((vec![], 0))),
        ((1, 0.5), Some(1), None),
        ((1, 1.0), Some(1), None),
        ((3, 1.0), Some(3), None),
    ];
    assert_eq!(told, wanted);
}

#[test]
fn a_transition_under_way_is_finished_before_another_way() {
    let (timeline, graph) = scene(&[(2, 11)]);
    let mut walker = walker(2, &[Leg::Synthetic(0), on(11, 13)], (&timeline, &graph));
    assert_eq!((walker.inside(), walker.departure(&graph)), (None, 2));
    walker.take(&graph, &timeline);
    assert_eq!((walker.inside(), walker.departure(&graph)), (Some(0), 11));

    let mut redirected = walker.clone();
    redirected.retarget(&graph, &timeline, &[on(11, 12)]).unwrap();
    assert_eq!(redirected.legs(), [Leg::Synthetic(0), on(11, 12)]);
    assert_eq!((redirected.leg(), redirected.progress(&graph)), (None, (0, 0.5)));
    assert_eq!(steps(&mut redirected, &graph, &timeline), [node(2), Step::Forward(12)]);
    assert_eq!(redirected.leg(), Some(0));

    let mut stopped = walker.clone();
    stopped.retarget(&graph, &timeline, &[]).unwrap();
    assert_eq!((stopped.end(&graph), stopped.remaining(&graph)), (11, 1));
    assert_eq!(steps(&mut stopped, &graph, &timeline), [node(2)]);

    // Where the legs do not fit, nothing changes.
    let before = walker.clone();
    assert_eq!(walker.retarget(&graph, &timeline, &[on(2, 3)]), Err(WalkError::Gap(0)));
    assert_eq!(walker.extend(&graph, &timeline, &[on(12, 13)]), Err(WalkError::Gap(0)));
    assert_eq!(walker, before);
}

#[test]
fn a_route_is_left_and_gone_on_with_anywhere() {
    let (timeline, graph) = scene(&[(2, 11)]);
    let mut walker = walker(0, &[on(0, 5)], (&timeline, &graph));
    walker.take(&graph, &timeline);
    assert_eq!(walker.departure(&graph), 1);
    walker.retarget(&graph, &timeline, &[back(1, 0)]).unwrap();
    walker.extend(&graph, &timeline, &[on(0, 2)]).unwrap();
    walker.extend(&graph, &timeline, &[Leg::Synthetic(0)]).unwrap();
    assert_eq!(walker.end(&graph), 11);
    let all = steps(&mut walker, &graph, &timeline);
    assert_eq!(all, [Step::Back(0), Step::Forward(1), Step::Forward(2), node(1), node(2)]);
    // At its end it can be gone on with, too, and what is long done is forgotten.
    walker.extend(&graph, &timeline, &[on(11, 12)]).unwrap();
    assert_eq!(walker.legs(), [Leg::Synthetic(0), on(11, 12)]);
    assert_eq!(steps(&mut walker, &graph, &timeline), [Step::Forward(12)]);
}
