//! Entropy coders of our own: small, total on hostile input, and the same bit for bit natively and in wasm.
//!
//! [`binary`] adapts while it codes and serves the sections that are read once, [`mixing`] guesses from several contexts for
//! those whose bytes count most; [`kernels::codec::rans`] works from tables that are
//! known beforehand, which is what makes a single frame of geometry quick to decode. What decides most lies among the kernels.

pub mod mixing;

pub use kernels::codec::{binary, numbers};
