//! Decisions of mixed probability, both ways: see [`kernels::codec::mixing`].

use super::binary::{Decoder, Encoder};
use kernels::codec::mixing::Mixer;

/// An encoder, which passes on the decisions that it is given, or a decoder, which gives those that it reads.
pub trait Decider {
    /// A decision that is yes with a probability of `yes` in 65,536, which is neither 0 nor 65,536.
    fn decide(&mut self, yes: u16, wanted: bool) -> bool;
    /// A decision that is as likely as not.
    fn toss(&mut self, wanted: bool) -> bool;
}

impl Decider for Encoder {
    fn decide(&mut self, yes: u16, wanted: bool) -> bool {
        self.likely(yes, wanted);
        wanted
    }

    fn toss(&mut self, wanted: bool) -> bool {
        self.raw(u32::from(wanted), 1);
        wanted
    }
}

impl Decider for Decoder<'_> {
    fn decide(&mut self, yes: u16, _: bool) -> bool {
        self.likely(yes)
    }

    fn toss(&mut self, _: bool) -> bool {
        self.raw(1) == 1
    }
}

/// Codes a decision in these contexts of `mixer`, with the weights of `choice`.
pub fn mixed(mixer: &mut Mixer, coder: &mut impl Decider, contexts: &[usize], choice: usize, wanted: bool) -> bool {
    let yes = mixer.guess(contexts, choice);
    let decision = coder.decide(yes, wanted);
    mixer.learn(decision);
    decision
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn decisions_come_back(decisions in prop::collection::vec((0..5_usize, 0..3_usize, any::<bool>()), 0..3000)) {
            let (mut encoder, mut mixer) = (Encoder::default(), Mixer::new(&[5, 3], 3));
            for &(a, b, bit) in &decisions {
                mixed(&mut mixer, &mut encoder, &[a, b], b, bit);
                encoder.toss(bit);
            }
            let bytes = encoder.finish();
            let (mut decoder, mut mixer) = (Decoder::new(&bytes), Mixer::new(&[5, 3], 3));
            for &(a, b, bit) in &decisions {
                prop_assert_eq!(mixed(&mut mixer, &mut decoder, &[a, b], b, false), bit);
                prop_assert_eq!(decoder.toss(false), bit);
            }
            prop_assert!(decoder.at_end());
        }
    }
}
