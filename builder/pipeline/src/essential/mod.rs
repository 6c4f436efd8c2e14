//! The essential graph: the edges of the complete digraph that no other path replaces.
//!
//! Boukhayma and Boyer, TVCG section 4.1; thesis section 3.3. It is McGeoch's essential subgraph: an edge stays if and
//! only if it is strictly cheaper than every path of two or more edges. Packing decides from few candidates ([`sparse`]).
//! Here it is decided from all transitions, for comparison: they make nearly complete digraphs, so all shortest paths are
//! found by blocked min-plus products, then each edge that is one of them is compared with all paths over a node in between.

mod candidates;
mod costs;
mod detours;
mod graph;
pub mod hidden_paths;
pub mod live;
mod motion_graph;
mod paths;
mod reach;
pub mod sparse;

use actor::graph::{ALPHA_RESOLUTION, rounded_alpha};
use actor::timeline::Timeline;
use rayon::prelude::*;
use thiserror::Error;

pub use self::costs::Costs;
pub use self::graph::{BuildError, GraphInput, build_graph};
pub use self::motion_graph::motion_graph;
pub use self::paths::PathLengths;
pub use self::reach::{Reach, reach};
use crate::transitions::TransitionMatrix;
pub use actor::components::{StrongComponents, strongly_connected};
use kernels::simd::Level;

/// The edges of the essential graph and what they cannot reach.
#[derive(Clone, Debug, PartialEq)]
pub struct Essential {
    /// Alpha as it was used: rounded.
    pub alpha: f64,
    /// Transitions that stay, as (from, to), sorted. Recorded steps always stay and are not listed.
    pub edges: Vec<(u32, u32)>,
    /// Number of pairs (i, j), i != j, with no path from i to j, in this graph as in the complete one.
    pub unreachable_pairs: u64,
    /// Frames that nothing leads on from.
    pub dead_ends: Vec<u32>,
    /// Frames that nothing leads to.
    pub unreached: Vec<u32>,
}

/// Why there is no essential graph.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum EssentialError {
    /// The transitions are of another capture.
    #[error("there are transitions between {transitions} frames, but the capture has {frames}")]
    FrameCount {
        /// Frames of the transition matrix.
        transitions: usize,
        /// Frames of the capture.
        frames: usize,
    },
    /// Alpha is too small, too large or not a number. At zero, playing on would be free and all frames of a sequence
    /// would tie.
    #[error("alpha is {0}, but must be between {ALPHA_RESOLUTION:.1e} and 1000")]
    Alpha(f64),
}

/// The essential graph of all transitions and recorded steps, for `alpha`, the cost of a frame's duration.
///
/// With E(i, j) = D + alpha L, and alpha for a recorded step (from the last frame of a cyclic sequence to the first,
/// too), an edge stays if and only if E(i, j) is strictly less than the cost of every path of two or more edges; of
/// equals, the path with recorded frames stays. Alpha is a multiple of 2^-24 and D a binary fraction, so sums are exact
/// unless D is below 1e-6 or so, and no comparison depends on their order. Time O(n^3), memory 8 n^2 bytes.
///
/// # Errors
/// Transitions of another capture, or an alpha that is not positive.
pub fn essential_edges(
    transitions: &TransitionMatrix,
    timeline: &Timeline,
    alpha: f64,
) -> Result<Essential, EssentialError> {
    essential_at(Level::best(), transitions, timeline, alpha)
}

fn essential_at(
    level: Level,
    transitions: &TransitionMatrix,
    timeline: &Timeline,
    alpha: f64,
) -> Result<Essential, EssentialError> {
    let frames = timeline.frame_count();
    if transitions.frame_count() != frames as usize {
        return Err(EssentialError::FrameCount { transitions: transitions.frame_count(), frames: frames as usize });
    }
    let rounded = rounded_alpha(alpha);
    if !(rounded > 0.0 && rounded <= 1000.0) {
        return Err(EssentialError::Alpha(alpha));
    }
    let costs = Costs { transitions, timeline, alpha: rounded };
    // No edge from a node to itself: then every path over a node in between is a true detour.
    let edge = |i: usize, j: usize| if i == j { f64::INFINITY } else { costs.edge(i as u32, j as u32) };
    let paths = PathLengths::new(level, frames as usize, edge);
    let reached = |i: u32, j: u32| i == j || paths.from(i as usize)[j as usize] < f64::INFINITY;
    let unreachable = |i: u32| (0..frames).filter(|&j| !reached(i, j)).count() as u64;
    Ok(Essential {
        alpha: rounded,
        edges: kept(&costs, &paths),
        unreachable_pairs: (0..frames).map(unreachable).sum(),
        dead_ends: (0..frames).filter(|&i| (0..frames).all(|j| i == j || !reached(i, j))).collect(),
        unreached: (0..frames).filter(|&j| (0..frames).all(|i| i == j || !reached(i, j))).collect(),
    })
}

/// Destinations whose columns are laid out together.
const GROUP: usize = 64;

/// The transitions that are strictly cheaper than every path over a node in between; sorted.
fn kept(costs: &Costs, paths: &PathLengths) -> Vec<(u32, u32)> {
    let frames = costs.timeline.frame_count();
    let firsts: Vec<u32> = (0..frames).step_by(GROUP).collect();
    let groups = firsts.into_par_iter().map(|first| {
        let group = first..(first + GROUP as u32).min(frames);
        let columns: Vec<Vec<f64>> =
            group.clone().map(|j| (0..frames as usize).map(|k| paths.from(k)[j as usize]).collect()).collect();
        let mut edges = Vec::new();
        for i in 0..frames {
            let from = paths.from(i as usize);
            for j in group.clone() {
                let cost = costs.synthetic(i, j);
                // A transition that costs what the recorded frames cost gives way to them.
                let shortest = cost <= from[j as usize] && cost < costs.recorded(i, j);
                if shortest && !has_detour(from, &columns[(j - first) as usize], cost) {
                    edges.push((i, j));
                }
            }
        }
        edges
    });
    let mut edges: Vec<(u32, u32)> = groups.flatten().collect();
    edges.sort_unstable();
    edges
}

/// Whether a path over some node costs at most `cost`.
fn has_detour(from: &[f64], to: &[f64], cost: f64) -> bool {
    from.iter().zip(to).any(|(a, b)| a + b <= cost)
}
