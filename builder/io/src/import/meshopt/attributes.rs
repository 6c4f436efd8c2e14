//! Mode 0: attributes, coded as the differences of consecutive elements, byte position by byte position.

use super::MeshoptError;

/// Elements of a group, whose differences have the same number of bits.
const GROUP: usize = 16;

/// How the differences of a group are stored.
#[derive(Clone, Copy)]
enum Packing {
    /// All are 0.
    Zero,
    /// So many bits each (1, 2 or 4); where all are set, the difference follows as a byte.
    Bits(u32),
    /// A byte each.
    Bytes,
}

/// How the bytes of a channel (four byte positions) follow from their differences.
#[derive(Clone, Copy)]
enum Channel {
    /// Zigzag differences of bytes.
    Bytes,
    /// Zigzag differences of 16-bit numbers.
    Words,
    /// Exclusive or of 32-bit numbers, turned left by so many bits.
    Xor(u32),
}

/// Decodes `count` elements of `stride` bytes.
pub(super) fn decode(stream: &[u8], count: usize, stride: usize) -> Result<Vec<u8>, MeshoptError> {
    let short = MeshoptError::Short(count);
    let newer = match stream.first() {
        Some(0xa0) => false,
        Some(0xa1) => true,
        Some(&other) => return Err(MeshoptError::Header(other)),
        None => return Err(short),
    };
    // The tail: one element, the modes of the channels (version 1), and zeros before them.
    let tail = stride + if newer { stride / 4 } else { 0 };
    let padded = tail.max(if newer { 24 } else { 32 });
    let Some(end) = stream.len().checked_sub(padded).filter(|&end| end >= 1) else { return Err(short) };
    let (baseline, modes) = stream[stream.len() - tail..].split_at(stride);
    let channels = channels(modes, stride)?;
    let mut rest = Reader { bytes: &stream[1..end], count };

    let block = ((8192 / stride) & !15).min(256);
    let blocks = count.div_ceil(block);
    // Least bytes of a block: its control header, or the header bits of one group at each position.
    let least = if newer { stride / 4 } else { stride };
    if blocks.checked_mul(least).is_none_or(|least| least > rest.bytes.len()) {
        return Err(short);
    }
    let mut out = Vec::with_capacity(count * stride);
    let mut previous = baseline.to_vec();
    let mut deltas = vec![0; stride * block];
    while out.len() < count * stride {
        let elements = block.min(count - out.len() / stride);
        read_block(&mut rest, newer, elements, block, &mut deltas)?;
        for element in 0..elements {
            for (k, &channel) in channels.iter().enumerate() {
                let delta = [0, 1, 2, 3].map(|byte| deltas[(4 * k + byte) * block + element]);
                let before = [0, 1, 2, 3].map(|byte| previous[4 * k + byte]);
                previous[4 * k..4 * k + 4].copy_from_slice(&channel.next(before, delta));
            }
            out.extend_from_slice(&previous);
        }
    }
    match rest.bytes.len() {
        0 => Ok(out),
        left => Err(MeshoptError::LeftOver(left)),
    }
}

fn channels(modes: &[u8], stride: usize) -> Result<Vec<Channel>, MeshoptError> {
    if modes.is_empty() {
        return Ok(vec![Channel::Bytes; stride / 4]);
    }
    let channel = |&mode: &u8| match (mode & 15, mode >> 4) {
        (0, 0) => Ok(Channel::Bytes),
        (1, 0) => Ok(Channel::Words),
        (2, turn) => Ok(Channel::Xor(turn.into())),
        _ => Err(MeshoptError::Code("a channel of the compressed stream has an unknown mode")),
    };
    modes.iter().map(channel).collect()
}

impl Channel {
    fn next(self, before: [u8; 4], delta: [u8; 4]) -> [u8; 4] {
        match self {
            Self::Bytes => [0, 1, 2, 3].map(|k| {
                let v = delta[k];
                before[k].wrapping_add(if v & 1 == 1 { !(v >> 1) } else { v >> 1 })
            }),
            Self::Words => {
                let word = |k: usize| {
                    let v = u16::from_le_bytes([delta[k], delta[k + 1]]);
                    let difference = if v & 1 == 1 { !(v >> 1) } else { v >> 1 };
                    u16::from_le_bytes([before[k], before[k + 1]]).wrapping_add(difference).to_le_bytes()
                };
                let ([a, b], [c, d]) = (word(0), word(2));
                [a, b, c, d]
            }
            // The text turns the difference left by `turn` when it is coded, so it is turned back here.
            Self::Xor(turn) => {
                (u32::from_le_bytes(before) ^ u32::from_le_bytes(delta).rotate_right(turn)).to_le_bytes()
            }
        }
    }
}

/// Reads the differences of a block of `elements` elements: those of byte position `k` begin at `k * block`.
fn read_block(
    rest: &mut Reader<'_>,
    newer: bool,
    elements: usize,
    block: usize,
    deltas: &mut [u8],
) -> Result<(), MeshoptError> {
    let stride = deltas.len() / block;
    let control = if newer { rest.take(stride / 4)? } else { &[] };
    for position in 0..stride {
        let out = &mut deltas[position * block..(position + 1) * block];
        let groups = elements.div_ceil(GROUP);
        let mode = control.get(position / 4).map(|byte| byte >> (2 * (position % 4)) & 3);
        use Packing::{Bits, Bytes, Zero};
        let packings = match mode {
            None => [Zero, Bits(2), Bits(4), Bytes],
            Some(0) => [Zero, Bits(1), Bits(2), Bits(4)],
            Some(1) => [Bits(1), Bits(2), Bits(4), Bytes],
            Some(2) => {
                out.fill(0);
                continue;
            }
            Some(_) => {
                out[..elements].copy_from_slice(rest.take(elements)?);
                continue;
            }
        };
        let header = rest.take(groups.div_ceil(4))?;
        for (group, out) in out.chunks_exact_mut(GROUP).take(groups).enumerate() {
            let packing = packings[usize::from(header[group / 4] >> (2 * (group % 4)) & 3)];
            read_group(rest, packing, out)?;
        }
    }
    Ok(())
}

fn read_group(rest: &mut Reader<'_>, packing: Packing, out: &mut [u8]) -> Result<(), MeshoptError> {
    match packing {
        Packing::Zero => out.fill(0),
        Packing::Bytes => out.copy_from_slice(rest.take(GROUP)?),
        Packing::Bits(bits) => {
            let packed = rest.take(GROUP * bits as usize / 8)?;
            let in_byte = 8 / bits as usize;
            let sentinel = (1 << bits) - 1;
            for (k, slot) in out.iter_mut().enumerate() {
                // Single bits run from the lowest, pairs and nibbles from the highest.
                let place = if bits == 1 { k % 8 } else { 8 - bits as usize * (k % in_byte + 1) };
                let value = packed[k / in_byte] >> place & sentinel;
                *slot = if value == sentinel { rest.take(1)?[0] } else { value };
            }
        }
    }
    Ok(())
}

/// The bytes that are not read yet.
struct Reader<'a> {
    bytes: &'a [u8],
    /// Elements of the whole stream, for the message.
    count: usize,
}

impl<'a> Reader<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], MeshoptError> {
        let (taken, rest) = self.bytes.split_at_checked(count).ok_or(MeshoptError::Short(self.count))?;
        self.bytes = rest;
        Ok(taken)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The example in the extension's text.
    #[test]
    fn nibbles_with_sentinels() {
        let bytes = [0x17, 0x5f, 0xf0, 0xbc, 0x77, 0xa9, 0x21, 0x00, 0x34, 0xb5];
        let mut rest = Reader { bytes: &bytes, count: 16 };
        let mut deltas = [0; GROUP];
        read_group(&mut rest, Packing::Bits(4), &mut deltas).unwrap();
        assert!(rest.bytes.is_empty());
        let decoded = deltas.map(|v| Channel::Bytes.next([0; 4], [v, 0, 0, 0])[0] as i8);
        assert_eq!(decoded, [-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0]);
    }
}
