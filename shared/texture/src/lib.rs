//! How a captured actor looks from frame to frame: Eigen textures and Eigen warps (thesis chapter 4, TVCG section 5).
//!
//! [`TextureModel`] is what the builder makes; [`basis`] is what the bundle keeps of it, and [`dealign`] the last step
//! of rebuilding a frame's texture. Each pass of the player's GPU has its twin here. [`quality`] compares textures.

pub mod basis;
pub mod dealign;
pub mod mask;
pub mod model;
pub mod quality;
pub mod transform;

pub use model::TextureModel;
