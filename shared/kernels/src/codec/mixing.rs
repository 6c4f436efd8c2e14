//! The probability of a yes-or-no decision, mixed from several guesses, each learnt in a context of its own.
//!
//! Based on: M. Mahoney, *Adaptive weighing of context models for lossless data compression*, 2005: guesses are added in the
//! logistic domain, and their weights follow the gradient of what a decision costs. Whole numbers only: the same bits
//! natively and in wasm.

use std::sync::LazyLock;

/// Most contexts that are mixed.
pub const MOST: usize = 6;

/// The logistic function at multiples of a half from -8 to 8, in 1 / 65,536.
const KNOTS: [u16; 33] = [
    22, 36, 60, 98, 162, 267, 439, 720, 1_179, 1_921, 3_108, 4_971, 7_812, 11_955, 17_625, 24_743, 32_768, 40_793,
    47_911, 53_581, 57_724, 60_565, 62_428, 63_615, 64_357, 64_816, 65_097, 65_269, 65_374, 65_438, 65_476, 65_500,
    65_514,
];

/// Largest logarithmic odds, in 1/256.
const STEEPEST: i32 = 2047;

/// The probability, in 1/65,536, whose logarithmic odds are `odds` / 256.
fn squash(odds: i32) -> u16 {
    let place = (odds.clamp(-STEEPEST, STEEPEST) + 2048) as usize;
    let [low, high] = [KNOTS[place >> 7], KNOTS[(place >> 7) + 1]].map(u32::from);
    let part = (place & 127) as u32;
    ((low * (128 - part) + high * part) >> 7) as u16
}

/// The inverse of [`squash`] by the twelve high bits of a probability; as code it is smaller than as numbers.
static STRETCH: LazyLock<Vec<i16>> = LazyLock::new(|| {
    let mut odds = -STEEPEST;
    let step = |at: u16| {
        while odds < STEEPEST && squash(odds) < at * 16 + 8 {
            odds += 1;
        }
        odds as i16
    };
    (0..4096).map(step).collect()
});

/// What has been learnt in one context.
#[derive(Clone, Copy, Debug)]
struct Guess {
    /// Probability of yes in 1/65,536.
    yes: u16,
    /// How often it was asked, up to 255.
    seen: u16,
}

/// How far weights follow: about 1/64 of the gradient.
const WEIGHT_SHIFT: u32 = 14;

/// A kind of decision, guessed in several contexts at once.
#[derive(Clone, Debug)]
pub struct Mixer {
    stretch: Vec<i16>,
    /// Guesses of one context after the other.
    guesses: Vec<Guess>,
    /// Where each context's guesses begin, and how many there are.
    ranges: Vec<(u32, u32)>,
    /// For each choice and context, how much it counts, in 1/65,536.
    weights: Vec<i32>,
    /// What the last question was about: its guesses, their odds, the first weight and what was answered.
    asked: [usize; MOST],
    odds: [i32; MOST],
    first: usize,
    yes: u16,
}

impl Mixer {
    /// Contexts of these sizes, [`MOST`] of them at most, and so many choices of weights.
    #[must_use]
    pub fn new(sizes: &[usize], choices: usize) -> Self {
        let sizes = &sizes[..sizes.len().min(MOST)];
        let mut total = 0;
        let range = |&size: &usize| {
            total += size as u32;
            (total - size as u32, size as u32)
        };
        let ranges: Vec<(u32, u32)> = sizes.iter().map(range).collect();
        // Together they begin as a little less than their mean.
        let begin = (52_429.0 / (sizes.len() as f32).sqrt()) as i32;
        Self {
            stretch: STRETCH.clone(),
            guesses: vec![Guess { yes: 1 << 15, seen: 0 }; total as usize],
            weights: vec![begin; choices * sizes.len()],
            ranges,
            asked: [0; MOST],
            odds: [0; MOST],
            first: 0,
            yes: 1 << 15,
        }
    }

    /// The probability of yes, in 1/65,536 and from 22 to 65,514, in these contexts, one of each size, with the weights of
    /// `choice`. [`Self::learn`] is told what came.
    pub fn guess(&mut self, contexts: &[usize], choice: usize) -> u16 {
        self.first = choice * self.ranges.len();
        let mut sum = 0;
        for (k, &(first, size)) in self.ranges.iter().enumerate() {
            let at = first as usize + contexts[k].min(size as usize - 1);
            let odds = i32::from(self.stretch[usize::from(self.guesses[at].yes >> 4)]);
            sum += i64::from(self.weights[self.first + k]) * i64::from(odds);
            (self.asked[k], self.odds[k]) = (at, odds);
        }
        self.yes = squash((sum >> 16).clamp(-2047, 2047) as i32);
        self.yes
    }

    /// What came after [`Self::guess`].
    pub fn learn(&mut self, yes: bool) {
        let came = i32::from(yes) * 65_535;
        let error = came - i32::from(self.yes);
        for k in 0..self.ranges.len() {
            let weight = &mut self.weights[self.first + k];
            let change = (self.odds[k] * error + (1 << (WEIGHT_SHIFT - 1))) >> WEIGHT_SHIFT;
            *weight = (*weight + change).clamp(-(1 << 20), 1 << 20);
            let guess = &mut self.guesses[self.asked[k]];
            // Fast at first, then a 128th of the way.
            let pace = 131_072 / (2 * u32::from(guess.seen) + 3);
            let step = (i64::from(came - i32::from(guess.yes)) * i64::from(pace)) >> 16;
            guess.yes = (i32::from(guess.yes) + step as i32).clamp(32, 65_503) as u16;
            guess.seen = (guess.seen + 1).min(255);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squash_and_stretch_are_inverse_and_monotone() {
        for odds in -STEEPEST..STEEPEST {
            assert!(squash(odds) <= squash(odds + 1));
            let exact = 65_536.0 / (1.0 + (f64::from(-odds) / 256.0).exp());
            assert!((f64::from(squash(odds)) / exact - 1.0).abs() < 0.04, "{odds}");
        }
        for (at, pair) in STRETCH.windows(2).enumerate() {
            assert!(pair[0] <= pair[1]);
            let back = i32::from(squash(i32::from(pair[0])));
            assert!((back - (at as i32 * 16 + 8)).abs() <= 24 + back.min(65_536 - back) / 64, "{at} {back}");
        }
    }

    /// Bits that decisions cost, in contexts that `of` tells of each.
    fn cost(of: impl Fn(usize) -> ([usize; 2], bool)) -> f64 {
        let mut mixer = Mixer::new(&[4, 2], 1);
        let one = |turn: usize| {
            let (contexts, bit) = of(turn);
            let yes = f64::from(mixer.guess(&contexts, 0)) / 65_536.0;
            mixer.learn(bit);
            -(if bit { yes } else { 1.0 - yes }).log2()
        };
        (0..20_000).map(one).sum()
    }

    #[test]
    fn what_one_context_knows_is_found_out() {
        // The second context tells the decision, the first one nothing.
        let bit = |turn: usize| (turn * turn / 7).is_multiple_of(3);
        let told = cost(|turn| ([turn % 4, usize::from(bit(turn))], bit(turn)));
        assert!(told < 300.0, "{told}");
        let untold = cost(|turn| ([0, 1], bit(turn)));
        assert!(untold > 40.0 * told, "{untold}");
    }
}
