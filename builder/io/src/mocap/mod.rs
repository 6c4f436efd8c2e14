//! Motion capture: skeletons in motion, from BVH, from ASF with AMC, from the skins of glTF.
//!
//! ```text
//! bvh | asf -> amc | gltf -> Clip in the file's unit -> metres, +Y up, without the pose that says how it was bound
//! ```
//!
//! Whatever a file holds, it is read or refused with its name and line: counts are held against the limits of
//! [`drive::clip`] before memory is reserved.

mod amc;
mod asf;
mod bvh;
mod error;
#[cfg(feature = "gltf")]
mod gltf;
mod skeleton;
mod units;
mod words;

use std::fs;
use std::path::Path;

use drive::Clip;

pub use self::error::MocapError;
use crate::import::{UpAxis, Warning};

/// Larger files are no clips.
const MOST_BYTES: u64 = 512 << 20;

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
    let mut warnings = Vec::new();
    let (clip, path, hint) = match input.split_once('+').filter(|_| !Path::new(input).exists()) {
        Some((skeleton, motion)) => pair(Path::new(skeleton), Path::new(motion), options, &mut warnings)?,
        None => single(Path::new(input), options, &mut warnings)?,
    };
    let clip = if options.up == UpAxis::Z { clip.z_upright() } else { clip };
    let clip = units::in_metres(clip, path, options.unit, hint, &mut warnings);
    let clip = if !options.keep_first && clip.begins_with_pose() {
        let message = format!(
            "{}: the first frame is no motion but the pose in which the skeleton was bound: it is left out (--keep-first)",
            path.display()
        );
        warnings.push(Warning::new("W_MOCAP_FIRST", message));
        clip.without_first()
    } else {
        clip
    };
    Ok(ReadClip { clip, warnings })
}

fn is(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(ending))
}

fn single<'a>(
    path: &'a Path,
    options: &MocapOptions,
    warnings: &mut Vec<Warning>,
) -> Result<(Clip, &'a Path, units::Hint), MocapError> {
    if is(path, "bvh") {
        let clip = bvh::read(path, &bytes(path)?)?;
        let clip = match options.rate {
            Some(rate) => clip.with_rate(rate).map_err(error::clip_error(path))?,
            None => clip,
        };
        return Ok((clip, path, units::Hint::None));
    }
    if is(path, "amc") {
        return Err(MocapError::Half { path: path.to_owned(), missing: "its skeleton (.asf) is missing" });
    }
    if is(path, "asf") {
        return Err(MocapError::Half { path: path.to_owned(), missing: "a motion (.amc) is missing" });
    }
    #[cfg(feature = "gltf")]
    if is(path, "glb") || is(path, "gltf") {
        let clip = gltf::read(path, options.clip.as_deref(), options.rate, warnings)?;
        return Ok((clip, path, units::Hint::Metres));
    }
    let _ = warnings;
    Err(MocapError::Format { path: path.to_owned() })
}

fn pair<'a>(
    skeleton: &'a Path,
    motion: &'a Path,
    options: &MocapOptions,
    warnings: &mut Vec<Warning>,
) -> Result<(Clip, &'a Path, units::Hint), MocapError> {
    let (skeleton, motion) = if is(skeleton, "amc") { (motion, skeleton) } else { (skeleton, motion) };
    if !is(skeleton, "asf") || !is(motion, "amc") {
        let path = if is(skeleton, "asf") { motion } else { skeleton };
        return Err(MocapError::Format { path: path.to_owned() });
    }
    let asf = asf::read(skeleton, &bytes(skeleton)?)?;
    if options.rate.is_none() {
        let message =
            format!("{}: AMC files have no rate: {} frames a second are assumed (--rate)", motion.display(), amc::RATE);
        warnings.push(Warning::new("W_MOCAP_RATE", message));
    }
    let clip = amc::read(motion, &bytes(motion)?, &asf, options.rate.unwrap_or(amc::RATE))?;
    Ok((clip, motion, units::Hint::Asf(asf.length)))
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
