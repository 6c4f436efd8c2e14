//! Import: files that hold a capture become a [`Capture`].
//!
//! ```text
//! inputs, options -> plan -> read -> textures -> assemble -> Capture
//!                     |        |        |           |
//!       inputs, manifest,    frames  pairing,     weld,
//!       pattern, numbered,   (obj,   nearby,      loops
//!       formats              ply,    masks
//!                            looks),
//!                            gltf, stills, places
//! ```
//!
//! What can be read:
//!
//! - **glTF and GLB** (`gltf`): every clip becomes a sequence, baked at [`ImportOptions::fps`] from its first keyframe
//!   to its last. A clip without duration is one frame; a file without clips is one frame. Unnamed animations of which
//!   no two move the same thing are one clip. Numbered files that hold a pose each are one sequence.
//! - **OBJ and PLY**: one file a frame, from a folder, a glob, or a pattern such as `frame_%05d.obj:0:99:2`
//!   (`pattern` has the syntax). Numbered files are played in the order of their numbers, one sequence for each
//!   common name; a gap in the numbers is a warning, except in a pattern's range, whose files must all exist.
//! - **A manifest** (`capture.toml`, or a folder that holds one): many sequences with labels, see
//!   `docs/capture-manifest.md`.
//!
//! Whatever the format, all frames of a capture have the same vertices and faces in the same order, the file's; anything
//! else is an error that names file, frame and face. Positions end up in metres, +Y up. Vertices that share their
//! position in every frame are welded (`weld`); texture coordinates stay with the corners of the drawn surface, with
//! v downwards (OBJ and PLY are turned over).
//!
//! Nothing is silently wrong: what is left aside, guessed, lost or elsewhere is a [`Warning`] with a stable code, and what
//! cannot be read as it is meant is an error (`docs/codes.md`). Textures belong to frames by number, never by their place
//! in a list.
//!
//! Nothing here trusts a file: counts are held against the file's size before memory is reserved, every index is
//! checked, and a fault is an [`ImportError`] with a stable [`ImportError::code`].

mod assemble;
mod beside;
mod bones;
mod colour;
#[cfg(feature = "gltf")]
mod draco;
#[cfg(feature = "gltf")]
mod drc;
mod error;
mod faces;
mod families;
mod folder;
mod formats;
mod frames;
#[cfg(feature = "gltf")]
mod gltf;
#[cfg(not(feature = "gltf"))]
#[path = "no_gltf.rs"]
mod gltf;
mod images;
mod inputs;
#[cfg(feature = "gltf")]
mod ktx2;
#[cfg(feature = "gltf")]
mod layers;
#[cfg(not(feature = "gltf"))]
#[path = "no_layers.rs"]
mod layers;
mod looks;
mod loops;
mod manifest;
mod masks;
mod mesh;
#[cfg(feature = "gltf")]
mod meshopt;
mod mtl;
mod nearby;
mod numbered;
mod obj;
mod pairing;
mod paths;
mod pattern;
mod per_vertex;
mod places;
mod plan;
mod ply;
mod polygon;
mod read;
mod scans;
mod scratch;
mod sheet;
mod stills;
mod text;
mod textures;
mod topologies;
#[cfg(feature = "gltf")]
mod uvol;
mod vologram;
mod warning;
mod weld;
mod worn;

use std::path::PathBuf;

use actor::capture::Capture;
use actor::files::Files;
use glam::DVec3;

pub use self::bones::{FileBone, FileSkeleton};
pub use self::error::ImportError;
pub use self::families::{DEFAULT_SAMPLES, FamilyParameter, FamilySamples, ManifestFamily};
#[cfg(all(feature = "gltf", feature = "mocap"))]
pub(crate) use self::gltf::Skeleton;
pub use self::manifest::UpAxis;
pub use self::scans::{ScannedFrame, ScannedSequence, Scans, scans};
pub use self::scratch::Scratch;
pub use self::sheet::ScannedTexture;
pub use self::warning::Warning;
use job::Job;

/// Frames per second where nothing else is said.
pub const DEFAULT_FPS: f32 = 30.0;

/// What the user may say about a capture; what is given here wins over a manifest.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImportOptions {
    /// Name of the subject; by default the manifest's, or that of the input.
    pub name: Option<String>,
    /// Frames per second: clips are sampled at it, mesh files are played at it. [`DEFAULT_FPS`] by default.
    pub fps: Option<f32>,
    /// Which axis of the input points up; +Y by default.
    pub up: Option<UpAxis>,
    /// Metres per unit of the input; 1 by default.
    pub unit: Option<f32>,
    /// Which sequences' end meets their beginning.
    pub cyclic: Cyclic,
    /// A texture for all frames, or a folder, glob or pattern with one per frame of each sequence.
    pub texture: Option<String>,
    /// A text file with one weight per file vertex, for the planar alignment; barycentric areas by default.
    pub weights: Option<PathBuf>,
    /// Vertices closer than this in every frame are welded, in metres; 1e-5 of the body's size by default.
    pub weld: Option<f32>,
}

/// Which sequences are loops, beside those that a manifest marks.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Cyclic {
    /// Those whose last frame goes on into the first as it goes from frame to frame, and of which a manifest does not say
    /// otherwise.
    #[default]
    Auto,
    /// None, whatever a manifest says.
    None,
    /// Those of these names.
    Names(Vec<String>),
}

/// What an import yields.
#[derive(Clone, Debug, PartialEq)]
pub struct Imported {
    /// The capture.
    pub capture: Capture,
    /// Sentences about what the user should know.
    pub warnings: Vec<Warning>,
    /// The texture file of each frame of the capture, where frames have their own; the first is also the static one.
    pub frame_textures: Option<Vec<PathBuf>>,
    /// For each of these a mask, bright where no camera saw the texel; empty where no frame has one.
    pub frame_masks: Vec<Option<PathBuf>>,
    /// What was taken off all positions so that the capture stands near the origin, in metres, +Y up; whole metres, and
    /// zero unless `W_RECENTRED` is among the warnings. A position plus this is where it was recorded.
    pub offset: DVec3,
    /// What exports need to know of the files.
    pub files: Files,
    /// Families that manifests ask for; their samples are not made yet.
    pub families: Vec<ManifestFamily>,
    /// The number of each vertex's part of the body, where parts were painted.
    pub parts: Option<Vec<u8>>,
    /// The bones that move the surface, where the input has them.
    pub skeleton: Option<FileSkeleton>,
    /// Keeps those of `frame_textures` alive that were written out of glTF files.
    pub scratch: Option<Scratch>,
}

/// Reads a capture from `inputs`: files, folders, globs, frame patterns or manifests, in the order of their sequences.
///
/// The job is told from the calling thread, and asked whether to go on after every few frames. The result does not depend on
/// the number of threads.
///
/// # Errors
/// Anything that cannot be read as one capture; see [`ImportError`].
pub fn import(inputs: &[String], options: &ImportOptions, job: &Job) -> Result<Imported, ImportError> {
    if options.weld.is_some_and(|weld| !(weld >= 0.0 && weld.is_finite())) {
        return Err(ImportError::Option("the welding tolerance must be a length in metres, not negative".into()));
    }
    let mut plan = plan::plan(inputs, options)?;
    let mut warnings = std::mem::take(&mut plan.warnings);
    let mut recording = read::read(&plan, job, &mut warnings)?;
    let own = std::mem::take(&mut recording.textures);
    let (offset, scratch) = (recording.offset, recording.scratch.take());
    let worn = textures::settle(&plan, &mut recording.mesh, &own, &recording.frame_counts, &mut warnings)?;
    let frame_masks = masks::settle(&plan, worn.as_deref(), &recording.frame_counts, &mut warnings)?;
    let frame_textures = worn.map(|worn| worn.into_iter().map(|worn| worn.path).collect());
    job.tell("welding", 0, 1)?;
    let before = recording.frame_counts.clone();
    let assemble::Assembled { capture, faces, dropped, parts } =
        assemble::assemble(&plan, recording, options.weld, &mut warnings)?;
    job.tell("welding", 1, 1)?;
    let frame_textures = frame_textures.map(|textures| without_dropped(textures, &before, &dropped));
    let frame_masks = without_dropped(frame_masks, &before, &dropped);
    let files = Files { faces, place: plan.place(offset) };
    let skeleton = bones::skeleton(&plan, offset, &capture);
    let families = plan.families;
    Ok(Imported { capture, warnings, frame_textures, frame_masks, offset, files, families, parts, skeleton, scratch })
}

/// Takes out what belongs to the last frames of those sequences that lost theirs.
fn without_dropped<T>(of_frames: Vec<T>, frame_counts: &[usize], dropped: &[bool]) -> Vec<T> {
    let mut rest = of_frames.into_iter();
    let mut kept = Vec::new();
    for (&count, &dropped) in frame_counts.iter().zip(dropped) {
        let of_sequence: Vec<T> = rest.by_ref().take(count).collect();
        kept.extend(of_sequence.into_iter().take(count - usize::from(dropped)));
    }
    kept
}
