//! What long work needs, whatever it works on: saying how far it is, and leaving files whole or not at all.

pub mod files;
pub mod memory;
pub mod progress;
