//! The parts section: which part of the body each vertex belongs to, as it was painted. Optional: without it parts are found.

use super::entropy::binary::{Bit, Decoder, Encoder};
use super::entropy::numbers::Number;
use kernels::topology::Topology;

/// What has been learnt about the numbers of parts.
#[derive(Default)]
struct Models {
    /// Whether a vertex belongs to the same part as its neighbour, by whether that is known to lie at a border.
    same: [Bit; 2],
    number: Number,
}

/// The section's bytes; `None` where there is not a number for each vertex.
pub(super) fn encode(parts: &[u8], topology: &Topology) -> Option<Vec<u8>> {
    let neighbours = earlier_neighbours(topology);
    if parts.len() != neighbours.len() {
        return None;
    }
    let (mut encoder, mut models) = (Encoder::default(), Models::default());
    for (vertex, &own) in parts.iter().enumerate() {
        let (like, border) = expected(&neighbours[vertex], &parts[..vertex]);
        encoder.bit(&mut models.same[usize::from(border)], own == like);
        if own != like {
            models.number.encode(&mut encoder, own.into());
        }
    }
    Some(encoder.finish())
}

/// Reads the section: a number for each vertex of the mesh; the reason where it is none.
pub(super) fn decode(bytes: &[u8], topology: &Topology) -> Result<Vec<u8>, &'static str> {
    let neighbours = earlier_neighbours(topology);
    let (mut decoder, mut models) = (Decoder::new(bytes), Models::default());
    let mut parts: Vec<u8> = Vec::with_capacity(neighbours.len());
    for earlier in &neighbours {
        let (like, border) = expected(earlier, &parts);
        let own = match decoder.bit(&mut models.same[usize::from(border)]) {
            true => like,
            false => {
                u8::try_from(models.number.decode(&mut decoder)).map_err(|_| "has a part of too large a number")?
            }
        };
        parts.push(own);
        if decoder.exhausted() {
            return Err("ends too early");
        }
    }
    if decoder.at_end() { Ok(parts) } else { Err("has bytes left over, or too few") }
}

/// For each vertex two of its neighbours that come before it: the lowest and the highest; or the vertex before, twice.
pub(super) fn earlier_neighbours(topology: &Topology) -> Vec<[u32; 2]> {
    let mut found: Vec<Option<[u32; 2]>> = vec![None; topology.vertex_count()];
    for &[a, b, c] in topology.triangles() {
        for (own, other) in [(a, b), (b, c), (c, a), (b, a), (c, b), (a, c)] {
            if other < own {
                let [low, high] = found[own as usize].unwrap_or([other; 2]);
                found[own as usize] = Some([low.min(other), high.max(other)]);
            }
        }
    }
    (0..).zip(found).map(|(vertex, found): (u32, _)| found.unwrap_or([vertex.saturating_sub(1); 2])).collect()
}

/// The part that a vertex is expected to belong to, and whether its neighbours disagree.
fn expected([low, high]: &[u32; 2], before: &[u8]) -> (u8, bool) {
    let part = |vertex: u32| before.get(vertex as usize).copied().unwrap_or(0);
    (part(*high), part(*low) != part(*high))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strip of triangles.
    fn strip(count: u32) -> Topology {
        let triangles = (2..count).map(|v| [v - 2, v - 1, v]).collect();
        Topology::new(count, triangles, vec![1.0; count as usize]).unwrap()
    }

    #[test]
    fn parts_are_read_as_they_were_written() {
        let topology = strip(3000);
        let parts: Vec<u8> = (0..3000_u32).map(|v| [0, 7, 255, 7, 1][(v / 600) as usize]).collect();
        let bytes = encode(&parts, &topology).unwrap();
        assert!(bytes.len() < 60, "{}", bytes.len());
        assert_eq!(decode(&bytes, &topology).unwrap(), parts);
        assert!(encode(&parts[1..], &topology).is_none());
        assert!(decode(&bytes[..bytes.len() - 3], &topology).is_err() && decode(&[], &topology).is_err());
        assert!(decode(&[bytes.clone(), vec![1; 9]].concat(), &topology).is_err());
        // Anything else gives parts, or a reason.
        for seed in 0..200_u32 {
            let noise: Vec<u8> = (0..40_u32).map(|k| (k.wrapping_mul(seed ^ 0x9e37) >> 3) as u8).collect();
            if let Ok(parts) = decode(&noise, &topology) {
                assert_eq!(parts.len(), 3000);
            }
        }
    }
}
