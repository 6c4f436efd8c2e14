//! The costs of the complete digraph's edges.

use actor::timeline::Timeline;

use crate::transitions::TransitionMatrix;

/// Edge costs E(i, j) of the complete digraph (TVCG equation 10; thesis equations 3.2 and 3.3).
#[derive(Clone, Copy)]
pub struct Costs<'a> {
    /// The optimal transitions of all pairs.
    pub transitions: &'a TransitionMatrix,
    /// The sequences.
    pub timeline: &'a Timeline,
    /// A multiple of [`actor::graph::ALPHA_RESOLUTION`].
    pub alpha: f64,
}

impl Costs<'_> {
    /// D + alpha L, or infinity.
    pub fn synthetic(&self, i: u32, j: u32) -> f64 {
        let transition = self.transitions.get(i as usize, j as usize).filter(|_| i != j);
        transition.map_or(f64::INFINITY, |transition| transition.cost(self.alpha))
    }

    /// alpha times the recorded steps from i to j, or infinity.
    pub fn recorded(&self, i: u32, j: u32) -> f64 {
        let Some(sequence) = self.timeline.sequence_of(i).filter(|sequence| sequence.contains(j)) else {
            return f64::INFINITY;
        };
        let steps = i64::from(j) - i64::from(i);
        match (steps >= 0, sequence.cyclic) {
            (true, _) => self.alpha * steps as f64,
            (false, true) => self.alpha * (steps + i64::from(sequence.frame_count)) as f64,
            (false, false) => f64::INFINITY,
        }
    }

    /// E(i, j): the lesser of both; 0 from a frame to itself.
    pub fn edge(&self, i: u32, j: u32) -> f64 {
        self.synthetic(i, j).min(self.recorded(i, j))
    }
}
