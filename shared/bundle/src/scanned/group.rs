//! The section of one group: how long its parts are, its mesh, its images.

use std::ops::Range;

use glam::Vec2;

use super::mesh::{self, FARTHEST_UV};
use super::{ScannedCorner, ScannedGroup, ScannedHead, ordered};
use crate::error::EncodeError;
use crate::limits::{MAX_COORDINATE, MAX_SCANNED_FRAMES, MAX_SECTION_BYTES};

/// A group as it is stored.
#[derive(Clone, Debug, PartialEq)]
pub struct CodedGroup {
    /// What the index tells of it.
    pub head: ScannedHead,
    /// Its section.
    pub bytes: Vec<u8>,
}

/// Codes `group` with positions as multiples of `step` metres. The same group gives the same bytes.
///
/// # Errors
/// A group whose parts do not fit together, or that is more than a bundle holds.
pub fn code_group(group: &ScannedGroup, step: f32) -> Result<CodedGroup, EncodeError> {
    check(group, step)?;
    let group = ordered(group);
    let head = head_of(&group);
    let mesh = mesh::encode(&group, &head, step);
    let parts = std::iter::once(&mesh).chain(group.images.iter().map(|image| &image.bytes));
    let mut bytes: Vec<u8> = parts.clone().flat_map(|part| (part.len() as u32).to_le_bytes()).collect();
    parts.for_each(|part| bytes.extend_from_slice(part));
    if bytes.len() as u64 > MAX_SECTION_BYTES {
        let count = bytes.len() as u64;
        return Err(EncodeError::TooLarge { what: "bytes in one section", count, limit: MAX_SECTION_BYTES });
    }
    Ok(CodedGroup { head, bytes })
}

fn check(group: &ScannedGroup, step: f32) -> Result<(), EncodeError> {
    let first = group.first_frame;
    let wrong = |what: &str| Err(EncodeError::Inconsistent(format!("the scanned frames from {first} on {what}")));
    let vertices = group.poses.first().map_or(0, Vec::len);
    if group.triangles.is_empty() || vertices == 0 || group.poses.iter().any(|pose| pose.len() != vertices) {
        return wrong("have no surface, or frames with different numbers of vertices");
    }
    if group.poses.len() > MAX_SCANNED_FRAMES as usize {
        return wrong("are too many for one group");
    }
    if group.triangles.iter().flatten().any(|&corner| corner as usize >= group.corners.len())
        || group.corners.iter().any(|corner| corner.vertex as usize >= vertices)
    {
        return wrong("have a triangle without a corner, or a corner without a vertex");
    }
    if !group.colours.is_empty() && (group.colours.len() != vertices || !group.images.is_empty()) {
        return wrong("have colours of other vertices, or images besides");
    }
    let is_near = |corner: &ScannedCorner| Vec2::from(corner.uv).abs().max_element() <= FARTHEST_UV;
    if step.is_nan() || step <= 0.0 || !group.corners.iter().all(is_near) {
        return wrong("have texture coordinates that are too far out, or no step");
    }
    let farthest = step * (MAX_COORDINATE - 2) as f32;
    for (frame, pose) in (first..).zip(&group.poses) {
        if let Some(vertex) = pose.iter().position(|p| !(p.is_finite() && p.abs().max_element() <= farthest)) {
            return Err(EncodeError::Position { frame, vertex: vertex as u32 });
        }
    }
    Ok(())
}

fn head_of(group: &ScannedGroup) -> ScannedHead {
    ScannedHead {
        first_frame: group.first_frame,
        frames: group.poses.len() as u32,
        vertices: group.poses[0].len() as u32,
        corners: group.corners.len() as u32,
        triangles: group.triangles.len() as u32,
        coloured: !group.colours.is_empty(),
        images: group.images.iter().map(|image| (image.format, image.width, image.height)).collect(),
        worn: group.worn.clone(),
    }
}

/// The parts of a group's section.
#[derive(Clone, Debug)]
pub struct OpenGroup<'a> {
    /// What the index tells of it.
    pub head: &'a ScannedHead,
    pub(super) mesh: &'a [u8],
    /// Where each image lies in the section.
    pub images: Vec<Range<usize>>,
}

impl<'a> OpenGroup<'a> {
    pub(super) fn new(head: &'a ScannedHead, bytes: &'a [u8]) -> Result<Self, &'static str> {
        let short = "is shorter than its parts";
        let count = 1 + head.images.len();
        let mut start = 4 * count;
        let lengths = bytes.get(..start).ok_or(short)?;
        let mut parts = Vec::with_capacity(count);
        for length in lengths.chunks_exact(4) {
            let length = length.first_chunk::<4>().map_or(0, |bytes| u32::from_le_bytes(*bytes)) as usize;
            let end = start.checked_add(length).filter(|&end| end <= bytes.len()).ok_or(short)?;
            parts.push(start..end);
            start = end;
        }
        if start != bytes.len() {
            return Err("has bytes left over");
        }
        let mesh = &bytes[parts.remove(0)];
        Ok(Self { head, mesh, images: parts })
    }
}
