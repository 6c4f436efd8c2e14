//! Export: the frames of a walk become files that other programs read.
//!
//! ```text
//! Walk -> play (synthesis, frame by frame) -> glb | frames as obj, ply | turntable -> picture -> png
//! ```
//!
//! Frames are written as they are made; only a GLB, which is one file, is held in memory.

mod error;
mod glb;
mod obj;
mod output;
mod picture;
mod play;
mod ply;
mod turntable;

pub use error::ExportError;
pub use output::Output;
pub use picture::{Picture, Raster};
pub use play::{Played, play};

use actor::surface::Surface;
use bundle::BundleReader;
use glam::Vec3;

use job::Job;

/// How a walk is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExportOptions {
    /// Every how many frames one is written; at least 1. Fewer frames make smaller files.
    pub every: u32,
    /// Width and height of a turntable's pictures in pixels.
    pub size: (u32, u32),
    /// Seconds in which the turntable turns once.
    pub turn_seconds: f32,
}

impl Default for ExportOptions {
    fn default() -> Self {
        Self { every: 1, size: (720, 720), turn_seconds: 8.0 }
    }
}

/// A bundle with all that exports need of it, its images included.
pub struct Actor {
    /// What is drawn.
    pub surface: Surface,
    /// Frames per second.
    pub fps: f32,
    /// Name of the subject.
    pub name: String,
}

impl Actor {
    /// Takes from a whole bundle what exports need.
    ///
    /// # Errors
    /// A bundle that is not whole.
    pub fn of(reader: &BundleReader) -> Result<Self, ExportError> {
        let (Some(meta), Some(surface)) = (reader.meta(), reader.surface()) else { return Err(ExportError::NotWhole) };
        Ok(Self { surface: surface.clone(), fps: meta.fps, name: meta.name.clone() })
    }

    /// Positions of the drawn mesh's corners of a pose over welded vertices.
    #[must_use]
    pub fn corners(&self, pose: &[Vec3]) -> Vec<Vec3> {
        self.surface.corners.iter().map(|corner| pose[corner.vertex as usize]).collect()
    }
}

/// Writes the frames that `played` makes to `output`; returns how many were written.
///
/// # Errors
/// A frame that cannot be made, or a file that cannot be written.
pub fn export(
    actor: &Actor,
    played: &mut Played,
    output: &Output,
    options: &ExportOptions,
    job: &Job,
) -> Result<u32, ExportError> {
    match output {
        Output::Glb(path) => glb::write(actor, played, path, options, job),
        Output::Obj(pattern) => obj::write(actor, played, pattern, options, job),
        Output::Ply(pattern) => ply::write(actor, played, pattern, options, job),
        Output::Png(pattern) => turntable::write(actor, played, pattern, options, job),
    }
}

/// The least and the largest coordinates; both 0 where there is no point.
fn bounds(points: &[Vec3]) -> (Vec3, Vec3) {
    let low = points.iter().copied().reduce(Vec3::min).unwrap_or_default();
    let high = points.iter().copied().reduce(Vec3::max).unwrap_or_default();
    (low, high)
}
