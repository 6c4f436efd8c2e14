//! Makes frames: recorded ones placed in the world, and synthesised ones between them.

use actor::blend::arrival;
use actor::graph::EssentialGraph;
use actor::ground::{PoseMemory, PosesOnGround, recorded_step};
use actor::pose_source::{PoseError, PoseSource};
use actor::timeline::Timeline;
use actor::walk::{Leg, Walk};
use glam::{Vec2, Vec3};
use kernels::align::{Placement, align_heading, centre_of_mass};
use kernels::sort::sort;
use kernels::topology::Topology;
use synthesis::{FrameInfo, FrameKind, Synthesiser};

use super::loading::{Actor, Loading};

/// Times kept of which the median is told.
const TIMES: usize = 60;

/// Where a frame comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum At {
    /// It was recorded.
    Recorded(u32),
    /// It was synthesised.
    Synthetic {
        /// Index of the transition in the graph.
        edge: u32,
        /// Weight of the destination, 0 to 1.
        lambda: f32,
        /// The recorded frame of the source side.
        source: u32,
        /// The recorded frame of the destination side.
        destination: u32,
    },
}

impl At {
    /// The recorded frame that it is, or is nearer to.
    #[must_use]
    pub fn frame(self) -> u32 {
        match self {
            Self::Recorded(frame) => frame,
            Self::Synthetic { lambda, source, destination, .. } => {
                if lambda < 0.5 {
                    source
                } else {
                    destination
                }
            }
        }
    }

    /// The transition that it belongs to.
    #[must_use]
    pub fn edge(self) -> Option<u32> {
        match self {
            Self::Recorded(_) => None,
            Self::Synthetic { edge, .. } => Some(edge),
        }
    }

    /// Whether it was synthesised.
    #[must_use]
    pub fn is_synthetic(self) -> bool {
        self.edge().is_some()
    }
}

/// A frame as it is shown.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Equal numbers are equal poses.
    pub number: u64,
    /// World positions, metres, one per welded vertex.
    pub pose: Vec<Vec3>,
    /// Where it comes from.
    pub at: At,
    /// The world from the recorded pose (of the nearer side in a transition).
    pub placement: Placement,
    /// The centre of mass on the ground (X, Z), metres.
    pub ground: Vec2,
}

/// Makes numbered frames.
pub struct Producer {
    /// Tells milliseconds.
    pub now: fn() -> f64,
    made: u64,
    memory: PoseMemory,
    synthesiser: Option<Synthesiser>,
    /// The transition that is being prepared, and whether all is done.
    prepared: Option<(u32, bool)>,
    /// Milliseconds that the last synthetic frames took, in a ring.
    times: Vec<f64>,
}

impl Producer {
    /// `now` tells milliseconds, only to say how long synthesis takes.
    #[must_use]
    pub fn new(now: fn() -> f64) -> Self {
        Self { now, made: 0, memory: PoseMemory::default(), synthesiser: None, prepared: None, times: Vec::new() }
    }

    /// Recorded frame `frame`, placed by `placement`.
    ///
    /// # Errors
    /// A frame that cannot be read.
    pub fn recorded(
        &mut self,
        source: &mut impl PoseSource,
        topology: &Topology,
        frame: u32,
        placement: Placement,
    ) -> Result<Frame, PoseError> {
        let mut pose = vec![Vec3::ZERO; topology.vertex_count()];
        source.read(frame, &mut pose)?;
        placement.apply_all(&mut pose);
        Ok(self.number(topology, pose, At::Recorded(frame), placement))
    }

    /// The frame recorded after `frame`, which is placed by `placement`; at the wrap of a cyclic sequence it is placed
    /// so that the motion goes on.
    ///
    /// # Errors
    /// A frame that cannot be read, or the end of a sequence.
    pub fn next_recorded(
        &mut self,
        loading: &mut Loading,
        actor: &Actor,
        frame: u32,
        placement: Placement,
    ) -> Result<Frame, PoseError> {
        let mut ground = PosesOnGround::new(&mut loading.source, actor.topology.weights(), &mut self.memory);
        let step = recorded_step(&actor.timeline, &mut ground, frame)?;
        let (next, step) = step.ok_or(PoseError::OutOfRange(frame))?;
        self.recorded(&mut loading.source, &actor.topology, next, placement.after(&step))
    }

    /// The next frame of transition `edge`. With `begin`, given the placement of the frame that it leaves, the first.
    ///
    /// # Errors
    /// A frame that cannot be read (yet); the same frame can be asked for again.
    pub fn synthetic(
        &mut self,
        loading: &mut Loading,
        actor: &Actor,
        graph: &EssentialGraph,
        edge: u32,
        begin: Option<Placement>,
    ) -> Result<Frame, PoseError> {
        let transition = graph.transitions().get(edge as usize).ok_or(PoseError::OutOfRange(edge))?;
        self.warm(loading, actor)?;
        let start = (self.now)();
        let synthesiser = self.synthesiser.as_mut().ok_or(PoseError::Damaged(transition.from))?;
        let mut pose = vec![Vec3::ZERO; actor.topology.vertex_count()];
        let mut next = |synthesiser: &mut Synthesiser| {
            let info = synthesiser.next_frame(graph, &actor.timeline, &mut loading.source, &mut pose)?;
            info.ok_or(PoseError::OutOfRange(transition.to))
        };
        if let Some(placement) = begin {
            synthesiser.begin_walk(transition.from, placement, &transition_alone(edge));
            self.prepared = None;
            // The frame that the walk begins with is on the stage already.
            next(synthesiser)?;
        }
        let info = next(synthesiser)?;
        self.note((self.now)() - start);
        Ok(self.number(&actor.topology, pose, at(&info), info.placement))
    }

    /// Placement of the frame that the transition under way arrives at.
    ///
    /// # Errors
    /// A frame that cannot be read.
    pub fn transition_end(
        &mut self,
        loading: &mut Loading,
        timeline: &Timeline,
        graph: &EssentialGraph,
    ) -> Result<Option<Placement>, PoseError> {
        match &mut self.synthesiser {
            Some(synthesiser) => synthesiser.departure_placement(graph, timeline, &mut loading.source),
            None => Ok(None),
        }
    }

    /// Placement of the last frame of `walk`, begun at `start`.
    ///
    /// # Errors
    /// A frame at a wrap that cannot be read.
    pub fn arrival(
        &mut self,
        loading: &mut Loading,
        actor: &Actor,
        graph: &EssentialGraph,
        start: Placement,
        walk: &Walk,
    ) -> Result<Placement, PoseError> {
        let mut ground = PosesOnGround::new(&mut loading.source, actor.topology.weights(), &mut self.memory);
        arrival(graph, &actor.timeline, &mut ground, start, walk)
    }

    /// Median milliseconds of the last synthetic frames; 0 before the first.
    #[must_use]
    pub fn synthesis_ms(&self) -> f64 {
        median(&self.times)
    }

    /// Makes the synthesiser where there is none yet: the slow part of the first transition.
    ///
    /// # Errors
    /// A mesh that cannot be factorised.
    pub fn warm(&mut self, loading: &Loading, actor: &Actor) -> Result<(), PoseError> {
        if self.synthesiser.is_none() {
            let made = Synthesiser::new(&actor.topology, loading.order());
            self.synthesiser = Some(made.map_err(|_| PoseError::Damaged(actor.first_frame))?);
        }
        Ok(())
    }

    /// Does a piece of the work that the beginning of transition `edge` would have to wait for; whether more of it is
    /// left. Not within a transition.
    pub fn prepare(&mut self, loading: &mut Loading, actor: &Actor, graph: &EssentialGraph, edge: u32) -> bool {
        if self.prepared == Some((edge, true)) || self.warm(loading, actor).is_err() {
            return false;
        }
        let Some(synthesiser) = &mut self.synthesiser else { return false };
        if self.prepared.is_none_or(|(before, _)| before != edge) {
            let from = graph.transitions().get(edge as usize).map_or(0, |transition| transition.from);
            synthesiser.begin_walk(from, Placement::IDENTITY, &transition_alone(edge));
        }
        // What fails here fails again, and is told, when the transition begins.
        let more = synthesiser.prepare(graph, &actor.timeline, &mut loading.source).unwrap_or(false);
        self.prepared = Some((edge, !more));
        more
    }

    fn note(&mut self, milliseconds: f64) {
        if self.times.len() == TIMES {
            self.times.remove(0);
        }
        self.times.push(milliseconds);
    }

    fn number(&mut self, topology: &Topology, pose: Vec<Vec3>, at: At, placement: Placement) -> Frame {
        let centre = centre_of_mass(&pose, topology.weights());
        self.made += 1;
        Frame { number: self.made, pose, at, placement, ground: Vec2::new(centre.x, centre.z) }
    }
}

fn transition_alone(edge: u32) -> Walk {
    Walk { legs: vec![Leg::Synthetic(edge)], ..Walk::default() }
}

fn at(info: &FrameInfo) -> At {
    match info.kind {
        FrameKind::Recorded { frame } => At::Recorded(frame),
        FrameKind::Synthetic { transition, lambda, source_frame, destination_frame, .. } => {
            At::Synthetic { edge: transition, lambda, source: source_frame, destination: destination_frame }
        }
    }
}

/// The middle of `times`; 0 where there is none.
#[must_use]
pub fn median(times: &[f64]) -> f64 {
    // Times are not negative: their bits order them.
    let mut bits: Vec<_> = times.iter().map(|time| u128::from(time.max(0.0).to_bits())).collect();
    sort(&mut bits);
    bits.get(bits.len() / 2).map_or(0.0, |&bits| f64::from_bits(bits as u64))
}

/// The placement that puts `recorded` where `shown` stands, and turns it like that unless `heading` says how.
#[must_use]
pub fn placed_like(shown: &Frame, recorded: &[Vec3], topology: &Topology, heading: Option<f32>) -> Placement {
    let heading = heading.unwrap_or_else(|| align_heading(&shown.pose, recorded, topology.weights()));
    let centre = centre_of_mass(recorded, topology.weights());
    Placement::turning(heading, Vec2::new(centre.x, centre.z), shown.ground)
}
