//! The `.reprise` bundle.
