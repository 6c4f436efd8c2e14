//! How alike textures are, and the frames that this is measured on.

use serde::Serialize;

/// Similarity and error at a point of a curve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Quality {
    /// Structural similarity.
    pub ssim: f64,
    /// Mean square error of colours from 0 to 1.
    pub mse: f64,
}

/// At most `most` of `frames`, evenly spread.
pub(super) fn evenly<T: Copy>(frames: &[T], most: usize) -> Vec<T> {
    frames.iter().copied().step_by(frames.len().div_ceil(most).max(1)).collect()
}
