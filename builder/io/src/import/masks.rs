//! Which frames have a mask of what no camera saw.
//!
//! A mask belongs to the frame whose texture has the same number in its name; frames without one were seen in full, as far
//! as masks say.

use std::path::{Path, PathBuf};

use super::error::ImportError;
use super::images::size_of;
use super::numbered::numbers_of;
use super::pairing::{Worn, numbers_worn};
use super::plan::Plan;
use super::warning::Warning;

/// The mask of each frame of the capture; empty where no sequence has any.
///
/// `textures` are those of all frames, `frame_counts` the sequences' frames.
pub(super) fn settle(
    plan: &Plan,
    textures: Option<&[Worn]>,
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
        let numbers = mask_numbers(&sequence.masks)?;
        let of_texture = numbers_worn(own);
        for (mask, number) in sequence.masks.iter().zip(numbers) {
            let frame = frame_of(mask, number, &of_texture)?;
            let wrong = |reason: String| ImportError::Mask { path: mask.clone(), reason };
            let (found, expected) = (size_of(mask)?, size_of(&own[frame].path)?);
            if found != expected {
                let texture = own[frame].path.display();
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

/// The numbers of all masks of a sequence.
fn mask_numbers(masks: &[PathBuf]) -> Result<Vec<i64>, ImportError> {
    let alone = |mask: &PathBuf| numbers_of(std::slice::from_ref(mask)).and_then(|numbers| numbers.first().copied());
    let each = || masks.iter().map(alone).collect::<Option<Vec<_>>>();
    numbers_of(masks).or_else(each).ok_or_else(|| {
        let nameless = masks.iter().find(|mask| alone(mask).is_none()).or(masks.first());
        ImportError::Mask {
            path: nameless.cloned().unwrap_or_default(),
            reason: "its name holds no frame's number".into(),
        }
    })
}

/// The frame, among those whose textures have `numbers`, whose number `mask` has.
fn frame_of(mask: &Path, number: i64, numbers: &[Option<i64>]) -> Result<usize, ImportError> {
    let wrong = |reason: String| ImportError::Mask { path: mask.to_owned(), reason };
    let mut those = (0..numbers.len()).filter(|&frame| numbers[frame] == Some(number));
    match (those.next(), those.next()) {
        (Some(frame), None) => Ok(frame),
        (None, _) => Err(wrong(format!("no texture of its sequence has the number {number}"))),
        (Some(_), Some(_)) => Err(wrong(format!("several textures of its sequence have the number {number}"))),
    }
}
