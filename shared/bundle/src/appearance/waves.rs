//! Entropy coding of a block's waves as versions 1.1 and 1.2 did it: modes know nothing of each other.

use crate::entropy::binary::{Bit, Decoder, Encoder};
use crate::entropy::numbers::Number;
use kernels::codec::zigzag::{unzigzag, zigzag};
use kernels::sort::{key, numbers, sort};
use texture::transform::{AREA, SIDE};

/// An encoder, which passes on what it is given, or a decoder, which gives what it reads.
pub trait Coder {
    /// A yes or no.
    fn bit(&mut self, model: &mut Bit, bit: bool) -> bool;
    /// A number of which something has been learnt.
    fn number(&mut self, model: &mut Number, value: u32) -> u32;
    /// A bit as it is.
    fn raw(&mut self, bit: bool) -> bool;
}

impl Coder for Encoder {
    fn bit(&mut self, model: &mut Bit, bit: bool) -> bool {
        Self::bit(self, model, bit);
        bit
    }

    fn number(&mut self, model: &mut Number, value: u32) -> u32 {
        model.encode(self, value);
        value
    }

    fn raw(&mut self, bit: bool) -> bool {
        Self::raw(self, u32::from(bit), 1);
        bit
    }
}

impl Coder for Decoder<'_> {
    fn bit(&mut self, model: &mut Bit, _: bool) -> bool {
        Self::bit(self, model)
    }

    fn number(&mut self, model: &mut Number, _: u32) -> u32 {
        model.decode(self)
    }

    fn raw(&mut self, _: bool) -> bool {
        Self::raw(self, 1) == 1
    }
}

/// Whole multiples of the step, by row and column of the wave.
pub type Waves = [i32; AREA];

/// What a block leaves for those to the right of it and below.
#[derive(Clone, Copy, Debug, Default)]
pub struct Trace {
    /// The constant wave.
    constant: i32,
    /// How far its waves reach in the order of [`Scan`].
    reach: u32,
}

/// The order of the waves, from slow ones to fast ones along diagonals, and what their place says of them.
#[derive(Clone, Debug)]
pub struct Scan {
    /// Index in [`Waves`] and class by speed.
    pub(super) order: Vec<(u8, u8)>,
}

impl Default for Scan {
    fn default() -> Self {
        let place = |at: usize| {
            let (x, y) = (at % SIDE, at / SIDE);
            let along = if (x + y).is_multiple_of(2) { x } else { y };
            key([(x + y) as u32, along as u32, at as u32, 0])
        };
        let mut order: Vec<u128> = (0..AREA).map(place).collect();
        sort(&mut order);
        let class = |sum: u32| [0, 0, 1, 2, 2, 3, 3, 3, 4, 4, 4, 4, 4, 5, 5, 5].get(sum as usize).copied().unwrap_or(6);
        let seat = |key| {
            let [diagonal, _, at, _] = numbers(key);
            (at as u8, class(diagonal))
        };
        Self { order: order.into_iter().map(seat).collect() }
    }
}

const SPEEDS: usize = 7;
const NEARBY: usize = 6;

/// What has been learnt of one channel's blocks.
#[derive(Clone, Debug, Default)]
pub struct Model {
    constant: [Number; 2],
    reach: [Number; 6],
    present: [[Bit; NEARBY]; SPEEDS],
    size: [Number; NEARBY],
}

impl Model {
    /// Codes a block: `waves` are written, or all zero and filled in. `None` where what is read is no block.
    pub fn block(
        &mut self,
        coder: &mut impl Coder,
        scan: &Scan,
        [left, above]: [Option<Trace>; 2],
        waves: &mut Waves,
    ) -> Option<Trace> {
        let near = [left.or(above), above.or(left)].map(Option::unwrap_or_default);
        let expected = (near[0].constant.wrapping_add(near[1].constant)) / 2;
        let found = &mut self.constant[usize::from(expected != 0)];
        let difference = coder.number(found, zigzag(waves[0].wrapping_sub(expected)));
        waves[0] = expected.wrapping_add(unzigzag(difference));

        let last = scan.order.iter().rposition(|&(at, _)| at > 0 && waves[usize::from(at)] != 0).unwrap_or(0);
        let class = (32 - (near[0].reach + near[1].reach).leading_zeros()).div_ceil(2).min(5);
        let reach = coder.number(&mut self.reach[class as usize], last as u32);
        let mut sizes = Sizes::default();
        for index in 1..=reach as usize {
            let &(at, speed) = scan.order.get(index)?;
            let nearby = sizes.around(at);
            let value = &mut waves[usize::from(at)];
            let present = &mut self.present[usize::from(speed)][nearby];
            if index < reach as usize && !coder.bit(present, *value != 0) {
                continue;
            }
            let size = coder.number(&mut self.size[nearby], value.unsigned_abs().wrapping_sub(1)).wrapping_add(1);
            let negative = coder.raw(*value < 0);
            *value = if negative { (size as i32).wrapping_neg() } else { size as i32 };
            sizes.note(at, size);
        }
        Some(Trace { constant: waves[0], reach })
    }
}

/// Sizes of a block's waves with a border, so that looking back needs no test.
struct Sizes([u8; (SIDE + 2) * (SIDE + 2)]);

impl Default for Sizes {
    fn default() -> Self {
        Self([0; (SIDE + 2) * (SIDE + 2)])
    }
}

impl Sizes {
    fn place(at: u8) -> usize {
        let at = usize::from(at);
        (at / SIDE + 2) * (SIDE + 2) + at % SIDE + 2
    }

    fn note(&mut self, at: u8, size: u32) {
        self.0[Self::place(at)] = size.min(3) as u8;
    }

    /// How large the next slower waves are, as a class.
    fn around(&self, at: u8) -> usize {
        let place = Self::place(at);
        let of = |back: usize| usize::from(self.0[place - back]);
        let row = SIDE + 2;
        let sum = 2 * (of(1) + of(row)) + of(2) + of(2 * row) + of(row + 1);
        [0, 1, 2, 2, 3, 3, 3, 4, 4, 4].get(sum).copied().unwrap_or(NEARBY - 1)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn blocks_come_back(values in prop::collection::vec((0..4_usize, 0..256_usize, -40_000..40_000_i32, 0..3_u32), 0..300)) {
            let scan = Scan::default();
            let mut blocks = vec![[0; AREA]; 4];
            for (block, at, value, shrink) in values {
                blocks[block][at] = value >> (shrink * 7);
            }
            let (mut encoder, mut model, mut trace) = (Encoder::default(), Model::default(), None);
            for waves in &mut blocks.clone() {
                let left = trace;
                trace = model.block(&mut encoder, &scan, [left, None], waves);
            }
            let bytes = encoder.finish();
            let (mut decoder, mut model, mut trace) = (Decoder::new(&bytes), Model::default(), None);
            for waves in blocks {
                let mut read = [0; AREA];
                let left = trace;
                trace = model.block(&mut decoder, &scan, [left, None], &mut read);
                prop_assert!(trace.is_some());
                prop_assert_eq!(read, waves);
            }
            prop_assert!(decoder.at_end());
        }
    }

    #[test]
    fn the_scan_visits_every_wave_once_and_looks_back_only() {
        let scan = Scan::default();
        let mut seen = [false; AREA];
        for &(at, _) in &scan.order {
            let (u, v) = (usize::from(at) % SIDE, usize::from(at) / SIDE);
            assert!(u == 0 || seen[usize::from(at) - 1]);
            assert!(v == 0 || seen[usize::from(at) - SIDE]);
            assert!(!std::mem::replace(&mut seen[usize::from(at)], true));
        }
        assert_eq!(scan.order.len(), AREA);
    }
}
