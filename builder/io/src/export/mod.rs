//! Export: the frames of a walk become files that other programs read.
//!
//! ```text
//! Walk -> play (synthesis, frame by frame) -> glb | frames as obj, ply | turntable -> picture -> png
//! ```
//!
//! Frames are written as they are made; only a GLB, which is one file, is held in memory.
//!
//! What goes out is what came in: the files' vertices and faces in their order (`mesh`), their materials by name
//! (`materials`), each frame's own texture (`textures`, `frame_textures`), and, but for GLB, which has metres and +Y up, the
//! files' place, unit and axes.

mod capture;
mod error;
mod frame_textures;
mod glb;
mod glb_file;
mod materials;
mod mesh;
mod obj;
mod output;
mod picture;
mod play;
mod ply;
mod rig_picture;
mod textures;
mod turntable;

pub use capture::{CaptureWriter, WrittenCapture, WrittenSequence};
pub use error::ExportError;
pub use output::Output;
pub use picture::{Picture, Raster};
pub use play::{Played, play, play_from};
pub use rig_picture::rig_picture;

use actor::files::FilePlace;
use actor::surface::Surface;
use bundle::BundleReader;
use glam::Vec3;

use self::mesh::FileMesh;
use self::textures::FrameTextures;
use crate::import::Warning;
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
    /// The most bytes that the textures of a GLB's frames may take once decoded, with their smaller levels. Where they take
    /// more, all frames wear that of the first.
    pub most_texture_bytes: u64,
}

impl Default for ExportOptions {
    fn default() -> Self {
        Self { every: 1, size: (720, 720), turn_seconds: 8.0, most_texture_bytes: 512 << 20 }
    }
}

/// A bundle with all that exports need of it, its images and models of textures included.
pub struct Actor {
    /// What is drawn.
    pub surface: Surface,
    /// Frames per second.
    pub fps: f32,
    /// Name of the subject.
    pub name: String,
    mesh: FileMesh,
    place: FilePlace,
    textures: Option<FrameTextures>,
}

/// What was written.
#[derive(Clone, Debug, PartialEq)]
pub struct Written {
    /// Number of frames.
    pub frames: u32,
    /// What is not as in the actor, or may be mistaken.
    pub warnings: Vec<Warning>,
}

impl Actor {
    /// Takes from a whole bundle what exports need.
    ///
    /// # Errors
    /// A bundle that is not whole, or textures that cannot be read.
    pub fn of(reader: &BundleReader) -> Result<Self, ExportError> {
        let (Some(meta), Some(surface)) = (reader.meta(), reader.surface()) else { return Err(ExportError::NotWhole) };
        Ok(Self {
            surface: surface.clone(),
            fps: meta.fps,
            name: meta.name.clone(),
            mesh: FileMesh::of(reader)?,
            place: reader.file_place(),
            textures: FrameTextures::of(reader, surface)?,
        })
    }

    /// The place, the unit and the axes of the coordinates that are written.
    #[must_use]
    pub fn place(&self) -> FilePlace {
        self.place
    }

    /// For each vertex of OBJ and PLY files that are written, in their order, which one of the poses' it is.
    #[must_use]
    pub fn file_vertices(&self) -> &[u32] {
        &self.mesh.vertices
    }

    /// All frames wear what the recorded `frame` wears, whatever their numbers.
    pub fn wear(&mut self, frame: u32) {
        if let Some(textures) = &mut self.textures {
            textures.worn = Some(frame);
        }
    }

    /// Positions of the drawn mesh's corners of a pose over welded vertices.
    #[must_use]
    pub fn corners(&self, pose: &[Vec3]) -> Vec<Vec3> {
        self.surface.corners.iter().map(|corner| pose[corner.vertex as usize]).collect()
    }
}

/// Writes the frames that `played` makes to `output`.
///
/// # Errors
/// A frame that cannot be made, or a file that cannot be written.
pub fn export(
    actor: &Actor,
    played: &mut Played,
    output: &Output,
    options: &ExportOptions,
    job: &Job,
) -> Result<Written, ExportError> {
    let (pattern, frames) = match output {
        Output::Glb(path) => return glb::write(actor, played, path, options, job),
        Output::Obj(pattern) => (pattern, obj::write(actor, played, pattern, options, job)?),
        Output::Ply(pattern) => (pattern, ply::write(actor, played, pattern, options, job)?),
        Output::Png(pattern) => (pattern, turntable::write(actor, played, pattern, options, job)?),
    };
    let mut warnings = Vec::new();
    let next = pattern.file(frames);
    if next.exists() {
        let message = format!(
            "{} is there from before and is none of the {frames} frames that were written: who reads the folder reads it, \
             too; remove it and those after it",
            next.display()
        );
        warnings.push(Warning::new("W_FRAMES_REMAIN", message));
    }
    Ok(Written { frames, warnings })
}

/// The least and the largest coordinates; both 0 where there is no point.
fn bounds(points: &[Vec3]) -> (Vec3, Vec3) {
    let low = points.iter().copied().reduce(Vec3::min).unwrap_or_default();
    let high = points.iter().copied().reduce(Vec3::max).unwrap_or_default();
    (low, high)
}
