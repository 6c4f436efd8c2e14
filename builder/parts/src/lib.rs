//! The parts of a body: a torso and limbs that overlap where they are joined, found from the shape and from how it moves.
//!
//! ```text
//! extremities (hills of the distance from the middle) -> hinge (where a limb turns no more) -> band (weights, discs and cylinders)
//! ```
//!
//! Thesis section 5.4.2 paints five parts by hand; here nothing is known of the body. A limb is a disc and the band in which it
//! overlaps the torso a cylinder, wherever the mesh allows it. The highest extremity, the head, stays with the torso, as in the thesis. A
//! body without limbs has one part. Parts may also be painted, as many as one likes. Knows no file.

mod band;
mod body;
mod extremities;
mod hinge;
mod measured;
mod names;
mod painted;
mod shape;

pub use crate::band::Limb;
pub use crate::body::Parts;
pub use crate::shape::{Shape, shape_of};
