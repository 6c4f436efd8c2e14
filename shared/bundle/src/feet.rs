//! The feet section: which vertices follow each foot, and the frames in which it stands. Optional: without it feet slide in
//! transitions where both sides have them elsewhere.

use super::entropy::binary::{Bit, Decoder, Encoder, MOST_DECISIONS_PER_BYTE};
use super::entropy::numbers::Number;
use actor::feet::{Feet, FootVertex, MOST_FEET};
use actor::timeline::Timeline;

/// Models of what is coded of a foot: how many vertices, how far on the next one is, its shares.
type Models = [Number; 4];

/// The section's bytes.
pub(super) fn encode(feet: &Feet, frame_count: u32) -> Vec<u8> {
    let mut encoder = Encoder::default();
    Number::default().encode(&mut encoder, feet.count() as u32);
    let mut models = Models::default();
    for foot in 0..feet.count() {
        let vertices = feet.vertices(foot);
        models[0].encode(&mut encoder, vertices.len() as u32);
        let (mut next, mut before) = (0, [0_i32; 2]);
        for vertex in vertices {
            models[1].encode(&mut encoder, vertex.vertex - next);
            next = vertex.vertex + 1;
            let now = [vertex.leg, vertex.sole].map(i32::from);
            for share in 0..2 {
                models[2 + share].encode_signed(&mut encoder, now[share] - before[share]);
            }
            before = now;
        }
    }
    let mut stood = [Bit::default(); 2];
    for foot in 0..feet.count() {
        let mut before = false;
        for frame in 0..frame_count {
            let stands = feet.stands(frame, foot);
            encoder.bit(&mut stood[usize::from(before)], stands);
            before = stands;
        }
    }
    encoder.finish()
}

/// Reads the section; the reason where it is none.
pub(super) fn decode(bytes: &[u8], vertex_count: u32, timeline: &Timeline) -> Result<Feet, &'static str> {
    let most = bytes.len().saturating_mul(MOST_DECISIONS_PER_BYTE);
    let mut decoder = Decoder::new(bytes);
    let count = Number::default().decode(&mut decoder) as usize;
    let frames = timeline.frame_count() as usize;
    if count > MOST_FEET || count * frames > most {
        return Err("has too many feet");
    }
    let mut models = Models::default();
    let mut feet = Vec::with_capacity(count);
    for _ in 0..count {
        let length = models[0].decode(&mut decoder);
        if length > vertex_count || length as usize > most {
            return Err("has a foot of too many vertices");
        }
        let mut vertices = Vec::with_capacity(length as usize);
        let (mut next, mut now) = (0_u32, [0_i32; 2]);
        for _ in 0..length {
            let vertex = next.wrapping_add(models[1].decode(&mut decoder));
            for share in 0..2 {
                now[share] = now[share].wrapping_add(models[2 + share].decode_signed(&mut decoder));
            }
            if decoder.exhausted() {
                return Err("ends too early");
            }
            let [leg, sole] = now.map(|share| share as u8);
            if now != [i32::from(leg), i32::from(sole)] {
                return Err("has a share out of range");
            }
            vertices.push(FootVertex { vertex, leg, sole });
            next = vertex.wrapping_add(1);
        }
        feet.push(vertices);
    }
    let mut stands = vec![false; count * frames];
    let mut stood = [Bit::default(); 2];
    for foot in 0..count {
        let mut before = false;
        for frame in 0..frames {
            before = decoder.bit(&mut stood[usize::from(before)]);
            stands[frame * count + foot] = before;
        }
    }
    if !decoder.at_end() {
        return Err("has bytes left over, or too few");
    }
    Feet::new(feet, stands, vertex_count as usize, timeline).ok_or("has a foot that does not fit the mesh")
}
