//! What searches read, where the actor is, and what has been decided so far.

use actor::graph::EssentialGraph;
use actor::timeline::Timeline;
use actor::walk::{Leg, Walk};
use kernels::align::Placement;

use super::answer::{Goal, Part};
use super::bend::Bend;
use super::ground_pose::GroundPose;
use super::search_graph::SearchGraph;
use super::task::State;

/// Most steps of an answer.
pub(crate) const MOST_STEPS: u32 = 1 << 20;

/// What searches read. It must be the same for all calls of a [`crate::Direction`].
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// The graph.
    pub graph: &'a EssentialGraph,
    /// Its sequences.
    pub timeline: &'a Timeline,
    /// Its edges with their motion over the ground.
    pub search_graph: &'a SearchGraph,
}

/// Where the actor is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// The frame shown.
    pub frame: u32,
    /// Where its recorded frames stand: `world_from_recorded`.
    pub placement: Placement,
}

/// What has been decided.
#[derive(Clone, Debug)]
pub(super) struct Done {
    pub frame: u32,
    pub ground_pose: GroundPose,
    pub walk: Walk,
    /// How the walk is bent, as [`Walk::bend`].
    pub bend: Vec<GroundPose>,
    pub parts: Vec<Part>,
}

impl Done {
    pub fn push(&mut self, scene: &Scene, walk: &Walk, bend: &Bend, goal: Goal, notes: Vec<String>) {
        let first_step = self.walk.steps(scene.graph);
        for leg in &walk.legs {
            self.follow(scene, leg);
        }
        self.walk.append(walk);
        if let Some(last) = bend.0.last() {
            self.ground_pose = last.after(&self.ground_pose);
        }
        if !bend.0.is_empty() || !self.bend.is_empty() {
            let before = self.bend.last().copied().unwrap_or(GroundPose::IDENTITY);
            self.bend.resize(first_step as usize + 1, before);
            self.bend.extend(bend.0.iter().skip(1).map(|pose| pose.after(&before)));
        }
        self.parts.push(Part { first_step, steps: walk.steps(scene.graph), goal, notes });
    }

    /// Keeps track of where the actor stands.
    fn follow(&mut self, scene: &Scene, leg: &Leg) {
        match *leg {
            Leg::Recorded { steps, .. } => {
                for _ in 0..steps {
                    let Some(next) = scene.timeline.next(self.frame) else { return };
                    if next != self.frame + 1 {
                        self.ground_pose = self.ground_pose.after(&wrap_of(scene, self.frame));
                    }
                    self.frame = next;
                }
            }
            Leg::Back { last, .. } => self.frame = last,
            Leg::Synthetic(index) => {
                if let Some(transition) = scene.graph.transitions().get(index as usize) {
                    self.ground_pose = self.ground_pose.after(&GroundPose::from(&transition.placement));
                    self.frame = transition.to;
                }
            }
        }
    }

    pub fn state(&self) -> State {
        State::start(self.frame, self.ground_pose)
    }
}

/// Where the first frame of a cyclic sequence stands after `last`, its last one.
fn wrap_of(scene: &Scene, last: u32) -> GroundPose {
    let mut recorded = scene
        .search_graph
        .from(last)
        .map(|edge| scene.search_graph.edge(edge))
        .filter(|edge| edge.transition.is_none());
    recorded.next().map_or(GroundPose::IDENTITY, |edge| edge.ground_pose)
}
