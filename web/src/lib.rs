//! The player: search, synthesis and rendering in the browser.
//!
//! ```text
//! bytes -> player (bundle, clock, walk, poses) -> gpu (what changed, the passes of a picture) -> canvas
//! ```
//!
//! The page drives it: `player` is told the time and says whether the picture changed, `gpu` draws what the player
//! shows. Only `bindings` knows JavaScript; `player` knows no GPU, `gpu` no player, and neither knows the page. All but
//! `bindings` compiles and is tested natively.

#[cfg(target_arch = "wasm32")]
pub mod bindings;
pub mod brought;
pub mod camera;
pub mod gpu;
pub mod pick;
pub mod player;
pub mod shaders;
pub mod trail;
