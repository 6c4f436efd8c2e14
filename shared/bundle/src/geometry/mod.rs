//! Positions: rounded to a grid, predicted from neighbours and in time, coded frame by frame.
//!
//! A vertex is visited when many of its neighbours have been ([`traversal`]) and predicted by a weighted sum of up to
//! eight of them; the weights are learnt over the whole capture ([`training`]) and stored ([`model`]). Every few frames
//! one is coded by itself, those between as differences from the mean of two others ([`schedule`]), so that decoding
//! any frame touches at most three others in groups of four. All arithmetic is on integers that wrap: native and wasm
//! agree bit for bit, and no stream of bytes can make it panic.
//!
//! What is new here is little: prediction along a traversal is C. Touma and C. Gotsman, "Triangle mesh compression"
//! (1998); learnt prediction weights are S. Gumhold and R. Amjoun, "Higher order prediction for geometry compression"
//! (2003), there per mesh, here per vertex, because a capture repeats every vertex over all its frames.

pub mod decode;
pub mod encode;
pub mod model;
pub mod quantise;
pub mod schedule;
pub mod training;
pub mod traversal;

pub use kernels::codec::Steps;
