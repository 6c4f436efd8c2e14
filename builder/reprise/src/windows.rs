//! `--mode windows`: the frames of a scan as they were scanned, cleaned as registration reads them, for the bundle.
//!
//! ```text
//! Scans -> one frame, cleaned, with its still -> keyframe groups -> code_group -> ScannedFrames; bytes -> disk
//! ```

use std::collections::HashMap;
use std::io;

use bundle::{CodedGroup, GROUP_FRAMES, ScannedCorner, ScannedFrames, ScannedGroup, code_group};
use capture_io::import::{ImportError, Scans};
use glam::Vec3;
use job::Job;
use rayon::prelude::*;
use registration::register::cleaned;
use registration::scan::Cleaned;
use serde::Serialize;

use crate::options::PackError;
use crate::scans::{Frames, RegisterError};

/// Frames that are read side by side; no more are in memory.
const BATCH: usize = 16;

/// What the bundle holds of the frames as they were scanned.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ScannedSummary {
    /// Frames that are shown as they were scanned.
    pub frames: u32,
    /// Meshes that are stored: frames of one keyframe group share theirs, a few at a time.
    pub groups: usize,
    /// Bytes of a frame, on average: its mesh, or its share of it, and its image.
    pub bytes_per_frame: f64,
    /// Bytes of those that are images.
    pub images_per_frame: f64,
    /// Largest error of a position along each axis, in metres.
    pub max_error: f64,
}

/// The frames `written` of `scans`, in this order, less `offset`, with positions as multiples of `step`; `take` is given each group's bytes,
/// so that no more than a few are in memory.
pub(crate) fn scanned_frames(
    scans: &Scans,
    written: &[usize],
    (offset, step): (Vec3, f32),
    job: &Job,
    take: &mut dyn FnMut(&[u8]) -> io::Result<()>,
) -> Result<(ScannedFrames, ScannedSummary), PackError> {
    let (mut all, mut images, mut open) = (ScannedFrames::default(), 0, None);
    let numbered: Vec<(u32, usize)> = (0..).zip(written.iter().copied()).collect();
    for (number, batch) in numbered.chunks(BATCH).enumerate() {
        job.tell("scanned frames", (number * BATCH) as u64, written.len() as u64)?;
        let read: Vec<Result<Option<ScannedGroup>, RegisterError>> =
            batch.par_iter().map(|&(frame, of_scan)| alone(scans, of_scan, frame, offset)).collect();
        let mut ready = Vec::new();
        for found in read {
            // A frame without a surface was lost before.
            let Some(found) = found? else { continue };
            match open.take() {
                None => open = Some(found),
                Some(before) => match joined(before, found) {
                    Ok(both) => open = Some(both),
                    Err(two) => {
                        let (before, found) = *two;
                        ready.push(before);
                        open = Some(found);
                    }
                },
            }
        }
        let last = (number + 1) * BATCH >= numbered.len();
        ready.extend(last.then(|| open.take()).flatten());
        let coded: Vec<_> = ready.par_iter().map(|group| code_group(group, step)).collect();
        for coded in coded {
            let coded: CodedGroup = coded?;
            images += images_of(&coded);
            take(&coded.bytes).map_err(|source| ImportError::Io { path: std::env::temp_dir(), source })?;
            all.push_elsewhere(&coded);
        }
    }
    let frames = all.index().frame_count();
    let share = |bytes: u64| bytes as f64 / f64::from(frames.max(1));
    let summary = ScannedSummary {
        frames,
        groups: all.index().groups.len(),
        bytes_per_frame: share(all.bytes()),
        images_per_frame: share(images),
        max_error: f64::from(step) / 2.0,
    };
    Ok((all, summary))
}

/// Bytes of the images of a group.
fn images_of(coded: &CodedGroup) -> u64 {
    let mesh = coded.bytes.first_chunk::<4>().map_or(0, |length| u64::from(u32::from_le_bytes(*length)));
    let lengths = 4 * (1 + coded.head.images.len() as u64);
    coded.bytes.len() as u64 - mesh - lengths
}

/// A frame by itself; `None` where it has no surface.
fn alone(scans: &Scans, of_scan: usize, frame: u32, offset: Vec3) -> Result<Option<ScannedGroup>, RegisterError> {
    let (mut scan, texture) = Frames(scans).plain(of_scan)?;
    let Some((Cleaned { surface, uvs, .. }, _)) = cleaned(&mut scan) else { return Ok(None) };
    let still = match &texture {
        Some(texture) if !uvs.is_empty() => Some(texture.still()?),
        _ => None,
    };
    let byte = |channel: f32| (channel * 255.0).round().clamp(0.0, 255.0) as u8;
    let colours = match (&still, &surface.colours) {
        (None, Some(colours)) => colours.iter().map(|colour| colour.to_array().map(byte)).collect(),
        _ => Vec::new(),
    };
    let mut corners = Vec::new();
    let mut known: HashMap<(u32, [u32; 2]), u32> = HashMap::new();
    let triangles = surface.mesh.triangles.iter().enumerate().map(|(number, triangle)| {
        std::array::from_fn(|k| {
            let (vertex, uv) =
                (triangle[k], uvs.get(number).filter(|_| still.is_some()).map_or([0.0; 2], |uvs| uvs[k].to_array()));
            *known.entry((vertex, uv.map(f32::to_bits))).or_insert_with(|| {
                corners.push(ScannedCorner { vertex, uv });
                corners.len() as u32 - 1
            })
        })
    });
    let triangles = triangles.collect();
    let pose = surface.mesh.positions.iter().map(|&p| p - offset).collect();
    let worn = if still.is_some() { vec![0] } else { Vec::new() };
    let (first_frame, poses, images) = (frame, vec![pose], still.into_iter().collect());
    Ok(Some(ScannedGroup { first_frame, corners, triangles, poses, colours, images, worn }))
}

/// The group with the next frame, where that has the same mesh; else both.
fn joined(mut group: ScannedGroup, mut next: ScannedGroup) -> Result<ScannedGroup, Box<(ScannedGroup, ScannedGroup)>> {
    let same = group.first_frame + group.poses.len() as u32 == next.first_frame
        && group.poses.len() < GROUP_FRAMES
        && group.poses[0].len() == next.poses[0].len()
        && (&group.triangles, &group.corners, &group.colours) == (&next.triangles, &next.corners, &next.colours)
        && group.worn.is_empty() == next.worn.is_empty();
    if !same {
        return Err(Box::new((group, next)));
    }
    group.poses.append(&mut next.poses);
    if let Some(image) = next.images.pop() {
        let known = group.images.iter().position(|other| *other == image);
        group.worn.push(known.unwrap_or(group.images.len()) as u32);
        group.images.extend(known.is_none().then_some(image));
    }
    Ok(group)
}
