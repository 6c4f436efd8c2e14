//! The numeric kernels behind every frame that is shown.
//!
//! They are a crate of their own because of how the page is compiled: these few functions for speed, everything else
//! for size.
//!
//! ```text
//! number -> scalar -> lanes -> gradients ---.
//! topology -> cholesky -> laplacian -> poisson
//! ```

pub mod align;
pub mod band;
pub mod cholesky;
pub mod codec;
pub mod components;
pub mod decimal;
pub mod gradients;
pub mod lanes;
pub mod laplacian;
pub mod lru;
pub mod modes;
pub mod number;
pub mod poisson;
pub mod random;
pub mod rotation;
pub mod scalar;
pub mod simd;
pub mod sort;
pub mod srgb;
pub mod topology;
