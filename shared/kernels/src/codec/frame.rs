//! A frame from its stream: residuals, predictions from parents, and metres.

use glam::Vec3;

use super::Steps;
use super::rans::{Decoder, Table};
use super::residual::{magnitude, read};

/// Prediction weights are multiples of one over two to the power of this.
pub const WEIGHT_BITS: u32 = 8;

/// A stream does not hold what it should.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BadFrame;

/// How the vertices of a frame are predicted and how often residuals occur.
#[derive(Clone, Copy, Debug)]
pub struct Prediction<'a> {
    /// Parents of each vertex: 2, 4 or 8.
    pub most_parents: usize,
    /// Slots of the parents of each vertex, in the order of decoding; each of an earlier vertex, or 0 where there is none.
    pub parent_slots: &'a [u32],
    /// Their weights.
    pub weights: &'a [i16],
    /// A table for each context.
    pub tables: &'a [Table],
    /// The context of each sum of magnitudes.
    pub contexts: &'a [u8],
}

/// Decodes a frame's residuals and adds predictions. Slot 0 is no vertex: it is what missing parents point to, and stays
/// zero. `magnitudes` is room for one number a slot.
///
/// # Errors
/// A stream that holds anything but one residual a vertex; `slots` are anything then.
///
/// # Panics
/// Where parents, tables and contexts do not fit each other, which [`Prediction`] asks for.
pub fn decode(
    prediction: &Prediction,
    stream: &[u8],
    magnitudes: &mut Vec<u8>,
    slots: &mut [Steps],
) -> Result<(), BadFrame> {
    magnitudes.clear();
    magnitudes.resize(slots.len(), 0);
    match prediction.most_parents {
        2 => decode_slots::<2>(prediction, stream, magnitudes, slots),
        4 => decode_slots::<4>(prediction, stream, magnitudes, slots),
        8 => decode_slots::<8>(prediction, stream, magnitudes, slots),
        _ => Err(BadFrame),
    }
}

fn decode_slots<const PARENTS: usize>(
    prediction: &Prediction,
    stream: &[u8],
    magnitudes: &mut [u8],
    slots: &mut [Steps],
) -> Result<(), BadFrame> {
    let Prediction { parent_slots, weights, tables, contexts, .. } = prediction;
    let rows = parent_slots.as_chunks::<PARENTS>().0.iter().zip(weights.as_chunks::<PARENTS>().0);
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

/// What a frame between two others is expected to be. Rounds down; the same on both sides is all that matters.
#[inline(always)]
#[must_use]
pub fn mean(a: i32, b: i32) -> i32 {
    a.wrapping_add(b) >> 1
}

/// Adds to each slot the mean of two other frames.
pub fn add_mean(slots: &mut [Steps], low: &[Steps], high: &[Steps]) {
    for ((slot, a), b) in slots.iter_mut().zip(low).zip(high) {
        for lane in 0..4 {
            slot[lane] = slot[lane].wrapping_add(mean(a[lane], b[lane]));
        }
    }
}

/// A decoded position in metres: a single multiplication, the same everywhere.
#[inline(always)]
#[must_use]
pub fn position(steps: Steps, step: f32) -> Vec3 {
    Vec3::new(steps[0] as f32 * step, steps[1] as f32 * step, steps[2] as f32 * step)
}

/// Writes the positions of `slots`, but for slot 0, into `pose`; `vertices` are theirs.
pub fn positions(slots: &[Steps], vertices: &[u32], step: f32, pose: &mut [Vec3]) {
    for (steps, &vertex) in slots.iter().skip(1).zip(vertices) {
        if let Some(place) = pose.get_mut(vertex as usize) {
            *place = position(*steps, step);
        }
    }
}
