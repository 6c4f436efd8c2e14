//! Decoding frames: the residuals of a frame from its bytes, positions from residuals.

use glam::Vec3;

use super::model::Model;
use super::schedule::{CLASSES, Coding, coding};
use kernels::codec::Steps;
pub use kernels::codec::frame::BadFrame;
use kernels::codec::frame::{Prediction, add_mean, decode, positions};
use kernels::codec::residual::context_of_sum;

/// A geometry section: the streams of its frames.
#[derive(Clone, Debug)]
pub struct ChunkBytes {
    bytes: Vec<u8>,
    frame_count: u32,
}

impl ChunkBytes {
    /// Takes the bytes of a section of `frame_count` frames; the reason where they are none.
    ///
    /// # Errors
    /// Lengths that do not fit the bytes.
    pub fn new(bytes: Vec<u8>, frame_count: u32) -> Result<Self, &'static str> {
        let head = frame_count as usize * 4;
        let Some(ends) = bytes.get(..head) else { return Err("is shorter than its table of frames") };
        let mut before = 0;
        for end in ends.as_chunks::<4>().0 {
            let end = u32::from_le_bytes(*end);
            if end < before {
                return Err("has frames that end before they begin");
            }
            before = end;
        }
        if head + before as usize != bytes.len() {
            return Err("has another size than its frames");
        }
        Ok(Self { bytes, frame_count })
    }

    /// Number of frames.
    #[must_use]
    pub fn frame_count(&self) -> u32 {
        self.frame_count
    }

    /// The stream of a frame, counted within the chunk.
    #[must_use]
    pub fn frame(&self, local: u32) -> Option<&[u8]> {
        let end_of = |local: u32| {
            let bytes = self.bytes.get(local as usize * 4..)?.first_chunk::<4>()?;
            Some(u32::from_le_bytes(*bytes) as usize)
        };
        if local >= self.frame_count {
            return None;
        }
        let begin = if local == 0 { 0 } else { end_of(local - 1)? };
        self.bytes.get(self.frame_count as usize * 4..)?.get(begin..end_of(local)?)
    }
}

/// Decodes frames in any order and remembers the last ones, because neighbours are decoded from the same references.
#[derive(Debug)]
pub struct FrameDecoder {
    group: u32,
    step: f32,
    contexts: Box<[u8]>,
    magnitudes: Vec<u8>,
    remembered: Vec<Remembered>,
    clock: u64,
}

#[derive(Debug)]
struct Remembered {
    chunk: usize,
    local: u32,
    last_use: u64,
    slots: Vec<Steps>,
}

impl FrameDecoder {
    /// Number of decoded frames that are remembered: all that the deepest frame of the largest group needs, and a few.
    pub const REMEMBERED: usize = 10;

    /// A decoder for independent frames `group` apart and positions in multiples of `step` metres.
    #[must_use]
    pub fn new(group: u32, step: f32) -> Self {
        let contexts = Box::new(context_of_sum());
        Self { group, step, contexts, magnitudes: Vec::new(), remembered: Vec::new(), clock: 0 }
    }

    /// Writes the positions of frame `local` of `chunk`, whose number is `index`, into `pose`.
    ///
    /// # Errors
    /// A stream that does not hold a frame; `pose` is unchanged then.
    pub fn read(
        &mut self,
        model: &Model,
        index: usize,
        chunk: &ChunkBytes,
        local: u32,
        pose: &mut [Vec3],
    ) -> Result<(), BadFrame> {
        self.ensure(model, index, chunk, local, CLASSES + 2)?;
        let found = self.find(index, local).ok_or(BadFrame)?;
        let slots = &self.remembered[found].slots;
        positions(slots, &model.traversal.vertex_of_place, self.step, pose);
        Ok(())
    }

    /// Makes sure that a frame is remembered; `depth` bounds the references of references.
    fn ensure(
        &mut self,
        model: &Model,
        index: usize,
        chunk: &ChunkBytes,
        local: u32,
        depth: usize,
    ) -> Result<(), BadFrame> {
        if self.find(index, local).is_some() {
            return Ok(());
        }
        let coding = coding(local, chunk.frame_count(), self.group);
        if let Some((low, high)) = coding.references {
            let depth = depth.checked_sub(1).ok_or(BadFrame)?;
            self.ensure(model, index, chunk, low, depth)?;
            self.ensure(model, index, chunk, high, depth)?;
        }
        let stream = chunk.frame(local).ok_or(BadFrame)?;
        let mut slots = self.forget_oldest();
        slots.resize(model.traversal.vertex_of_place.len() + 1, [0; 4]);
        let decoded = self.decode(model, index, coding, stream, &mut slots);
        if decoded.is_ok() {
            self.clock += 1;
            self.remembered.push(Remembered { chunk: index, local, last_use: self.clock, slots });
        }
        decoded
    }

    fn decode(
        &mut self,
        model: &Model,
        index: usize,
        coding: Coding,
        stream: &[u8],
        slots: &mut [Steps],
    ) -> Result<(), BadFrame> {
        let prediction = Prediction {
            most_parents: model.traversal.most_parents,
            parent_slots: &model.traversal.parent_slots,
            weights: &model.weights[usize::from(coding.references.is_some())],
            tables: model.tables_of(coding.class()),
            contexts: &self.contexts[..],
        };
        decode(&prediction, stream, &mut self.magnitudes, slots)?;
        if let Some((low, high)) = coding.references {
            let (low, high) = (self.find(index, low).ok_or(BadFrame)?, self.find(index, high).ok_or(BadFrame)?);
            let (low, high) = (&self.remembered[low].slots, &self.remembered[high].slots);
            add_mean(slots, low, high);
        }
        Ok(())
    }

    fn find(&mut self, chunk: usize, local: u32) -> Option<usize> {
        let found = self.remembered.iter().position(|frame| frame.chunk == chunk && frame.local == local)?;
        self.clock += 1;
        self.remembered[found].last_use = self.clock;
        Some(found)
    }

    /// An empty buffer: that of the frame used longest ago, once enough are remembered.
    fn forget_oldest(&mut self) -> Vec<Steps> {
        if self.remembered.len() < Self::REMEMBERED {
            return Vec::new();
        }
        let oldest = (0..self.remembered.len()).min_by_key(|&i| self.remembered[i].last_use);
        oldest.map(|oldest| self.remembered.swap_remove(oldest).slots).unwrap_or_default()
    }
}
