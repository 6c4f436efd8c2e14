//! Whole numbers as adaptive decisions: how long the number is, its two highest bits, then the rest as it is.

use super::binary::{Bit, Decoder, Encoder};
use crate::codec::zigzag::{unzigzag, zigzag};

/// What has been learnt about one kind of number from 0 to 2^32 - 2.
#[derive(Clone, Debug, Default)]
pub struct Number {
    length: [Bit; 32],
    high: [[Bit; 4]; 32],
}

impl Number {
    /// Codes `value`, which is less than `u32::MAX`.
    pub fn encode(&mut self, encoder: &mut Encoder, value: u32) {
        let shifted = value.saturating_add(1);
        let length = 31 - shifted.leading_zeros();
        for step in 0..length {
            encoder.bit(&mut self.length[step as usize], true);
        }
        if length < 31 {
            encoder.bit(&mut self.length[length as usize], false);
        }
        let (mut rest, mut context) = (length, 1);
        while rest > 0 && context < 4 {
            rest -= 1;
            let bit = shifted >> rest & 1;
            encoder.bit(&mut self.high[length as usize][context], bit == 1);
            context = context << 1 | bit as usize;
        }
        encoder.raw(shifted & ((1_u64 << rest) - 1) as u32, rest);
    }

    /// The next number.
    pub fn decode(&mut self, decoder: &mut Decoder) -> u32 {
        let mut length = 0;
        while length < 31 && decoder.bit(&mut self.length[length]) {
            length += 1;
        }
        let (mut rest, mut context, mut shifted) = (length as u32, 1, 1_u32);
        while rest > 0 && context < 4 {
            rest -= 1;
            let bit = decoder.bit(&mut self.high[length][context]);
            shifted = shifted << 1 | u32::from(bit);
            context = context << 1 | usize::from(bit);
        }
        let low = decoder.raw(rest);
        ((u64::from(shifted) << rest | u64::from(low)) as u32).wrapping_sub(1)
    }

    /// Codes a number with a sign, greater than -2^31 + 1.
    pub fn encode_signed(&mut self, encoder: &mut Encoder, value: i32) {
        self.encode(encoder, zigzag(value));
    }

    /// The next number with a sign.
    pub fn decode_signed(&mut self, decoder: &mut Decoder) -> i32 {
        unzigzag(self.decode(decoder))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn numbers_come_back(values in prop::collection::vec(prop_oneof![0..10_u32, 0..u32::MAX], 0..300)) {
            let (mut model, mut encoder) = (Number::default(), Encoder::default());
            values.iter().for_each(|&value| model.encode(&mut encoder, value));
            let bytes = encoder.finish();
            let (mut model, mut decoder) = (Number::default(), Decoder::new(&bytes));
            for &value in &values {
                prop_assert_eq!(model.decode(&mut decoder), value);
            }
            prop_assert!(decoder.at_end());
        }

    }
}
