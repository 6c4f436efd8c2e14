//! What can be wrong with a bundle, told apart so that the user knows what to do.

use thiserror::Error;

use super::kind::{SectionKind, VERSION_MAJOR};

/// Why bytes are not a bundle that this library can read.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum BundleError {
    /// The file does not begin like a bundle.
    #[error("this is not a Reprise bundle")]
    NotOurs,
    /// The file was written for a later version of the player.
    #[error("the bundle has format version {major}, but this player reads up to {VERSION_MAJOR}: update the player")]
    TooNew {
        /// Major version of the file.
        major: u16,
    },
    /// The file needs a section that this version does not know.
    #[error("the bundle needs a section of kind {kind} that this player does not know: update the player")]
    UnknownSection {
        /// Number of the kind.
        kind: u16,
    },
    /// Some bytes are not those that were written.
    #[error(
        "the bundle is damaged: {} has checksum {found:08x}, but {expected:08x} was written; fetch it again",
        section_name(*kind, *ordinal)
    )]
    Damaged {
        /// The section; `None` is the header.
        kind: Option<SectionKind>,
        /// Which section of its kind.
        ordinal: u32,
        /// Checksum that the file declares.
        expected: u32,
        /// Checksum of what arrived.
        found: u32,
    },
    /// The file ends too early.
    #[error("the bundle is cut off: {received} of {total} bytes arrived; fetch it again")]
    Truncated {
        /// Bytes that arrived.
        received: u64,
        /// Bytes that the header declares; 0 where the header itself is incomplete.
        total: u64,
    },
    /// The bytes are as they were written, but what they say makes no sense.
    #[error("the bundle contradicts itself: {} {reason}", section_name(*kind, *ordinal))]
    Inconsistent {
        /// The section; `None` is the header.
        kind: Option<SectionKind>,
        /// Which section of its kind.
        ordinal: u32,
        /// What is wrong.
        reason: String,
    },
}

impl BundleError {
    /// Something in the header that makes no sense.
    pub(super) fn header(reason: impl Into<String>) -> Self {
        Self::Inconsistent { kind: None, ordinal: 0, reason: reason.into() }
    }

    /// Something in the only section of `kind` that makes no sense.
    pub(super) fn section(kind: SectionKind, reason: impl Into<String>) -> Self {
        Self::Inconsistent { kind: Some(kind), ordinal: 0, reason: reason.into() }
    }
}

fn section_name(kind: Option<SectionKind>, ordinal: u32) -> String {
    match kind {
        None => "the header".into(),
        Some(kind) if kind.is_repeated() => format!("section {} {ordinal}", kind.name()),
        Some(kind) => format!("section {}", kind.name()),
    }
}

/// Why a capture and its graph cannot be written as a bundle.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum EncodeError {
    /// The frame to be drawn first does not exist.
    #[error("the first frame is {first_frame}, but the capture has {frame_count} frames")]
    FirstFrame {
        /// The frame asked for.
        first_frame: u32,
        /// Frames of the capture.
        frame_count: u32,
    },
    /// The error bound is not a positive length.
    #[error("the largest position error must be a positive length in metres, not {0}")]
    MaxError(f32),
    /// A coordinate is not a number or too far out for the error bound.
    #[error("vertex {vertex} of frame {frame} is not finite, or too far from the origin for this error bound")]
    Position {
        /// The frame.
        frame: u32,
        /// The vertex.
        vertex: u32,
    },
    /// The capture, the graph and the order do not describe the same thing.
    #[error("the parts of the capture do not fit together: {0}")]
    Inconsistent(String),
    /// More of something than the format allows.
    #[error("the capture has {count} {what}, but a bundle holds at most {limit}")]
    TooLarge {
        /// What there is too much of.
        what: &'static str,
        /// How many there are.
        count: u64,
        /// How many there may be.
        limit: u64,
    },
}
