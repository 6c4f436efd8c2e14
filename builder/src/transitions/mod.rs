//! Optimal transitions between all pairs of frames.
