//! An adaptive binary range coder.
//!
//! Based on: G. N. N. Martin, "Range encoding" (1979), in the carry-propagating form that LZMA made common.
//! Probabilities have 11 bits and move by a sixteenth of the error.

const PROBABILITY_BITS: u32 = 11;
const ADAPTATION: u32 = 4;
const TOP: u32 = 1 << 24;

/// More decisions than this cannot be stored in one byte: a decision costs at least 0.0106 bits, because its
/// probability stops adapting at 2033 in 2048.
pub const MOST_DECISIONS_PER_BYTE: usize = 1024;

/// The adaptive probability of one kind of yes-or-no decision.
#[derive(Clone, Copy, Debug)]
pub struct Bit(u16);

impl Default for Bit {
    fn default() -> Self {
        Self(1 << (PROBABILITY_BITS - 1))
    }
}

impl Bit {
    fn adapt(&mut self, bit: bool) {
        if bit {
            self.0 -= self.0 >> ADAPTATION;
        } else {
            self.0 += ((1 << PROBABILITY_BITS) - self.0) >> ADAPTATION;
        }
    }
}

/// Writes decisions.
pub struct Encoder {
    low: u64,
    range: u32,
    cache: u8,
    pending: usize,
    bytes: Vec<u8>,
}

impl Default for Encoder {
    fn default() -> Self {
        Self { low: 0, range: u32::MAX, cache: 0, pending: 0, bytes: Vec::new() }
    }
}

impl Encoder {
    /// Codes `bit` with the probability that `model` has learnt.
    pub fn bit(&mut self, model: &mut Bit, bit: bool) {
        let bound = (self.range >> PROBABILITY_BITS) * u32::from(model.0);
        model.adapt(bit);
        self.split(bound, bit);
    }

    /// Codes `bit`, which is set with a probability of `yes` in 65,536, neither 0 nor 65,536.
    pub fn likely(&mut self, yes: u16, bit: bool) {
        self.split((self.range >> 16) * (65_536 - u32::from(yes)), bit);
    }

    /// Goes on in the part of the range from `bound` on, or in that before it.
    fn split(&mut self, bound: u32, bit: bool) {
        if bit {
            self.low += u64::from(bound);
            self.range -= bound;
        } else {
            self.range = bound;
        }
        self.normalise();
    }

    /// Codes the `count` low bits of `value` as they are.
    pub fn raw(&mut self, value: u32, count: u32) {
        for shift in (0..count).rev() {
            self.range >>= 1;
            if value >> shift & 1 == 1 {
                self.low += u64::from(self.range);
            }
            self.normalise();
        }
    }

    /// All bytes; the last decisions are flushed.
    #[must_use]
    pub fn finish(mut self) -> Vec<u8> {
        for _ in 0..5 {
            self.shift();
        }
        self.bytes
    }

    fn normalise(&mut self) {
        while self.range < TOP {
            self.range <<= 8;
            self.shift();
        }
    }

    /// Moves the highest byte out; a byte of 255 waits, because a carry could still run through it.
    fn shift(&mut self) {
        if self.low < 0xff00_0000 || self.low > 0xffff_ffff {
            let carry = (self.low >> 32) as u8;
            self.bytes.push(self.cache.wrapping_add(carry));
            for _ in 0..self.pending {
                self.bytes.push(0xff_u8.wrapping_add(carry));
            }
            self.pending = 0;
            self.cache = (self.low >> 24) as u8;
        } else {
            self.pending += 1;
        }
        self.low = (self.low & 0x00ff_ffff) << 8;
    }
}

/// Where a [`Decoder`] stands.
#[derive(Clone, Copy, Debug)]
pub struct Paused {
    position: usize,
    range: u32,
    code: u32,
}

/// Reads decisions. Past the end of its bytes it reads zeros and remembers that it did.
pub struct Decoder<'a> {
    bytes: &'a [u8],
    position: usize,
    range: u32,
    code: u32,
}

impl<'a> Decoder<'a> {
    /// Reads from `bytes`.
    #[must_use]
    pub fn new(bytes: &'a [u8]) -> Self {
        let mut decoder = Self { bytes, position: 0, range: u32::MAX, code: 0 };
        for _ in 0..5 {
            decoder.code = decoder.code << 8 | decoder.next_byte();
        }
        decoder
    }

    /// Where it stands, to go on later.
    #[must_use]
    pub fn pause(&self) -> Paused {
        Paused { position: self.position, range: self.range, code: self.code }
    }

    /// Goes on over the same `bytes`.
    #[must_use]
    pub fn resume(bytes: &'a [u8], Paused { position, range, code }: Paused) -> Self {
        Self { bytes, position, range, code }
    }

    /// The next decision of the kind that `model` has learnt.
    pub fn bit(&mut self, model: &mut Bit) -> bool {
        let bound = (self.range >> PROBABILITY_BITS) * u32::from(model.0);
        let bit = self.split(bound);
        model.adapt(bit);
        bit
    }

    /// The next decision, which is yes with a probability of `yes` in 65,536.
    pub fn likely(&mut self, yes: u16) -> bool {
        self.split((self.range >> 16) * (65_536 - u32::from(yes)))
    }

    /// Goes on in the part of the range that the code lies in: whether it is the one from `bound` on.
    fn split(&mut self, bound: u32) -> bool {
        let bit = self.code >= bound;
        if bit {
            self.code -= bound;
            self.range -= bound;
        } else {
            self.range = bound;
        }
        self.normalise();
        bit
    }

    /// The next `count` bits that were written as they are.
    pub fn raw(&mut self, count: u32) -> u32 {
        let mut value = 0;
        for _ in 0..count {
            self.range >>= 1;
            let bit = self.code >= self.range;
            if bit {
                self.code -= self.range;
            }
            value = value << 1 | u32::from(bit);
            self.normalise();
        }
        value
    }

    /// Whether more was read than was there: what came out since is meaningless.
    #[must_use]
    pub fn exhausted(&self) -> bool {
        self.position > self.bytes.len()
    }

    /// Whether exactly the bytes that were there have been read.
    #[must_use]
    pub fn at_end(&self) -> bool {
        self.position == self.bytes.len()
    }

    fn normalise(&mut self) {
        while self.range < TOP {
            self.range <<= 8;
            self.code = self.code << 8 | self.next_byte();
        }
    }

    fn next_byte(&mut self) -> u32 {
        let byte = self.bytes.get(self.position).copied().unwrap_or(0);
        self.position = self.position.saturating_add(1);
        u32::from(byte)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn decisions_come_back(decisions in prop::collection::vec((0..4_usize, any::<bool>(), 0..=20_u32), 0..2000)) {
            let (mut models, mut encoder) = ([Bit::default(); 4], Encoder::default());
            for &(model, bit, width) in &decisions {
                encoder.bit(&mut models[model], bit);
                encoder.raw(0x9e37_79b9 >> (32 - width).min(31), width);
            }
            let bytes = encoder.finish();
            let (mut models, mut decoder) = ([Bit::default(); 4], Decoder::new(&bytes));
            for &(model, bit, width) in &decisions {
                prop_assert_eq!(decoder.bit(&mut models[model]), bit);
                let expected = (0x9e37_79b9_u32 >> (32 - width).min(31)) & ((1_u64 << width) - 1) as u32;
                prop_assert_eq!(decoder.raw(width), expected);
            }
            prop_assert!(decoder.at_end());
        }
    }

    #[test]
    fn carries_run_through_bytes_of_255() {
        let (mut model, mut encoder) = (Bit::default(), Encoder::default());
        for _ in 0..5000 {
            encoder.bit(&mut model, true);
        }
        for _ in 0..5000 {
            encoder.raw(1, 1);
        }
        let bytes = encoder.finish();
        let (mut model, mut decoder) = (Bit::default(), Decoder::new(&bytes));
        assert!((0..5000).all(|_| decoder.bit(&mut model)));
        assert!((0..5000).all(|_| decoder.raw(1) == 1));
        assert!(!decoder.exhausted());
    }

    #[test]
    fn no_decision_is_cheaper_than_declared() {
        let (mut model, mut encoder) = (Bit::default(), Encoder::default());
        let count = 1_000_000;
        for _ in 0..count {
            encoder.bit(&mut model, false);
        }
        let bytes = encoder.finish();
        assert!(bytes.len() * MOST_DECISIONS_PER_BYTE >= count);
    }
}
