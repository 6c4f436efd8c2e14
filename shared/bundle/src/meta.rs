//! The first section: names, counts, sequences, and where frames lie. Serialised by postcard.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::error::BundleError;
use super::geometry::schedule;
use super::kind::SectionKind;
use super::limits::{
    MAX_CHUNK_FRAMES, MAX_COORDINATE, MAX_CORNERS, MAX_IMAGES, MAX_TRANSITIONS, MAX_TRIANGLES, MAX_VERTICES,
};
use actor::timeline::{Sequence, Timeline};

/// A sequence as the bundle stores it; its first frame follows from those before it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SequenceMeta {
    /// Name, as the input gives it.
    pub name: String,
    /// Behaviours that the sequence shows.
    pub labels: Vec<String>,
    /// Number of frames.
    pub frame_count: u32,
    /// Whether its last frame is followed by its first one.
    pub cyclic: bool,
}

/// Consecutive frames whose positions one geometry section holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Chunk {
    /// Its first frame.
    pub first_frame: u32,
    /// Number of its frames.
    pub frame_count: u32,
}

/// What a bundle holds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Meta {
    /// Name of the subject.
    pub name: String,
    /// The program that wrote the bundle, with its version.
    pub generator: String,
    /// Frames per second.
    pub fps: f32,
    /// The sequences.
    pub sequences: Vec<SequenceMeta>,
    /// Number of welded vertices.
    pub vertex_count: u32,
    /// Number of corners of the drawn mesh.
    pub corner_count: u32,
    /// Number of triangles.
    pub triangle_count: u32,
    /// Number of images.
    pub image_count: u32,
    /// Number of transitions.
    pub transition_count: u32,
    /// Least coordinates over all frames, in metres.
    pub lowest: [f32; 3],
    /// Largest coordinates over all frames, in metres.
    pub highest: [f32; 3],
    /// The frame to be drawn first.
    pub first_frame: u32,
    /// The largest distance in metres between a vertex and where it was captured.
    pub max_error: f32,
    /// Positions are multiples of this length, in metres.
    pub step: f32,
    /// Frames from one independent frame to the next: a power of two.
    pub group: u32,
    /// The frames of each geometry section, by ordinal.
    pub chunks: Vec<Chunk>,
}

impl Meta {
    /// Corners of the box that the actor stays in, in metres.
    #[must_use]
    pub fn bounds(&self) -> (Vec3, Vec3) {
        (self.lowest.into(), self.highest.into())
    }

    pub(super) fn encode(&self) -> Result<Vec<u8>, postcard::Error> {
        postcard::to_stdvec(self)
    }

    /// Reads the section and the timeline that it describes.
    pub(super) fn decode(bytes: &[u8]) -> Result<(Self, Timeline), BundleError> {
        let wrong = |reason: &str| BundleError::section(SectionKind::Meta, reason);
        let (meta, rest) = postcard::take_from_bytes::<Self>(bytes).map_err(|_| wrong("cannot be read"))?;
        if !rest.is_empty() {
            return Err(wrong("has bytes left over"));
        }
        let timeline = meta.timeline()?;
        meta.check_counts()?;
        meta.check_chunks(&timeline)?;
        Ok((meta, timeline))
    }

    fn timeline(&self) -> Result<Timeline, BundleError> {
        let mut first_frame = 0_u32;
        let mut sequences = Vec::with_capacity(self.sequences.len());
        for stored in &self.sequences {
            sequences.push(Sequence {
                name: stored.name.clone(),
                labels: stored.labels.clone(),
                first_frame,
                frame_count: stored.frame_count,
                cyclic: stored.cyclic,
            });
            first_frame = first_frame.saturating_add(stored.frame_count);
        }
        Timeline::new(self.fps, sequences)
            .map_err(|error| BundleError::section(SectionKind::Meta, format!("is no timeline: {error}")))
    }

    fn check_counts(&self) -> Result<(), BundleError> {
        let within = |count: u32, limit: u32| (1..=limit).contains(&count);
        let numbers = [&self.lowest[..], &self.highest[..], &[self.max_error]].concat();
        let holds = within(self.vertex_count, MAX_VERTICES)
            && within(self.corner_count, MAX_CORNERS)
            && within(self.triangle_count, MAX_TRIANGLES)
            && self.image_count <= MAX_IMAGES
            && self.transition_count <= MAX_TRANSITIONS
            && numbers.iter().all(|number| number.is_finite())
            && self.step > 0.0
            && (self.step * MAX_COORDINATE as f32).is_finite()
            && schedule::GROUPS.contains(&self.group);
        if holds { Ok(()) } else { Err(BundleError::section(SectionKind::Meta, "has a number out of range")) }
    }

    /// Chunks must cover the frames one after another and stay inside sequences.
    fn check_chunks(&self, timeline: &Timeline) -> Result<(), BundleError> {
        let mut next = 0;
        for chunk in &self.chunks {
            let last = chunk.first_frame.saturating_add(chunk.frame_count.saturating_sub(1));
            let holds = chunk.first_frame == next
                && (1..=MAX_CHUNK_FRAMES).contains(&chunk.frame_count)
                && timeline.sequence_index(last).is_some()
                && timeline.sequence_index(chunk.first_frame) == timeline.sequence_index(last);
            if !holds {
                return Err(BundleError::section(SectionKind::Meta, "divides the frames wrongly"));
            }
            next = last + 1;
        }
        if next == timeline.frame_count() && self.first_frame < next {
            Ok(())
        } else {
            Err(BundleError::section(SectionKind::Meta, "leaves frames out"))
        }
    }
}
