//! Variety: alternatives of recorded stretches, shown whenever the actor comes by.

use std::sync::Arc;

use bundle::AlternativesDecoder;
use synthesis::Varied;

use super::Player;

/// By this what is shown is drawn.
const SEED: u64 = 1;

/// Alternatives that are being read, and how much of them is shown.
pub struct Variety {
    coming: Option<AlternativesDecoder>,
    amount: f32,
}

impl Default for Variety {
    fn default() -> Self {
        Self { coming: None, amount: 1.0 }
    }
}

impl Player {
    /// Reads a piece of the alternatives, once they have arrived: all of it takes longer than a display frame.
    pub(super) fn read_alternatives(&mut self) {
        if self.loading.source.varied.is_some() {
            return;
        }
        if self.variety.coming.is_none() {
            // What is damaged is left out: the recording is there.
            self.variety.coming = self.loading.take_alternatives().ok().flatten();
        }
        let Some(coming) = &mut self.variety.coming else { return };
        match coming.advance() {
            Ok(None) => {}
            Ok(Some(all)) => {
                self.loading.source.varied = Some(Varied::new(Arc::new(all), SEED, self.variety.amount));
                self.variety.coming = None;
            }
            Err(_) => self.variety.coming = None,
        }
    }

    /// How much recorded stretches vary: the share of their alternatives' differences, from 0, as recorded, to 1. From the next
    /// stretch on.
    pub fn set_variety(&mut self, amount: f64) {
        self.variety.amount = if amount.is_finite() { amount.clamp(0.0, 1.0) as f32 } else { 0.0 };
        if let Some(varied) = &mut self.loading.source.varied {
            varied.set_amount(self.variety.amount);
        }
    }

    /// The number of the stretch that is shown in another way than it was recorded, and which one that is.
    #[must_use]
    pub fn alternative(&self) -> Option<(usize, usize)> {
        self.loading.source.varied.as_ref()?.present()
    }

    /// The recording again, at once.
    pub(super) fn leave_variety(&mut self) {
        if self.loading.source.varied.as_mut().is_some_and(Varied::leave) {
            self.producer.forget_poses();
        }
    }
}
