//! Synthesis of a walk, frame by frame.
