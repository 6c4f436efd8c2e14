//! Reprise as a library: from files to an actor.

pub mod pack;
