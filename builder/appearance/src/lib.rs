//! Appearance from the textures of a capture's frames: Eigen textures and Eigen warps.
//!
//! ```text
//! textures -> charts, gaps -> reference -> flow, warp (align) -> store -> components -> fit, completion -> TextureModel
//! ```
//!
//! This work is based on: A. Boukhayma, *Surface Motion Capture Animation*, thesis 2017, chapter 4. Textures are read a
//! frame at a time and never all held; what is made of them lies in scratch files. The result depends neither on the
//! number of threads nor on the processor.

pub mod align;
pub mod basis;
pub mod build;
pub mod charts;
mod coarsest;
pub mod completion;
mod error;
pub mod fit;
pub mod flow;
pub mod gaps;
mod level;
pub mod model;
pub mod naive;
pub mod prepare;
mod reach;
pub mod rebuilt;
pub mod reference;
mod sampling;
mod screened;
pub mod stored;
pub mod textures;
pub mod warp;

pub use self::build::{AppearanceOptions, build};
pub use self::charts::Charts;
pub use self::error::AppearanceError;
pub use self::model::AppearanceSummary;
