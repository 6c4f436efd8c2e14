//! Appearance from the textures of a capture's frames: Eigen textures and Eigen warps.
//!
//! This work is based on: A. Boukhayma, *Surface Motion Capture Animation*, thesis 2017, chapter 4.

pub mod charts;
mod error;
pub mod flow;
mod level;
pub mod pca;
pub mod prepare;
pub mod store;
pub mod symmetric;
pub mod textures;
pub mod warp;

pub use self::error::AppearanceError;
