//! The index of scanned frames: which group holds which frame, and what each group will need. A list of whole numbers.

use actor::surface::ImageFormat;
use actor::timeline::Timeline;

use super::group::{CodedGroup, OpenGroup};
use super::{ScannedGroup, ScannedHead, mesh};
use crate::checksum::checksum;
use crate::error::EncodeError;
use crate::integers;
use crate::kind::SectionKind;
use crate::limits::{MAX_CORNERS, MAX_SCANNED_FRAMES, MAX_SCANNED_SIDE, MAX_SECTIONS, MAX_TRIANGLES, MAX_VERTICES};
use crate::sections::Draft;

/// Numbers of a list at most, and what each is below.
const MOST: (u32, u32) = (1 << 24, 1 << 24);

/// Which scanned frames there are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScannedIndex {
    /// The groups, in order of their frames.
    pub groups: Vec<ScannedHead>,
}

impl ScannedIndex {
    /// Reads the section.
    pub(crate) fn decode(raw: &[u8], timeline: &Timeline) -> Result<Self, &'static str> {
        let mut numbers = integers::decode(raw, MOST.0, MOST.1)?.into_iter();
        let mut groups = Vec::new();
        while !numbers.as_slice().is_empty() {
            groups.push(ScannedHead::read(&mut numbers)?);
        }
        let index = Self { groups };
        if index.is_sound(timeline) { Ok(index) } else { Err(WRONG) }
    }

    /// Groups in order, with frames that there are.
    fn is_sound(&self, timeline: &Timeline) -> bool {
        let mut next = 0;
        let in_order = |head: &ScannedHead| {
            let sound = head.first_frame >= next && is_sound(head);
            next = head.first_frame.saturating_add(head.frames);
            sound
        };
        self.groups.iter().all(in_order) && next <= timeline.frame_count()
    }

    /// The section.
    pub(crate) fn encode(&self) -> Vec<u8> {
        let numbers: Vec<u32> = self.groups.iter().flat_map(ScannedHead::words).collect();
        integers::encode(&numbers)
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
        mesh::decode(open.mesh, open.head)
    }
}

impl ScannedHead {
    /// Itself as numbers: as they stand in the index, and are handed from one memory to another.
    pub fn words(&self) -> impl Iterator<Item = u32> {
        let sizes = [self.first_frame, self.frames, self.vertices, self.corners, self.triangles];
        let looks = [u32::from(self.coloured), self.images.len() as u32];
        let images = self.images.iter().flat_map(|&(format, width, height)| [number_of(format), width, height]);
        sizes.into_iter().chain(looks).chain(images).chain(self.worn.iter().copied())
    }

    /// The group of which `numbers` tell next.
    ///
    /// # Errors
    /// The reason where they tell of none.
    pub fn read(numbers: &mut impl Iterator<Item = u32>) -> Result<Self, &'static str> {
        let mut next = || numbers.next().ok_or("ends within a group");
        let [first_frame, frames, vertices, corners, triangles, coloured, images] =
            [next()?, next()?, next()?, next()?, next()?, next()?, next()?];
        if frames > MAX_SCANNED_FRAMES || images > frames {
            return Err(WRONG);
        }
        let images = (0..images)
            .map(|_| Ok((format_of(next()?)?, next()?, next()?)))
            .collect::<Result<Vec<_>, &'static str>>()?;
        let worn = if images.is_empty() { 0 } else { frames };
        let worn = (0..worn).map(|_| next()).collect::<Result<Vec<_>, &'static str>>()?;
        let head = Self { first_frame, frames, vertices, corners, triangles, coloured: coloured > 0, images, worn };
        if is_sound(&head) { Ok(head) } else { Err(WRONG) }
    }
}

const WRONG: &str = "has groups out of order, or without a surface, an image or a frame that they need";

fn is_sound(head: &ScannedHead) -> bool {
    let sizes = [(head.vertices, MAX_VERTICES), (head.corners, MAX_CORNERS), (head.triangles, MAX_TRIANGLES)];
    let sides =
        head.images.iter().flat_map(|&(_, width, height)| [(width, MAX_SCANNED_SIDE), (height, MAX_SCANNED_SIDE)]);
    let frames = [(head.frames, MAX_SCANNED_FRAMES)];
    let (images, worn) = (head.images.len(), if head.images.is_empty() { 0 } else { head.frames as usize });
    sizes.into_iter().chain(sides).chain(frames).all(|(size, limit)| (1..=limit).contains(&size))
        // Every corner is used, and so is every vertex.
        && head.vertices <= head.corners
        && head.corners <= 3 * head.triangles
        && images <= head.frames as usize
        && !(head.coloured && images > 0)
        && head.worn.len() == worn
        && head.worn.iter().all(|&image| (image as usize) < images)
}

const FORMATS: [ImageFormat; 3] = [ImageFormat::Png, ImageFormat::Jpeg, ImageFormat::WebP];

fn format_of(number: u32) -> Result<ImageFormat, &'static str> {
    FORMATS.get(number as usize).copied().ok_or(WRONG)
}

fn number_of(format: ImageFormat) -> u32 {
    FORMATS.iter().position(|&other| other == format).unwrap_or(0) as u32
}

/// A group's section on its way into a bundle.
#[derive(Clone, Debug, PartialEq)]
struct Section {
    length: u64,
    checksum: u32,
    /// Nothing where whoever writes the bundle has them.
    bytes: Option<Vec<u8>>,
}

/// Coded groups on their way into a bundle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScannedFrames {
    index: ScannedIndex,
    groups: Vec<Section>,
}

impl ScannedFrames {
    /// Takes the next group.
    pub fn push(&mut self, coded: CodedGroup) {
        self.add(&coded.head, &coded.bytes);
        if let Some(section) = self.groups.last_mut() {
            section.bytes = Some(coded.bytes);
        }
    }

    /// Takes the next group without its bytes, as [`Self::push`] does with them: who writes the bundle appends the bytes of all groups, in
    /// this order, to what [`encode_with_extras`](crate::encode_with_extras) returns.
    pub fn push_elsewhere(&mut self, coded: &CodedGroup) {
        self.add(&coded.head, &coded.bytes);
    }

    fn add(&mut self, head: &ScannedHead, bytes: &[u8]) {
        self.index.groups.push(head.clone());
        self.groups.push(Section { length: bytes.len() as u64, checksum: checksum(&[bytes]), bytes: None });
    }

    /// What there is.
    #[must_use]
    pub fn index(&self) -> &ScannedIndex {
        &self.index
    }

    /// Bytes of all groups.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.groups.iter().map(|section| section.length).sum()
    }

    /// The section of the index, which comes last but for the groups: a page fetches these when it wants them.
    pub(crate) fn draft(&self, timeline: &Timeline) -> Result<Draft, EncodeError> {
        if self.groups.len() as u32 > MAX_SECTIONS / 2 {
            let (count, limit) = (self.groups.len() as u64, u64::from(MAX_SECTIONS / 2));
            return Err(EncodeError::TooLarge { what: "groups of scanned frames", count, limit });
        }
        if !self.index.is_sound(timeline) {
            return Err(EncodeError::Inconsistent(format!("the index of scanned frames {WRONG}")));
        }
        Ok(Draft { kind: SectionKind::Scanned, ordinal: 0, raw: self.index.encode() })
    }

    /// Length and checksum of each group's section.
    pub(crate) fn told(&self) -> impl Iterator<Item = (u64, u32)> {
        self.groups.iter().map(|section| (section.length, section.checksum))
    }

    /// The bytes of those that are here.
    pub(crate) fn here(&self) -> impl Iterator<Item = &[u8]> {
        self.groups.iter().filter_map(|section| section.bytes.as_deref())
    }
}
