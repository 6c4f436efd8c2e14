//! Skeletons of motion capture drive an actor, with all processors: the recording is looked at, the frames are made, and they are
//! measured. What is done is `driving`'s business, the same as in the page.

pub mod measure;
pub mod retarget;

pub use driving::{Body, BodyError, Clip, ClipError, ClipJoint, Mapping, MappingError, MappingFile, Role, Stance};

pub use self::measure::Measures;
pub use self::retarget::{Driven, body, retarget};
