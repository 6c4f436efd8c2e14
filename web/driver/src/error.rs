//! Why an actor cannot be driven, in sentences for the stage.

use driving::{BodyError, ClipError, SurfaceError};
use mocap::MocapError;
use thiserror::Error;

/// Why an actor cannot be driven.
#[derive(Clone, Debug, Error)]
pub enum DriverError {
    /// The actor has no rig.
    #[error("this actor has no bones to be driven by: pack it again with a rig (builder pack --rig)")]
    NoRig,
    /// Its rig cannot be used.
    #[error("the actor's rig cannot be used: {0}")]
    Rig(String),
    /// Its rig is no human's.
    #[error("this actor cannot be driven by a human's motion: {0}")]
    Body(#[from] BodyError),
    /// The files are no clip.
    #[error(transparent)]
    Files(#[from] MocapError),
    /// The skeleton is no human's.
    #[error("{0}: this is no human's motion: the skeleton has no two legs that can be told")]
    NoLegs(String),
    /// The clip is longer than anybody wants to watch in a page.
    #[error("{file}: the clip lasts {seconds} s, but a page performs up to {most} s; cut it first")]
    Long {
        /// The file.
        file: String,
        /// How long it is, in seconds.
        seconds: u32,
        /// How long it may be.
        most: u32,
    },
    /// Nothing recorded is long enough to go on in after the clip.
    #[error("nothing was recorded that is long enough for the actor to go on in after the clip")]
    NoWayBack,
    /// The clip cannot be had at the actor's rate.
    #[error("{file}: {cause}")]
    Clip {
        /// The file.
        file: String,
        /// Why.
        cause: ClipError,
    },
    /// The surface cannot be solved for.
    #[error(transparent)]
    Surface(#[from] SurfaceError),
    /// What was handed over does not fit together.
    #[error("what is known of the actor does not fit together; load the page again")]
    Misfit,
}
