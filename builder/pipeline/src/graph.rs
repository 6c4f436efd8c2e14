//! From measured poses to the graph that the player walks: transitions, the essential ones among them, their warps.

use actor::capture::Capture;
use actor::contacts::Contacts;
use actor::feet::Feet;
use actor::graph::{ALPHA_RESOLUTION, DEFAULT_ALPHA, EssentialGraph, rounded_alpha};
use actor::ties::Ties;
use job::{Job, Stopped};
use thiserror::Error;

use crate::contacts;
use crate::distance::Measured;
use crate::essential::sparse::{Candidates, candidate_transitions, essential_of};
use crate::essential::{
    BuildError, EssentialError, GraphInput, StrongComponents, build_graph, reach, strongly_connected,
};
use crate::feet;
use crate::ties;
use crate::transitions::{TransitionError, TransitionOptions};

/// How the graph of a capture is made.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct GraphOptions {
    /// How transitions are chosen.
    pub transition: TransitionOptions,
    /// Weight of a frame's duration against surface deformation (thesis section 3.3.2).
    pub alpha: f64,
    /// Whether transitions keep still what stands on the ground on both sides, and components on each other; else they follow
    /// the papers alone.
    pub hold_contacts: bool,
}

impl Default for GraphOptions {
    fn default() -> Self {
        Self { transition: TransitionOptions::default(), alpha: DEFAULT_ALPHA, hold_contacts: true }
    }
}

/// Why there is no graph.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum GraphError {
    /// The transitions cannot be found.
    #[error(transparent)]
    Transition(#[from] TransitionError),
    /// The essential ones cannot be told.
    #[error(transparent)]
    Essential(#[from] EssentialError),
    /// Stages contradict each other: a fault of ours.
    #[error("the graph cannot be built: {0}")]
    Build(#[from] BuildError),
    /// It was asked to stop.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

/// The essential graph of a capture, and what is known of it.
#[derive(Clone, Debug)]
pub struct Graphed {
    /// The graph.
    pub graph: EssentialGraph,
    /// Number of pairs (i, j), i != j, with no path from i to j.
    pub unreachable_pairs: u64,
    /// Frames that nothing leads on from.
    pub dead_ends: Vec<u32>,
    /// Its strongly connected components.
    pub components: StrongComponents,
}

/// The essential graph of `capture`, whose poses were measured.
///
/// # Errors
/// Options that do not fit the capture; being stopped.
pub fn essential_graph(
    capture: &Capture,
    measured: &Measured,
    options: &GraphOptions,
    job: &Job,
) -> Result<Graphed, GraphError> {
    let timeline = &capture.timeline;
    let alpha = rounded_alpha(options.alpha);
    if !(alpha > 0.0 && alpha <= 1000.0) {
        return Err(EssentialError::Alpha(options.alpha).into());
    }
    debug_assert!(alpha >= ALPHA_RESOLUTION);
    let candidates = candidate_transitions(&measured.distances, timeline, &options.transition, alpha, job)?;
    job.begin("essential graph")?;
    let kept = essential_of(&candidates, timeline, alpha, job)?;
    drop(candidates);
    job.begin("temporal warps")?;
    let contacts = match options.hold_contacts {
        true => contacts::contacts(&capture.topology, timeline, &capture.poses),
        false => Contacts::default(),
    };
    let feet = match options.hold_contacts {
        true => feet::feet(&capture.topology, timeline, &capture.poses),
        false => Feet::default(),
    };
    let ties = match options.hold_contacts {
        true => ties::ties(&capture.topology, &capture.poses),
        false => Ties::default(),
    };
    let graphed = graph_of(capture, measured, &kept, options, contacts)?;
    Ok(Graphed { graph: graphed.graph.with_feet(feet).with_ties(ties), ..graphed })
}

/// The graph of the transitions `kept`.
///
/// # Errors
/// Stages that contradict each other.
pub fn graph_of(
    capture: &Capture,
    measured: &Measured,
    kept: &Candidates,
    options: &GraphOptions,
    contacts: Contacts,
) -> Result<Graphed, GraphError> {
    let timeline = &capture.timeline;
    let findings =
        GraphInput { distances: &measured.distances, headings: &measured.headings, options: &options.transition };
    let graph = build_graph(capture, &findings, kept, options.alpha, contacts)?;
    let edges: Vec<(u32, u32)> =
        graph.transitions().iter().map(|transition| (transition.from, transition.to)).collect();
    let components = strongly_connected(timeline, &edges);
    let reach = reach(&components, timeline, &edges);
    Ok(Graphed { graph, unreachable_pairs: reach.unreachable_pairs, dead_ends: reach.dead_ends, components })
}
