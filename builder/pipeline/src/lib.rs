//! The stages from poses to the essential graph: distances -> transitions -> essential edges -> graph.

pub mod contacts;
pub mod distance;
pub mod essential;
pub mod feet;
pub mod graph;
pub mod ties;
pub mod transitions;
