//! Types and algorithms that Reprise's builder and player both run.
//!
//! The pipeline, left to right; a stage reads the output of the stage before it and nothing further back:
//!
//! ```text
//! builder:  import -> poses -> distances -> transitions -> essential graph -> appearance -> bundle
//! player:   bundle -> search -> synthesis -> texture -> picture
//! ```
//!
//! This crate does no input or output and knows no GPU, no thread and no page.
//!
//! Conventions: right-handed coordinates, +Y up, metres, seconds, radians; the ground is the XZ plane; vectors are
//! columns. Frames are counted over the whole capture (all sequences of one subject, one after another), from 0.

pub mod appearance;
pub mod bundle;
pub mod capture;
pub mod contacts;
pub mod graph;
pub mod pose_source;
pub mod search;
pub mod surface;
pub mod synthesis;
pub mod timeline;
pub mod warp;

pub use glam::{Quat, Vec2, Vec3};
pub use kernels::{align, cholesky, gradients, lanes, laplacian, poisson, scalar, sort, topology};
