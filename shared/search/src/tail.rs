//! How a walk to a place ends in a pose: from every frame the cheapest walk to that pose, and where it leads. One backward
//! Dijkstra over all frames, in slices.

use super::ground_pose::GroundPose;
use super::queue::Queue;
use super::search_graph::{Edge, SearchGraph};

/// Edges that are looked at in the time of an expanded state.
const EDGES_A_STATE: u32 = 32;

/// The cheapest walks to a frame.
#[derive(Clone, Debug)]
pub(super) struct Tail {
    /// The frame.
    pub to: u32,
    /// For every frame the cost from there on; infinite where no walk leads to it, or where none is known yet.
    cost: Vec<f64>,
    /// Where `to` stands once the frame stands as it was recorded.
    ground_pose: Vec<GroundPose>,
    /// The first edge of the walk from each frame.
    first: Vec<u32>,
    /// Edges by the frame that they lead to, and the frame that each of them leaves.
    arriving: Vec<u32>,
    first_arriving: Vec<u32>,
    leaves: Vec<u32>,
    queue: Queue,
}

impl Tail {
    /// Only `to` itself is known yet. The frame must exist.
    pub fn new(search_graph: &SearchGraph, to: u32) -> Self {
        let frames = search_graph.frame_count() as usize;
        let edges = search_graph.from(search_graph.frame_count().saturating_sub(1)).end as usize;
        let mut first_arriving = vec![0; frames + 1];
        let mut leaves = vec![0; edges];
        for frame in 0..frames as u32 {
            for index in search_graph.from(frame) {
                leaves[index as usize] = frame;
                first_arriving[search_graph.edge(index).to as usize + 1] += 1;
            }
        }
        for frame in 0..frames {
            first_arriving[frame + 1] += first_arriving[frame];
        }
        let (mut next, mut arriving) = (first_arriving.clone(), vec![0; edges]);
        for index in 0..edges as u32 {
            let place = &mut next[search_graph.edge(index).to as usize];
            arriving[*place as usize] = index;
            *place += 1;
        }
        let mut tail = Self {
            to,
            cost: vec![f64::INFINITY; frames],
            ground_pose: vec![GroundPose::IDENTITY; frames],
            first: vec![0; frames],
            arriving,
            first_arriving,
            leaves,
            queue: Queue::default(),
        };
        tail.cost[to as usize] = 0.0;
        tail.queue.push(0.0, u64::from(to));
        tail
    }

    /// Learns more, for as long as expanding up to so many `states` takes; how many it took, fewer than `states` once all is known.
    /// `price` is what an edge costs.
    pub fn advance(&mut self, search_graph: &SearchGraph, states: u32, price: impl Fn(&Edge) -> f64) -> u32 {
        let most = states.saturating_mul(EDGES_A_STATE);
        let mut looked = 0;
        while looked < most {
            let Some((cost, frame)) = self.queue.pop() else { return looked / EDGES_A_STATE };
            let frame = frame as usize;
            if cost > self.cost[frame] {
                continue;
            }
            for at in self.first_arriving[frame]..self.first_arriving[frame + 1] {
                let index = self.arriving[at as usize];
                let (edge, from) = (search_graph.edge(index), self.leaves[index as usize] as usize);
                let whole = cost + price(edge);
                if whole < self.cost[from] {
                    self.cost[from] = whole;
                    self.first[from] = index;
                    self.ground_pose[from] = edge.ground_pose.after(&self.ground_pose[frame]);
                    self.queue.push(whole, from as u64);
                }
                looked += 1;
            }
        }
        states
    }

    /// What it costs from `frame` on, standing at `ground_pose`, and where the pose stands then; `None` where no walk leads to it.
    pub fn from(&self, frame: u32, ground_pose: GroundPose) -> Option<(f64, GroundPose)> {
        let frame = frame as usize;
        let cost = *self.cost.get(frame)?;
        cost.is_finite().then(|| (cost, ground_pose.after(&self.ground_pose[frame])))
    }

    /// The edges of the walk from `frame`.
    pub fn edges(&self, search_graph: &SearchGraph, mut frame: u32) -> Vec<u32> {
        let mut edges = Vec::new();
        while frame != self.to && self.cost[frame as usize].is_finite() {
            let edge = self.first[frame as usize];
            edges.push(edge);
            frame = search_graph.edge(edge).to;
        }
        edges
    }
}
