//! Synthesis of a walk through the essential graph, one frame at a time, with constant memory.
//!
//! ```text
//! legs -> Walker -> Step -> Synthesiser -> pose, FrameInfo
//! ```
//!
//! The [`Walker`] knows the route and no pose; the [`Synthesiser`] makes the frame of each step. Films are made by
//! [`Synthesiser::next_frame`], which does all the work of a frame at once; the page asks
//! [`Synthesiser::next_frame_within`] a budget and makes the beginning of a transition ahead of time. Both get the same
//! frames, bit for bit.
//!
//! This work is based on: Boukhayma, thesis (2017), section 3.4, algorithms 2 and 3; TVCG algorithms 1 and 2. The
//! centre of mass steps by the displacements between the frames that the warps actually visit; the papers' n + 1 would
//! count a repeated frame's displacement twice. Walks may change their mind; wraps of cyclic sequences are bridged
//! ([`recorded_step`](actor::ground::recorded_step)).

mod bend;
mod feet;
mod frames;
mod lean;
pub mod steps;
mod ties;
mod varied;
mod walker;

pub use varied::{Varied, VariedPoses, mixture};
pub use walker::{Step, Walker};

use glam::Vec3;

use actor::blend::arrival;
use actor::graph::EssentialGraph;
use actor::pose_source::{PoseError, PoseSource};
use actor::timeline::Timeline;
use actor::walk::{Leg, Walk, WalkError};
use bend::{Bending, until_departure};
use frames::{FrameMaker, Recording, Standing};
use kernels::align::Placement;
use kernels::cholesky::CholeskyError;
use kernels::poisson::Effort;
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

impl FrameKind {
    /// The recorded frame that it is, or is nearer to.
    #[must_use]
    pub fn frame(self) -> u32 {
        match self {
            Self::Recorded { frame } => frame,
            Self::Synthetic { lambda, source_frame, destination_frame, .. } => {
                if lambda < 0.5 {
                    source_frame
                } else {
                    destination_frame
                }
            }
        }
    }

    /// The transition that it belongs to.
    #[must_use]
    pub fn transition(self) -> Option<u32> {
        match self {
            Self::Recorded { .. } => None,
            Self::Synthetic { transition, .. } => Some(transition),
        }
    }

    /// Whether it was synthesised.
    #[must_use]
    pub fn is_synthetic(self) -> bool {
        self.transition().is_some()
    }
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

/// What came of asking for a frame with a budget.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Made {
    /// The next frame.
    Frame(FrameInfo),
    /// A transition is being begun, and the budget is spent: asking again goes on with it.
    Unfinished,
    /// The walk has arrived.
    Arrived,
}

/// Where a frame is that is put elsewhere; what is left where it is stays so to the last bit.
fn put_at(put: &Placement, placement: Placement) -> Placement {
    if *put == Placement::IDENTITY { placement } else { put.after(&placement) }
}

/// Makes the frames of walks.
pub struct Synthesiser {
    maker: FrameMaker,
    walker: Walker,
    /// Where the actor stands; `None` before the first walk.
    standing: Option<Standing>,
    /// Whether the frame that it stands in has yet to be made.
    is_due: bool,
    /// The next transition of the route, and where the frame that it leaves will stand, once that was asked for.
    coming: Option<(u32, Placement)>,
    /// Where frames are put from where `standing` has them.
    bending: Bending,
}

impl Synthesiser {
    /// A synthesiser over `topology`; `order` as in [`PoissonInterpolator::new`](kernels::poisson::PoissonInterpolator::new).
    ///
    /// # Errors
    /// As there.
    pub fn new(topology: &Topology, order: Option<&[u32]>) -> Result<Self, CholeskyError> {
        let mut synthesiser = Self::unprepared(topology);
        synthesiser.warm(topology, order)?;
        Ok(synthesiser)
    }

    /// One that makes recorded frames only until it [is warm](Self::warm): there at once.
    #[must_use]
    pub fn unprepared(topology: &Topology) -> Self {
        let maker = FrameMaker::new(topology);
        Self {
            maker,
            walker: Walker::default(),
            standing: None,
            is_due: false,
            coming: None,
            bending: Bending::default(),
        }
    }

    /// Makes what transitions need, where that is missing; the same `topology` as before. `order` as in [`Self::new`].
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn warm(&mut self, topology: &Topology, order: Option<&[u32]>) -> Result<(), CholeskyError> {
        self.maker.warm(topology, order)
    }

    /// Forgets the poses that it has read: its source has others from now on.
    pub fn forget_poses(&mut self) {
        self.maker.forget_poses();
        self.coming = None;
    }

    /// Begins `walk`, which starts at `frame`, the actor standing at `placement`. That frame is the first to come.
    ///
    /// # Errors
    /// A walk that is not in the graph, or has gaps.
    pub fn begin_walk(
        &mut self,
        graph: &EssentialGraph,
        timeline: &Timeline,
        (frame, placement): (u32, Placement),
        walk: &Walk,
    ) -> Result<(), WalkError> {
        let mut walker = Walker::standing(frame);
        walker.retarget(graph, timeline, &walk.legs)?;
        self.stand(frame, placement);
        (self.walker, self.is_due) = (walker, true);
        self.bending.replace(0, &walk.bend);
        self.bending.plan(graph, timeline, &self.walker);
        Ok(())
    }

    /// Stands in `frame`, which has been shown already; the route is dropped.
    pub fn stand(&mut self, frame: u32, placement: Placement) {
        self.walker = Walker::standing(frame);
        self.standing = Some(Standing::Recorded { frame, placement });
        (self.is_due, self.coming, self.bending) = (false, None, Bending::default());
    }

    /// Writes `frame`, placed, into `out`; where the actor stands does not change.
    ///
    /// # Errors
    /// A frame that cannot be read (yet).
    pub fn place(
        &mut self,
        source: &mut dyn PoseSource,
        frame: u32,
        placement: Placement,
        out: &mut [Vec3],
    ) -> Result<(), PoseError> {
        self.maker.recorded(source, frame, placement, out).map(|_| ())
    }

    /// Drops the route at once, within a transition, too: it stands in the recorded frame that is nearest.
    pub fn halt(&mut self) {
        if let Some(standing) = self.standing {
            let (frame, placement) = standing.recorded();
            let placement = put_at(&self.bending.after(0), placement);
            match standing {
                // The feet stay where they are.
                Standing::Recorded { .. } => {
                    self.bending.fold();
                    self.walker = Walker::standing(frame);
                    self.standing = Some(Standing::Recorded { frame, placement });
                    (self.is_due, self.coming) = (false, None);
                }
                Standing::Node { .. } => self.stand(frame, placement),
            }
        }
    }

    /// Replaces what is left of the route: `legs` start at [`Self::departure`]. A transition under way is finished first.
    ///
    /// # Errors
    /// Legs that are not in the graph, or have gaps. The route stays as it was.
    pub fn retarget(&mut self, graph: &EssentialGraph, timeline: &Timeline, legs: &[Leg]) -> Result<(), WalkError> {
        self.retarget_bent(graph, timeline, legs, &[])
    }

    /// The same with legs that are bent ([`Walk::bend`]).
    ///
    /// # Errors
    /// As [`Self::retarget`].
    pub fn retarget_bent(
        &mut self,
        graph: &EssentialGraph,
        timeline: &Timeline,
        legs: &[Leg],
        bend: &[[f32; 3]],
    ) -> Result<(), WalkError> {
        let left = until_departure(graph, &self.walker);
        self.walker.retarget(graph, timeline, legs)?;
        self.coming = None;
        self.bending.replace(left, bend);
        self.bending.plan(graph, timeline, &self.walker);
        self.settle();
        Ok(())
    }

    /// Where the walk has arrived, the frame stands where it was put.
    fn settle(&mut self) {
        if let Some(Standing::Recorded { placement, .. }) = &mut self.standing
            && self.walker.has_arrived()
        {
            *placement = put_at(&self.bending.fold(), *placement);
        }
    }

    /// Goes on with `legs`, which start where the route ends and are bent by `bend` ([`Walk::bend`]).
    ///
    /// # Errors
    /// As [`Self::retarget`].
    pub fn extend(
        &mut self,
        graph: &EssentialGraph,
        timeline: &Timeline,
        legs: &[Leg],
        bend: &[[f32; 3]],
    ) -> Result<(), WalkError> {
        let left = self.walker.remaining(graph) as usize;
        self.walker.extend(graph, timeline, legs)?;
        self.coming = None;
        if !self.bending.is_straight() || !bend.is_empty() {
            self.bending.replace(left, bend);
            self.bending.plan(graph, timeline, &self.walker);
        }
        Ok(())
    }

    /// The route, and how far it is done.
    #[must_use]
    pub fn walker(&self) -> &Walker {
        &self.walker
    }

    /// The frame that a new walk has to start from: the one shown, or the end of the transition under way. `None` before
    /// the first walk.
    #[must_use]
    pub fn departure(&self, graph: &EssentialGraph) -> Option<u32> {
        self.standing.map(|_| self.walker.departure(graph))
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
        let put = self.bending.after(until_departure(graph, &self.walker));
        Ok(self.unbent_departure(graph, timeline, source)?.map(|placement| put_at(&put, placement)))
    }

    /// The same where nothing is bent.
    fn unbent_departure(
        &mut self,
        graph: &EssentialGraph,
        timeline: &Timeline,
        source: &mut dyn PoseSource,
    ) -> Result<Option<Placement>, PoseError> {
        match self.standing {
            None => Ok(None),
            Some(Standing::Recorded { placement, .. }) => Ok(Some(placement)),
            Some(Standing::Node { transition: index, mut blend }) => {
                let warp = &actor::blend::transition(graph, index)?.warp;
                let mut ground = self.maker.ground(source);
                while let Some(next) = blend.next(timeline, &mut ground, warp, graph.contacts())? {
                    blend = next;
                }
                Ok(Some(blend.placements[1]))
            }
        }
    }

    /// Where the last frame of `legs`, which start at [`Self::departure`], will stand; `None` before the first walk.
    ///
    /// # Errors
    /// A frame that cannot be read, or legs that are not in the graph.
    pub fn arrival(
        &mut self,
        graph: &EssentialGraph,
        timeline: &Timeline,
        source: &mut dyn PoseSource,
        legs: &[Leg],
    ) -> Result<Option<Placement>, PoseError> {
        let Some(start) = self.departure_placement(graph, timeline, source)? else { return Ok(None) };
        arrival(graph, timeline, &mut self.maker.ground(source), start, legs).map(Some)
    }

    fn unbent_arrival(
        &mut self,
        graph: &EssentialGraph,
        timeline: &Timeline,
        source: &mut dyn PoseSource,
        legs: &[Leg],
    ) -> Result<Option<Placement>, PoseError> {
        let Some(start) = self.unbent_departure(graph, timeline, source)? else { return Ok(None) };
        arrival(graph, timeline, &mut self.maker.ground(source), start, legs).map(Some)
    }

    /// Does a piece of the work for the beginning of the next transition ahead of time, at most one factorisation; whether
    /// more of it is left. For idle moments while recorded frames are shown; within a transition it does nothing.
    ///
    /// # Errors
    /// A frame that cannot be read (yet).
    pub fn prepare(
        &mut self,
        graph: &EssentialGraph,
        timeline: &Timeline,
        source: &mut dyn PoseSource,
    ) -> Result<bool, PoseError> {
        if self.coming.is_none() {
            let Some((way, transition)) = self.walker.coming() else { return Ok(false) };
            let Some(placement) = self.unbent_arrival(graph, timeline, source, &way)? else { return Ok(false) };
            self.coming = Some((transition, placement));
        }
        let Some((transition, placement)) = self.coming else { return Ok(false) };
        Ok(self.maker.prepare(&mut Recording { graph, timeline, source }, transition, placement)?.more)
    }

    /// The same for legs that may be asked for soon, from where it stands.
    ///
    /// # Errors
    /// As [`Self::prepare`], and legs that are not in the graph.
    pub fn prepare_for(
        &mut self,
        graph: &EssentialGraph,
        timeline: &Timeline,
        source: &mut dyn PoseSource,
        legs: &[Leg],
    ) -> Result<bool, PoseError> {
        let first = legs.iter().enumerate().find_map(|(index, leg)| Some((&legs[..index], leg.transition()?)));
        let (Some((way, transition)), None) = (first, self.walker.inside()) else { return Ok(false) };
        let Some(placement) = self.unbent_arrival(graph, timeline, source, way)? else { return Ok(false) };
        Ok(self.maker.prepare(&mut Recording { graph, timeline, source }, transition, placement)?.more)
    }

    /// Writes the walk's next frame, in metres, into `out`, which has one element per vertex. `None` once the walk has
    /// arrived. After an error the same frame can be asked for again.
    ///
    /// # Errors
    /// A frame that cannot be read (yet).
    pub fn next_frame(
        &mut self,
        graph: &EssentialGraph,
        timeline: &Timeline,
        source: &mut dyn PoseSource,
        out: &mut [Vec3],
    ) -> Result<Option<FrameInfo>, PoseError> {
        let Some(standing) = self.standing else { return Ok(None) };
        if self.is_due {
            let (frame, placement) = standing.recorded();
            self.enter(source, frame);
            self.maker.recorded(source, frame, placement, out)?;
            self.is_due = false;
            self.bending.apply(graph.feet(), self.maker.weights(), out);
            return Ok(Some(self.info(standing, Effort::default())));
        }
        let Some(step) = self.walker.next(timeline) else { return Ok(None) };
        if let Step::Forward(frame) | Step::Back(frame) = step {
            self.enter(source, frame);
        }
        let (standing, effort) = self.maker.make(&mut Recording { graph, timeline, source }, standing, step, out)?;
        self.walker.take(graph, timeline);
        self.standing = Some(standing);
        self.bending.take();
        self.bending.apply(graph.feet(), self.maker.weights(), out);
        self.settle();
        if matches!(step, Step::Node { .. }) {
            self.coming = None;
        }
        Ok(Some(self.info(standing, effort)))
    }

    fn enter(&mut self, source: &mut dyn PoseSource, frame: u32) {
        if source.enters(frame) {
            self.forget_poses();
        }
    }

    /// The same with bounded work: the beginning of a transition takes its factorisations, beside which all else is quick, from
    /// the budget of `factorisations`. A recorded frame prepares a piece of the transition to come, of one at most.
    ///
    /// # Errors
    /// As [`Self::next_frame`].
    pub fn next_frame_within(
        &mut self,
        factorisations: &mut u32,
        graph: &EssentialGraph,
        timeline: &Timeline,
        source: &mut dyn PoseSource,
        out: &mut [Vec3],
    ) -> Result<Made, PoseError> {
        match self.walker.next(timeline).filter(|_| !self.is_due) {
            Some(Step::Node { transition, node: 1 }) => {
                let Some((_, placement)) = self.standing.map(|standing| standing.recorded()) else {
                    return Ok(Made::Arrived);
                };
                while !self.maker.is_prepared(transition, placement) {
                    if *factorisations == 0 {
                        return Ok(Made::Unfinished);
                    }
                    let mut over = Recording { graph, timeline, source };
                    let piece = self.maker.prepare(&mut over, transition, placement)?;
                    *factorisations -= u32::from(piece.factorised);
                    if !piece.more {
                        break;
                    }
                }
            }
            // Recorded frames are quick. What fails here fails again, and is told, when the transition begins.
            Some(Step::Forward(_) | Step::Back(_)) => {
                let _ = self.prepare(graph, timeline, source);
            }
            _ => {}
        }
        Ok(self.next_frame(graph, timeline, source, out)?.map_or(Made::Arrived, Made::Frame))
    }

    fn info(&self, standing: Standing, effort: Effort) -> FrameInfo {
        let (frame, placement) = standing.recorded();
        let placement = put_at(&self.bending.after(0), placement);
        let kind = match standing {
            Standing::Recorded { .. } => FrameKind::Recorded { frame },
            Standing::Node { transition, blend } => FrameKind::Synthetic {
                transition,
                node: blend.node as u32,
                lambda: blend.lambda,
                source_frame: blend.nearest(0),
                destination_frame: blend.nearest(1),
            },
        };
        FrameInfo { kind, placement, leg: self.walker.leg(), effort }
    }
}
