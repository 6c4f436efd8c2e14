//! Synthesis of a walk through the essential graph, one frame at a time, with constant memory.
//!
//! This work is based on: Boukhayma, thesis (2017), section 3.4, algorithms 2 and 3; TVCG algorithms 1 and 2. The
//! centre of mass steps by the displacements between the frames that the warps actually visit; the papers' n + 1 would
//! count a repeated frame's displacement twice. Walks may change their mind; wraps of cyclic sequences are bridged
//! ([`recorded_step`]).

use std::collections::VecDeque;

use glam::Vec3;

use actor::blend::{Blend, transition};
use actor::graph::{EssentialGraph, Transition};
use actor::ground::{PoseMemory, PosesOnGround, recorded_step};
use actor::pose_source::{PoseError, PoseSource};
use actor::timeline::Timeline;
use actor::walk::{Leg, Walk};
use kernels::align::Placement;
use kernels::cholesky::CholeskyError;
use kernels::poisson::{Effort, KeyedPose, PoissonInterpolator};
use kernels::topology::Topology;

/// Where a frame of a walk comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FrameKind {
    /// A frame as it was recorded, placed.
    Recorded {
        /// The frame.
        frame: u32,
    },
    /// A node of a transition; the first and the last node of one are recorded frames.
    Synthetic {
        /// Index of the transition in [`EssentialGraph::transitions`].
        transition: u32,
        /// Index t of the node of its warp, from 0.
        node: u32,
        /// Weight of the destination, between 0 and 1.
        lambda: f32,
        /// Frame n of the source.
        source_frame: u32,
        /// Frame m of the destination.
        destination_frame: u32,
    },
}

/// A frame of a walk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameInfo {
    /// Where it comes from.
    pub kind: FrameKind,
    /// Placement of the recorded frame, or of the nearer side of a transition: `world_from_recorded`.
    pub placement: Placement,
    /// Index of the leg that it belongs to, in the walk begun or retargeted to last; `None` before its first leg.
    pub leg: Option<usize>,
    /// What interpolating it took.
    pub effort: Effort,
}

/// Makes the frames of walks.
pub struct Synthesiser {
    weights: Vec<f32>,
    interpolator: PoissonInterpolator,
    memory: PoseMemory,
    /// Source and destination of a transition, placed.
    placed: [Vec<Vec3>; 2],
    /// Legs to come.
    legs: VecDeque<Leg>,
    /// Legs of the walk begun so far.
    legs_begun: usize,
    state: State,
}

#[derive(Clone, Copy, Debug)]
enum State {
    /// No walk was begun.
    Idle,
    /// The walk's first frame is due.
    Due { frame: u32, placement: Placement },
    /// A recorded frame was shown; `left` steps of the present leg are to come.
    Recorded { frame: u32, placement: Placement, left: u32 },
    /// A node of a transition was shown.
    Synthetic { transition: u32, blend: Blend },
}

impl Synthesiser {
    /// A synthesiser over `topology`; `order` as in [`PoissonInterpolator::new`].
    ///
    /// # Errors
    /// As [`PoissonInterpolator::new`].
    pub fn new(topology: &Topology, order: Option<&[u32]>) -> Result<Self, CholeskyError> {
        let pose = vec![Vec3::ZERO; topology.vertex_count()];
        Ok(Self {
            weights: topology.weights().to_vec(),
            interpolator: PoissonInterpolator::new(topology, order)?,
            memory: PoseMemory::default(),
            placed: [pose.clone(), pose],
            legs: VecDeque::new(),
            legs_begun: 0,
            state: State::Idle,
        })
    }

    /// Does a piece of the next transition's work ahead of time, at most one factorisation; whether more of it is left.
    /// For idle moments while recorded frames are shown.
    ///
    /// # Errors
    /// A frame that cannot be read (yet), or a walk that does not belong to `graph`.
    pub fn prepare(
        &mut self,
        graph: &EssentialGraph,
        timeline: &Timeline,
        source: &mut dyn PoseSource,
    ) -> Result<bool, PoseError> {
        let Some(index) = self.legs.iter().find_map(|leg| match leg {
            Leg::Synthetic(index) => Some(*index),
            Leg::Recorded { .. } => None,
        }) else {
            return Ok(false);
        };
        let to = transition(graph, index)?;
        let (_, lj) = to.warp.lengths();
        let first = timeline.offset(to.to, 1 - lj as i64).ok_or(PoseError::OutOfRange(to.to))?;
        let mut unprepared = [to.from, first].into_iter().filter(|&frame| !self.interpolator.is_prepared(frame));
        let (next, more) = (unprepared.next(), unprepared.next().is_some());
        if let Some(frame) = next {
            let mut ground = PosesOnGround::new(source, &self.weights, &mut self.memory);
            ground.place(frame, Placement::IDENTITY, &mut self.placed[0])?;
            let pose = KeyedPose { frame, pose: &self.placed[0] };
            self.interpolator.prepare(pose).map_err(|_| PoseError::Damaged(frame))?;
        }
        Ok(more)
    }

    /// Begins `walk`, which starts at `frame`, the actor standing at `placement`. That frame is the first to come.
    pub fn begin_walk(&mut self, frame: u32, placement: Placement, walk: &Walk) {
        self.state = State::Due { frame, placement };
        self.set_legs(walk);
    }

    /// Replaces what is left of the walk: `walk` starts at [`Self::departure`]. A transition under way is finished first.
    pub fn retarget(&mut self, walk: &Walk) {
        if let State::Recorded { left, .. } = &mut self.state {
            *left = 0;
        }
        self.set_legs(walk);
    }

    /// The frame that a new walk has to start from: the one shown, or the end of the transition under way. `None` before
    /// the first walk.
    #[must_use]
    pub fn departure(&self, graph: &EssentialGraph) -> Option<u32> {
        match self.state {
            State::Idle => None,
            State::Due { frame, .. } | State::Recorded { frame, .. } => Some(frame),
            State::Synthetic { transition, .. } => Some(graph.transitions().get(transition as usize)?.to),
        }
    }

    /// Placement of the recorded frames around [`Self::departure`] once the actor is there; `None` before the first walk.
    ///
    /// # Errors
    /// A frame that cannot be read.
    pub fn departure_placement(
        &mut self,
        graph: &EssentialGraph,
        timeline: &Timeline,
        source: &mut dyn PoseSource,
    ) -> Result<Option<Placement>, PoseError> {
        match self.state {
            State::Idle => Ok(None),
            State::Due { placement, .. } | State::Recorded { placement, .. } => Ok(Some(placement)),
            State::Synthetic { transition: index, mut blend } => {
                let warp = &transition(graph, index)?.warp;
                let mut ground = PosesOnGround::new(source, &self.weights, &mut self.memory);
                while let Some(next) = blend.next(timeline, &mut ground, warp, graph.contacts())? {
                    blend = next;
                }
                Ok(Some(blend.placements[1]))
            }
        }
    }

    /// Writes the walk's next frame, in metres, into `out`, which has one element per vertex. `None` once the walk has
    /// arrived. After an error the same frame can be asked for again.
    ///
    /// # Errors
    /// A frame that cannot be read (yet), or a walk that does not belong to `graph`.
    pub fn next_frame(
        &mut self,
        graph: &EssentialGraph,
        timeline: &Timeline,
        source: &mut dyn PoseSource,
        out: &mut [Vec3],
    ) -> Result<Option<FrameInfo>, PoseError> {
        match self.state {
            State::Idle => Ok(None),
            State::Due { frame, placement } => self.show_recorded(source, frame, placement, 0, out),
            State::Recorded { frame, placement, left } if left > 0 => {
                self.step_recorded(timeline, source, frame, placement, left, out)
            }
            State::Recorded { frame, placement, .. } => self.begin_leg(graph, timeline, source, frame, placement, out),
            State::Synthetic { transition: index, blend } => {
                let to = transition(graph, index)?;
                let mut ground = PosesOnGround::new(source, &self.weights, &mut self.memory);
                let next = blend.next(timeline, &mut ground, &to.warp, graph.contacts())?;
                self.show_node(source, index, to, next.unwrap_or(blend), out)
            }
        }
    }

    fn set_legs(&mut self, walk: &Walk) {
        self.legs.clear();
        self.legs.extend(&walk.legs);
        self.legs_begun = 0;
    }

    /// The first new frame of the next leg; the frame it begins with has been shown.
    fn begin_leg(
        &mut self,
        graph: &EssentialGraph,
        timeline: &Timeline,
        source: &mut dyn PoseSource,
        frame: u32,
        placement: Placement,
        out: &mut [Vec3],
    ) -> Result<Option<FrameInfo>, PoseError> {
        while let Some(Leg::Recorded { steps: 0, .. }) = self.legs.front() {
            self.legs.pop_front();
            self.legs_begun += 1;
        }
        let Some(&leg) = self.legs.front() else { return Ok(None) };
        let info = match leg {
            Leg::Recorded { first, steps, .. } => {
                check_leg(first, frame)?;
                self.step_recorded(timeline, source, frame, placement, steps, out)
            }
            Leg::Synthetic(index) => {
                let to = transition(graph, index)?;
                check_leg(to.from, frame)?;
                let mut ground = PosesOnGround::new(source, &self.weights, &mut self.memory);
                let first = Blend::begin(timeline, &mut ground, (to.from, to.to), &to.warp, placement)?;
                let second = first.next(timeline, &mut ground, &to.warp, graph.contacts())?;
                self.interpolator.restart();
                self.show_node(source, index, to, second.unwrap_or(first), out)
            }
        }?;
        self.legs.pop_front();
        self.legs_begun += 1;
        Ok(info.map(|info| FrameInfo { leg: self.legs_begun.checked_sub(1), ..info }))
    }

    fn step_recorded(
        &mut self,
        timeline: &Timeline,
        source: &mut dyn PoseSource,
        frame: u32,
        placement: Placement,
        left: u32,
        out: &mut [Vec3],
    ) -> Result<Option<FrameInfo>, PoseError> {
        let mut ground = PosesOnGround::new(source, &self.weights, &mut self.memory);
        let (next, step) = recorded_step(timeline, &mut ground, frame)?.ok_or(PoseError::OutOfRange(frame))?;
        self.show_recorded(source, next, placement.after(&step), left - 1, out)
    }

    fn show_recorded(
        &mut self,
        source: &mut dyn PoseSource,
        frame: u32,
        placement: Placement,
        left: u32,
        out: &mut [Vec3],
    ) -> Result<Option<FrameInfo>, PoseError> {
        PosesOnGround::new(source, &self.weights, &mut self.memory).place(frame, placement, out)?;
        self.state = State::Recorded { frame, placement, left };
        Ok(Some(self.info(FrameKind::Recorded { frame }, placement, Effort::default())))
    }

    /// A node of a transition. The last one is the destination itself, from where its placement goes on.
    fn show_node(
        &mut self,
        source: &mut dyn PoseSource,
        index: u32,
        transition: &Transition,
        blend: Blend,
        out: &mut [Vec3],
    ) -> Result<Option<FrameInfo>, PoseError> {
        let [from, to] = blend.placements;
        if blend.node + 1 >= transition.warp.duration() {
            return self.show_recorded(source, transition.to, to, 0, out);
        }
        let mut ground = PosesOnGround::new(source, &self.weights, &mut self.memory);
        let [source_frame, destination_frame] = blend.frames;
        ground.place(source_frame, from, &mut self.placed[0])?;
        ground.place(destination_frame, to, &mut self.placed[1])?;
        let effort = self
            .interpolator
            .interpolate(
                KeyedPose { frame: source_frame, pose: &self.placed[0] },
                KeyedPose { frame: destination_frame, pose: &self.placed[1] },
                blend.lambda,
                out,
            )
            .map_err(|_| PoseError::Damaged(source_frame))?;
        self.state = State::Synthetic { transition: index, blend };
        let kind = FrameKind::Synthetic {
            transition: index,
            node: blend.node as u32,
            lambda: blend.lambda,
            source_frame,
            destination_frame,
        };
        Ok(Some(self.info(kind, if blend.lambda < 0.5 { from } else { to }, effort)))
    }

    fn info(&self, kind: FrameKind, placement: Placement, effort: Effort) -> FrameInfo {
        FrameInfo { kind, placement, leg: self.legs_begun.checked_sub(1), effort }
    }
}

/// A leg has to begin where the actor is.
fn check_leg(first: u32, frame: u32) -> Result<(), PoseError> {
    if first == frame { Ok(()) } else { Err(PoseError::OutOfRange(first)) }
}
