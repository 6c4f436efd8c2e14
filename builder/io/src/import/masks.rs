//! Which frames have a mask of what no camera saw.
//!
//! A mask belongs to the frame whose texture has the same number at the end of its name; frames without one were seen in
//! full, as far as masks say.

use std::path::{Path, PathBuf};

use super::error::ImportError;
use super::images::size_of;
use super::numbered::prefix_and_number;
use super::plan::Plan;
use super::warning::Warning;

/// The mask of each frame of the capture; empty where no sequence has any.
///
/// `textures` are those of all frames, `frame_counts` the sequences' frames.
pub(super) fn settle(
    plan: &Plan,
    textures: Option<&[PathBuf]>,
    frame_counts: &[usize],
    warnings: &mut Vec<Warning>,
) -> Result<Vec<Option<PathBuf>>, ImportError> {
    let Some(named) = plan.sequences.iter().find(|sequence| !sequence.masks.is_empty()) else { return Ok(Vec::new()) };
    let Some(textures) = textures else {
        warnings.push(Warning::new(
            "W_MASKS_UNUSED",
            format!(
                "sequence \"{}\" has masks, but frames have no textures of their own: masks are ignored",
                named.name
            ),
        ));
        return Ok(Vec::new());
    };
    let mut all = vec![None; textures.len()];
    let mut first = 0;
    for (sequence, &count) in plan.sequences.iter().zip(frame_counts) {
        let own = textures.get(first..first + count).unwrap_or_default();
        for mask in &sequence.masks {
            let frame = frame_of(mask, own)?;
            let wrong = |reason: String| ImportError::Mask { path: mask.clone(), reason };
            let (found, expected) = (size_of(mask)?, size_of(&own[frame])?);
            if found != expected {
                let texture = own[frame].display();
                let ([w, h], [x, y]): ([u32; 2], [u32; 2]) = (found.into(), expected.into());
                return Err(wrong(format!(
                    "frame {frame} of sequence \"{}\": {w} x {h} pixels, but its texture {texture} has {x} x {y}",
                    sequence.name
                )));
            }
            if all[first + frame].replace(mask.clone()).is_some() {
                return Err(wrong(format!("frame {frame} of sequence \"{}\" has a mask already", sequence.name)));
            }
        }
        first += count;
    }
    Ok(all)
}

/// The frame, among those that wear `textures`, whose number `mask` has.
fn frame_of(mask: &Path, textures: &[PathBuf]) -> Result<usize, ImportError> {
    let wrong = |reason: String| ImportError::Mask { path: mask.to_owned(), reason };
    let number =
        prefix_and_number(mask).1.ok_or_else(|| wrong("its name does not end with a frame's number".into()))?;
    let mut those = (0..textures.len()).filter(|&frame| prefix_and_number(&textures[frame]).1 == Some(number));
    match (those.next(), those.next()) {
        (Some(frame), None) => Ok(frame),
        (None, _) => Err(wrong(format!("no texture of its sequence has the number {number}"))),
        (Some(_), Some(_)) => Err(wrong(format!("several textures of its sequence have the number {number}"))),
    }
}
