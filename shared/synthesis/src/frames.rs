//! Makes the frame of a step: recorded ones placed, nodes of transitions blended and interpolated.
//!
//! The first node of a transition takes most work, as nothing is factorised for its poses: it can be made ahead of time, a
//! piece at a time. A frame never depends on whether and when that was done: what was made ahead is the node itself, and
//! where it turns out not to be needed, it leaves nothing behind.

use glam::Vec3;

use actor::blend::{Blend, transition};
use actor::graph::{EssentialGraph, Transition};
use actor::ground::{PoseMemory, PosesOnGround, recorded_step};
use actor::pose_source::{PoseError, PoseSource};
use actor::timeline::Timeline;
use kernels::align::Placement;
use kernels::cholesky::CholeskyError;
use kernels::poisson::{Effort, KeyedPose, Memory, PoissonInterpolator};
use kernels::topology::Topology;

use crate::feet::{self, Sides};
use crate::steps::{FootStep, foot_steps};
use crate::ties::Components;
use crate::walker::Step;

/// What frames are made from.
pub(crate) struct Recording<'a> {
    pub graph: &'a EssentialGraph,
    pub timeline: &'a Timeline,
    pub source: &'a mut dyn PoseSource,
}

/// Where the actor stands after a frame: what the next one goes on from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Standing {
    /// In a recorded frame.
    Recorded { frame: u32, placement: Placement },
    /// In a node of a transition that is not its last.
    Node { transition: u32, blend: Blend },
}

impl Standing {
    /// The recorded frame that it is, or is nearer to, and its placement.
    pub fn recorded(&self) -> (u32, Placement) {
        match *self {
            Self::Recorded { frame, placement } => (frame, placement),
            Self::Node { blend, .. } => {
                let side = usize::from(blend.lambda >= 0.5);
                (blend.frames[side], blend.placements[side])
            }
        }
    }
}

/// Makes frames.
pub(crate) struct FrameMaker {
    weights: Vec<f32>,
    components: Components,
    /// Made last: until then frames are recorded ones.
    interpolator: Option<PoissonInterpolator>,
    memory: PoseMemory,
    /// Source and destination of a transition, placed.
    placed: [Vec<Vec3>; 2],
    ahead: Option<Ahead>,
    plan: Option<Plan>,
}

/// What is known of a transition's feet as long as it is under way.
struct Plan {
    transition: u32,
    steps: Vec<Option<FootStep>>,
    /// From the destination's first frame as it was recorded to where its last one stands once the first does.
    alone: Placement,
}

/// A piece of the work for the first node of a transition.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Piece {
    /// Whether more of it is left.
    pub more: bool,
    /// Whether it took a factorisation: all else is quick.
    pub factorised: bool,
}

/// The first node of a transition, made ahead of time.
struct Ahead {
    transition: u32,
    /// Where the frame stands that the transition leaves.
    placement: Placement,
    blend: Blend,
    pose: Vec<Vec3>,
    /// Once the pose is made: what it took.
    effort: Option<Effort>,
    /// What the interpolator remembered before.
    before: Memory,
}

impl FrameMaker {
    pub fn new(topology: &Topology) -> Self {
        Self {
            weights: topology.weights().to_vec(),
            components: Components::of(topology),
            interpolator: None,
            memory: PoseMemory::default(),
            placed: Default::default(),
            ahead: None,
            plan: None,
        }
    }

    /// Makes the interpolator where there is none yet.
    pub fn warm(&mut self, topology: &Topology, order: Option<&[u32]>) -> Result<(), CholeskyError> {
        if self.interpolator.is_none() {
            self.interpolator = Some(PoissonInterpolator::new(topology, order)?);
            self.placed.iter_mut().for_each(|pose| pose.resize(topology.vertex_count(), Vec3::ZERO));
        }
        Ok(())
    }

    /// Forgets all that depends on poses read before.
    pub fn forget_poses(&mut self) {
        (self.memory, self.ahead, self.plan) = (PoseMemory::default(), None, None);
        if let Some(interpolator) = &mut self.interpolator {
            interpolator.forget_poses();
        }
    }

    pub fn ground<'a>(&'a mut self, source: &'a mut dyn PoseSource) -> PosesOnGround<'a> {
        PosesOnGround::new(source, &self.weights, &mut self.memory)
    }

    /// Writes a recorded frame into `out`.
    pub fn recorded(
        &mut self,
        source: &mut dyn PoseSource,
        frame: u32,
        placement: Placement,
        out: &mut [Vec3],
    ) -> Result<Standing, PoseError> {
        self.ground(source).place(frame, placement, out)?;
        Ok(Standing::Recorded { frame, placement })
    }

    /// Writes the frame of `step`, taken from where the actor stands, into `out`. After an error it can be asked for again.
    pub fn make(
        &mut self,
        over: &mut Recording,
        from: Standing,
        step: Step,
        out: &mut [Vec3],
    ) -> Result<(Standing, Effort), PoseError> {
        let (frame, placement) = from.recorded();
        let standing = match (step, from) {
            (Step::Forward(_), _) => {
                let next = recorded_step(over.timeline, &mut self.ground(over.source), frame)?;
                let (next, step) = next.ok_or(PoseError::OutOfRange(frame))?;
                self.recorded(over.source, next, placement.after(&step), out)?
            }
            (Step::Back(frame), _) => self.recorded(over.source, frame, placement, out)?,
            (Step::Node { transition: index, .. }, Standing::Node { transition: inside, blend }) if inside == index => {
                let to = transition(over.graph, index)?;
                let mut ground = self.ground(over.source);
                let next = blend.next(over.timeline, &mut ground, &to.warp, over.graph.contacts())?;
                return self.node(over, index, to, next.unwrap_or(blend), out);
            }
            (Step::Node { transition: index, .. }, _) => return self.first_node(over, index, placement, out),
        };
        Ok((standing, Effort::default()))
    }

    /// Does a piece of the work for the first node of a transition that leaves a frame standing at `placement`. No
    /// transition must be under way.
    pub fn prepare(&mut self, over: &mut Recording, index: u32, placement: Placement) -> Result<Piece, PoseError> {
        let nothing = Ok(Piece::default());
        if !self.ahead.as_ref().is_some_and(|ahead| ahead.is_of(index, placement)) {
            self.forget();
            if !self.begin(over, index, placement)? {
                return nothing;
            }
        }
        let (Some(ahead), Some(interpolator)) = (&mut self.ahead, &mut self.interpolator) else { return nothing };
        if ahead.effort.is_some() {
            return nothing;
        }
        let blend = ahead.blend;
        let before = interpolator.effort().factorisations;
        match interpolator.advance() {
            Ok(is_done) => {
                let factorised = interpolator.effort().factorisations > before;
                if is_done {
                    ahead.effort = Some(interpolator.finish(&mut ahead.pose));
                    self.components.hold(over.graph.ties(), &self.placed, blend.lambda, &mut ahead.pose);
                    let plan = self.plan.as_ref();
                    keep_feet(over.graph, plan, (index, &blend), (&self.placed, &self.weights), &mut ahead.pose)?;
                }
                Ok(Piece { more: !is_done, factorised })
            }
            Err(_) => {
                let frame = ahead.blend.frames[0];
                self.forget();
                Err(PoseError::Damaged(frame))
            }
        }
    }

    /// Weights of the vertices in the centre of mass, with a sum of 1.
    pub fn weights(&self) -> &[f32] {
        &self.weights
    }

    /// Whether the first node of this transition is made.
    pub fn is_prepared(&self, index: u32, placement: Placement) -> bool {
        self.ahead.as_ref().is_some_and(|ahead| ahead.is_of(index, placement) && ahead.effort.is_some())
    }

    /// Begins the first node of a transition ahead of time. False where there is nothing to be interpolated.
    fn begin(&mut self, over: &mut Recording, index: u32, placement: Placement) -> Result<bool, PoseError> {
        let blend = self.first_blend(over, index, placement)?;
        let to = transition(over.graph, index)?;
        if is_last(&blend, to) {
            return Ok(false);
        }
        let Some(interpolator) = &self.interpolator else { return Err(PoseError::NotLoaded(to.from)) };
        let before = interpolator.memory();
        self.place(over.source, &blend)?;
        self.plan = None;
        self.plan(over, index)?;
        let Some(interpolator) = &mut self.interpolator else { return Err(PoseError::NotLoaded(to.from)) };
        interpolator.restart();
        interpolator.begin(keyed(&self.placed, &blend), blend.lambda);
        let pose = vec![Vec3::ZERO; self.weights.len()];
        self.ahead = Some(Ahead { transition: index, placement, blend, pose, effort: None, before });
        Ok(true)
    }

    /// Drops what was made ahead, as if it had never been.
    fn forget(&mut self) {
        if let (Some(ahead), Some(interpolator)) = (self.ahead.take(), &mut self.interpolator) {
            interpolator.recall(ahead.before);
        }
    }

    /// Node 1 of a transition.
    fn first_blend(&mut self, over: &mut Recording, index: u32, placement: Placement) -> Result<Blend, PoseError> {
        let to = transition(over.graph, index)?;
        let mut ground = self.ground(over.source);
        let first = Blend::of(over.timeline, &mut ground, to, placement, over.graph.contacts())?;
        let second = first.next(over.timeline, &mut ground, &to.warp, over.graph.contacts())?;
        Ok(second.unwrap_or(first))
    }

    fn first_node(
        &mut self,
        over: &mut Recording,
        index: u32,
        placement: Placement,
        out: &mut [Vec3],
    ) -> Result<(Standing, Effort), PoseError> {
        while self.prepare(over, index, placement)?.more {}
        if let Some(Ahead { blend, pose, effort: Some(effort), .. }) = self.ahead.take() {
            out.copy_from_slice(&pose);
            return Ok((Standing::Node { transition: index, blend }, effort));
        }
        let blend = self.first_blend(over, index, placement)?;
        self.node(over, index, transition(over.graph, index)?, blend, out)
    }

    /// A node of a transition. The last one is the destination itself, from where its placement goes on.
    fn node(
        &mut self,
        over: &mut Recording,
        index: u32,
        to: &Transition,
        blend: Blend,
        out: &mut [Vec3],
    ) -> Result<(Standing, Effort), PoseError> {
        if is_last(&blend, to) {
            return Ok((self.recorded(over.source, to.to, blend.placements[1], out)?, Effort::default()));
        }
        self.place(over.source, &blend)?;
        self.plan(over, index)?;
        let Some(interpolator) = &mut self.interpolator else { return Err(PoseError::NotLoaded(to.from)) };
        let [source, destination] = keyed(&self.placed, &blend);
        let effort = interpolator.interpolate(source, destination, blend.lambda, out);
        let effort = effort.map_err(|_| PoseError::Damaged(source.frame))?;
        self.components.hold(over.graph.ties(), &self.placed, blend.lambda, out);
        keep_feet(over.graph, self.plan.as_ref(), (index, &blend), (&self.placed, &self.weights), out)?;
        Ok((Standing::Node { transition: index, blend }, effort))
    }

    /// Plans the steps of a transition's feet, unless that was done.
    fn plan(&mut self, over: &mut Recording, index: u32) -> Result<(), PoseError> {
        if self.plan.as_ref().is_some_and(|plan| plan.transition == index) || over.graph.feet().count() == 0 {
            return Ok(());
        }
        let to = transition(over.graph, index)?;
        let steps = foot_steps(over.graph.feet(), over.timeline, to);
        let mut ground = PosesOnGround::new(over.source, &self.weights, &mut self.memory);
        let (mut alone, length) = (Placement::IDENTITY, to.warp.lengths().1 as i64);
        let mut frame = over.timeline.offset(to.to, 1 - length).ok_or(PoseError::OutOfRange(to.to))?;
        for _ in 1..length {
            let step = recorded_step(over.timeline, &mut ground, frame)?;
            let (next, step) = step.ok_or(PoseError::OutOfRange(frame))?;
            (frame, alone) = (next, alone.after(&step));
        }
        self.plan = Some(Plan { transition: index, steps, alone });
        Ok(())
    }

    /// Both sides of a node, placed.
    fn place(&mut self, source: &mut dyn PoseSource, blend: &Blend) -> Result<(), PoseError> {
        let mut ground = PosesOnGround::new(source, &self.weights, &mut self.memory);
        for (side, placed) in self.placed.iter_mut().enumerate() {
            let (frame, next) = (blend.frames[side], &blend.next[side]);
            placed.resize(self.weights.len(), Vec3::ZERO);
            ground.place(frame, Placement::IDENTITY, placed)?;
            if next.share > 0.0 {
                if let Some(interpolator) = &mut self.interpolator {
                    interpolator.weigh(KeyedPose { frame, pose: placed });
                }
                ground.approach(next, placed)?;
            }
            blend.placements[side].apply_all(placed);
        }
        Ok(())
    }
}

impl Ahead {
    /// Whether it belongs to this transition, begun here: by the bits, so that what is no number is itself.
    fn is_of(&self, transition: u32, placement: Placement) -> bool {
        let bits = |placement: Placement| {
            let [x, z] = placement.translation.to_array();
            [placement.heading, x, z].map(f32::to_bits)
        };
        self.transition == transition && bits(self.placement) == bits(placement)
    }
}

/// Puts the feet of a node where they stand. Where the transition arrives was stored with it: its feet are there already.
fn keep_feet(
    graph: &EssentialGraph,
    plan: Option<&Plan>,
    (index, blend): (u32, &Blend),
    (placed, weights): (&[Vec<Vec3>; 2], &[f32]),
    pose: &mut [Vec3],
) -> Result<(), PoseError> {
    let Some(plan) = plan.filter(|plan| plan.transition == index && graph.feet().count() > 0) else { return Ok(()) };
    let end = blend.start.after(&transition(graph, index)?.placement);
    let sides = Sides { placed, alone: feet::alone(blend, &end.after(&plan.alone.inverse())) };
    feet::keep(graph.feet(), &plan.steps, blend.node, &sides, weights, pose);
    Ok(())
}

fn is_last(blend: &Blend, transition: &Transition) -> bool {
    blend.node + 1 >= transition.warp.duration()
}

fn keyed<'a>(placed: &'a [Vec<Vec3>; 2], blend: &Blend) -> [KeyedPose<'a>; 2] {
    [0, 1].map(|side| KeyedPose { frame: blend.frames[side], pose: &placed[side] })
}
