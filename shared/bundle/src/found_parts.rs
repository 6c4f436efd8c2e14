//! The section of parts that were found: their names, and which of them each vertex of the surface belongs to. Optional.
//!
//! Painted parts have a section of their own (`body_parts`): builders find parts anew, with their bands, but keep to what was painted.

use std::fmt;

use kernels::topology::Topology;

use super::body_parts;

/// Bytes of a name, at most.
const MOST_NAME: usize = 40;

/// The parts of a body as they were found.
#[derive(Clone, PartialEq, Eq)]
pub struct FoundParts {
    /// A name for each part, the torso's first.
    pub names: Vec<String>,
    /// For each vertex the part that it belongs to most, as a place among the names.
    pub of_vertex: Vec<u8>,
}

impl fmt::Debug for FoundParts {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "FoundParts({:?} on {} vertices)", self.names, self.of_vertex.len())
    }
}

/// The section's bytes; `None` where there is not a named part for each vertex.
pub(super) fn encode(parts: &FoundParts, topology: &Topology) -> Option<Vec<u8>> {
    let mut bytes = vec![u8::try_from(parts.names.len()).ok()?];
    for name in &parts.names {
        bytes.push(u8::try_from(name.len()).ok()?);
        bytes.extend(name.as_bytes());
    }
    bytes.extend(body_parts::encode(&parts.of_vertex, topology)?);
    decode(&bytes, topology).is_ok().then_some(bytes)
}

/// Reads the section; the reason where it does not hold parts of this mesh.
pub(super) fn decode(bytes: &[u8], topology: &Topology) -> Result<FoundParts, &'static str> {
    let short = "ends too early";
    let (&count, mut rest) = bytes.split_first().ok_or(short)?;
    let mut names: Vec<String> = Vec::new();
    for _ in 0..count {
        let (&length, after) = rest.split_first().ok_or(short)?;
        let (name, after) = after.split_at_checked(length.into()).ok_or(short)?;
        let name = std::str::from_utf8(name).map_err(|_| "has a name that is no text")?;
        let is_plain = !name.is_empty() && name.len() <= MOST_NAME && !name.chars().any(char::is_control);
        if !is_plain || names.iter().any(|other| other == name) {
            return Err("has a name that is no name, or twice");
        }
        names.push(name.to_owned());
        rest = after;
    }
    let of_vertex = body_parts::decode(rest, topology)?;
    if of_vertex.iter().any(|&part| part >= count) {
        return Err("has a vertex of a part that there is not");
    }
    Ok(FoundParts { names, of_vertex })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_read_as_they_were_written() {
        let topology = Topology::new(300, (2..300).map(|v| [v - 2, v - 1, v]).collect(), vec![1.0; 300]).unwrap();
        let names: Vec<String> = ["torso", "left arm", "right arm"].map(String::from).to_vec();
        let parts = FoundParts { names, of_vertex: (0..300_u32).map(|v| (v / 100) as u8).collect() };
        let bytes = encode(&parts, &topology).unwrap();
        assert_eq!(decode(&bytes, &topology), Ok(parts.clone()));
        for length in 0..bytes.len() {
            if let Ok(read) = decode(&bytes[..length], &topology) {
                assert_eq!(read.of_vertex.len(), 300);
            }
        }
        for seed in 0..300_u32 {
            let mut noise = bytes.clone();
            let at = seed as usize % noise.len();
            noise[at] ^= (seed.wrapping_mul(97) >> 2) as u8 | 1;
            if let Ok(read) = decode(&noise, &topology) {
                assert!(read.of_vertex.iter().all(|&part| usize::from(part) < read.names.len()));
            }
        }
        let wrong = |change: fn(&mut FoundParts)| {
            let mut other = parts.clone();
            change(&mut other);
            assert!(encode(&other, &topology).is_none(), "{other:?}");
        };
        wrong(|parts| parts.of_vertex[7] = 3);
        wrong(|parts| _ = parts.of_vertex.pop());
        wrong(|parts| parts.names[1] = "torso".into());
        wrong(|parts| parts.names[1] = "a\nb".into());
        wrong(|parts| parts.names[1] = String::new());
        wrong(|parts| parts.names[1] = "long".repeat(11));
    }
}
