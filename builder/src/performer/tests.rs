//! The performer as a whole.
