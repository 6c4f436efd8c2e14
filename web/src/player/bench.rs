//! The page's own benchmark: how long the player takes for what it does most, on the reader's machine.

use actor::pose_source::PoseSource;
use actor::walk::{Leg, Walk};
use glam::Vec3;
use kernels::align::Placement;
use search::cheapest_walk;
use serde::Serialize;
use synthesis::{FrameKind, Synthesiser};

use super::produce::median;
use super::{Player, PlayerError};

/// Median milliseconds.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Bench {
    /// A frame of a transition.
    pub synthetic_frame: f64,
    /// The first one of a transition, with nothing prepared.
    pub synthetic_frame_first: f64,
    /// The slowest one.
    pub synthetic_frame_worst: f64,
    /// Any recorded frame, in no order.
    pub recorded_frame: f64,
    /// The cheapest walk between two frames.
    pub plan: f64,
    /// Transitions measured.
    pub transitions: usize,
}

/// Transitions measured, spread over the graph.
const TRANSITIONS: usize = 12;
/// Runs of what is quick.
const RUNS: u32 = 200;

impl Player {
    /// Measures with the clock `now`, in milliseconds. What is shown is not touched.
    ///
    /// # Errors
    /// The bundle has not arrived.
    pub fn bench(&mut self, now: fn() -> f64) -> Result<Bench, PlayerError> {
        let (actor, graph) = self.ready(0)?;
        let frames = actor.timeline.frame_count();
        // A step of the golden section visits all frames evenly, far from one another.
        let some = |run: u32| (u64::from(run) * 2_654_435_769 % u64::from(frames)) as u32;
        let mut pose = vec![Vec3::ZERO; actor.topology.vertex_count()];
        let time = |work: &mut dyn FnMut()| {
            let start = now();
            work();
            now() - start
        };
        let recorded = (0..RUNS).map(|run| {
            let source = &mut self.loading.source;
            let mut outcome = Ok(());
            let taken = time(&mut || outcome = source.read(some(run), &mut pose));
            outcome.map(|()| taken)
        });
        let recorded = recorded.collect::<Result<Vec<_>, _>>()?;
        let plans = (0..RUNS).map(|run| {
            time(&mut || {
                std::hint::black_box(cheapest_walk(&graph, &actor.timeline, some(run), some(run + RUNS)));
            })
        });
        let plans = plans.collect::<Vec<_>>();
        let mut synthesiser =
            Synthesiser::new(&actor.topology, self.loading.order()).map_err(|_| PlayerError::Damaged(0))?;
        let stride = (graph.transitions().len() / TRANSITIONS).max(1);
        let (mut synthetic, mut first) = (Vec::new(), Vec::new());
        let mut transitions = 0;
        for edge in (0..graph.transitions().len()).step_by(stride).take(TRANSITIONS) {
            let walk = Walk { legs: vec![Leg::Synthetic(edge as u32)], ..Walk::default() };
            let from = graph.transitions()[edge].from;
            let begun = synthesiser.begin_walk(&graph, &actor.timeline, (from, Placement::IDENTITY), &walk);
            begun.map_err(|_| PlayerError::Damaged(from))?;
            transitions += 1;
            let before = synthetic.len();
            loop {
                let mut made = Ok(None);
                let source = &mut self.loading.source;
                let taken = time(&mut || made = synthesiser.next_frame(&graph, &actor.timeline, source, &mut pose));
                let Some(info) = made? else { break };
                if matches!(info.kind, FrameKind::Synthetic { .. }) {
                    synthetic.push(taken);
                }
            }
            first.extend(synthetic.get(before));
        }
        Ok(Bench {
            synthetic_frame_worst: synthetic.iter().copied().fold(0.0, f64::max),
            synthetic_frame: median(&synthetic),
            synthetic_frame_first: median(&first),
            recorded_frame: median(&recorded),
            plan: median(&plans),
            transitions,
        })
    }
}
