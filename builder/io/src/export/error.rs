//! Why a walk could not be written.

use std::path::{Path, PathBuf};

use actor::pose_source::PoseError;
use actor::walk::WalkError;
use bundle::BundleError;
use kernels::cholesky::CholeskyError;
use thiserror::Error;

/// Why a walk could not be written.
#[derive(Debug, Error)]
pub enum ExportError {
    /// It was asked to stop.
    #[error(transparent)]
    Stopped(#[from] job::Stopped),
    /// The bundle has not arrived in full.
    #[error("the bundle is not whole")]
    NotWhole,
    /// The bundle contradicts itself.
    #[error(transparent)]
    Bundle(#[from] BundleError),
    /// A model of textures cannot be read.
    #[error("section appearance-mode {ordinal} of the bundle {reason}: builder validate says more")]
    Mode {
        /// Which of its kind.
        ordinal: u32,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// One name for many files.
    #[error("{0:?} is one file, but every frame is one: say where its number goes, as in frames/%05d.obj")]
    NoNumber(String),
    /// A name that says no format.
    #[error(
        "{0:?} says no format: name a .glb file, or frames such as frames/%05d.obj, frames/%05d.ply or frames/%05d.png"
    )]
    Format(String),
    /// A picture of a rig that cannot be encoded.
    #[error("the picture of the rig cannot be encoded: {0}")]
    RigPicture(image::ImageError),
    /// A frame could not be made.
    #[error("frame {step} of the walk could not be made: {cause}")]
    Frame {
        /// Steps of the walk before it.
        step: u32,
        /// Why.
        cause: PoseError,
    },
    /// The walk is another bundle's.
    #[error("the walk does not fit the bundle: {0}")]
    Walk(#[from] WalkError),
    /// The mesh cannot be interpolated.
    #[error("the mesh cannot be interpolated: {0}")]
    Mesh(#[from] CholeskyError),
    /// A GLB would be too large.
    #[error(
        "{frames} frames of {corners} vertices make a GLB of {megabytes} MB, but at most {most} are written: take fewer \
         frames with --every, or write them as files of their own"
    )]
    TooLarge {
        /// Frames of the walk that are written.
        frames: u32,
        /// Vertices of each.
        corners: usize,
        /// Size of the file.
        megabytes: u64,
        /// The largest size.
        most: u64,
    },
    /// A texture cannot be decoded.
    #[error("texture {image} cannot be decoded: {cause}")]
    Texture {
        /// Which image of the bundle.
        image: usize,
        /// Why.
        cause: image::ImageError,
    },
    /// A picture cannot be encoded.
    #[error("{} cannot be encoded: {cause}", file.display())]
    Picture {
        /// The file.
        file: PathBuf,
        /// Why.
        cause: image::ImageError,
    },
    /// A file cannot be written.
    #[error("cannot write {}: {cause}", file.display())]
    Write {
        /// The file.
        file: PathBuf,
        /// Why.
        cause: std::io::Error,
    },
}

impl ExportError {
    /// For `map_err` on writing to `file`.
    pub(super) fn write(file: &Path) -> impl FnOnce(std::io::Error) -> Self {
        let file = file.to_owned();
        move |cause| Self::Write { file, cause }
    }
}
