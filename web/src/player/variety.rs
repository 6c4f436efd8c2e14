//! Variety: alternatives of recorded stretches, shown whenever the actor comes by.

use std::sync::Arc;

use bundle::AlternativesDecoder;
use synthesis::Varied;

use super::loading::Loading;

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

impl Variety {
    /// Reads a piece of the alternatives, once they have arrived: all of it takes longer than a display frame.
    pub fn read(&mut self, loading: &mut Loading) {
        if loading.source.varied.is_some() {
            return;
        }
        if self.coming.is_none() {
            // What is damaged is left out: the recording is there.
            self.coming = loading.take_alternatives().ok().flatten();
        }
        let Some(coming) = &mut self.coming else { return };
        match coming.advance() {
            Ok(None) => {}
            Ok(Some(all)) => {
                loading.source.varied = Some(Varied::new(Arc::new(all), SEED, self.amount));
                self.coming = None;
            }
            Err(_) => self.coming = None,
        }
    }

    /// Takes another share of the alternatives' differences, from 0 to 1.
    pub fn set(&mut self, loading: &mut Loading, amount: f64) {
        self.amount = if amount.is_finite() { amount.clamp(0.0, 1.0) as f32 } else { 0.0 };
        if let Some(varied) = &mut loading.source.varied {
            varied.set_amount(self.amount);
        }
    }
}
