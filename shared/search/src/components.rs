//! Where the actor never gets stuck: the largest set of frames that all reach each other (Prada and others 2016,
//! section 7), and the frames that lead into it.

use actor::graph::EssentialGraph;
use actor::timeline::Timeline;

/// What [`components`] finds out about every frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Components {
    /// Whether it is in the largest strongly connected component; of equally large ones the one of the first frame.
    pub main: Vec<bool>,
    /// Whether a walk leads from it into the main component: the frames that are no dead end. All frames where the main
    /// component is a single frame, since then nothing can be planned around.
    pub live: Vec<bool>,
}

/// The main component of the graph, and the frames that lead into it. Kosaraju and Sharir's algorithm.
#[must_use]
pub fn components(graph: &EssentialGraph, timeline: &Timeline) -> Components {
    let edges = graph.transitions().iter().map(|transition| (transition.from, transition.to));
    components_of(timeline, edges.collect())
}

/// The same for recorded steps and any `transitions` (from, to); those that name frames that do not exist are ignored.
#[must_use]
pub fn components_of(timeline: &Timeline, transitions: Vec<(u32, u32)>) -> Components {
    let frames = timeline.frame_count();
    let edges = with_recorded(timeline, transitions);
    let forwards = Edges::new(frames, &edges, |edge| edge);
    let backwards = Edges::new(frames, &edges, |(from, to)| (to, from));

    let mut reached = vec![false; frames as usize];
    let order: Vec<_> = (0..frames).flat_map(|frame| forwards.search(frame, &mut reached)).collect();
    reached.fill(false);
    let mut largest: Vec<u32> = Vec::new();
    for &frame in order.iter().rev() {
        let component = backwards.search(frame, &mut reached);
        let earlier = component.iter().min() < largest.iter().min();
        if component.len() > largest.len() || component.len() == largest.len() && earlier {
            largest = component;
        }
    }
    let mut main = vec![false; frames as usize];
    largest.iter().for_each(|&frame| main[frame as usize] = true);
    let mut live = vec![largest.len() < 2; frames as usize];
    if largest.len() > 1 {
        backwards.search(largest[0], &mut live);
    }
    Components { main, live }
}

/// For every frame, whether a walk leads from it to `to`.
#[must_use]
pub fn reaching(graph: &EssentialGraph, timeline: &Timeline, to: u32) -> Vec<bool> {
    search_from(timeline, to, graph.transitions().iter().map(|edge| (edge.from, edge.to)), |(a, b)| (b, a))
}

/// For every frame, whether a walk leads to it from `from`.
#[must_use]
pub fn reached(graph: &EssentialGraph, timeline: &Timeline, from: u32) -> Vec<bool> {
    search_from(timeline, from, graph.transitions().iter().map(|edge| (edge.from, edge.to)), |edge| edge)
}

fn search_from(
    timeline: &Timeline,
    start: u32,
    transitions: impl Iterator<Item = (u32, u32)>,
    turn: fn((u32, u32)) -> (u32, u32),
) -> Vec<bool> {
    let frames = timeline.frame_count();
    let mut reached = vec![false; frames as usize];
    if start < frames {
        Edges::new(frames, &with_recorded(timeline, transitions), turn).search(start, &mut reached);
    }
    reached
}

/// `transitions` and the recorded steps, without what names frames that do not exist.
fn with_recorded(timeline: &Timeline, transitions: impl IntoIterator<Item = (u32, u32)>) -> Vec<(u32, u32)> {
    let frames = timeline.frame_count();
    let recorded = (0..frames).filter_map(|frame| Some((frame, timeline.next(frame)?)));
    recorded.chain(transitions).filter(|&(a, b)| a < frames && b < frames).collect()
}

/// Edges by the frame that they leave.
struct Edges {
    first: Vec<u32>,
    ends: Vec<u32>,
}

impl Edges {
    /// Of `edges` between frames that exist, each turned by `turn`; counted rather than sorted, since pages do it too.
    fn new(frames: u32, edges: &[(u32, u32)], turn: fn((u32, u32)) -> (u32, u32)) -> Self {
        let mut first = vec![0; frames as usize + 1];
        for &edge in edges {
            first[turn(edge).0 as usize + 1] += 1;
        }
        for frame in 0..frames as usize {
            first[frame + 1] += first[frame];
        }
        let (mut next, mut ends) = (first.clone(), vec![0; edges.len()]);
        for &edge in edges {
            let (from, to) = turn(edge);
            ends[next[from as usize] as usize] = to;
            next[from as usize] += 1;
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
