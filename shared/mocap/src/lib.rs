//! Motion capture as text: skeletons in motion, from BVH, from ASF with AMC.
//!
//! ```text
//! bvh | asf -> amc -> Clip in the file's unit -> metres, +Y up, without the pose that says how it was bound
//! ```
//!
//! Whatever a file holds, it is read or refused with its name and line: counts are held against the limits of
//! [`driving::clip`] before memory is reserved.

mod amc;
mod asf;
mod bvh;
mod error;
mod note;
mod skeleton;
mod units;
mod words;

use driving::Clip;

pub use self::error::{MocapError, clip_error};
pub use self::note::Note;
pub use self::units::Hint;

/// Larger files are no clips, in bytes.
pub const MOST_BYTES: u64 = 512 << 20;
/// What is read, here and by the builder.
const KNOWN: &str = ".bvh, .asf with .amc, .glb or .gltf";
const KNOWN_AS_TEXT: &str = ".bvh, or .asf with .amc";

/// What the user may say about a clip.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Options {
    /// Frames a second, instead of what the file says.
    pub rate: Option<f32>,
    /// Metres per unit of the file; told from the body's height where not given.
    pub unit: Option<f32>,
    /// Whether +Z points up.
    pub z_up: bool,
    /// Whether a first frame is kept that is no motion.
    pub keep_first: bool,
}

/// Files by what they are: indices into a list of names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// One BVH file.
    Bvh(usize),
    /// A skeleton and its motion.
    Pair {
        /// The ASF file.
        skeleton: usize,
        /// The AMC file.
        motion: usize,
    },
}

/// What the files `names` are, by their endings.
///
/// # Errors
/// Nothing that is read, or one half of a pair.
pub fn kind(names: &[&str]) -> Result<Kind, MocapError> {
    let find = |ending: &str| names.iter().position(|name| is(name, ending));
    let file = || names.first().copied().unwrap_or("(no file)").to_owned();
    match (find(".asf"), find(".amc"), find(".bvh")) {
        (Some(skeleton), Some(motion), _) if names.len() == 2 => Ok(Kind::Pair { skeleton, motion }),
        (None, None, Some(file)) if names.len() == 1 => Ok(Kind::Bvh(file)),
        (Some(_), None, None) => Err(MocapError::Half { file: file(), missing: "a motion (.amc) is missing" }),
        (None, Some(_), None) => Err(MocapError::Half { file: file(), missing: "its skeleton (.asf) is missing" }),
        _ => Err(MocapError::Format {
            file: file(),
            known: if cfg!(target_arch = "wasm32") { KNOWN_AS_TEXT } else { KNOWN },
        }),
    }
}

/// Whether the name of a file ends so, in whatever letters.
#[must_use]
pub fn is(name: &str, ending: &str) -> bool {
    let tail = name.len().checked_sub(ending.len()).and_then(|at| name.get(at..));
    tail.is_some_and(|tail| tail.eq_ignore_ascii_case(ending))
}

/// Reads a clip from the names and the bytes of its files, in metres, +Y up; and what the user should know of it.
///
/// # Errors
/// [`MocapError`].
pub fn read(files: &[(&str, &[u8])], options: &Options) -> Result<(Clip, Vec<Note>), MocapError> {
    let names: Vec<&str> = files.iter().map(|(name, _)| *name).collect();
    let mut notes = Vec::new();
    let (clip, hint) = match kind(&names)? {
        Kind::Bvh(file) => {
            let (name, bytes) = files[file];
            let clip = bvh::read(name, bytes)?;
            let clip = match options.rate {
                Some(rate) => clip.with_rate(rate).map_err(clip_error(name))?,
                None => clip,
            };
            (clip, Hint::None)
        }
        Kind::Pair { skeleton, motion } => {
            let [(skeleton, bones), (motion, frames)] = [files[skeleton], files[motion]];
            let asf = asf::read(skeleton, bones)?;
            if options.rate.is_none() {
                notes.push(Note::Rate(amc::RATE));
            }
            let clip = amc::read(motion, frames, &asf, options.rate.unwrap_or(amc::RATE))?;
            (clip, Hint::Asf(asf.length))
        }
    };
    Ok((finished(clip, hint, options, &mut notes), notes))
}

/// A clip as it was read becomes one in metres, +Y up, that begins with its motion.
#[must_use]
pub fn finished(clip: Clip, hint: Hint, options: &Options, notes: &mut Vec<Note>) -> Clip {
    let clip = if options.z_up { clip.z_upright() } else { clip };
    let clip = units::in_metres(clip, options.unit, hint, notes);
    if options.keep_first || !clip.begins_with_pose() {
        return clip;
    }
    notes.push(Note::First);
    clip.without_first()
}

#[cfg(test)]
mod tests;
