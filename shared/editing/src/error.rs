//! Why an edit cannot be made.

use actor::json::Unread;
use actor::pose_source::PoseError;
use kernels::cholesky::CholeskyError;
use thiserror::Error;

/// Why an edit cannot be made.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum EditError {
    /// The text is no document of edits.
    #[error("this is not a document of edits: {0}")]
    Json(String),
    /// The document was written for another version.
    #[error("the edits have version {found}, but this version of Reprise knows {known}: update it")]
    Version {
        /// The document's version.
        found: u64,
        /// The version that is known.
        known: u32,
    },
    /// More of something than is allowed.
    #[error("{what}: there are {count}, but at most {limit} are allowed")]
    TooMany {
        /// What there is too much of.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many there may be.
        limit: usize,
    },
    /// A sequence that the capture does not have.
    #[error("edit {edit}: there is no sequence {name:?}; there are: {known}")]
    Sequence {
        /// Which edit, from 0.
        edit: usize,
        /// The name.
        name: String,
        /// The names that there are.
        known: String,
    },
    /// A frame that the sequence does not have.
    #[error("edit {edit}: {name:?} has {count} frames, counted from 0, and no frame {frame}")]
    Frame {
        /// Which edit, from 0.
        edit: usize,
        /// The sequence.
        name: String,
        /// The frame.
        frame: u32,
        /// How many frames it has.
        count: u32,
    },
    /// A vertex that the mesh does not have.
    #[error("edit {edit}: there is no vertex {vertex}: the mesh has {count}, counted from 0")]
    Vertex {
        /// Which edit, from 0.
        edit: usize,
        /// The vertex.
        vertex: u32,
        /// How many vertices the mesh has.
        count: usize,
    },
    /// An edit that says nothing, or twice the same.
    #[error("edit {edit}: {reason}")]
    Edit {
        /// Which edit, from 0.
        edit: usize,
        /// What is wrong and what to do.
        reason: &'static str,
    },
    /// A rig whose parts do not fit together.
    #[error("this is not a rig: {0}")]
    Rig(String),
    /// A learned space whose parts do not fit together.
    #[error("this is not a learned space: {0}")]
    Space(String),
    /// A surface that cannot be solved for.
    #[error("the surface cannot be edited: {0}")]
    Surface(#[from] CholeskyError),
}

impl From<Unread> for EditError {
    fn from(error: Unread) -> Self {
        Self::Json(error.0)
    }
}

impl EditError {
    /// The same, of the edit of this index.
    #[must_use]
    pub fn of_edit(self, index: usize) -> Self {
        match self {
            Self::Vertex { vertex, count, .. } => Self::Vertex { edit: index, vertex, count },
            Self::Edit { reason, .. } => Self::Edit { edit: index, reason },
            other => other,
        }
    }
}

/// Why an edited frame cannot be made.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PreparedError {
    /// The recorded frame cannot be read.
    #[error(transparent)]
    Pose(#[from] PoseError),
    /// The edit cannot be made.
    #[error(transparent)]
    Edit(#[from] EditError),
}
