//! The contacts section: what stands on the ground in every frame. Optional: without it transitions follow the centre of
//! mass alone.

use glam::Vec2;

use super::entropy::binary::{Decoder, Encoder, MOST_DECISIONS_PER_BYTE};
use super::entropy::numbers::Number;
use actor::contacts::{Contact, Contacts, MOST_PARTS, POINT_STEP, WEIGHT_STEP};
use actor::timeline::Timeline;

/// Models of a part's weight and of its point along both axes.
type Models = [Number; 3];

/// The section's bytes; `None` for points that are too far out to be rounded.
pub(super) fn encode(contacts: &Contacts, frame_count: u32) -> Option<Vec<u8>> {
    let mut encoder = Encoder::default();
    Number::default().encode(&mut encoder, contacts.parts() as u32);
    let mut models = Models::default();
    let mut before = vec![[0_i32; 3]; contacts.parts()];
    for frame in 0..frame_count {
        for (contact, before) in contacts.of(frame).iter().zip(&mut before) {
            let now = [(contact.weight / WEIGHT_STEP).round() as i32, steps(contact.point.x)?, steps(contact.point.y)?];
            // Where nothing stands, no point is stored.
            let stored = if now[0] > 0 { 3 } else { 1 };
            for axis in 0..stored {
                models[axis].encode_signed(&mut encoder, now[axis] - before[axis]);
                before[axis] = now[axis];
            }
        }
    }
    Some(encoder.finish())
}

/// Reads the section; the reason where it is none.
pub(super) fn decode(bytes: &[u8], timeline: &Timeline) -> Result<Contacts, &'static str> {
    let mut decoder = Decoder::new(bytes);
    let parts = Number::default().decode(&mut decoder) as usize;
    if parts > MOST_PARTS {
        return Err("has too many parts");
    }
    let count = parts * timeline.frame_count() as usize;
    if count > bytes.len().saturating_mul(MOST_DECISIONS_PER_BYTE) {
        return Err("is too short for its frames");
    }
    let mut contacts = Vec::with_capacity(count);
    let mut models = Models::default();
    let mut before = [[0_i32; 3]; MOST_PARTS];
    for index in 0..count {
        let now = &mut before[index % parts];
        now[0] = now[0].wrapping_add(models[0].decode_signed(&mut decoder));
        let stands = now[0] > 0;
        for axis in 1..if stands { 3 } else { 1 } {
            now[axis] = now[axis].wrapping_add(models[axis].decode_signed(&mut decoder));
        }
        if decoder.exhausted() {
            return Err("ends too early");
        }
        let point = if stands { Vec2::new(now[1] as f32, now[2] as f32) * POINT_STEP } else { Vec2::ZERO };
        contacts.push(Contact { point, weight: now[0] as f32 * WEIGHT_STEP });
    }
    if !decoder.at_end() {
        return Err("has bytes left over, or too few");
    }
    Contacts::new(parts, contacts, timeline).ok_or("has a weight out of range")
}

/// A whole number of steps, small enough for differences of two of them.
fn steps(metres: f32) -> Option<i32> {
    let steps = (f64::from(metres) / f64::from(POINT_STEP)).round();
    (steps.abs() < f64::from(1 << 28)).then_some(steps as i32)
}
