//! Factors that are kept to precondition the systems of nearby poses, and when to take a new one.

use std::sync::Arc;

use super::conjugate_gradients::Outcome;
use crate::cholesky::Factor;

/// What a solve with a pose's own factor, in single precision, leaves of the error at most.
const OWN_CONTRACTION: f32 = 1e-3;

/// Frames over which a measured contraction is a guide.
const TRUSTED_FRAMES: u32 = 6;

/// Solves that a factorisation costs.
const FACTORISATION: usize = 10;

/// A pose's factor, and how well it did for other poses.
#[derive(Clone, Default)]
pub(super) struct KeptFactor {
    pub frame: u32,
    pub factor: Arc<Factor>,
    /// Diagonal of the pose's Laplacian.
    pub diagonal: Arc<[f32]>,
    /// The pose that it was used for last, and what one solve left of the error.
    measured: Option<(u32, f32)>,
    /// Fewest solves that another pose took.
    fewest: Option<usize>,
    /// Solves spent beyond the fewest ones since.
    excess: usize,
}

impl KeptFactor {
    /// A factor that was not used yet.
    pub fn new(frame: u32, factor: Factor, diagonal: &[f32]) -> Self {
        Self { frame, factor: Arc::new(factor), diagonal: diagonal.into(), ..Self::default() }
    }

    /// What one solve will leave of the error of a system of `frame`.
    pub fn expected_contraction(&self, frame: u32) -> f32 {
        match self.measured {
            _ if self.frame == frame && self.factor.regularised == 0 => OWN_CONTRACTION,
            // Poses that drift away contract less.
            Some((measured, contraction)) if frame.abs_diff(measured) <= TRUSTED_FRAMES => {
                (contraction * (1.5 + 0.5 * frame.abs_diff(measured) as f32)).min(1.0)
            }
            _ => 1.0,
        }
    }

    /// Takes note of a system of `frame` that was solved with this factor.
    pub fn learn(&mut self, frame: u32, outcome: &Outcome) {
        if self.frame == frame {
            return;
        }
        if let Some(contraction) = outcome.contraction {
            self.measured = Some((frame, contraction));
        }
        let fewest = self.fewest.map_or(outcome.solves, |fewest| fewest.min(outcome.solves));
        self.fewest = Some(fewest);
        self.excess += outcome.solves - fewest;
    }

    /// Whether the poses have drifted so far that what a new factor would have saved by now would have paid for it.
    pub fn is_worn_out(&self, frame: u32) -> bool {
        self.frame != frame && self.excess >= FACTORISATION
    }
}
