//! Captures from files ([`import`]) and frames to files ([`export`]).

pub mod export;
pub mod import;
mod png;
