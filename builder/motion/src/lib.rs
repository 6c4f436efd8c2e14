//! Motion that is learned from a capture: other ways through what was recorded.
//!
//! ```text
//! body (its own frame) -> numbers (a row a frame) -> learn::gpdm, learn::stretch -> reach, layers (how far) -> vary -> seen (rows back to poses, feet held) -> alternatives
//! ```
//!
//! Thesis chapter 6, with what it takes to work on real captures (docs/learning.md). Knows no file.

pub mod alternatives;
pub mod body;
pub mod hold;
mod layers;
pub mod numbers;
mod reach;
pub mod seen;
pub mod smooth;
pub mod vary;
