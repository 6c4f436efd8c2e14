//! Shortest walks: Dijkstra's algorithm forwards from one frame, and backwards from targets to tables over all frames.

use super::meter;
use super::queue::Queue;
use actor::graph::EssentialGraph;
use actor::timeline::Timeline;
use actor::walk::{Leg, Walk, steps_of};

/// How a frame is reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Arrival {
    Recorded(u32),
    Synthetic(u32),
}

/// The cheapest walk between two frames, by Dijkstra's algorithm; equal costs prefer recorded frames.
///
/// A walk from a frame to itself has no legs. `None` where there is no walk, or a frame does not exist.
#[must_use]
pub fn cheapest_walk(graph: &EssentialGraph, timeline: &Timeline, from: u32, to: u32) -> Option<Walk> {
    cheapest_walk_to(graph, timeline, from, &|frame| frame == to)
}

/// The cheapest walk to the nearest frame that `is_target`. It looks no farther than that.
#[must_use]
pub(super) fn cheapest_walk_to(
    graph: &EssentialGraph,
    timeline: &Timeline,
    from: u32,
    is_target: &dyn Fn(u32) -> bool,
) -> Option<Walk> {
    let n = timeline.frame_count();
    if from >= n || graph.frame_count() != n {
        return None;
    }
    let mut distance = vec![f64::INFINITY; n as usize];
    let mut arrival = vec![None; n as usize];
    let mut queue = Queue::default();
    distance[from as usize] = 0.0;
    queue.push(0.0, u64::from(from));
    while let Some((cost, frame)) = queue.pop() {
        let frame = frame as u32;
        if is_target(frame) {
            return Some(walk_back(graph, &arrival, from, frame));
        }
        if cost > distance[frame as usize] {
            continue;
        }
        let mut reach = |next: u32, cost: f64, how: Arrival| {
            let known = &mut distance[next as usize];
            if cost < *known {
                *known = cost;
                arrival[next as usize] = Some(how);
                queue.push(cost, u64::from(next));
            }
        };
        if let Some(next) = timeline.next(frame) {
            reach(next, cost + graph.alpha(), Arrival::Recorded(frame));
        }
        let leaving = graph.transitions_from(frame);
        meter::count(leaving.len() + 1);
        for index in leaving {
            let transition = &graph.transitions()[index];
            reach(transition.to, cost + transition.cost(graph.alpha()), Arrival::Synthetic(index as u32));
        }
    }
    None
}

fn walk_back(graph: &EssentialGraph, arrivals: &[Option<Arrival>], from: u32, to: u32) -> Walk {
    let mut walk = Walk::default();
    let mut frame = to;
    while let (true, Some(arrival)) = (frame != from, arrivals[frame as usize]) {
        match arrival {
            Arrival::Recorded(before) => {
                walk.cost += graph.alpha();
                walk.duration += 1;
                match walk.legs.last_mut() {
                    Some(Leg::Recorded { first, steps, .. }) => {
                        *first = before;
                        *steps += 1;
                    }
                    _ => walk.legs.push(Leg::Recorded { first: before, last: frame, steps: 1 }),
                }
                frame = before;
            }
            Arrival::Synthetic(index) => {
                let transition = &graph.transitions()[index as usize];
                walk.cost += transition.cost(graph.alpha());
                walk.deformation += f64::from(transition.deformation);
                walk.duration += transition.warp.duration() as u32;
                walk.legs.push(Leg::Synthetic(index));
                frame = transition.from;
            }
        }
    }
    walk.legs.reverse();
    walk
}

/// What a table of [`to_targets`] adds up along a walk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// The cost E of the edges.
    Cost,
    /// Steps from frame to frame ([`steps_of`]): the least time in frames.
    Steps,
}

/// For every frame, the least measure of a walk to the nearest of `targets`; infinite where there is none.
///
/// One backward Dijkstra from all targets at once: O(m log n). Frames that do not exist are no targets.
#[must_use]
pub fn to_targets(graph: &EssentialGraph, timeline: &Timeline, targets: &[u32], measure: Measure) -> Vec<f64> {
    let n = timeline.frame_count();
    let mut least = vec![f64::INFINITY; n as usize];
    if graph.frame_count() != n {
        return least;
    }
    let arriving = Arriving::new(graph, n);
    let mut queue = Queue::default();
    for &target in targets.iter().filter(|&&target| target < n) {
        least[target as usize] = 0.0;
        queue.push(0.0, u64::from(target));
    }
    let step = if measure == Measure::Cost { graph.alpha() } else { 1.0 };
    while let Some((known, frame)) = queue.pop() {
        let frame = frame as u32;
        if known > least[frame as usize] {
            continue;
        }
        let mut reach = |before: u32, measured: f64| {
            if measured < least[before as usize] {
                least[before as usize] = measured;
                queue.push(measured, u64::from(before));
            }
        };
        if let Some(before) = timeline.offset(frame, -1) {
            reach(before, known + step);
        }
        meter::count(arriving.at(frame).len() + 1);
        for &index in arriving.at(frame) {
            let transition = &graph.transitions()[index as usize];
            let measured = match measure {
                Measure::Cost => transition.cost(graph.alpha()),
                Measure::Steps => f64::from(steps_of(transition)),
            };
            reach(transition.from, known + measured);
        }
    }
    least
}

/// The walk from `from` that a table of [`to_targets`] by cost describes; `None` where it leads nowhere.
#[must_use]
pub fn walk_down(graph: &EssentialGraph, timeline: &Timeline, costs: &[f64], from: u32) -> Option<Walk> {
    let at = |frame: u32| costs.get(frame as usize).copied().unwrap_or(f64::INFINITY);
    if !at(from).is_finite() {
        return None;
    }
    let mut legs = Walk::default();
    let mut frame = from;
    // Costs along the walk fall, but for edges that cost nothing: those are no loop that would end.
    for _ in 0..=costs.len() {
        if at(frame) <= 0.0 {
            return Walk::of_legs(legs.legs, graph).ok();
        }
        let recorded = timeline.next(frame).map(|next| (at(next) + graph.alpha(), next, None));
        let synthetic = graph.transitions_from(frame).map(|index| {
            let transition = &graph.transitions()[index];
            (at(transition.to) + transition.cost(graph.alpha()), transition.to, Some(index as u32))
        });
        let (_, next, how) = recorded.into_iter().chain(synthetic).min_by(|a, b| a.0.total_cmp(&b.0))?;
        match how {
            None => legs.push_recorded(frame, next, 1),
            Some(index) => legs.legs.push(Leg::Synthetic(index)),
        }
        frame = next;
    }
    None
}

/// Transitions by the frame that they arrive at.
struct Arriving {
    first: Vec<u32>,
    indices: Vec<u32>,
}

impl Arriving {
    fn new(graph: &EssentialGraph, frame_count: u32) -> Self {
        let mut first = vec![0_u32; frame_count as usize + 1];
        for transition in graph.transitions() {
            first[transition.to as usize + 1] += 1;
        }
        for frame in 0..frame_count as usize {
            first[frame + 1] += first[frame];
        }
        let mut next = first.clone();
        let mut indices = vec![0; graph.transitions().len()];
        for (index, transition) in graph.transitions().iter().enumerate() {
            let slot = &mut next[transition.to as usize];
            indices[*slot as usize] = index as u32;
            *slot += 1;
        }
        Self { first, indices }
    }

    fn at(&self, frame: u32) -> &[u32] {
        let frame = frame as usize;
        &self.indices[self.first[frame] as usize..self.first[frame + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use actor::graph::Transition;
    use actor::temporal_warp::{Move, TemporalWarp};
    use actor::timeline::Sequence;
    use kernels::align::Placement;

    fn timeline() -> Timeline {
        let sequence = |name: &str, first_frame| Sequence {
            name: name.into(),
            labels: vec![],
            first_frame,
            frame_count: 6,
            cyclic: false,
        };
        Timeline::new(25.0, vec![sequence("a", 0), sequence("b", 6)]).unwrap()
    }

    fn transition(from: u32, to: u32, deformation: f32) -> Transition {
        let warp = TemporalWarp::new(vec![Move::Both; 2]);
        Transition { from, to, deformation, warp, placement: Placement::IDENTITY, turn: 0.0 }
    }

    #[test]
    fn waits_for_the_cheaper_transition() {
        let timeline = timeline();
        let edges = vec![transition(0, 8, 1.0), transition(3, 9, 0.25)];
        let graph = EssentialGraph::new(0.01, edges, &timeline).unwrap();
        let walk = cheapest_walk(&graph, &timeline, 0, 11).unwrap();
        let legs = [
            Leg::Recorded { first: 0, last: 3, steps: 3 },
            Leg::Synthetic(1),
            Leg::Recorded { first: 9, last: 11, steps: 2 },
        ];
        assert_eq!(walk.legs, legs);
        assert_eq!(walk.duration, 3 + 3 + 2);
        assert!((walk.cost - (0.25 + 8.0 * graph.alpha())).abs() < 1e-12);
        assert_eq!(cheapest_walk(&graph, &timeline, 4, 4), Some(Walk::default()));
        assert_eq!(cheapest_walk(&graph, &timeline, 11, 0), None);
        assert_eq!(cheapest_walk(&graph, &timeline, 0, 12), None);
    }

    #[test]
    fn refuses_segments_that_leave_their_sequence() {
        let edges = vec![transition(4, 9, 1.0)];
        let refused = EssentialGraph::new(0.01, edges, &timeline());
        assert_eq!(refused, Err(actor::graph::GraphError::Segment(0)));
    }
}
