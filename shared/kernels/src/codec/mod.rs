//! The part of the geometry codec that runs for every vertex of every frame that is shown.
//!
//! What it means is told in `shared`'s `bundle::geometry`, which reads and writes sections around it.

pub mod frame;
pub mod rans;
pub mod residual;
pub mod zigzag;

/// A position or a difference of positions in steps of the quantisation; the fourth lane is not used.
///
/// Four lanes, because that is what the processor works on at once.
pub type Steps = [i32; 4];
