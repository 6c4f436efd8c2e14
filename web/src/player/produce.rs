//! Makes the frames that are shown, numbered and measured; what they look like is the synthesis' business.

use actor::graph::EssentialGraph;
use actor::pose_source::PoseError;
use actor::walk::{Leg, Walk, WalkError};
use glam::{Vec2, Vec3};
use kernels::align::{Placement, align_heading, centre_of_mass};
use kernels::sort::sort;
use kernels::topology::Topology;
use synthesis::{FrameInfo, FrameKind, Made, Step, Synthesiser, Walker};

use super::loading::{Actor, Loading, Origin};

/// Times kept of which the median is told.
const TIMES: usize = 60;

/// A frame as it is shown.
#[derive(Clone, Debug, PartialEq)]
pub struct ShownFrame {
    /// Equal numbers are equal poses.
    pub number: u64,
    /// World positions, metres, one per welded vertex.
    pub pose: Vec<Vec3>,
    /// Where it comes from.
    pub kind: FrameKind,
    /// The world from the recorded pose (of the nearer side in a transition).
    pub placement: Placement,
    /// The centre of mass on the ground (X, Z), metres.
    pub ground: Vec2,
    /// Whose pose it is.
    pub origin: Origin,
}

/// Makes numbered frames.
pub struct Producer {
    /// Tells milliseconds.
    pub now: fn() -> f64,
    made: u64,
    /// Once there is an actor.
    synthesiser: Option<Synthesiser>,
    /// Milliseconds that the last synthetic frames took, in a ring.
    times: Vec<f64>,
}

impl Producer {
    /// `now` tells milliseconds, only to say how long synthesis takes.
    #[must_use]
    pub fn new(now: fn() -> f64) -> Self {
        Self { now, made: 0, synthesiser: None, times: Vec::new() }
    }

    fn synthesiser(&mut self, actor: &Actor) -> &mut Synthesiser {
        self.synthesiser.get_or_insert_with(|| Synthesiser::unprepared(&actor.topology))
    }

    /// The route under way; `None` before there is an actor.
    #[must_use]
    pub fn walker(&self) -> Option<&Walker> {
        self.synthesiser.as_ref().map(Synthesiser::walker)
    }

    /// Recorded frame `frame`, placed by `placement`; where the actor stands does not change.
    ///
    /// # Errors
    /// A frame that cannot be read.
    pub fn recorded(
        &mut self,
        loading: &mut Loading,
        actor: &Actor,
        frame: u32,
        placement: Placement,
    ) -> Result<ShownFrame, PoseError> {
        let mut pose = vec![Vec3::ZERO; actor.topology.vertex_count()];
        self.synthesiser(actor).place(&mut loading.source, frame, placement, &mut pose)?;
        let shown = self.number(&actor.topology, pose, FrameKind::Recorded { frame }, placement);
        Ok(ShownFrame { origin: loading.source.origin(frame), ..shown })
    }

    /// The actor stands in `frame` from now on, without a route.
    pub fn stand(&mut self, actor: &Actor, frame: u32, placement: Placement) {
        self.synthesiser(actor).stand(frame, placement);
    }

    /// Drops the route.
    pub fn halt(&mut self) {
        if let Some(synthesiser) = &mut self.synthesiser {
            synthesiser.halt();
        }
    }

    /// Leaves for the end of `walk`, which begins at [`Self::departure`]; a transition under way is finished first.
    ///
    /// # Errors
    /// Legs that are not in the graph, or have gaps.
    pub fn retarget(&mut self, actor: &Actor, graph: &EssentialGraph, walk: &Walk) -> Result<(), WalkError> {
        self.synthesiser(actor).retarget_bent(graph, &actor.timeline, &walk.legs, &walk.bend)
    }

    /// Goes on with `walk`, which begins where the route ends.
    ///
    /// # Errors
    /// As [`Self::retarget`].
    pub fn extend(&mut self, actor: &Actor, graph: &EssentialGraph, walk: &Walk) -> Result<(), WalkError> {
        self.synthesiser(actor).extend(graph, &actor.timeline, &walk.legs, &walk.bend)
    }

    /// The frame after the present one on the route; `None` at its end, and where the beginning of a transition takes more
    /// than the budget of `factorisations`: asking again goes on with it.
    ///
    /// # Errors
    /// A frame that cannot be read (yet); the same frame can be asked for again.
    pub fn next(
        &mut self,
        loading: &mut Loading,
        actor: &Actor,
        graph: &EssentialGraph,
        factorisations: &mut u32,
    ) -> Result<Option<ShownFrame>, PoseError> {
        let start = (self.now)();
        let synthesiser = self.synthesiser(actor);
        let step = synthesiser.walker().next(&actor.timeline);
        let is_node = matches!(step, Some(Step::Node { .. }));
        if is_node || synthesiser.walker().coming().is_some() {
            let warm = self.warm(loading, actor);
            // While recorded frames are shown, that can wait to be told.
            if is_node {
                warm?;
            }
        }
        let synthesiser = self.synthesiser(actor);
        let mut pose = vec![Vec3::ZERO; actor.topology.vertex_count()];
        let made =
            synthesiser.next_frame_within(factorisations, graph, &actor.timeline, &mut loading.source, &mut pose)?;
        let Made::Frame(FrameInfo { kind, placement, .. }) = made else { return Ok(None) };
        if kind.is_synthetic() {
            self.note((self.now)() - start);
        }
        let origin = if kind.is_synthetic() { Origin::Made } else { loading.source.origin(kind.frame()) };
        Ok(Some(ShownFrame { origin, ..self.number(&actor.topology, pose, kind, placement) }))
    }

    /// The frame from which what comes next can be chosen freely, and its placement once the actor is there.
    ///
    /// # Errors
    /// A frame that cannot be read.
    pub fn departure(
        &mut self,
        loading: &mut Loading,
        actor: &Actor,
        graph: &EssentialGraph,
    ) -> Result<(u32, Placement), PoseError> {
        let synthesiser = self.synthesiser(actor);
        let frame = synthesiser.departure(graph).unwrap_or(0);
        let placement = synthesiser.departure_placement(graph, &actor.timeline, &mut loading.source)?;
        Ok((frame, placement.unwrap_or(Placement::IDENTITY)))
    }

    /// Placement of the last frame of `legs`, begun at [`Self::departure`].
    ///
    /// # Errors
    /// A frame that cannot be read.
    pub fn arrival(
        &mut self,
        loading: &mut Loading,
        actor: &Actor,
        graph: &EssentialGraph,
        legs: &[Leg],
    ) -> Result<Placement, PoseError> {
        let arrival = self.synthesiser(actor).arrival(graph, &actor.timeline, &mut loading.source, legs)?;
        Ok(arrival.unwrap_or(Placement::IDENTITY))
    }

    /// Median milliseconds of the last synthetic frames; 0 before the first.
    #[must_use]
    pub fn synthesis_ms(&self) -> f64 {
        median(&self.times)
    }

    /// Forgets the poses that it has read: others stand in for them now.
    pub fn forget_poses(&mut self) {
        if let Some(synthesiser) = &mut self.synthesiser {
            synthesiser.forget_poses();
        }
    }

    /// Makes what transitions need where it is missing: the slow part of the first one.
    ///
    /// # Errors
    /// A mesh that cannot be factorised.
    pub fn warm(&mut self, loading: &Loading, actor: &Actor) -> Result<(), PoseError> {
        let warm = self.synthesiser(actor).warm(&actor.topology, loading.order());
        warm.map_err(|_| PoseError::Damaged(actor.first_frame))
    }

    /// Does a piece of the work that the first transition of `legs` would have to wait for. Not within a transition.
    pub fn prepare_for(&mut self, loading: &mut Loading, actor: &Actor, graph: &EssentialGraph, legs: &[Leg]) {
        // What fails here fails again, and is told, when the transition begins.
        if self.warm(loading, actor).is_ok() {
            let _ = self.synthesiser(actor).prepare_for(graph, &actor.timeline, &mut loading.source, legs);
        }
    }

    fn note(&mut self, milliseconds: f64) {
        if self.times.len() == TIMES {
            self.times.remove(0);
        }
        self.times.push(milliseconds);
    }

    /// The number of a frame that is made now.
    pub fn count(&mut self) -> u64 {
        self.made += 1;
        self.made
    }

    fn number(&mut self, topology: &Topology, pose: Vec<Vec3>, kind: FrameKind, placement: Placement) -> ShownFrame {
        let centre = centre_of_mass(&pose, topology.weights());
        let ground = Vec2::new(centre.x, centre.z);
        ShownFrame { number: self.count(), pose, kind, placement, ground, origin: Origin::Made }
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
pub fn placed_like(shown: &ShownFrame, recorded: &[Vec3], topology: &Topology, heading: Option<f32>) -> Placement {
    let heading = heading.unwrap_or_else(|| align_heading(&shown.pose, recorded, topology.weights()));
    let centre = centre_of_mass(recorded, topology.weights());
    Placement::turning(heading, Vec2::new(centre.x, centre.z), shown.ground)
}
