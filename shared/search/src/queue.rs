//! A queue by least cost: one type for all searches, as each further heap would weigh a kilobyte on the page.

use std::collections::BinaryHeap;

/// What waits, least cost first; of equal costs the least payload first. Costs are not negative.
#[derive(Clone, Debug, Default)]
pub(super) struct Queue(BinaryHeap<u128>);

impl Queue {
    /// Adds `what` at `cost`. Floats that are not negative order as their bits do.
    #[inline(never)]
    pub fn push(&mut self, cost: f64, what: u64) {
        self.0.push(!(u128::from(cost.max(0.0).to_bits()) << 64 | u128::from(what)));
    }

    /// Takes the cheapest.
    #[inline(never)]
    pub fn pop(&mut self) -> Option<(f64, u64)> {
        let key = !self.0.pop()?;
        Some((f64::from_bits((key >> 64) as u64), key as u64))
    }

    /// How many wait.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Keeps only the `most` cheapest; what is dropped.
    pub fn cut(&mut self, most: usize) -> Vec<u64> {
        let mut keys = std::mem::take(&mut self.0).into_vec();
        let too_many = keys.len().saturating_sub(most);
        kernels::sort::least_first(&mut keys, too_many);
        let dropped = keys.drain(..too_many).map(|key| !key as u64).collect();
        self.0 = keys.into();
        dropped
    }
}
