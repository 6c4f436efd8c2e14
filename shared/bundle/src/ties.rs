//! The ties section: which components of the mesh stay on which. Optional: without it each goes its own way in transitions.

use super::entropy::binary::{Decoder, Encoder, MOST_DECISIONS_PER_BYTE};
use super::entropy::numbers::Number;
use actor::ties::{MOST_TIED, Tie, Ties};
use kernels::topology::Topology;

/// Models of what is coded of a tie's end: how many vertices, the first one, how far on the next one is.
type Models = [Number; 3];

/// The section's bytes.
pub(super) fn encode(ties: &Ties) -> Vec<u8> {
    let mut encoder = Encoder::default();
    Number::default().encode(&mut encoder, ties.all().len() as u32);
    let mut models = Models::default();
    for end in ties.all().iter().flat_map(|tie| [&tie.contact, &tie.patch]) {
        models[0].encode(&mut encoder, end.len() as u32);
        let mut next = 0;
        for (index, &vertex) in end.iter().enumerate() {
            models[1 + usize::from(index > 0)].encode(&mut encoder, vertex - next);
            next = vertex + 1;
        }
    }
    encoder.finish()
}

/// Reads the section; the reason where it is none.
pub(super) fn decode(bytes: &[u8], topology: &Topology) -> Result<Ties, &'static str> {
    let mut decoder = Decoder::new(bytes);
    let count = Number::default().decode(&mut decoder) as usize;
    if count > topology.component_count() || count > bytes.len().saturating_mul(MOST_DECISIONS_PER_BYTE) {
        return Err("has too many ties");
    }
    let mut models = Models::default();
    let mut ties = Vec::with_capacity(count);
    for _ in 0..count {
        let (contact, patch) = (end(&mut decoder, &mut models)?, end(&mut decoder, &mut models)?);
        ties.push(Tie { contact, patch });
    }
    if !decoder.at_end() {
        return Err("has bytes left over, or too few");
    }
    Ties::new(ties, topology).ok_or("has a tie that does not fit the mesh")
}

fn end(decoder: &mut Decoder, models: &mut Models) -> Result<Vec<u32>, &'static str> {
    let length = models[0].decode(decoder) as usize;
    if length > MOST_TIED {
        return Err("has a tie of too many vertices");
    }
    let (mut vertices, mut next) = (Vec::with_capacity(length), 0_u32);
    for index in 0..length {
        let vertex = next.wrapping_add(models[1 + usize::from(index > 0)].decode(decoder));
        vertices.push(vertex);
        next = vertex.wrapping_add(1);
    }
    if decoder.exhausted() { Err("ends too early") } else { Ok(vertices) }
}
