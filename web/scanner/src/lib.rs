//! Frames as they were scanned, apart from the player: the page loads this module where an actor has such frames.
//!
//! ```text
//! player: what the index tells of a group (words) --\
//!             the group's section, checked (bytes) --+--> Opened -> images to the browser, mesh to the stage
//!         the registered mesh in the frame's pose --------> carried -> where each vertex lies on it, to the stage
//! ```
//!
//! It has a memory of its own, and holds nothing longer than the page looks at it.

#[cfg(all(target_arch = "wasm32", feature = "bindings"))]
pub mod bindings;
pub mod carried;
pub mod opened;
