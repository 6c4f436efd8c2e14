//! What JavaScript sees: two classes and a function. The only modules that know it.

pub mod error;
mod numbers;
pub mod player;
pub mod stage;
