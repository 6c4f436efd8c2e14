//! The built-in performer.
