//! Why a request cannot be worked on.

use actor::json::Unread;
use thiserror::Error;

use super::VERSION;
use crate::behaviours::UnknownBehaviour;

/// Why a request cannot be worked on.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum RequestError {
    /// The text is not a request.
    #[error("this is not a request: {0}")]
    Json(String),
    /// The request was written for another version.
    #[error("the request has version {0}, but this version of Reprise knows {VERSION}: update it")]
    Version(u32),
    /// More of something than is allowed.
    #[error("the request has {count} {what}, but at most {limit} are allowed")]
    TooMany {
        /// What there is too much of.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many there may be.
        limit: usize,
    },
    /// A number is not finite or out of range.
    #[error("{what} must be a number from {least} to {most}")]
    Range {
        /// What the number is.
        what: &'static str,
        /// The least it may be.
        least: f64,
        /// The most it may be.
        most: f64,
    },
    /// There is nothing to do.
    #[error("{0} has nothing in it")]
    Empty(&'static str),
    /// A path's points are neither all on the ground nor all in space.
    #[error("point {0} of the path must have two coordinates (x, z) or three (x, y, z), as all others have")]
    Coordinates(usize),
    /// A path has no length.
    #[error("the path has no length: its points are all in one place; draw it longer, or ask for a place instead")]
    NoLength,
    /// A behaviour that the capture does not have.
    #[error(transparent)]
    UnknownBehaviour(#[from] UnknownBehaviour),
    /// A frame that the capture does not have.
    #[error("there is no frame {0}")]
    UnknownFrame(String),
    /// A queue within a queue.
    #[error("a queue cannot hold a queue")]
    Nested,
    /// The search graph is not that of the group of vertices that is to follow the path.
    #[error(
        "the motion of these vertices has not been measured: all paths of a request must be followed by the same ones"
    )]
    OtherGroup,
    /// A vertex that the capture does not have.
    #[error("there is no vertex {0}")]
    UnknownVertex(u32),
}

impl From<Unread> for RequestError {
    fn from(error: Unread) -> Self {
        Self::Json(error.0)
    }
}
