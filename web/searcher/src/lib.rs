//! Searching, apart from the player: the page loads this module when somebody first asks for more than a pose.
//!
//! ```text
//! player: graph, timeline, motion -> scene (words) -> searcher (slices of a search) -> report (JSON), walk (numbers) -> player
//! ```
//!
//! The two modules have a memory each, so what a search needs of the actor is handed over once, and walks come back as
//! numbers. What both write for the page (`page`, `report`) is written here; the player links it from here.

#[cfg(all(target_arch = "wasm32", feature = "bindings"))]
pub mod bindings;
#[cfg(target_arch = "wasm32")]
pub mod page;
pub mod report;
pub mod scene;
pub mod searcher;
pub mod walk;
pub mod words;
