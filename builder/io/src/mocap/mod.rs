//! Motion capture from files: BVH, ASF with AMC, whose text `mocap` reads, and the skins of glTF.

mod error;
#[cfg(feature = "gltf")]
mod gltf;

use std::fs;
use std::path::Path;

use driving::Clip;
use mocap::{MOST_BYTES, Note, Options};

pub use self::error::MocapError;
use crate::import::{UpAxis, Warning};

/// What the user may say about a clip.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MocapOptions {
    /// Frames a second, instead of what the file says; glTF is sampled at it.
    pub rate: Option<f32>,
    /// Metres per unit of the file; told from the body's height where not given.
    pub unit: Option<f32>,
    /// Which axis points up.
    pub up: UpAxis,
    /// The clip of a glTF file; the first where not given.
    pub clip: Option<String>,
    /// Whether a first frame is kept that is no motion.
    pub keep_first: bool,
}

/// A clip, and what the user should know of it.
#[derive(Clone, Debug)]
pub struct ReadClip {
    /// The clip in metres, +Y up.
    pub clip: Clip,
    /// Sentences for the user.
    pub warnings: Vec<Warning>,
}

/// Reads a clip: `walk.bvh`, `02.asf+02_01.amc`, `run.glb`.
///
/// # Errors
/// [`MocapError`].
pub fn read_clip(input: &str, options: &MocapOptions) -> Result<ReadClip, MocapError> {
    let names: Vec<&str> = match input.split_once('+').filter(|_| !Path::new(input).exists()) {
        Some((skeleton, motion)) => vec![skeleton, motion],
        None => vec![input],
    };
    let said = Options {
        rate: options.rate,
        unit: options.unit,
        z_up: options.up == UpAxis::Z,
        keep_first: options.keep_first,
    };
    #[cfg(feature = "gltf")]
    if let [file] = names[..]
        && (mocap::is(file, ".glb") || mocap::is(file, ".gltf"))
    {
        let (mut warnings, mut notes) = (Vec::new(), Vec::new());
        let clip = gltf::read(Path::new(file), options.clip.as_deref(), options.rate, &mut warnings)?;
        let clip = mocap::finished(clip, mocap::Hint::Metres, &said, &mut notes);
        warnings.extend(notes.iter().map(|note| warning(file, note)));
        return Ok(ReadClip { clip, warnings });
    }
    let file = match mocap::kind(&names)? {
        mocap::Kind::Bvh(file) | mocap::Kind::Pair { motion: file, .. } => names[file],
    };
    let texts = names.iter().map(|name| bytes(Path::new(name))).collect::<Result<Vec<_>, _>>()?;
    let files: Vec<(&str, &[u8])> = names.iter().zip(&texts).map(|(&name, text)| (name, text.as_slice())).collect();
    let (clip, notes) = mocap::read(&files, &said)?;
    Ok(ReadClip { clip, warnings: notes.iter().map(|note| warning(file, note)).collect() })
}

/// A note with its code, and the option that says otherwise.
fn warning(file: &str, note: &Note) -> Warning {
    let (code, option) = match note {
        Note::Rate(_) => ("W_MOCAP_RATE", "--rate"),
        Note::First => ("W_MOCAP_FIRST", "--keep-first"),
        _ => ("W_MOCAP_UNIT", "--clip-unit"),
    };
    Warning::new(code, format!("{file}: {note} ({option})"))
}

fn bytes(path: &Path) -> Result<Vec<u8>, MocapError> {
    let io = |source| MocapError::Io { path: path.to_owned(), source };
    let size = fs::metadata(path).map_err(io)?.len();
    if size > MOST_BYTES {
        return Err(MocapError::TooLarge { path: path.to_owned(), bytes: size, most: MOST_BYTES });
    }
    fs::read(path).map_err(io)
}

#[cfg(test)]
mod tests;
