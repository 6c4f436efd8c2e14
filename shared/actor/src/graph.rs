//! The essential graph: frames as nodes, recorded steps and the transitions worth keeping as edges.
//!
//! Boukhayma and Boyer, TVCG section 4.1, equations 9 and 10; Boukhayma, thesis (2017), section 3.3, equations 3.1 to
//! 3.4.

use thiserror::Error;

use crate::contacts::Contacts;
use crate::feet::Feet;
use crate::temporal_warp::TemporalWarp;
use crate::ties::Ties;
use crate::timeline::Timeline;
use kernels::align::Placement;

/// Resolution of alpha: it is rounded to a multiple of this, so that sums of costs are exact in `f64` and comparisons
/// of paths do not depend on the order of summation.
pub const ALPHA_RESOLUTION: f64 = 1.0 / 16_777_216.0;

/// The default weight of a frame's duration against surface deformation, per frame (thesis section 3.3.2).
pub const DEFAULT_ALPHA: f64 = 0.01;

/// `alpha` as the graph uses it: rounded to a multiple of [`ALPHA_RESOLUTION`].
#[must_use]
pub fn rounded_alpha(alpha: f64) -> f64 {
    (alpha / ALPHA_RESOLUTION).round() * ALPHA_RESOLUTION
}

/// An edge that was not recorded: a synthesised transition between two frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Transition {
    /// Frame i that it leaves from.
    pub from: u32,
    /// Frame j that it arrives at.
    pub to: u32,
    /// Surface deformation cost D(i, j): the sum of pose distances along the warp, in radians.
    pub deformation: f32,
    /// How the segments [i, i + li - 1] and [j - lj + 1, j] are matched; its duration is L(i, j).
    pub warp: TemporalWarp,
    /// Placement of the destination's recorded frames once the source's stand as they were recorded (`Blend` of thesis
    /// algorithm 2, TVCG algorithm 1, followed to its end): `source_from_destination`.
    pub placement: Placement,
    /// How far both sides are turned about +Y meanwhile, in radians, beyond what their own headings and the blend make of it,
    /// so that the foot that bears does not turn on the ground; part of `placement`. A multiple of [`TURN_STEP`].
    pub turn: f32,
}

/// [`Transition::turn`] is a multiple of this many radians.
pub const TURN_STEP: f32 = 1.0 / 1024.0;

impl Transition {
    /// E(i, j) = D + alpha L (TVCG equation 10; thesis equation 3.3).
    #[must_use]
    pub fn cost(&self, alpha: f64) -> f64 {
        f64::from(self.deformation) + alpha * self.warp.duration() as f64
    }
}

/// Why transitions are not a graph over a timeline.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum GraphError {
    /// Alpha is negative, not finite or absurdly large.
    #[error("alpha must be between 0 and 1000")]
    Alpha(f64),
    /// A transition names a frame that does not exist.
    #[error("transition {0} names a frame that does not exist")]
    Frame(usize),
    /// A transition's segment leaves its sequence.
    #[error("a segment of transition {0} leaves its sequence")]
    Segment(usize),
    /// A transition's cost is negative or not finite.
    #[error("the cost of transition {0} is negative or not a number")]
    Cost(usize),
    /// Transitions are not strictly ordered by (from, to).
    #[error("transition {0} is out of order")]
    Order(usize),
}

/// Frames joined by recorded steps (cost alpha each) and by transitions (cost D + alpha L each).
#[derive(Clone, Debug, PartialEq)]
pub struct EssentialGraph {
    alpha: f64,
    transitions: Vec<Transition>,
    first_transition: Vec<u32>,
    contacts: Contacts,
    feet: Feet,
    ties: Ties,
}

impl EssentialGraph {
    /// A graph over `timeline`; `transitions` are strictly ordered by (from, to).
    ///
    /// # Errors
    /// Anything that a walk through the graph could stumble over; see [`GraphError`].
    pub fn new(alpha: f64, transitions: Vec<Transition>, timeline: &Timeline) -> Result<Self, GraphError> {
        let mut builder = EssentialGraphBuilder::new(alpha, timeline)?;
        for (index, transition) in transitions.iter().enumerate() {
            builder.admit(index, transition, timeline)?;
        }
        builder.transitions = transitions;
        Ok(builder.finish())
    }

    /// From now on `alpha` is the weight of a frame's duration; rounded. Transitions, and so walks through them, stay what they
    /// are: other walks are the cheapest.
    ///
    /// # Errors
    /// Not between 0 and 1000.
    pub fn set_alpha(&mut self, alpha: f64) -> Result<(), GraphError> {
        if !(0.0..=1000.0).contains(&alpha) {
            return Err(GraphError::Alpha(alpha));
        }
        self.alpha = rounded_alpha(alpha);
        Ok(())
    }

    /// The same graph, whose transitions keep still what stands on the ground on both sides. Their placements have to be
    /// found with the same contacts.
    #[must_use]
    pub fn with_contacts(self, contacts: Contacts) -> Self {
        Self { contacts, ..self }
    }

    /// The same graph, whose transitions turn besides, each by so many radians; those beyond the last number do not.
    /// Their placements have to be found with the same turns.
    #[must_use]
    pub fn with_turns(mut self, turns: &[f32]) -> Self {
        let turns = turns.iter().copied().chain(std::iter::repeat(0.0));
        self.transitions.iter_mut().zip(turns).for_each(|(transition, turn)| transition.turn = turn);
        self
    }

    /// The same graph, in whose transitions feet that stand stay where they are. Where its transitions lead does not change.
    #[must_use]
    pub fn with_feet(self, feet: Feet) -> Self {
        Self { feet, ..self }
    }

    /// The same graph, in whose transitions components stay on each other. Where its transitions lead does not change.
    #[must_use]
    pub fn with_ties(self, ties: Ties) -> Self {
        Self { ties, ..self }
    }

    /// Which components stay on which; none where that is not known.
    #[must_use]
    pub fn ties(&self) -> &Ties {
        &self.ties
    }

    /// The feet that stay where they stand; none where they are not known.
    #[must_use]
    pub fn feet(&self) -> &Feet {
        &self.feet
    }

    /// What stands on the ground in its frames; empty where that is not known or not to be kept still.
    #[must_use]
    pub fn contacts(&self) -> &Contacts {
        &self.contacts
    }

    /// Cost of a recorded step: the weight of a frame's duration.
    #[must_use]
    pub fn alpha(&self) -> f64 {
        self.alpha
    }

    /// All transitions, ordered by (from, to).
    #[must_use]
    pub fn transitions(&self) -> &[Transition] {
        &self.transitions
    }

    /// Indices of the transitions that leave from `frame`; none for a frame that does not exist.
    #[must_use]
    pub fn transitions_from(&self, frame: u32) -> std::ops::Range<usize> {
        match self.first_transition.get(frame as usize..).and_then(|rest| rest.get(..2)) {
            Some(&[start, end]) => start as usize..end as usize,
            _ => 0..0,
        }
    }

    /// Number of frames.
    #[must_use]
    pub fn frame_count(&self) -> u32 {
        (self.first_transition.len() - 1) as u32
    }

    /// Edges, recorded and synthetic, over the possible n (n - 1) (thesis equation 3.4).
    #[must_use]
    pub fn density(&self, timeline: &Timeline) -> f64 {
        let n = f64::from(self.frame_count());
        let recorded = (0..self.frame_count()).filter(|&frame| timeline.next(frame).is_some()).count();
        (recorded + self.transitions.len()) as f64 / (n * (n - 1.0)).max(1.0)
    }
}

/// Makes an [`EssentialGraph`], transition by transition, for whoever has other things to do meanwhile.
#[derive(Clone, Debug)]
pub struct EssentialGraphBuilder {
    alpha: f64,
    transitions: Vec<Transition>,
    /// Number of transitions from each frame, one place further on.
    first_transition: Vec<u32>,
    last: Option<(u32, u32)>,
}

impl EssentialGraphBuilder {
    /// A graph over `timeline` without transitions.
    ///
    /// # Errors
    /// `alpha` is not between 0 and 1000.
    pub fn new(alpha: f64, timeline: &Timeline) -> Result<Self, GraphError> {
        if !(0.0..=1000.0).contains(&alpha) {
            return Err(GraphError::Alpha(alpha));
        }
        let first_transition = vec![0; timeline.frame_count() as usize + 1];
        Ok(Self { alpha: rounded_alpha(alpha), transitions: Vec::new(), first_transition, last: None })
    }

    /// Memory for so many more transitions, at once.
    pub fn reserve(&mut self, transitions: usize) {
        self.transitions.reserve_exact(transitions);
    }

    /// Adds the next transition by (from, to).
    ///
    /// # Errors
    /// As [`EssentialGraph::new`].
    pub fn push(&mut self, transition: Transition, timeline: &Timeline) -> Result<(), GraphError> {
        self.admit(self.transitions.len(), &transition, timeline)?;
        self.transitions.push(transition);
        Ok(())
    }

    fn admit(&mut self, index: usize, transition: &Transition, timeline: &Timeline) -> Result<(), GraphError> {
        check(index, transition, timeline)?;
        let ends = (transition.from, transition.to);
        if self.last.is_some_and(|last| last >= ends) {
            return Err(GraphError::Order(index));
        }
        self.last = Some(ends);
        self.first_transition[transition.from as usize + 1] += 1;
        Ok(())
    }

    /// The graph.
    #[must_use]
    pub fn finish(mut self) -> EssentialGraph {
        for frame in 1..self.first_transition.len() {
            self.first_transition[frame] += self.first_transition[frame - 1];
        }
        EssentialGraph {
            alpha: self.alpha,
            transitions: self.transitions,
            first_transition: self.first_transition,
            contacts: Contacts::default(),
            feet: Feet::default(),
            ties: Ties::default(),
        }
    }
}

fn check(index: usize, transition: &Transition, timeline: &Timeline) -> Result<(), GraphError> {
    let placement = transition.placement;
    let numbers_hold = transition.deformation >= 0.0
        && transition.deformation.is_finite()
        && placement.heading.is_finite()
        && placement.translation.is_finite();
    if !numbers_hold {
        return Err(GraphError::Cost(index));
    }
    let (Some(source), Some(destination)) =
        (timeline.sequence_of(transition.from), timeline.sequence_of(transition.to))
    else {
        return Err(GraphError::Frame(index));
    };
    let (li, lj) = transition.warp.lengths();
    let source_holds = source.offset(transition.from, li as i64 - 1).is_some();
    let destination_holds = destination.offset(transition.to, 1 - lj as i64).is_some();
    if source_holds && destination_holds { Ok(()) } else { Err(GraphError::Segment(index)) }
}
