//! Images in the folders of mesh files that name no texture.
//!
//! An image that is named like its frame, or has its name and number, is meant. The only image of a folder is meant for
//! all. Other names are a guess, which is told.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::error::ImportError;
use super::folder::list;
use super::images::is_image;
use super::numbered::{Run, numbers_of, runs};
use super::paths::folder_of;
use super::plan::PlannedSequence;
use super::vologram::folder_of_frame;
use super::warning::Warning;

/// Parts of names of images that are no colours.
const OTHER_MAPS: [&str; 14] = [
    "mask",
    "hidden",
    "normal",
    "_nrm",
    "depth",
    "rough",
    "metal",
    "spec",
    "alpha",
    "opacity",
    "occlusion",
    "_ao",
    "bump",
    "height",
];

/// What lies beside the frames of a sequence: no image, one for all, or one a frame where there is one.
pub(super) fn images(
    sequence: &PlannedSequence,
    frames: &[PathBuf],
    warnings: &mut Vec<Warning>,
) -> Result<Vec<Option<PathBuf>>, ImportError> {
    let Some(first) = frames.first() else { return Ok(Vec::new()) };
    let folder = folder_of_frame(first);
    if frames.iter().any(|frame| folder_of_frame(frame) != folder) {
        return in_own_folders(frames);
    }
    let images = images_in(folder)?;
    let stems: HashMap<_, _> = images.iter().map(|image| (image.file_stem(), image)).collect();
    let like: Vec<Option<PathBuf>> =
        frames.iter().map(|frame| stems.get(&frame.file_stem()).map(|&i| i.clone())).collect();
    if 2 * like.iter().flatten().count() > frames.len() {
        return Ok(like);
    }
    if let [only] = images.as_slice() {
        return Ok(vec![Some(only.clone())]);
    }
    if images.is_empty() {
        return Ok(Vec::new());
    }
    Ok(by_number(sequence, frames, &images, warnings).unwrap_or_else(|| {
        warnings.push(Warning::new(
            "W_TEXTURES_UNPAIRED",
            format!(
                "{}: {} images lie beside the frames of sequence \"{}\", but neither is there only one, nor are they named or \
                 numbered like the frames: none is used; name them with --texture, or texture in a manifest",
                folder.display(),
                images.len(),
                sequence.name
            ),
        ));
        Vec::new()
    }))
}

/// Images of a run whose numbers are those of most frames.
fn by_number(
    sequence: &PlannedSequence,
    frames: &[PathBuf],
    images: &[PathBuf],
    warnings: &mut Vec<Warning>,
) -> Option<Vec<Option<PathBuf>>> {
    let numbers = numbers_of(frames)?;
    let pair = |run: &Run| -> Vec<Option<PathBuf>> {
        let of_number: HashMap<i64, &PathBuf> = run.numbers.iter().copied().zip(&run.files).collect();
        numbers.iter().map(|number| of_number.get(number).map(|&path| path.clone())).collect()
    };
    let fits = |run: &Run| 2 * pair(run).iter().flatten().count() > frames.len();
    let name = runs(frames.to_vec()).first().map(|run| run.name.clone()).unwrap_or_default();
    let mut fitting: Vec<Run> = runs(images.to_vec()).into_iter().filter(fits).collect();
    // A run of the frames' own name is meant, however many digits its numbers have.
    if let Some(own) = fitting.iter().find(|run| run.name == name) {
        return Some(pair(own));
    }
    fitting.retain(|run| !OTHER_MAPS.iter().any(|part| run.name.to_lowercase().contains(part)));
    let [run] = fitting.as_slice() else { return None };
    warnings.push(Warning::new(
        "W_TEXTURES_GUESSED",
        format!(
            "sequence \"{}\": the images {}, ... beside the frames have their numbers and are taken as their textures: if they \
             are not, name the right ones with --texture",
            sequence.name,
            run.files.first().map(|path| path.display().to_string()).unwrap_or_default()
        ),
    ));
    Some(pair(run))
}

/// Each frame in a folder of its own: the image that is named like it, or the only one.
fn in_own_folders(frames: &[PathBuf]) -> Result<Vec<Option<PathBuf>>, ImportError> {
    let one = |frame: &PathBuf| -> Result<Option<PathBuf>, ImportError> {
        let images = images_in(folder_of(frame))?;
        let like = images.iter().find(|image| image.file_stem() == frame.file_stem());
        Ok(match (like, images.as_slice()) {
            (Some(like), _) => Some(like.clone()),
            (None, [only]) => Some(only.clone()),
            _ => None,
        })
    };
    let found = frames.iter().map(one).collect::<Result<Vec<_>, _>>()?;
    Ok(if found.iter().any(Option::is_some) { found } else { Vec::new() })
}

fn images_in(folder: &Path) -> Result<Vec<PathBuf>, ImportError> {
    Ok(list(folder)?.into_iter().filter(|path| is_image(path) && path.is_file()).collect())
}
