//! Captures and motion capture from files ([`import`], [`mocap`]) and frames to files ([`export`]).

pub mod export;
pub mod import;
#[cfg(feature = "mocap")]
pub mod mocap;
mod png;
