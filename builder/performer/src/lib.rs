//! The built-in performer: a clothed figure made by program, and the capture of its performance.
//!
//! It is written as any user would bring a capture: a folder with a manifest, mesh files for every frame and a texture,
//! and beside them the ground truth that no camera gives: joints, planted feet and every artefact that was added.
//!
//! ```text
//! skeleton -> body (implicit) -> polygonise -> remesh -> skin, skirt, atlas, paint      the figure, once
//! motion (gait or keys, feet) -> skeleton -> hair, cloth -> skin -> artefacts -> write   every take
//! ```
//!
//! Everything depends on the options alone: the same options give the same bytes, whatever the number of threads.

pub mod artefacts;
pub mod between;
pub mod body;
pub mod build;
mod charts;
pub mod cloth;
pub mod curve;
pub mod feet;
pub mod figure;
pub mod gait;
pub mod hair;
mod lattice;
pub mod motion;
pub mod paint;
pub mod perform;
mod scanned;
pub mod skeleton;
pub mod skinning;
pub mod skirt;
mod write;

#[cfg(test)]
mod tests;

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use thiserror::Error;

pub use artefacts::Artefacts;
pub use build::Kind;
pub use scanned::{ScannedOptions, write_scanned};

/// What to perform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PerformerOptions {
    /// Frames of the whole capture, shared by its sequences.
    pub frames: usize,
    /// Vertices of the surface; there are twice as many triangles, less four.
    pub vertices: usize,
    /// Width and height of the texture in texels.
    pub texture_size: usize,
    /// Capture artefacts.
    pub artefacts: Artefacts,
    /// Seed of everything that varies from take to take and from stride to stride.
    pub seed: u64,
    /// Frames per second.
    pub fps: f32,
    /// Who performs.
    pub figure: Kind,
}

impl Default for PerformerOptions {
    fn default() -> Self {
        Self {
            frames: 1200,
            vertices: 5000,
            texture_size: 1024,
            artefacts: Artefacts::default(),
            seed: 1,
            fps: 50.0,
            figure: Kind::Woman,
        }
    }
}

/// What was written.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Summary {
    /// The manifest that `builder pack` reads.
    pub manifest: PathBuf,
    /// Frames.
    pub frames: usize,
    /// Vertices of each frame.
    pub vertices: usize,
    /// Triangles of each frame.
    pub triangles: usize,
    /// Names and numbers of frames of the sequences, in order.
    pub sequences: Vec<(String, usize)>,
}

/// Why no capture was written.
#[derive(Debug, Error)]
pub enum PerformerError {
    /// An option is outside of what can be made.
    #[error("{option} is {value}, but must be from {low} to {high}")]
    Option {
        /// The option, as on the command line.
        option: &'static str,
        /// What was asked for.
        value: f64,
        /// Least.
        low: f64,
        /// Greatest.
        high: f64,
    },
    /// A file could not be written.
    #[error("cannot write {path}: {source}; is there room, and may the folder be written?")]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// An image could not be encoded.
    #[error("cannot encode {path}: {source}")]
    Image {
        /// The file.
        path: PathBuf,
        /// Why.
        source: image::ImageError,
    },
}

/// How far the work is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Frames written so far; 0 while the figure is made.
    pub frames_done: usize,
    /// Frames in all.
    pub frames: usize,
}

/// Performs with `options` and writes the capture into the folder `out`, which is made if it is missing.
///
/// Writes `capture.toml` (last, so that a folder with it is complete), `texture.png` or a texture per frame, a folder
/// of binary PLY files per sequence, and `truth/`. `progress` may be called from any thread.
///
/// # Errors
/// Options out of range, or a file that cannot be written.
pub fn write_performer(
    options: &PerformerOptions,
    out: &Path,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<Summary, PerformerError> {
    check(options)?;
    progress(Progress { frames_done: 0, frames: options.frames });
    let figure = figure::Figure::of(options.figure, options.vertices, options.texture_size);
    let takes = perform::takes(options.frames, options.fps, options.seed);
    let writer = write::Writer::new(&figure, options, out)?;
    let done = AtomicUsize::new(0);
    takes.par_iter().try_for_each(|take| {
        let frames = perform::perform(&figure, take, options.fps);
        writer.take(take, &frames, &|| {
            let frames_done = done.fetch_add(1, Ordering::Relaxed) + 1;
            progress(Progress { frames_done, frames: options.frames });
        })
    })?;
    let manifest = writer.finish(&takes)?;
    Ok(Summary {
        manifest,
        frames: options.frames,
        vertices: figure.mesh.positions.len(),
        triangles: figure.mesh.triangles.len(),
        sequences: takes.into_iter().map(|take| (take.name, take.frames)).collect(),
    })
}

fn check(options: &PerformerOptions) -> Result<(), PerformerError> {
    let ranges = [
        ("--frames", options.frames as f64, 1.0, 100_000.0),
        ("--vertices", options.vertices as f64, 1_500.0, 60_000.0),
        ("--texture-size", options.texture_size as f64, 128.0, 8_192.0),
        ("--rate", f64::from(options.fps), 10.0, 240.0),
    ];
    for (option, value, low, high) in ranges {
        if !(low..=high).contains(&value) {
            return Err(PerformerError::Option { option, value, low, high });
        }
    }
    Ok(())
}
