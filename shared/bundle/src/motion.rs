//! The motion section: where the actor is and which way it faces in every frame, so that walks over the ground can be
//! planned without a single pose. Optional; a reader measures it from the poses where it is missing.

use glam::{Vec2, Vec3};

use super::entropy::binary::{Decoder, Encoder, MOST_DECISIONS_PER_BYTE};
use super::entropy::numbers::Number;
use super::graph::{HEADING_STEP, TRANSLATION_STEP};
use actor::motion::Motion;
use actor::timeline::Timeline;
use kernels::align::Placement;

/// Numbers of a frame: its centre and its facing.
const PER_FRAME: usize = 4;
/// Numbers of a wrap: its heading and its translation.
const PER_WRAP: usize = 3;

/// The section's bytes; `None` for motion that is too far out to be rounded.
pub(super) fn encode(motion: &Motion) -> Option<Vec<u8>> {
    let mut encoder = Encoder::default();
    let mut models: [Number; PER_FRAME] = Default::default();
    let mut before = [0_i32; PER_FRAME];
    for (centre, &facing) in motion.centres.iter().zip(&motion.facings) {
        let now = [
            rounded(centre.x, TRANSLATION_STEP)?,
            rounded(centre.y, TRANSLATION_STEP)?,
            rounded(centre.z, TRANSLATION_STEP)?,
            rounded(facing, HEADING_STEP)?,
        ];
        for axis in 0..PER_FRAME {
            models[axis].encode_signed(&mut encoder, now[axis] - before[axis]);
        }
        before = now;
    }
    let mut models: [Number; PER_WRAP] = Default::default();
    for wrap in &motion.wraps {
        let Vec2 { x, y } = wrap.translation;
        models[0].encode_signed(&mut encoder, rounded(wrap.heading, HEADING_STEP)?);
        models[1].encode_signed(&mut encoder, rounded(x, TRANSLATION_STEP)?);
        models[2].encode_signed(&mut encoder, rounded(y, TRANSLATION_STEP)?);
    }
    Some(encoder.finish())
}

/// Reads the section; the reason where it is none.
pub(super) fn decode(bytes: &[u8], timeline: &Timeline) -> Result<Motion, &'static str> {
    let frames = timeline.frame_count() as usize;
    if frames > bytes.len().saturating_mul(MOST_DECISIONS_PER_BYTE) {
        return Err("is too short for its frames");
    }
    let mut decoder = Decoder::new(bytes);
    let mut models: [Number; PER_FRAME] = Default::default();
    let mut now = [0_i32; PER_FRAME];
    let mut motion = Motion {
        centres: Vec::with_capacity(frames),
        facings: Vec::with_capacity(frames),
        wraps: Vec::with_capacity(timeline.sequences().len()),
    };
    for _ in 0..frames {
        for axis in 0..PER_FRAME {
            now[axis] = now[axis].wrapping_add(models[axis].decode_signed(&mut decoder));
        }
        if decoder.exhausted() {
            return Err("ends too early");
        }
        let [x, y, z, facing] = now.map(|number| number as f32);
        motion.centres.push(Vec3::new(x, y, z) * TRANSLATION_STEP);
        motion.facings.push(facing * HEADING_STEP);
    }
    let mut models: [Number; PER_WRAP] = Default::default();
    for _ in timeline.sequences() {
        let [heading, x, y] = [0, 1, 2].map(|axis: usize| models[axis].decode_signed(&mut decoder) as f32);
        let translation = Vec2::new(x, y) * TRANSLATION_STEP;
        motion.wraps.push(Placement { heading: heading * HEADING_STEP, translation });
    }
    if decoder.at_end() { Ok(motion) } else { Err("has bytes left over, or too few") }
}

/// A whole number of steps, small enough for differences of two of them.
fn rounded(value: f32, step: f32) -> Option<i32> {
    let steps = (f64::from(value) / f64::from(step)).round();
    (steps.abs() < f64::from(1 << 28)).then_some(steps as i32)
}
