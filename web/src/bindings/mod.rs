//! What JavaScript sees: two classes and a function. The only modules that know it.

pub mod direct;
pub mod error;
mod numbers;
pub mod player;
pub mod request;
pub mod stage;
