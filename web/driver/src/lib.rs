//! Driving by motion capture, apart from the player: the page loads this module when a clip is first dropped.
//!
//! ```text
//! player: timeline, mesh, feet (words), rig (bytes), recorded poses --\
//!                                            files of a clip (bytes) --+--> Session -> frames in the world -> player
//! ```
//!
//! It has a memory of its own and knows no bundle. How a body is driven is `driving`'s business, the same as in the builder.

pub mod actor;
#[cfg(all(target_arch = "wasm32", feature = "bindings"))]
pub mod bindings;
pub mod clip;
pub mod error;
pub mod joins;
pub mod perform;
pub mod session;
