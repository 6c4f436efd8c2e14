//! `builder pack`: the whole pipeline.
