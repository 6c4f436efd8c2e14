//! The turns section: how far the body turns in each transition besides, so that the foot that bears does not turn on the
//! ground. Optional: without it no transition does.

use super::entropy::binary::{Decoder, Encoder, MOST_DECISIONS_PER_BYTE};
use super::entropy::numbers::Number;
use actor::graph::{TURN_STEP, Transition};

/// No body turns further, in steps.
const FURTHEST: f32 = std::f32::consts::PI / TURN_STEP;

/// The section's bytes; `None` where no transition turns, or one by more than half a turn.
pub(super) fn encode(transitions: &[Transition]) -> Option<Vec<u8>> {
    let steps: Vec<f32> = transitions.iter().map(|transition| (transition.turn / TURN_STEP).round()).collect();
    if steps.iter().all(|&steps| steps == 0.0) || !steps.iter().all(|steps| steps.abs() <= FURTHEST) {
        return None;
    }
    let (mut encoder, mut model) = (Encoder::default(), Number::default());
    steps.into_iter().for_each(|steps| model.encode_signed(&mut encoder, steps as i32));
    Some(encoder.finish())
}

/// The turn of each of `count` transitions in radians; the reason where the section does not hold them.
pub(super) fn decode(bytes: &[u8], count: u32) -> Result<Vec<f32>, &'static str> {
    if count as usize > bytes.len().saturating_mul(MOST_DECISIONS_PER_BYTE) {
        return Err("is too short for its transitions");
    }
    let (mut decoder, mut model) = (Decoder::new(bytes), Number::default());
    let mut turns = Vec::new();
    for _ in 0..count {
        let steps = model.decode_signed(&mut decoder) as f32;
        if decoder.exhausted() {
            return Err("ends too early");
        }
        if steps.abs() > FURTHEST {
            return Err("turns by more than half a turn");
        }
        turns.push(steps * TURN_STEP);
    }
    if decoder.at_end() { Ok(turns) } else { Err("has bytes left over") }
}
