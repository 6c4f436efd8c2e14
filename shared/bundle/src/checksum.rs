//! The bundle's checksum: CRC-32 as in zip and PNG.
//!
//! Its tables are computed where they are needed: as data, like a crate's, they would weigh 16 KB on the page, for
//! numbers without a pattern do not compress.

use std::sync::OnceLock;

/// Bytes that are taken at once.
const STRIDE: usize = 8;

type Tables = [[u32; 256]; STRIDE];

/// The checksum of `parts`, one after another.
#[must_use]
pub fn checksum(parts: &[&[u8]]) -> u32 {
    static TABLES: OnceLock<Tables> = OnceLock::new();
    let tables = TABLES.get_or_init(tables);
    !parts.iter().fold(u32::MAX, |state, part| update(tables, state, part))
}

/// `tables[k][byte]`: what a byte followed by k zeros adds.
fn tables() -> Tables {
    let mut tables = [[0; 256]; STRIDE];
    for byte in 0..256 {
        let step = |state: u32| (state >> 1) ^ (0xEDB8_8320 & (state & 1).wrapping_neg());
        tables[0][byte] = (0..8).fold(byte as u32, |state, _| step(state));
    }
    for k in 1..STRIDE {
        for byte in 0..256 {
            let before = tables[k - 1][byte];
            tables[k][byte] = (before >> 8) ^ tables[0][before as usize & 255];
        }
    }
    tables
}

fn update(tables: &Tables, mut state: u32, bytes: &[u8]) -> u32 {
    let (strides, rest) = bytes.as_chunks::<STRIDE>();
    for stride in strides {
        let [a, b, c, d] = state.to_le_bytes();
        let mixed =
            [stride[0] ^ a, stride[1] ^ b, stride[2] ^ c, stride[3] ^ d, stride[4], stride[5], stride[6], stride[7]];
        state = (0..STRIDE).fold(0, |sum, at| sum ^ tables[STRIDE - 1 - at][mixed[at] as usize]);
    }
    for byte in rest {
        state = (state >> 8) ^ tables[0][(state as u8 ^ byte) as usize];
    }
    state
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_checksum_of_zip() {
        assert_eq!(checksum(&[b"123456789"]), 0xCBF4_3926);
        let mut state = 1_u32;
        let mut byte = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        };
        for length in (0..40).chain([1000, 4099]) {
            let bytes: Vec<u8> = (0..length).map(|_| byte()).collect();
            assert_eq!(checksum(&[&bytes]), crc32fast::hash(&bytes), "{length} bytes");
            let (first, second) = bytes.split_at(length / 3);
            assert_eq!(checksum(&[first, second]), crc32fast::hash(&bytes), "{length} bytes in two parts");
        }
    }
}
