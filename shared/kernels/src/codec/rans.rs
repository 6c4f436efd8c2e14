//! A static entropy coder: range asymmetric numeral systems over known frequencies.
//!
//! Based on: J. Duda, "Asymmetric numeral systems" (2013), arXiv:1311.2540, with 32-bit states that are refilled 16
//! bits at a time. Three states, one for each coordinate, take turns on one stream, so that the processor works on
//! three symbols at once.

/// Frequencies add up to two to the power of this.
pub const FREQUENCY_BITS: u32 = 11;
/// Sum of the frequencies of a table.
pub const FREQUENCY_SUM: u32 = 1 << FREQUENCY_BITS;
/// Number of states that take turns.
pub const LANES: usize = 3;

const LOWEST: u32 = 1 << 16;

/// Frequencies of the symbols of one context, ready for coding both ways.
#[derive(Clone, Debug)]
pub struct Table {
    symbol_of_slot: Box<[u8; FREQUENCY_SUM as usize]>,
    /// Frequency and first slot of each symbol.
    share: [(u16, u16); 256],
}

impl Table {
    /// A table of `frequencies`, whose sum must be [`FREQUENCY_SUM`], for at most 256 symbols; otherwise `None`.
    #[must_use]
    pub fn new(frequencies: &[u32]) -> Option<Self> {
        let sum: u64 = frequencies.iter().map(|&frequency| u64::from(frequency)).sum();
        if sum != u64::from(FREQUENCY_SUM) || frequencies.len() > 256 {
            return None;
        }
        let mut table = Self { symbol_of_slot: Box::new([0; FREQUENCY_SUM as usize]), share: [(0, 0); 256] };
        let mut start = 0;
        for (symbol, &frequency) in frequencies.iter().enumerate() {
            table.share[symbol] = (frequency as u16, start as u16);
            table.symbol_of_slot[start..start + frequency as usize].fill(symbol as u8);
            start += frequency as usize;
        }
        Some(table)
    }
}

/// Collects what is to be coded, first to last, and codes it last to first, as this family of coders must.
#[derive(Default)]
pub struct Encoder {
    steps: Vec<(u8, Step)>,
}

#[derive(Clone, Copy)]
enum Step {
    Symbol { frequency: u16, start: u16 },
    Raw { value: u16, count: u8 },
}

impl Encoder {
    /// Appends `symbol`, which must have a frequency in `table`, to `lane`.
    pub fn symbol(&mut self, lane: usize, table: &Table, symbol: u8) {
        let (frequency, start) = table.share[usize::from(symbol)];
        debug_assert!(frequency > 0, "symbol {symbol} has no frequency");
        self.steps.push((lane as u8, Step::Symbol { frequency, start }));
    }

    /// Appends the `count` (at most 32) low bits of `value` to `lane`, as they are.
    pub fn raw(&mut self, lane: usize, value: u32, count: u32) {
        self.raw_part(lane, value, count.min(16));
        if count > 16 {
            self.raw_part(lane, value >> 16, count - 16);
        }
    }

    fn raw_part(&mut self, lane: usize, value: u32, count: u32) {
        let value = (value & ((1 << count) - 1)) as u16;
        self.steps.push((lane as u8, Step::Raw { value, count: count as u8 }));
    }

    /// The bytes of all that was appended.
    #[must_use]
    pub fn finish(self) -> Vec<u8> {
        let mut states = [LOWEST; LANES];
        let mut words = Vec::new();
        for &(lane, step) in self.steps.iter().rev() {
            let state = &mut states[usize::from(lane)];
            let full = match step {
                Step::Symbol { frequency, .. } => u64::from(frequency) << (32 - FREQUENCY_BITS),
                Step::Raw { count, .. } => 1 << (32 - u32::from(count)),
            };
            if u64::from(*state) >= full {
                words.push(*state as u16);
                *state >>= 16;
            }
            *state = match step {
                Step::Symbol { frequency, start } => {
                    let frequency = u32::from(frequency);
                    ((*state / frequency) << FREQUENCY_BITS) + *state % frequency + u32::from(start)
                }
                Step::Raw { value, count } => *state << count | u32::from(value),
            };
        }
        let mut bytes: Vec<u8> = states.iter().flat_map(|state| state.to_le_bytes()).collect();
        bytes.extend(words.iter().rev().flat_map(|word| word.to_le_bytes()));
        bytes
    }
}

/// Reads symbols back, first to last. Past the end of its bytes it reads zeros; [`Decoder::finished`] then says no.
pub struct Decoder<'a> {
    states: [u32; LANES],
    words: &'a [u8],
    position: usize,
}

impl<'a> Decoder<'a> {
    /// Reads from `bytes`; `None` where they are too short to hold the states.
    #[must_use]
    pub fn new(bytes: &'a [u8]) -> Option<Self> {
        let (head, words) = bytes.split_at_checked(4 * LANES)?;
        let mut states = [0; LANES];
        for (state, bytes) in states.iter_mut().zip(head.as_chunks::<4>().0) {
            *state = u32::from_le_bytes(*bytes);
        }
        Some(Self { states, words, position: 0 })
    }

    /// The next symbol of `lane`.
    #[inline(always)]
    pub fn symbol(&mut self, lane: usize, table: &Table) -> u8 {
        let state = self.states[lane];
        let slot = state & (FREQUENCY_SUM - 1);
        let symbol = table.symbol_of_slot[slot as usize];
        let (frequency, start) = table.share[usize::from(symbol)];
        let state = u32::from(frequency)
            .wrapping_mul(state >> FREQUENCY_BITS)
            .wrapping_add(slot.wrapping_sub(u32::from(start)));
        self.refill(lane, state);
        symbol
    }

    /// The next `count` (at most 32) bits of `lane` that were written as they are.
    pub fn raw(&mut self, lane: usize, count: u32) -> u32 {
        let low = self.raw_part(lane, count.min(16));
        if count > 16 { low | self.raw_part(lane, count - 16) << 16 } else { low }
    }

    /// Whether everything was read, nothing more and nothing less, and the states are where the encoder began.
    #[must_use]
    pub fn finished(&self) -> bool {
        self.position == self.words.len() && self.states == [LOWEST; LANES]
    }

    fn raw_part(&mut self, lane: usize, count: u32) -> u32 {
        let state = self.states[lane];
        self.refill(lane, state >> count);
        state & ((1 << count) - 1)
    }

    #[inline(always)]
    fn refill(&mut self, lane: usize, state: u32) {
        self.states[lane] = if state < LOWEST {
            let word = match self.words.get(self.position..self.position + 2) {
                Some(&[low, high]) => u32::from(u16::from_le_bytes([low, high])),
                _ => 0,
            };
            self.position += 2;
            state << 16 | word
        } else {
            state
        };
    }
}

/// Scales `counts` to frequencies with a sum of [`FREQUENCY_SUM`]; every symbol that occurs keeps at least one.
///
/// At most [`FREQUENCY_SUM`] symbols may occur. If none does, symbol 0 gets everything.
#[must_use]
pub fn frequencies(counts: &[u64]) -> Vec<u32> {
    let total: u64 = counts.iter().sum();
    let mut frequencies = vec![0_u32; counts.len()];
    if total == 0 {
        frequencies[0] = FREQUENCY_SUM;
        return frequencies;
    }
    for (frequency, &count) in frequencies.iter_mut().zip(counts) {
        let exact = u128::from(count) * u128::from(FREQUENCY_SUM) / u128::from(total);
        *frequency = if count == 0 { 0 } else { (exact as u32).max(1) };
    }
    // What rounding left over or took too much goes to the most frequent symbols, where it matters least.
    let mut sum: u32 = frequencies.iter().sum();
    while sum != FREQUENCY_SUM {
        let Some(largest) = (0..counts.len()).max_by_key(|&symbol| (frequencies[symbol], counts.len() - symbol)) else {
            break;
        };
        if sum < FREQUENCY_SUM {
            frequencies[largest] += FREQUENCY_SUM - sum;
            sum = FREQUENCY_SUM;
        } else {
            frequencies[largest] -= 1;
            sum -= 1;
        }
    }
    frequencies
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn symbols_come_back(symbols in prop::collection::vec((0..40_u8, 0..=32_u32, any::<u32>()), 0..1000)) {
            let mut counts = vec![0; 40];
            symbols.iter().for_each(|&(symbol, _, _)| counts[usize::from(symbol)] += 1);
            let table = Table::new(&frequencies(&counts)).unwrap();
            let mut encoder = Encoder::default();
            for (index, &(symbol, count, value)) in symbols.iter().enumerate() {
                encoder.symbol(index % LANES, &table, symbol);
                encoder.raw(index % LANES, value, count);
            }
            let bytes = encoder.finish();
            let mut decoder = Decoder::new(&bytes).unwrap();
            for (index, &(symbol, count, value)) in symbols.iter().enumerate() {
                prop_assert_eq!(decoder.symbol(index % LANES, &table), symbol);
                let mask = ((1_u64 << count) - 1) as u32;
                prop_assert_eq!(decoder.raw(index % LANES, count), value & mask);
            }
            prop_assert!(decoder.finished());
        }

        #[test]
        fn frequencies_have_the_right_sum(counts in prop::collection::vec(0..100_000_u64, 1..200)) {
            let frequencies = frequencies(&counts);
            prop_assert_eq!(frequencies.iter().sum::<u32>(), FREQUENCY_SUM);
            if counts.iter().any(|&count| count > 0) {
                for (&frequency, &count) in frequencies.iter().zip(&counts) {
                    prop_assert_eq!(frequency > 0, count > 0);
                }
            }
        }
    }
}
