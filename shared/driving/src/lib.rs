//! Skeletons of motion capture drive the surface of an actor: clips, bodies, feet that are planted, the surface over the bones.
//!
//! ```text
//! Clip -> Mapping -> Source (directions and turns, body part by body part) --\
//!                                                                             Plan (feet planted) -> Surface -> poses
//! Rig, recorded poses -> Body (what its parts look like upright, how its joints bend) --/
//! ```
//!
//! Where a clip joins the recording its ends are edited [`towards`] recorded postures, between the two.
//!
//! Motion goes over by directions and by turns against the upright body, never by local rotations, so that neither the clip's
//! rest pose nor its conventions matter. Knows no file and no thread: frames are made one by one, by the builder and by the
//! page alike; a clip comes from whoever reads it.
//!
//! This work is based on: Tejera, Casas and Hilton, "Animation control of surface motion capture" (2013), section V-A. What
//! differs: the rig is estimated from the capture, feet are planted, and the surface is solved once a frame about its skinned
//! pose instead of in a learned space.

pub mod body;
pub mod bones;
pub mod clip;
pub mod contacts;
mod find;
pub mod foot;
pub mod frames;
mod hints;
pub mod join;
pub mod mapping;
pub mod nearest;
pub mod plan;
pub mod plant;
pub mod pose;
pub mod posture;
pub mod role;
pub mod seen;
pub mod smooth;
pub mod source;
pub mod steps;
pub mod strain;
pub mod strength;
pub mod surface;
pub mod towards;
mod tree;

pub use self::body::Body;
pub use self::bones::BodyError;
pub use self::clip::{Clip, ClipError, ClipJoint, Stance};
pub use self::join::{Apart, Look};
pub use self::mapping::{Mapping, MappingError, MappingFile};
pub use self::nearest::Likeness;
pub use self::plan::Plan;
pub use self::role::Role;
pub use self::seen::{Looker, Seen};
pub use self::strain::Masses;
pub use self::strength::{End, strength};
pub use self::surface::{Solver, Surface, SurfaceError};
pub use self::towards::Aim;
