//! Drawing with wgpu: one mesh over pose buffers, and the passes of a picture in the order in which they run.
//!
//! Knows no page and no player: [`scene::Scene`] is given poses and says what it drew.
//!
//! Every object has a label `reprise.pass.thing`, and every pass is begun by `passes`, where it can be timed.

pub mod appearance;
pub mod context;
pub mod frame;
pub mod ghosts;
pub mod grid;
pub mod marks;
pub mod mesh;
pub mod mix;
mod passes;
pub mod pose;
pub mod readback;
pub mod scans;
pub mod scene;
pub mod shadow;
mod slot;
pub mod target;
pub mod texture;
pub mod thumbnail;
#[cfg(not(target_arch = "wasm32"))]
pub mod timing;
pub mod trail;
