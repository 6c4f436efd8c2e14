//! Walks through the essential graph.

use serde::{Deserialize, Serialize};

use crate::graph::{EssentialGraph, Transition};
use crate::timeline::Timeline;

/// A stretch of a walk.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
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
    /// Recorded frames backwards, from `first` down to `last` of the same sequence, both included: out of a dead end, or to
    /// a frame at which no transition can arrive. No edge of the graph; a step costs as much as one forwards.
    Back {
        /// The frame that the stretch begins with.
        first: u32,
        /// The frame that it ends with.
        last: u32,
        /// Steps from `first` down to `last`.
        steps: u32,
    },
}

impl Leg {
    /// Steps from frame to frame; none for a transition that the graph does not have.
    #[must_use]
    pub fn steps(&self, graph: &EssentialGraph) -> u32 {
        match *self {
            Self::Recorded { steps, .. } | Self::Back { steps, .. } => steps,
            Self::Synthetic(edge) => graph.transitions().get(edge as usize).map_or(0, steps_of),
        }
    }

    /// The frames that it begins and ends with; `None` for a transition that the graph does not have.
    #[must_use]
    pub fn ends(&self, graph: &EssentialGraph) -> Option<(u32, u32)> {
        match *self {
            Self::Recorded { first, last, .. } | Self::Back { first, last, .. } => Some((first, last)),
            Self::Synthetic(edge) => {
                graph.transitions().get(edge as usize).map(|transition| (transition.from, transition.to))
            }
        }
    }

    /// The transition that it is, if it is one.
    #[must_use]
    pub fn transition(&self) -> Option<u32> {
        match *self {
            Self::Synthetic(edge) => Some(edge),
            Self::Recorded { .. } | Self::Back { .. } => None,
        }
    }
}

/// A walk through the graph, from frame to frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Walk {
    /// Its stretches, each beginning with the frame that the one before ends with.
    pub legs: Vec<Leg>,
    /// J: the sum of its edges' costs (TVCG equation 9; thesis equation 3.1).
    pub cost: f64,
    /// Sum of the transitions' surface deformation costs.
    pub deformation: f64,
    /// Duration in frames: recorded steps and transition lengths.
    pub duration: u32,
    /// How it is bent: after each step, from none on, where the frame is put from where the legs alone lead, in the world:
    /// heading in radians about +Y, then metres along X and Z. Steps beyond the last one are put as that one; empty where
    /// the walk is not bent.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bend: Vec<[f32; 3]>,
}

impl Walk {
    /// Number of transitions on the way.
    #[must_use]
    pub fn transition_count(&self) -> usize {
        self.legs.iter().filter_map(Leg::transition).count()
    }
}

/// Steps from the frame that `transition` leaves to the one that it arrives at: its first node is the frame left, which
/// has been shown, so that L nodes take L - 1 steps.
#[must_use]
pub fn steps_of(transition: &Transition) -> u32 {
    (transition.warp.duration() as u32).saturating_sub(1).max(1)
}

/// Follows `legs` from frame `start` and returns the frame that they end with.
///
/// # Errors
/// The first leg that the graph does not have, or that does not continue the one before.
pub fn end_of(legs: &[Leg], graph: &EssentialGraph, timeline: &Timeline, start: u32) -> Result<u32, WalkError> {
    let mut frame = start;
    for (index, leg) in legs.iter().enumerate() {
        let (first, last) = leg.ends(graph).ok_or(WalkError::NoSuchLeg(index))?;
        let recorded = match *leg {
            Leg::Recorded { steps, .. } => timeline.offset(first, i64::from(steps)) == Some(last),
            // Backwards across the wrap of a cyclic sequence nobody knows where the body stood.
            Leg::Back { steps, .. } => {
                timeline.sequence_of(first).is_some_and(|sequence| sequence.contains(last))
                    && first.checked_sub(steps) == Some(last)
            }
            Leg::Synthetic(_) => true,
        };
        if !recorded {
            return Err(WalkError::NoSuchLeg(index));
        }
        if first != frame {
            return Err(WalkError::Gap(index));
        }
        frame = last;
    }
    Ok(frame)
}

/// Why legs are not a walk through a graph: what the checker found first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WalkError {
    /// A leg begins elsewhere than the leg before ended.
    #[error("leg {0} does not begin where the walk is")]
    Gap(usize),
    /// A leg names a transition that does not exist, or leaves its sequence.
    #[error("leg {0} is not in the graph")]
    NoSuchLeg(usize),
    /// Cost, deformation or duration are not the sums over the legs.
    #[error("the walk's sums are not those of its legs")]
    Sums,
}

impl Walk {
    /// The walk of `legs`, with its sums.
    ///
    /// # Errors
    /// A leg that the graph does not have; gaps are found by [`Self::check`].
    pub fn of_legs(legs: Vec<Leg>, graph: &EssentialGraph) -> Result<Self, WalkError> {
        let mut walk = Self::default();
        for (index, leg) in legs.iter().enumerate() {
            match *leg {
                Leg::Recorded { steps, .. } | Leg::Back { steps, .. } => {
                    walk.cost += graph.alpha() * f64::from(steps);
                    walk.duration += steps;
                }
                Leg::Synthetic(edge) => {
                    let transition = graph.transitions().get(edge as usize).ok_or(WalkError::NoSuchLeg(index))?;
                    walk.cost += transition.cost(graph.alpha());
                    walk.deformation += f64::from(transition.deformation);
                    walk.duration += transition.warp.duration() as u32;
                }
            }
        }
        walk.legs = legs;
        Ok(walk)
    }

    /// Follows the walk from `start` through the graph and returns the frame that it ends with.
    ///
    /// # Errors
    /// The first leg that the graph does not have or that does not continue the one before, or sums that are not the legs'.
    pub fn check(&self, graph: &EssentialGraph, timeline: &Timeline, start: u32) -> Result<u32, WalkError> {
        let end = end_of(&self.legs, graph, timeline, start)?;
        let sums = Self::of_legs(self.legs.clone(), graph)?;
        let same = |a: f64, b: f64| (a - b).abs() <= 1e-6 * (1.0 + a.abs());
        let holds =
            same(sums.cost, self.cost) && same(sums.deformation, self.deformation) && sums.duration == self.duration;
        if holds { Ok(end) } else { Err(WalkError::Sums) }
    }

    /// Steps from frame to frame: the frames that are shown after the one that the walk begins with. Transitions whose
    /// index the graph does not have count none.
    #[must_use]
    pub fn steps(&self, graph: &EssentialGraph) -> u32 {
        self.legs.iter().map(|leg| leg.steps(graph)).sum()
    }

    /// The frame that the walk ends with; `None` where it has no legs, or its last one is not in the graph.
    #[must_use]
    pub fn end(&self, graph: &EssentialGraph) -> Option<u32> {
        self.legs.last()?.ends(graph).map(|(_, last)| last)
    }

    /// Appends a recorded step or stretch from `first` to `last`, joining it to a recorded leg that ends there.
    pub fn push_recorded(&mut self, first: u32, last: u32, steps: u32) {
        match self.legs.last_mut() {
            _ if steps == 0 => {}
            Some(Leg::Recorded { last: end, steps: taken, .. }) if *end == first => {
                *end = last;
                *taken += steps;
            }
            _ => self.legs.push(Leg::Recorded { first, last, steps }),
        }
    }

    /// Appends `other`, which begins where this walk ends; neither is bent.
    pub fn append(&mut self, other: &Self) {
        for leg in &other.legs {
            match *leg {
                Leg::Recorded { first, last, steps } => self.push_recorded(first, last, steps),
                Leg::Synthetic(_) | Leg::Back { .. } => self.legs.push(*leg),
            }
        }
        self.cost += other.cost;
        self.deformation += other.deformation;
        self.duration += other.duration;
    }
}
