//! The builder: reads 4D surface captures and packs them into `.reprise` bundles.
//!
//! The modules follow the pipeline: import -> distances -> transitions -> essential graph -> bundle.

pub mod appearance;
pub mod distance;
pub mod essential;
pub mod evaluate;
pub mod export;
pub mod files;
pub mod import;
pub mod memory;
pub mod pack;
pub mod performer;
pub mod progress;
pub mod raster;
mod simd;
pub mod transitions;
