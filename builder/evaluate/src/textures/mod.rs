//! What the models of textures are worth: quality over components, in views, at seams, against the truth.

pub mod curves;
pub mod ghosting;
mod performed;
pub mod quality;
pub mod seams;
mod section;
pub mod views;

pub(crate) use section::section;
