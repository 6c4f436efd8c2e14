//! The index of scanned frames: which group holds which frame, and what each group will need. Serialised by postcard.

use actor::timeline::Timeline;
use serde::{Deserialize, Serialize};

use super::group::{CodedGroup, OpenGroup};
use super::{ScannedGroup, ScannedHead, mesh};
use crate::error::EncodeError;
use crate::limits::{MAX_CORNERS, MAX_SCANNED_FRAMES, MAX_SCANNED_SIDE, MAX_SECTIONS, MAX_TRIANGLES, MAX_VERTICES};

/// Texture coordinates may be so far out: pictures repeat.
const FARTHEST_UV: f32 = 1e4;

/// Which scanned frames there are.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ScannedIndex {
    /// Positions are whole multiples of this, in metres.
    pub step: f32,
    /// The groups, in order of their frames.
    pub groups: Vec<ScannedHead>,
}

impl ScannedIndex {
    /// Reads the section.
    pub(crate) fn decode(raw: &[u8], timeline: &Timeline) -> Result<Self, &'static str> {
        let (index, rest): (Self, _) = postcard::take_from_bytes(raw).map_err(|_| "is no list of groups")?;
        if !rest.is_empty() {
            return Err("has bytes left over");
        }
        index.check(timeline)?;
        Ok(index)
    }

    /// What must hold; the reason where it does not.
    fn check(&self, timeline: &Timeline) -> Result<(), &'static str> {
        if !(self.step.is_finite() && self.step > 0.0 && self.step < 1e6) {
            return Err("has a step that is no length");
        }
        let mut next = 0_u32;
        for head in &self.groups {
            if head.first_frame < next || head.frames == 0 || head.frames > MAX_SCANNED_FRAMES {
                return Err("has groups that overlap, are empty or too long");
            }
            next = head.first_frame.checked_add(head.frames).ok_or("has a frame that does not exist")?;
            check_head(head)?;
        }
        if next > timeline.frame_count() { Err("has a frame that does not exist") } else { Ok(()) }
    }

    /// The section.
    pub(crate) fn encode(&self) -> Result<Vec<u8>, postcard::Error> {
        postcard::to_allocvec(self)
    }

    /// The group that holds `frame`, and which of its frames that is; `None` where it was not scanned, or was lost.
    #[must_use]
    pub fn place_of(&self, frame: u32) -> Option<(u32, u32)> {
        let after = self.groups.partition_point(|head| head.first_frame <= frame);
        let ordinal = after.checked_sub(1)?;
        let head = &self.groups[ordinal];
        let place = frame - head.first_frame;
        (place < head.frames).then_some((ordinal as u32, place))
    }

    /// Frames of all groups.
    #[must_use]
    pub fn frame_count(&self) -> u32 {
        self.groups.iter().map(|head| head.frames).sum()
    }

    /// Where the parts of group `ordinal` lie in its section `bytes`.
    ///
    /// # Errors
    /// The reason where that is none of it.
    pub fn open<'a>(&'a self, ordinal: u32, bytes: &'a [u8]) -> Result<OpenGroup<'a>, &'static str> {
        OpenGroup::new(self.groups.get(ordinal as usize).ok_or("is not declared")?, bytes)
    }

    /// Group `ordinal` without the bytes of its images, from its section `bytes`.
    ///
    /// # Errors
    /// The reason where that is none of it.
    pub fn read(&self, ordinal: u32, bytes: &[u8]) -> Result<ScannedGroup, &'static str> {
        let open = self.open(ordinal, bytes)?;
        mesh::decode(open.mesh, open.head, self.step)
    }
}

fn check_head(head: &ScannedHead) -> Result<(), &'static str> {
    let sizes = [(head.vertices, MAX_VERTICES), (head.corners, MAX_CORNERS), (head.triangles, MAX_TRIANGLES)];
    if sizes.iter().any(|&(size, limit)| size == 0 || size > limit) {
        return Err("has a group without a surface, or with too large a one");
    }
    // Every corner is used, and so is every vertex.
    if head.vertices > head.corners || u64::from(head.corners) > 3 * u64::from(head.triangles) {
        return Err("has a group with corners that nothing can use");
    }
    if head.uv_range.iter().any(|&(low, extent)| !(low.abs() <= FARTHEST_UV && (0.0..=2.0 * FARTHEST_UV).contains(&extent))) {
        return Err("has texture coordinates that are too far out");
    }
    let sound = |&(_, width, height): &(_, u32, u32)| (1..=MAX_SCANNED_SIDE).contains(&width) && (1..=MAX_SCANNED_SIDE).contains(&height);
    if head.images.len() > head.frames as usize || !head.images.iter().all(sound) || (head.coloured && !head.images.is_empty()) {
        return Err("has images that nothing can wear");
    }
    let worn = if head.images.is_empty() { 0 } else { head.frames as usize };
    if head.worn.len() != worn || head.worn.iter().any(|&image| image as usize >= head.images.len()) {
        return Err("has frames without their image");
    }
    Ok(())
}

/// Coded groups on their way into a bundle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScannedFrames {
    index: ScannedIndex,
    groups: Vec<Vec<u8>>,
}

impl ScannedFrames {
    /// None yet; positions are whole multiples of `step` metres.
    #[must_use]
    pub fn new(step: f32) -> Self {
        Self { index: ScannedIndex { step, groups: Vec::new() }, groups: Vec::new() }
    }

    /// Takes the next group.
    pub fn push(&mut self, CodedGroup { head, bytes }: CodedGroup) {
        self.index.groups.push(head);
        self.groups.push(bytes);
    }

    /// What there is.
    #[must_use]
    pub fn index(&self) -> &ScannedIndex {
        &self.index
    }

    /// Bytes of all groups.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.groups.iter().map(|bytes| bytes.len() as u64).sum()
    }

    /// The sections' contents: the index, and the groups.
    pub(crate) fn sections(&self, timeline: &Timeline) -> Result<(Vec<u8>, &[Vec<u8>]), EncodeError> {
        let wrong = |reason: &str| EncodeError::Inconsistent(format!("the index of scanned frames {reason}"));
        if self.groups.len() as u32 > MAX_SECTIONS / 2 {
            let (count, limit) = (self.groups.len() as u64, u64::from(MAX_SECTIONS / 2));
            return Err(EncodeError::TooLarge { what: "groups of scanned frames", count, limit });
        }
        self.index.check(timeline).map_err(wrong)?;
        let index = self.index.encode().map_err(|error| wrong(&error.to_string()))?;
        Ok((index, &self.groups))
    }
}
