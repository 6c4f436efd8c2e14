//! Bones of a rig by the names that a human's have.

use editing::Rig;
use thiserror::Error;

/// Why a rig is no body that a skeleton can drive.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum BodyError {
    /// A bone that must be there is not.
    #[error(
        "the actor's rig has no bone {0:?}: only a body with two legs can be driven; where it has, give its bones these names \
         with a rig file (builder rig --toml, then --rig)"
    )]
    NoBone(String),
    /// A foot without vertices, or a leg without length.
    #[error("the actor's {0} is too small to be driven")]
    Small(String),
}

/// The bone `name` of `rig`, which must be there.
pub(crate) fn need(rig: &Rig, name: &str) -> Result<usize, BodyError> {
    rig.bones().iter().position(|bone| bone.name == name).ok_or_else(|| BodyError::NoBone(name.into()))
}
