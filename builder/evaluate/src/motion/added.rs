//! What blends add to the motion: with X = (1 - lambda) X_i + lambda X_j, dX/dt has the part lambda' (X_j - X_i), whose size
//! as a pose distance is v_t = lambda'_t d_t. The rest of dX/dt is recorded.

use actor::blend::Blend;
use actor::graph::EssentialGraph;
use actor::walk::{Leg, steps_of};

use super::played::Begun;
use crate::EvaluateError;
use crate::performance::Recordings;
use pipeline::distance::DistanceMatrix;

/// What the transitions of some walks add, transition after transition as they are used.
#[derive(Clone, Debug, Default)]
pub struct Added {
    /// Their indices in the graph.
    pub transitions: Vec<u32>,
    /// The largest v_t of each, in radians a frame.
    pub peaks: Vec<f64>,
    /// The mean v_t of each, in radians a frame.
    pub means: Vec<f64>,
    /// Steps of each.
    pub durations: Vec<f64>,
}

impl Added {
    /// Measures the transitions on `walks`.
    ///
    /// # Errors
    /// Walks of another graph.
    pub fn of(
        recordings: &Recordings,
        distances: &DistanceMatrix,
        graph: &EssentialGraph,
        walks: &[Begun],
    ) -> Result<Self, EvaluateError> {
        let mut added = Self::default();
        for leg in walks.iter().flat_map(|begun| &begun.walk.legs) {
            let Leg::Synthetic(index) = *leg else { continue };
            let transition = &graph.transitions()[index as usize];
            let blends = recordings.blends(transition)?;
            let apart = |blend: &Blend| f64::from(distances.get(blend.nearest(0) as usize, blend.nearest(1) as usize));
            let velocity =
                |pair: &[Blend]| f64::from(pair[1].lambda - pair[0].lambda) * (apart(&pair[0]) + apart(&pair[1])) / 2.0;
            let velocities: Vec<f64> = blends.windows(2).map(velocity).collect();
            added.transitions.push(index);
            added.peaks.push(velocities.iter().copied().fold(0.0, f64::max));
            added.means.push(velocities.iter().sum::<f64>() / velocities.len().max(1) as f64);
            added.durations.push(f64::from(steps_of(transition)));
        }
        Ok(added)
    }
}
