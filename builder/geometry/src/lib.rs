//! Meshes and what is done with them: making them from distance fields, remeshing, cutting into charts, flattening, rasterising,
//! ways along them.
//!
//! Nothing here knows a frame, a sequence or a file.

pub mod atlas;
pub mod charts;
pub mod closest;
pub mod flatten;
pub mod geodesic;
pub mod kd;
pub mod mesh;
pub mod polygonise;
pub mod raster;
pub mod remesh;
pub mod sdf;
