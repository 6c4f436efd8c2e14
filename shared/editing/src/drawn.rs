//! Handles beyond the reach of a surface without bones: they stop where the surface would be drawn out.
//!
//! Nothing tells a surface how far its limbs reach: modes are blown up, and edges stretched, until its handles are where they are wanted. So a
//! surface that has come to rest is looked at. Where too much of it is drawn out, modes are first made rarer, up to next to none: they are no guide
//! so far from what was recorded. Where that does not do, its handles go less far, as far as it stays whole.

/// A surface is whole where at most one edge in so many is longer than this, beside how long it was. Chosen on crane + jumping (`docs/results`):
/// edits within reach are below, recorded frames beside one another far above.
pub(crate) const ONE_IN: usize = 100;
pub(crate) const LONGEST: f32 = 1.35;
/// How close to that is close enough, and how often it is looked for.
const CLOSE: f32 = 0.05;
const TRIES: usize = 4;

/// By how much modes are made rarer at a time, and how often.
const RARER: f64 = 30.0;
pub(crate) const TIMES: i32 = 2;

/// How far handles may go: what was found so far.
#[derive(Clone, Debug)]
pub(crate) struct Drawn {
    /// Whether handles are wanted beyond what any surface reaches.
    pub(crate) is_far: bool,
    /// How often modes were made rarer.
    pub(crate) rarer: i32,
    /// No handle goes farther than this, in metres.
    pub(crate) cap: f32,
    /// The farthest cap at which the surface was whole, the nearest at which it was not, and how long its edges were there.
    low: (f32, f32),
    high: Option<(f32, f32)>,
    tries: usize,
}

impl Default for Drawn {
    fn default() -> Self {
        Self { is_far: false, rarer: 0, cap: f32::INFINITY, low: (0.0, 1.0), high: None, tries: 0 }
    }
}

impl Drawn {
    /// The weight of the modes' prior, which is `prior` where nothing is drawn out.
    pub(crate) fn prior(&self, prior: f64) -> f64 {
        prior * RARER.powi(self.rarer)
    }

    /// The next cap where edges are as long as `length` by the one that there is; nothing where that is as it is to be.
    pub(crate) fn next(&mut self, length: f32) -> Option<f32> {
        let is_whole = length <= LONGEST;
        let is_close = length > LONGEST * (1.0 - CLOSE);
        if is_whole && (self.high.is_none() || is_close || self.tries >= TRIES) {
            return None;
        }
        self.tries += 1;
        match is_whole {
            true => self.low = (self.cap, length),
            false => (self.high, self.is_far) = (Some((self.cap, length)), true),
        }
        let (low, (high, most)) = (self.low, self.high?);
        if self.tries > TRIES {
            // Enough: the last at which it was whole. What still is not, is as good as it gets.
            return (self.tries == TRIES + 1).then_some(low.0);
        }
        let share = (LONGEST * (1.0 - 0.5 * CLOSE) - low.1) / (most - low.1).max(1e-6);
        Some(low.0 + share.clamp(0.1, 0.9) * (high - low.0))
    }
}
