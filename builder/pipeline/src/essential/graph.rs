//! From the edges that are kept to the graph that the player walks: their warps, and where they lead.

use actor::blend::transition_way;
use actor::capture::Capture;
use actor::contacts::{Contacts, Facings};
use actor::graph::{EssentialGraph, GraphError, Transition};
use actor::ground::Ground;
use actor::pose_source::PoseError;
use glam::Vec2;
use rayon::prelude::*;
use thiserror::Error;

use super::sparse::Candidates;
use crate::distance::{DistanceMatrix, HeadingMatrix};
use crate::transitions::{TransitionCost, TransitionError, TransitionOptions, WarpFinder};

/// Why kept edges are no graph; any of these is a fault of the stages before.
#[derive(Debug, Error)]
pub enum BuildError {
    /// A warp could not be found again.
    #[error("the warp from frame {from} to frame {to} cannot be found again: {cause}")]
    TemporalWarp {
        /// The frame that the transition leaves from.
        from: u32,
        /// The frame that it arrives at.
        to: u32,
        /// Why.
        cause: TransitionError,
    },
    /// The options of the transitions make no sense.
    #[error(transparent)]
    Options(#[from] TransitionError),
    /// A frame could not be read.
    #[error(transparent)]
    Pose(#[from] PoseError),
    /// The transitions do not fit the timeline.
    #[error(transparent)]
    Graph(#[from] GraphError),
}

/// What the stages before have found out about a capture.
pub struct GraphInput<'a> {
    /// Pose distances of all pairs.
    pub distances: &'a DistanceMatrix,
    /// Planar alignment of all pairs.
    pub headings: &'a HeadingMatrix,
    /// How transitions were chosen.
    pub options: &'a TransitionOptions,
}

/// The essential graph of `capture` from the transitions that are kept.
///
/// `contacts` are what its transitions keep still, and which way these point; none of them, and they follow the papers alone.
///
/// The warp of each edge is found again here, since only costs and lengths are kept for all pairs.
///
/// # Errors
/// Findings that do not fit together.
pub fn build_graph(
    capture: &Capture,
    input: &GraphInput,
    kept: &Candidates,
    alpha: f64,
    (contacts, facings): (Contacts, Facings),
) -> Result<EssentialGraph, BuildError> {
    let timeline = &capture.timeline;
    let centres = capture.poses.ground_centres(capture.topology.weights());
    let warps = WarpFinder::new(input.distances, timeline, input.options)?;
    let edges: Vec<(u32, u32, TransitionCost)> = (0..kept.frame_count())
        .flat_map(|from| kept.from(from).iter().map(move |&(to, cost)| (from, to, cost)))
        .collect();
    let transitions = edges
        .into_par_iter()
        .map(|(from, to, cost)| {
            let warp = warps
                .find(from, to, cost.source_length.into(), cost.destination_length.into())
                .map_err(|cause| BuildError::TemporalWarp { from, to, cause })?;
            let mut ground = Recorded { headings: input.headings, centres: &centres };
            let (placement, turn) = transition_way(timeline, &mut ground, (from, to), &warp, (&contacts, &facings))?;
            Ok(Transition { from, to, deformation: cost.deformation, warp, placement, turn })
        })
        .collect::<Result<Vec<_>, BuildError>>()?;
    Ok(EssentialGraph::new(alpha, transitions, timeline)?.with_contacts(contacts))
}

/// Where recorded frames stand, from the tables of the builder.
struct Recorded<'a> {
    headings: &'a HeadingMatrix,
    centres: &'a [Vec2],
}

impl Ground for Recorded<'_> {
    fn heading(&mut self, fixed: u32, moving: u32) -> Result<f32, PoseError> {
        Ok(self.headings.get(fixed as usize, moving as usize))
    }

    fn centre(&mut self, frame: u32) -> Result<Vec2, PoseError> {
        self.centres.get(frame as usize).copied().ok_or(PoseError::OutOfRange(frame))
    }
}
