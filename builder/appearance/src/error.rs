//! Why no appearance can be built.

use std::io;
use std::path::PathBuf;

use learn::ScratchError;
use thiserror::Error;

/// Why no appearance can be built; each message names the file, the frame and what to do.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum AppearanceError {
    /// It was asked to stop.
    #[error(transparent)]
    Stopped(#[from] job::Stopped),
    /// There is no frame.
    #[error("there is no texture to build an appearance from")]
    NoFrames,
    /// All frames miss a part.
    #[error(
        "every one of the {frames} textures has texels that were not seen: at least two complete ones are needed, or \
             --appearance static"
    )]
    NoCompleteFrames {
        /// Frames.
        frames: usize,
    },
    /// No triangle wears the texture.
    #[error("no triangle covers a texel: the texture coordinates are all alike, or no material has a texture")]
    NoTexels,
    /// A texture coordinate is no number or absurdly far away.
    #[error("triangle {triangle}: a texture coordinate is not finite or lies more than 64 textures away: export again")]
    Coordinate {
        /// The triangle, from 0.
        triangle: u32,
    },
    /// An image cannot be decoded.
    #[error("{path}, frame {frame}: not a readable image ({reason}): convert or export it again")]
    Image {
        /// The file.
        path: PathBuf,
        /// Frame within the capture, from 0.
        frame: usize,
        /// What the decoder says.
        reason: String,
    },
    /// An image has another size than the first.
    #[error("{path}, frame {frame}: {} x {} texels, but the first frame's texture has {} x {}: all textures and masks \
             of a capture need one size", found.0, found.1, expected.0, expected.1)]
    Size {
        /// The file.
        path: PathBuf,
        /// Frame within the capture, from 0.
        frame: usize,
        /// Its width and height.
        found: (u32, u32),
        /// Those of the first.
        expected: (u32, u32),
    },
    /// The models cannot be stored.
    #[error("the appearance cannot be stored: {0}")]
    Stored(#[from] bundle::EncodeError),
    /// The work folder failed.
    #[error("cannot use the work folder: {source}")]
    Work {
        /// What the operating system says.
        source: io::Error,
    },
    /// The scratch file failed.
    #[error(transparent)]
    Scratch(#[from] ScratchError),
}
