//! The parts of the codecs that run most: for every vertex of every frame that is shown, and for every decision that
//! stands in a bundle.
//!
//! What they mean is told in the modules `geometry` and `appearance` of the crate `bundle`, which read and write
//! sections around them.

pub mod binary;
pub mod frame;
pub mod mixing;
pub mod numbers;
pub mod rans;
pub mod residual;
pub mod zigzag;

/// A position or a difference of positions in steps of the quantisation; the fourth lane is not used.
///
/// Four lanes, because that is what the processor works on at once.
pub type Steps = [i32; 4];
