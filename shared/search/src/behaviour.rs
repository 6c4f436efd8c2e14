//! Going to a behaviour, and holding it.

use super::meter;
use super::queue::Queue;
use super::search_graph::SearchGraph;
use super::shortest::cheapest_walk_to;
use actor::graph::EssentialGraph;
use actor::timeline::Timeline;
use actor::walk::{Leg, Walk, steps_of};

/// Most frames from which loops are looked for.
const MOST_SOURCES: usize = 128;
/// The shortest loop in seconds: what is shorter looks like a stutter.
const SHORTEST_LOOP: f64 = 0.8;

/// The cheapest walk from `from` to any of `targets`; `None` where there is none.
#[must_use]
pub fn walk_to_any(graph: &EssentialGraph, timeline: &Timeline, from: u32, targets: &[u32]) -> Option<Walk> {
    let mut is_target = vec![false; timeline.frame_count() as usize];
    for &target in targets {
        if let Some(mark) = is_target.get_mut(target as usize) {
            *mark = true;
        }
    }
    cheapest_walk_to(graph, timeline, from, &|frame| is_target[frame as usize])
}

/// The cheapest walk to frames that show a behaviour, by its number in [`SearchGraph`], and that it can be seen from: half a second
/// of it follows, or as much as there is.
#[must_use]
pub fn walk_to_behaviour(
    graph: &EssentialGraph,
    timeline: &Timeline,
    search_graph: &SearchGraph,
    from: u32,
    behaviour: usize,
) -> Option<Walk> {
    let follows = |frame: u32, steps: i64| {
        let later = timeline.offset(frame, steps);
        later.is_some_and(|later| search_graph.shows(behaviour, later) && search_graph.live[later as usize])
    };
    for seconds in [0.5, 0.2, 0.0] {
        let steps = (seconds * search_graph.fps) as i64;
        let shows = |frame: &u32| search_graph.shows(behaviour, *frame) && follows(*frame, steps);
        let targets: Vec<u32> = (0..search_graph.frame_count()).filter(shows).collect();
        if let Some(walk) = walk_to_any(graph, timeline, from, &targets) {
            return Some(walk);
        }
    }
    let targets: Vec<u32> =
        (0..search_graph.frame_count()).filter(|&frame| search_graph.shows(behaviour, frame)).collect();
    walk_to_any(graph, timeline, from, &targets)
}

/// A loop within a behaviour.
#[derive(Clone, Debug, PartialEq)]
pub struct Hold {
    /// The frame that it begins and ends with.
    pub frame: u32,
    /// Once around.
    pub walk: Walk,
    /// Its steps.
    pub steps: u32,
}

impl Hold {
    /// The frames of the loop that it shows as they were recorded: where it can be entered. Entering elsewhere than at
    /// [`Self::frame`] means to turn the loop ([`Self::entered_at`]).
    #[must_use]
    pub fn entries(&self, timeline: &Timeline) -> Vec<u32> {
        let mut entries = vec![self.frame];
        for leg in &self.walk.legs {
            if let Leg::Recorded { first, steps, .. } = *leg {
                let steps = i64::from(steps).min(i64::from(timeline.frame_count()));
                entries.extend((0..=steps).filter_map(|step| timeline.offset(first, step)));
            }
        }
        entries.sort_unstable();
        entries.dedup();
        entries
    }

    /// The same loop, begun at another of its [`Self::entries`]; as it is for a frame that is none.
    #[must_use]
    pub fn entered_at(&self, timeline: &Timeline, frame: u32) -> Self {
        let legs = &self.walk.legs;
        for (index, leg) in legs.iter().enumerate() {
            let Leg::Recorded { first, last, steps } = *leg else { continue };
            let Some(before) = (0..=steps).find(|&step| timeline.offset(first, i64::from(step)) == Some(frame)) else {
                continue;
            };
            let mut turned = Walk::default();
            turned.push_recorded(frame, last, steps - before);
            for leg in legs[index + 1..].iter().chain(&legs[..index]) {
                match *leg {
                    Leg::Recorded { first, last, steps } => turned.push_recorded(first, last, steps),
                    Leg::Synthetic(_) | Leg::Back { .. } => turned.legs.push(*leg),
                }
            }
            turned.push_recorded(first, frame, before);
            return Self { frame, walk: Walk { legs: turned.legs, ..self.walk.clone() }, steps: self.steps };
        }
        self.clone()
    }
}

/// The loop within a behaviour with the least cost a step, of at least 0.8 s where there is one, all at once
/// ([`LoopSearch`]). `None` where the behaviour has no loop of its own.
#[must_use]
pub fn holding_loop(
    graph: &EssentialGraph,
    timeline: &Timeline,
    search_graph: &SearchGraph,
    behaviour: usize,
) -> Option<Hold> {
    let mut search = LoopSearch::new(search_graph, behaviour);
    while !search.advance(graph, timeline) {}
    search.best
}

/// The search for the loop within a behaviour, a frame at a time: for up to 128 of its frames one Dijkstra inside the
/// behaviour, each closed by the transitions and steps that lead back.
#[derive(Clone, Debug)]
pub struct LoopSearch {
    inside: Vec<u32>,
    next: usize,
    stride: usize,
    /// The best loop so far; final once [`Self::advance`] says so.
    pub best: Option<Hold>,
    /// Whether that is too short, and what a step of it costs.
    price: (bool, f64),
    fps: f64,
}

impl LoopSearch {
    /// The search among the frames of a behaviour, by its number in [`SearchGraph`].
    #[must_use]
    pub fn new(search_graph: &SearchGraph, behaviour: usize) -> Self {
        let inside: Vec<u32> =
            (0..search_graph.frame_count()).filter(|&frame| search_graph.shows(behaviour, frame)).collect();
        let stride = inside.len().div_ceil(MOST_SOURCES).max(1);
        Self { inside, next: 0, stride, best: None, price: (true, f64::INFINITY), fps: search_graph.fps }
    }

    /// Looks for no more.
    pub fn skip(&mut self) {
        self.next = self.inside.len();
    }

    /// Looks for loops through one more frame; whether that was the last.
    pub fn advance(&mut self, graph: &EssentialGraph, timeline: &Timeline) -> bool {
        let Some(&source) = self.inside.get(self.next) else { return true };
        let mut search = Inside::new(graph, timeline, &self.inside);
        search.from(source);
        for (frame, cost, steps, edge) in search.closing(source) {
            let price = (f64::from(steps) < SHORTEST_LOOP * self.fps, cost / f64::from(steps.max(1)));
            if self.price <= price {
                continue;
            }
            if let Some(walk) = search.walk(source, frame, edge) {
                (self.price, self.best) = (price, Some(Hold { frame: source, walk, steps }));
            }
        }
        self.next += self.stride;
        self.next >= self.inside.len()
    }
}

/// Dijkstra's algorithm among some frames only.
struct Inside<'a> {
    graph: &'a EssentialGraph,
    timeline: &'a Timeline,
    is_inside: Vec<bool>,
    frames: &'a [u32],
    cost: Vec<f64>,
    steps: Vec<u32>,
    /// The frame before each, and the transition from it.
    before: Vec<Option<(u32, Option<u32>)>>,
}

impl<'a> Inside<'a> {
    fn new(graph: &'a EssentialGraph, timeline: &'a Timeline, frames: &'a [u32]) -> Self {
        let n = timeline.frame_count() as usize;
        let mut is_inside = vec![false; n];
        frames.iter().for_each(|&frame| is_inside[frame as usize] = true);
        Self { graph, timeline, is_inside, frames, cost: vec![0.0; n], steps: vec![0; n], before: vec![None; n] }
    }

    /// Edges from a frame that stay inside: where to, cost, steps, transition.
    fn edges(&self, frame: u32) -> impl Iterator<Item = (u32, f64, u32, Option<u32>)> {
        let (graph, alpha) = (self.graph, self.graph.alpha());
        let recorded = self.timeline.next(frame).map(|next| (next, alpha, 1, None));
        let synthetic = graph.transitions_from(frame).map(move |index| {
            let transition = &graph.transitions()[index];
            (transition.to, transition.cost(alpha), steps_of(transition), Some(index as u32))
        });
        recorded.into_iter().chain(synthetic).filter(|edge| self.is_inside[edge.0 as usize])
    }

    fn from(&mut self, source: u32) {
        for &frame in self.frames {
            self.cost[frame as usize] = f64::INFINITY;
            self.before[frame as usize] = None;
        }
        (self.cost[source as usize], self.steps[source as usize]) = (0.0, 0);
        let mut queue = Queue::default();
        queue.push(0.0, u64::from(source));
        while let Some((cost, frame)) = queue.pop() {
            let frame = frame as u32;
            if cost > self.cost[frame as usize] {
                continue;
            }
            meter::count(self.graph.transitions_from(frame).len() + 1);
            let edges: Vec<_> = self.edges(frame).collect();
            for (to, more, steps, edge) in edges {
                if cost + more < self.cost[to as usize] {
                    self.cost[to as usize] = cost + more;
                    self.steps[to as usize] = self.steps[frame as usize] + steps;
                    self.before[to as usize] = Some((frame, edge));
                    queue.push(cost + more, u64::from(to));
                }
            }
        }
    }

    /// Edges that lead back to the source: from which frame, and the loop's cost and steps.
    fn closing(&self, source: u32) -> Vec<(u32, f64, u32, Option<u32>)> {
        let reached = self.frames.iter().filter(|&&frame| self.cost[frame as usize].is_finite());
        let back = reached.flat_map(|&frame| self.edges(frame).map(move |edge| (frame, edge)));
        back.filter(|(_, edge)| edge.0 == source)
            .map(|(frame, (_, cost, steps, edge))| {
                (frame, self.cost[frame as usize] + cost, self.steps[frame as usize] + steps, edge)
            })
            .collect()
    }

    fn walk(&self, source: u32, last: u32, closing: Option<u32>) -> Option<Walk> {
        let mut edges = vec![(last, source, closing)];
        let mut frame = last;
        while frame != source {
            let (before, edge) = self.before[frame as usize]?;
            edges.push((before, frame, edge));
            frame = before;
        }
        let mut walk = Walk::default();
        for &(from, to, edge) in edges.iter().rev() {
            match edge {
                None => walk.push_recorded(from, to, 1),
                Some(index) => walk.legs.push(Leg::Synthetic(index)),
            }
        }
        Walk::of_legs(walk.legs, self.graph).ok()
    }
}
