//! Walks through the essential graph: the cheapest way from one frame to another.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::graph::EssentialGraph;
use crate::timeline::Timeline;

/// A stretch of a walk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Leg {
    /// Recorded frames from `first` to `last`, both included, wrapping where their sequence is cyclic.
    Recorded {
        /// The frame that the stretch begins with.
        first: u32,
        /// The frame that it ends with.
        last: u32,
        /// Steps from `first` to `last`; more than one turn around a cyclic sequence counts them all.
        steps: u32,
    },
    /// The transition with this index in [`EssentialGraph::transitions`].
    Synthetic(u32),
}

/// A walk through the graph, from frame to frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Walk {
    /// Its stretches, each beginning with the frame that the one before ends with.
    pub legs: Vec<Leg>,
    /// J: the sum of its edges' costs (TVCG equation 9).
    pub cost: f64,
    /// Sum of the transitions' surface deformation costs.
    pub deformation: f64,
    /// Duration in frames: recorded steps and transition lengths.
    pub duration: u32,
}

impl Walk {
    /// Number of transitions on the way.
    #[must_use]
    pub fn transition_count(&self) -> usize {
        self.legs.iter().filter(|leg| matches!(leg, Leg::Synthetic(_))).count()
    }
}

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
    let n = timeline.frame_count();
    if from >= n || to >= n || graph.frame_count() != n {
        return None;
    }
    let arrivals = arrivals(graph, timeline, from, to)?;
    Some(walk_back(graph, &arrivals, from, to))
}

/// How each frame on the way to `to` is reached from `from`; `None` where `to` cannot be.
fn arrivals(graph: &EssentialGraph, timeline: &Timeline, from: u32, to: u32) -> Option<Vec<Option<Arrival>>> {
    let n = timeline.frame_count() as usize;
    let mut distance = vec![f64::INFINITY; n];
    let mut arrival = vec![None; n];
    let mut queue = BinaryHeap::new();
    distance[from as usize] = 0.0;
    queue.push(Reverse((0.0_f64.to_bits(), from)));
    while let Some(Reverse((bits, frame))) = queue.pop() {
        // Costs are not negative, and such floats order as their bits do.
        let cost = f64::from_bits(bits);
        if frame == to {
            return Some(arrival);
        }
        if cost > distance[frame as usize] {
            continue;
        }
        let mut reach = |next: u32, cost: f64, how: Arrival| {
            let known = &mut distance[next as usize];
            if cost < *known {
                *known = cost;
                arrival[next as usize] = Some(how);
                queue.push(Reverse((cost.to_bits(), next)));
            }
        };
        if let Some(next) = timeline.next(frame) {
            reach(next, cost + graph.alpha(), Arrival::Recorded(frame));
        }
        for index in graph.transitions_from(frame) {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::align::Placement;
    use crate::graph::Transition;
    use crate::timeline::Sequence;
    use crate::warp::{Move, Warp};

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
        let warp = Warp::new(vec![Move::Both; 2]);
        Transition { from, to, deformation, warp, placement: Placement::IDENTITY }
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
        assert_eq!(refused, Err(crate::graph::GraphError::Segment(0)));
    }
}
