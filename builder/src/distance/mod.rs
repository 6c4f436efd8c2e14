//! Pose distances between all pairs of frames.
