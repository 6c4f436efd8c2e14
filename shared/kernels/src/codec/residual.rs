//! Residuals as symbols: small ones each have their own, large ones share one with others of about their size and
//! carry the rest of their bits as they are.

use super::rans::{Decoder, Encoder, Table};
use super::zigzag::{unzigzag, zigzag};

/// Number of symbols of the alphabet.
pub const SYMBOLS: usize = DIRECT as usize + 2 * 28;
/// Residuals of this many magnitudes and signs have a symbol of their own.
const DIRECT: u32 = 24;
/// So that the first shared symbol begins at a power of two.
const OFFSET: u32 = 8;

/// A residual as what is coded of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Coded {
    /// Its symbol, below [`SYMBOLS`].
    pub symbol: u8,
    /// Number of bits that follow as they are.
    pub count: u32,
    /// Those bits.
    pub bits: u32,
}

impl Coded {
    /// What is coded of `residual`.
    #[must_use]
    pub fn new(residual: i32) -> Self {
        let value = zigzag(residual);
        if value < DIRECT {
            return Self { symbol: value as u8, count: 0, bits: 0 };
        }
        let shifted = value - OFFSET;
        let length = 31 - shifted.leading_zeros();
        let symbol = DIRECT + 2 * (length - 4) + (shifted >> (length - 1) & 1);
        let count = length - 1;
        Self { symbol: symbol as u8, count, bits: shifted & ((1 << count) - 1) }
    }

    /// Appends it to `lane`.
    pub fn write(&self, encoder: &mut Encoder, lane: usize, table: &Table) {
        encoder.symbol(lane, table, self.symbol);
        if self.count > 0 {
            encoder.raw(lane, self.bits, self.count);
        }
    }
}

/// The next residual of `lane`.
#[inline(always)]
pub fn read(decoder: &mut Decoder, lane: usize, table: &Table) -> i32 {
    let symbol = u32::from(decoder.symbol(lane, table));
    if symbol < DIRECT { unzigzag(symbol) } else { read_large(decoder, lane, symbol) }
}

#[cold]
fn read_large(decoder: &mut Decoder, lane: usize, symbol: u32) -> i32 {
    let (length, high) = ((symbol - DIRECT) / 2 + 4, (symbol - DIRECT) & 1);
    // Tables may be forged, but they have no more than `SYMBOLS` symbols.
    let count = (length - 1).min(30);
    let bits = decoder.raw(lane, count);
    unzigzag(((2 | high) << count | bits).wrapping_add(OFFSET))
}

/// Number of contexts in which residuals are counted.
pub const CONTEXTS: usize = 16;
/// Magnitudes are not told apart beyond this.
const LARGEST: u32 = 255;

/// The magnitude of a vertex's residual as contexts see it.
#[inline(always)]
pub fn magnitude(x: i32, y: i32, z: i32) -> u8 {
    let sum = x.unsigned_abs().min(LARGEST) + y.unsigned_abs().min(LARGEST) + z.unsigned_abs().min(LARGEST);
    sum.min(LARGEST) as u8
}

/// The context for each sum of three magnitudes: each of the smallest has its own, then half octaves.
#[must_use]
pub fn context_of_sum() -> [u8; 3 * LARGEST as usize + 1] {
    // First sum of contexts 6 to 15.
    const STARTS: [usize; 10] = [6, 8, 12, 17, 24, 34, 48, 68, 96, 136];
    let mut contexts = [0; 3 * LARGEST as usize + 1];
    for (sum, context) in contexts.iter_mut().enumerate() {
        let beyond = STARTS.iter().filter(|&&start| start <= sum).count();
        *context = if beyond == 0 { sum as u8 } else { 5 + beyond as u8 };
    }
    contexts
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::rans::{FREQUENCY_SUM, LANES};
    use super::*;

    proptest! {
        #[test]
        fn residuals_come_back(residuals in prop::collection::vec(prop_oneof![-40..40_i32, any::<i32>()], 0..300)) {
            let mut frequencies = vec![25; SYMBOLS];
            frequencies[0] = FREQUENCY_SUM - 25 * (SYMBOLS as u32 - 1);
            let table = Table::new(&frequencies).unwrap();
            let mut encoder = Encoder::default();
            for (index, &residual) in residuals.iter().enumerate() {
                Coded::new(residual).write(&mut encoder, index % LANES, &table);
            }
            let bytes = encoder.finish();
            let mut decoder = Decoder::new(&bytes).unwrap();
            for (index, &residual) in residuals.iter().enumerate() {
                prop_assert_eq!(read(&mut decoder, index % LANES, &table), residual);
            }
            prop_assert!(decoder.finished());
        }
    }

    #[test]
    fn contexts_grow_with_magnitudes() {
        let contexts = context_of_sum();
        assert!(contexts.is_sorted());
        assert_eq!(usize::from(contexts[3 * LARGEST as usize]), CONTEXTS - 1);
        assert_eq!(contexts[..7], [0, 1, 2, 3, 4, 5, 6]);
    }
}
