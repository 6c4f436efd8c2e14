//! How a captured actor looks from frame to frame: Eigen textures and Eigen warps (thesis chapter 4, TVCG section 5).

pub mod dealign;
pub mod mask;
pub mod model;

pub use model::AppearanceModel;
