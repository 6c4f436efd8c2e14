//! Why a file of motion capture cannot be read.

use std::io;
use std::path::PathBuf;

use mocap::MocapError as Text;
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
    /// Its text is no clip, or it is none of the formats.
    #[error(transparent)]
    Text(#[from] Text),
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
            Self::Text(Text::Format { .. } | Text::Half { .. }) => "E_MOCAP_FORMAT",
            Self::Text(Text::Clip { .. }) => "E_MOCAP_CLIP",
            Self::Text(_) => "E_MOCAP_SYNTAX",
            Self::NoClip { .. } => "E_MOCAP_NO_CLIP",
            Self::Gltf(error) => error.code(),
        }
    }
}
