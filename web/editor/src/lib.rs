//! Editing, apart from the player: the page loads this module when somebody first grabs the actor, or opens a link with edits.
//!
//! ```text
//! player: timeline, mesh, feet -> scene (words) -> session (drags, edited frames) -> positions -> player
//!         rig (bytes), recorded poses ----------------^
//! ```
//!
//! It has a memory of its own and knows no bundle: recorded poses are given to it as it asks for them, and edited ones go back
//! frame by frame. What an edit does is `editing`'s business, the same as in films.

#[cfg(all(target_arch = "wasm32", feature = "bindings"))]
pub mod bindings;
pub mod scene;
pub mod session;
