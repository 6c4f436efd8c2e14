//! What JavaScript sees: two classes and a function. The only modules that know it.

pub mod direct;
pub mod edit;
pub mod error;
pub mod player;
mod scans;
pub mod stage;
