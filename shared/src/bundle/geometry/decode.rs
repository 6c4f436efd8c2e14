//! Decoding frames: the residuals of a frame from its bytes, positions from residuals.

use glam::Vec3;

use super::super::entropy::rans::Decoder;
use super::Steps;
use super::model::{Model, WEIGHT_BITS};
use super::quantise;
use super::residual::{context_of_sum, magnitude, read};
use super::schedule::{CLASSES, Coding, coding};

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

/// A frame's stream does not hold what it should.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BadFrame;

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
        let slots = self.remembered[found].slots.get(1..).unwrap_or_default();
        for (steps, &vertex) in slots.iter().zip(&model.traversal.vertex_of_place) {
            if let Some(position) = pose.get_mut(vertex as usize) {
                *position = quantise::position(*steps, self.step);
            }
        }
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
        self.magnitudes.clear();
        self.magnitudes.resize(slots.len(), 0);
        let scratch = &mut self.magnitudes;
        let contexts = &self.contexts;
        match model.traversal.most_parents {
            2 => decode_slots::<2>(model, coding, stream, contexts, scratch, slots),
            4 => decode_slots::<4>(model, coding, stream, contexts, scratch, slots),
            8 => decode_slots::<8>(model, coding, stream, contexts, scratch, slots),
            _ => Err(BadFrame),
        }?;
        if let Some((low, high)) = coding.references {
            let (low, high) = (self.find(index, low).ok_or(BadFrame)?, self.find(index, high).ok_or(BadFrame)?);
            let (low, high) = (&self.remembered[low].slots, &self.remembered[high].slots);
            for ((slot, a), b) in slots.iter_mut().zip(low).zip(high) {
                for lane in 0..4 {
                    slot[lane] = slot[lane].wrapping_add(mean(a[lane], b[lane]));
                }
            }
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

/// What a frame between two others is expected to be. Rounds down; the same on both sides is all that matters.
#[inline(always)]
#[must_use]
pub fn mean(a: i32, b: i32) -> i32 {
    a.wrapping_add(b) >> 1
}

/// The weighted sum of a vertex's parents, rounded. Wraps: forged numbers give wrong positions, never a panic.
#[inline(always)]
#[must_use]
pub fn predict<const PARENTS: usize>(slots: &[Steps], parents: &[u32; PARENTS], weights: &[i16; PARENTS]) -> Steps {
    let mut sum = [1 << (WEIGHT_BITS - 1); 4];
    for parent in 0..PARENTS {
        let steps = slots[parents[parent] as usize];
        let weight = i32::from(weights[parent]);
        for lane in 0..4 {
            sum[lane] = weight.wrapping_mul(steps[lane]).wrapping_add(sum[lane]);
        }
    }
    sum.map(|lane| lane >> WEIGHT_BITS)
}

/// Decodes residuals and adds predictions. Slot 0 is no vertex: it is what missing parents point to, and stays zero.
fn decode_slots<const PARENTS: usize>(
    model: &Model,
    coding: Coding,
    stream: &[u8],
    contexts: &[u8],
    magnitudes: &mut [u8],
    slots: &mut [Steps],
) -> Result<(), BadFrame> {
    let tables = model.tables_of(coding.class());
    let weights = &model.weights[usize::from(coding.references.is_some())];
    let rows = model.traversal.parent_slots.as_chunks::<PARENTS>().0.iter().zip(weights.as_chunks::<PARENTS>().0);
    let mut decoder = Decoder::new(stream).ok_or(BadFrame)?;
    let mut before = 0;
    let mut done = 0;
    for (place, (parents, weights)) in rows.enumerate() {
        let near = usize::from(magnitudes[parents[0] as usize]) + usize::from(magnitudes[parents[1] as usize]);
        let table = &tables[usize::from(contexts[near + usize::from(before)])];
        let x = read(&mut decoder, 0, table);
        let y = read(&mut decoder, 1, table);
        let z = read(&mut decoder, 2, table);
        before = magnitude(x, y, z);
        magnitudes[place + 1] = before;
        let predicted = predict(slots, parents, weights);
        slots[place + 1] =
            [predicted[0].wrapping_add(x), predicted[1].wrapping_add(y), predicted[2].wrapping_add(z), 0];
        done += 1;
    }
    if decoder.finished() && done + 1 == slots.len() { Ok(()) } else { Err(BadFrame) }
}
