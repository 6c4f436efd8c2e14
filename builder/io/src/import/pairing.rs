//! Which image belongs to which frame: by the number in its name, never by its place in a list.

use std::collections::HashMap;
use std::path::PathBuf;

use super::error::ImportError;
use super::numbered::numbers_of;
use super::plan::{NamedImages, PlannedSequence};
use super::warning::Warning;

/// Frames named in a message.
const NAMED: usize = 8;

/// The texture of a frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Worn {
    pub path: PathBuf,
    /// Whether it was made for this frame, or is that of the nearest frame that has one.
    pub own: bool,
}

/// The image of each of the `count` frames of a sequence, among those that the user names; there must be several.
///
/// Images are named like the frames, or have their numbers. Where the user gives a range of numbers, its order counts.
pub(super) fn named(
    images: &NamedImages,
    sequence: &PlannedSequence,
    count: usize,
    warnings: &mut Vec<Warning>,
) -> Result<Vec<Option<PathBuf>>, ImportError> {
    let (files, frames) = (&images.files, sequence.source.files());
    let input = || files.first().map(|path| path.display().to_string()).unwrap_or_default();
    let wrong_count = || ImportError::TextureCount {
        input: input(),
        found: files.len(),
        expected: count,
        sequence: sequence.name.clone(),
    };
    let unpaired = |reason: String| Err(ImportError::TexturePairing { input: input(), reason });
    let numbers = (numbers_of(files), numbers_of(frames));
    if images.in_order || frames.is_empty() {
        if files.len() != count {
            return Err(wrong_count());
        }
        if let (Some(images), Some(frames)) = &numbers
            && images != frames
        {
            warnings.push(Warning::new(
                "W_TEXTURES_IN_ORDER",
                format!(
                    "{}: belongs to {} as the first of its range, for both are given by ranges, and so on: their numbers \
                     are others",
                    input(),
                    frames_path(sequence)
                ),
            ));
        }
        return Ok(files.iter().cloned().map(Some).collect());
    }
    if let Some(same) = same_stems(files, frames) {
        return Ok(same);
    }
    let (Some(image_numbers), Some(frame_numbers)) = numbers else {
        if files.len() != count {
            return Err(wrong_count());
        }
        return unpaired(format!(
            "it cannot be told which of {} textures belongs to which frame of sequence \"{}\": their names are not those of \
             the frames, and do not differ in one number only",
            files.len(),
            sequence.name
        ));
    };
    let of_number: HashMap<i64, &PathBuf> = image_numbers.iter().copied().zip(files).collect();
    if of_number.len() < files.len() {
        return unpaired(format!("two textures of sequence \"{}\" have one number", sequence.name));
    }
    let paired: Vec<Option<PathBuf>> =
        frame_numbers.iter().map(|number| of_number.get(number).map(|&path| path.clone())).collect();
    let (found, range) = (paired.iter().flatten().count(), |numbers: &[i64]| {
        format!("{} to {}", numbers.iter().min().unwrap_or(&0), numbers.iter().max().unwrap_or(&0))
    });
    if found < count && (found == 0 || is_shifted(&image_numbers, &frame_numbers)) {
        return unpaired(format!(
            "textures are numbered {}, but the frames of sequence \"{}\" {}",
            range(&image_numbers),
            sequence.name,
            range(&frame_numbers)
        ));
    }
    if found < files.len() {
        let unused = files.iter().zip(&image_numbers).find(|(_, number)| !frame_numbers.contains(number));
        let unused = unused.map(|(path, _)| path.display().to_string()).unwrap_or_default();
        warnings.push(Warning::new(
            "W_TEXTURES_UNUSED",
            format!(
                "{} of {} textures have numbers that no frame of sequence \"{}\" has, the first of them {unused}",
                files.len() - found,
                files.len(),
                sequence.name
            ),
        ));
    }
    Ok(paired)
}

fn frames_path(sequence: &PlannedSequence) -> String {
    sequence.source.path().display().to_string()
}

/// Whether both are as many, and each number is as far from its counterpart: then it may be meant so.
fn is_shifted(a: &[i64], b: &[i64]) -> bool {
    let sorted = |numbers: &[i64]| {
        let mut numbers = numbers.to_vec();
        numbers.sort_unstable();
        numbers
    };
    let (a, b) = (sorted(a), sorted(b));
    let shift = |(a, b): (&i64, &i64)| i128::from(*a) - i128::from(*b);
    let mut shifts = a.iter().zip(&b).map(shift);
    let first = shifts.next();
    a.len() == b.len() && first != Some(0) && shifts.all(|shift| Some(shift) == first)
}

/// The image of each frame that is named like it but for the ending; `None` where that is not so for all.
fn same_stems(images: &[PathBuf], frames: &[PathBuf]) -> Option<Vec<Option<PathBuf>>> {
    let of_stem: HashMap<_, _> = images.iter().map(|image| (image.file_stem(), image)).collect();
    let same: Option<Vec<PathBuf>> =
        frames.iter().map(|frame| of_stem.get(&frame.file_stem()).map(|&i| i.clone())).collect();
    Some(same?.into_iter().map(Some).collect())
}

/// The textures of all frames of a sequence, where some may have lost theirs: these wear that of the nearest frame before
/// them, or else after them. `None` where none has any.
pub(super) fn filled(
    textures: &[Option<PathBuf>],
    sequence: &PlannedSequence,
    warnings: &mut Vec<Warning>,
) -> Option<Vec<Worn>> {
    let first = textures.iter().flatten().next()?;
    let mut last = first.clone();
    let mut worn = Vec::with_capacity(textures.len());
    for texture in textures {
        if let Some(texture) = texture {
            last.clone_from(texture);
        }
        worn.push(Worn { path: last.clone(), own: texture.is_some() });
    }
    let lost: Vec<usize> = (0..textures.len()).filter(|&frame| textures[frame].is_none()).collect();
    if !lost.is_empty() {
        let named: Vec<String> = lost.iter().take(NAMED).map(|&frame| frame_name(sequence, frame)).collect();
        let more = if lost.len() > NAMED { format!(" and {} more", lost.len() - NAMED) } else { String::new() };
        warnings.push(Warning::new(
            "W_TEXTURE_LOST",
            format!(
                "sequence \"{}\": no texture for {} of {} frames ({}{more}): they wear that of the nearest frame before \
                 them, or else after them",
                sequence.name,
                lost.len(),
                textures.len(),
                named.join(", ")
            ),
        ));
    }
    Some(worn)
}

fn frame_name(sequence: &PlannedSequence, frame: usize) -> String {
    let file = sequence.source.files().get(frame).and_then(|path| path.file_name());
    file.map_or(format!("frame {frame}"), |name| name.to_string_lossy().into_owned())
}

/// The numbers of textures, as far as they are those of their own frames.
pub(super) fn numbers_worn(worn: &[Worn]) -> Vec<Option<i64>> {
    let own: Vec<PathBuf> = worn.iter().filter(|worn| worn.own).map(|worn| worn.path.clone()).collect();
    let mut numbers = numbers_of(&own).map(Vec::into_iter);
    worn.iter().map(|worn| numbers.as_mut().filter(|_| worn.own).and_then(Iterator::next)).collect()
}
