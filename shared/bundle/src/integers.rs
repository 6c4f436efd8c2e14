//! Lists of indices: the order of the vertices and the map from file vertices.

use super::entropy::binary::{Decoder, Encoder, MOST_DECISIONS_PER_BYTE};
use super::entropy::numbers::Number;

/// Codes `values`, each less than 2^30, as differences from the value before.
#[must_use]
pub fn encode(values: &[u32]) -> Vec<u8> {
    let (mut encoder, mut length, mut model) = (Encoder::default(), Number::default(), Number::default());
    length.encode(&mut encoder, values.len() as u32);
    let mut before = -1;
    for &value in values {
        let value = value as i32;
        model.encode_signed(&mut encoder, value - before - 1);
        before = value;
    }
    encoder.finish()
}

/// Reads a list of at most `longest` values below `bound`; the reason where it is none.
pub fn decode(bytes: &[u8], longest: u32, bound: u32) -> Result<Vec<u32>, &'static str> {
    let mut decoder = Decoder::new(bytes);
    let (mut length, mut model) = (Number::default(), Number::default());
    let count = length.decode(&mut decoder);
    if count > longest || count as usize > bytes.len().saturating_mul(MOST_DECISIONS_PER_BYTE) {
        return Err("declares more values than it can hold");
    }
    let mut values = Vec::with_capacity(count as usize);
    let mut before = -1_i32;
    for _ in 0..count {
        let value = before.wrapping_add(1).wrapping_add(model.decode_signed(&mut decoder));
        if decoder.exhausted() {
            return Err("ends too early");
        }
        if value < 0 || value as u32 >= bound {
            return Err("names a vertex that does not exist");
        }
        values.push(value as u32);
        before = value;
    }
    if decoder.at_end() { Ok(values) } else { Err("has bytes left over") }
}
