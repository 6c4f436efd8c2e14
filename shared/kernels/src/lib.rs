//! The numeric kernels behind every frame that is shown.
//!
//! They are a crate of their own because of how the page is compiled: these few functions for speed, everything else
//! for size. Use them through `shared`, which exports them under the same names.

pub mod align;
pub mod cholesky;
pub mod codec;
pub mod gradients;
pub mod kept;
mod lanes;
pub mod laplacian;
pub mod poisson;
pub mod random;
pub mod simd;
pub mod sort;
pub mod topology;
