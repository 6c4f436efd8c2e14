//! Where the actor never gets stuck: the largest set of frames that all reach each other (Prada and others 2016,
//! section 7), and the frames that lead into it.

use actor::components::{Adjacency, components_of, with_recorded};
use actor::graph::EssentialGraph;
use actor::timeline::Timeline;

/// What [`main_component`] finds out about every frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MainComponent {
    /// Whether it is in the largest strongly connected component; of equally large ones the one of the first frame.
    pub main: Vec<bool>,
    /// Whether a walk leads from it into the main component: the frames that are no dead end. All frames where the main
    /// component is a single frame, since then nothing can be planned around.
    pub live: Vec<bool>,
}

/// The main component of the graph, and the frames that lead into it.
#[must_use]
pub fn main_component(graph: &EssentialGraph, timeline: &Timeline) -> MainComponent {
    // As it lies there: pages do it, and graphs have hundreds of thousands of transitions.
    main_of(graph.frame_count(), |frame| {
        let transitions = &graph.transitions()[graph.transitions_from(frame)];
        timeline.next(frame).into_iter().chain(transitions.iter().map(|transition| transition.to))
    })
}

/// The same for recorded steps and any `transitions` (from, to); those that name frames that do not exist are ignored.
#[must_use]
pub fn main_component_of(timeline: &Timeline, transitions: &[(u32, u32)]) -> MainComponent {
    let edges = with_recorded(timeline, transitions.iter().copied());
    let adjacency = Adjacency::new(timeline.frame_count(), edges.iter().copied());
    main_of(timeline.frame_count(), |frame| adjacency.of(frame).iter().copied())
}

fn main_of<I: Iterator<Item = u32>>(frames: u32, ends: impl Fn(u32) -> I) -> MainComponent {
    let components = components_of(frames, &ends);
    let mut main = vec![false; frames as usize];
    components.largest_frames().for_each(|frame| main[frame as usize] = true);
    let alone = components.largest_frames().nth(1).is_none();
    let live = if alone { vec![true; frames as usize] } else { components.leading_into_largest(ends) };
    MainComponent { main, live }
}

/// For every frame, whether a walk leads from it to any of `targets`.
#[must_use]
pub fn reaching(graph: &EssentialGraph, timeline: &Timeline, targets: &[u32]) -> Vec<bool> {
    connected(timeline, targets, edges(graph), |(from, to)| (to, from))
}

/// For every frame, whether a walk leads to it from `from`.
#[must_use]
pub fn reached(graph: &EssentialGraph, timeline: &Timeline, from: u32) -> Vec<bool> {
    connected(timeline, &[from], edges(graph), |edge| edge)
}

fn edges(graph: &EssentialGraph) -> impl Iterator<Item = (u32, u32)> {
    graph.transitions().iter().map(|transition| (transition.from, transition.to))
}

/// What can be reached from `starts` along edges that are turned by `turn`.
fn connected(
    timeline: &Timeline,
    starts: &[u32],
    transitions: impl Iterator<Item = (u32, u32)>,
    turn: fn((u32, u32)) -> (u32, u32),
) -> Vec<bool> {
    let frames = timeline.frame_count();
    let edges = with_recorded(timeline, transitions);
    let adjacency = Adjacency::new(frames, edges.iter().map(|&edge| turn(edge)));
    let mut reached = vec![false; frames as usize];
    for &start in starts.iter().filter(|&&start| start < frames) {
        // What is marked is wanted, not in which order.
        let _ = adjacency.visit(start, &mut reached);
    }
    reached
}
