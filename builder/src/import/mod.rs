//! Reads captures from files.
