//! From measured poses to the graph that the player walks: transitions, the essential ones among them, their warps.

use actor::capture::Capture;
use actor::contacts::{Contacts, Facings};
use actor::feet::Feet;
use actor::graph::{DEFAULT_ALPHA, EssentialGraph, rounded_alpha};
use actor::ties::Ties;
use job::{Job, Stopped};
use thiserror::Error;

use crate::contacts;
use crate::distance::Measured;
use crate::essential::live::one_for_all;
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
    /// The least and the largest alpha that a player may choose instead of it, without packing again; `None` where it stays.
    pub alphas: Option<[f64; 2]>,
    /// Whether transitions keep still what stands on the ground on both sides, and components on each other; else they follow
    /// the papers alone.
    pub hold_contacts: bool,
}

impl Default for GraphOptions {
    fn default() -> Self {
        let alphas = Some(ALPHAS);
        Self { transition: TransitionOptions::default(), alpha: DEFAULT_ALPHA, alphas, hold_contacts: true }
    }
}

/// The alphas between which actors move smoothly or quickly (thesis section 3.3.2 has 0.01, figure 3.8 up to 0.2).
pub const ALPHAS: [f64; 2] = [0.01, 0.2];

/// Alphas of the range that are looked at, from the least to the largest, evenly by their logarithms: what is essential between
/// two of them is nearly always essential for one of both.
const RUNGS: usize = 4;

impl GraphOptions {
    /// The alphas that the graph is made for: its own first, then those of the range from the largest on.
    ///
    /// # Errors
    /// One that is not between the resolution and 1000.
    pub fn rungs(&self) -> Result<Vec<f64>, EssentialError> {
        let range = self.alphas.into_iter().flat_map(|[least, most]| {
            (0..RUNGS).rev().map(move |rung| least * (most / least).powf(rung as f64 / (RUNGS - 1) as f64))
        });
        let mut rungs = Vec::new();
        for alpha in [self.alpha].into_iter().chain(range) {
            let rounded = rounded_alpha(alpha);
            if !(rounded > 0.0 && rounded <= 1000.0) {
                return Err(EssentialError::Alpha(alpha));
            }
            if !rungs.contains(&rounded) {
                rungs.push(rounded);
            }
        }
        Ok(rungs)
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
    let rungs = options.rungs()?;
    let candidates = candidate_transitions(&measured.distances, timeline, &options.transition, &rungs, job)?;
    job.begin("essential graph")?;
    let mut essential = Vec::new();
    for (candidates, &alpha) in candidates.into_iter().zip(&rungs) {
        essential.push((alpha, essential_of(&candidates, timeline, alpha, job)?));
    }
    // There is always one: the capture's own.
    let (_, own) = essential.remove(0);
    let kept = one_for_all(&own, &essential, timeline);
    job.begin("temporal warps")?;
    let contacts = match options.hold_contacts {
        true => contacts::contacts(&capture.topology, timeline, &capture.poses),
        false => Default::default(),
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
    contacts: (Contacts, Facings),
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
