//! Why a file of motion capture cannot be read.

use std::io;
use std::path::{Path, PathBuf};

use drive::ClipError;
use thiserror::Error;

use crate::import::ImportError;

/// Why a file is no clip of motion capture. Each message names the file, the place in it, and what is wrong there.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum MocapError {
    /// The operating system refused to read.
    #[error("{path}: cannot be read: {source}")]
    Io {
        /// The file.
        path: PathBuf,
        /// What the operating system says.
        source: io::Error,
    },
    /// The file is larger than any clip.
    #[error("{path}: the file has {bytes} bytes, more than {most}")]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Its size.
        bytes: u64,
        /// The largest that is read.
        most: u64,
    },
    /// The name ends in nothing that is read.
    #[error("{path}: no motion capture that is read: .bvh, .asf with .amc, .glb or .gltf")]
    Format {
        /// The file.
        path: PathBuf,
    },
    /// An AMC file without its skeleton, or the other way round.
    #[error("{path}: {missing}: name both, as in 02.asf+02_01.amc")]
    Half {
        /// The file.
        path: PathBuf,
        /// What is missing.
        missing: &'static str,
    },
    /// A line that is not written as the format asks.
    #[error("{path}: line {line}: {reason}")]
    Syntax {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// What is wrong.
        reason: String,
    },
    /// The file ends too early.
    #[error("{path}: the file ends in the middle of {what}")]
    Truncated {
        /// The file.
        path: PathBuf,
        /// What it should have gone on with.
        what: String,
    },
    /// What was read is no clip.
    #[error("{path}: {cause}")]
    Clip {
        /// The file.
        path: PathBuf,
        /// Why.
        cause: ClipError,
    },
    /// A glTF file that cannot be read, or has no clip of that name.
    #[error(transparent)]
    Gltf(#[from] ImportError),
    /// A glTF file without a clip that is asked for.
    #[error("{path}: {reason}")]
    NoClip {
        /// The file.
        path: PathBuf,
        /// What is missing, and what there is.
        reason: String,
    },
}

impl MocapError {
    /// A name for its kind that never changes, for scripts.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Self::Io { .. } | Self::TooLarge { .. } => "E_MOCAP_READ",
            Self::Format { .. } | Self::Half { .. } => "E_MOCAP_FORMAT",
            Self::Syntax { .. } | Self::Truncated { .. } => "E_MOCAP_SYNTAX",
            Self::Clip { .. } => "E_MOCAP_CLIP",
            Self::NoClip { .. } => "E_MOCAP_NO_CLIP",
            Self::Gltf(error) => error.code(),
        }
    }
}

/// A clip's fault in a file.
pub(super) fn clip_error(path: &Path) -> impl Fn(ClipError) -> MocapError + '_ {
    move |cause| MocapError::Clip { path: path.to_owned(), cause }
}
