//! Skeletons of motion capture drive the surface of an actor.
//!
//! ```text
//! Clip -> Mapping -> Source (directions and turns, body part by body part) --\
//!                                                                             Retarget -> plant -> Surface -> poses
//! Rig, recorded poses -> Body (what its parts look like upright, how its joints bend) --/
//! ```
//!
//! Motion goes over by directions and by turns against the upright body, never by local rotations, so that neither the clip's
//! rest pose nor its conventions matter. Knows no file; a clip comes from whoever reads it.
//!
//! This work is based on: Tejera, Casas and Hilton, "Animation control of surface motion capture" (2013), section V-A. What
//! differs: the rig is estimated from the capture, feet are planted, and the surface is solved once a frame about its skinned
//! pose instead of in a learned space.

pub mod body;
pub mod clip;
pub mod contacts;
mod find;
pub mod foot;
pub mod frames;
mod hints;
pub mod mapping;
pub mod measure;
pub mod nearest;
pub mod plant;
pub mod pose;
pub mod posture;
pub mod retarget;
pub mod role;
pub mod smooth;
pub mod source;
pub mod steps;
pub mod surface;
mod tree;

pub use self::body::{Body, BodyError};
pub use self::clip::{Clip, ClipError, ClipJoint, Stance};
pub use self::mapping::{Mapping, MappingError, MappingFile};
pub use self::measure::Measures;
pub use self::retarget::{Driven, retarget};
pub use self::role::Role;
