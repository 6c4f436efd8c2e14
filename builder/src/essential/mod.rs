//! The essential graph.
