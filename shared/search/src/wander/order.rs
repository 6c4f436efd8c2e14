//! Puts transitions in order, the best first, some at a time: runs are sorted while they are gathered, then merged.
//!
//! There may be a million: a heap of all of them would be walked through from end to end for each that is taken out.

use crate::queue::Queue;
use kernels::sort;

/// Transitions of a run.
const RUN: usize = 1024;

/// Transitions that are being put in order.
#[derive(Clone, Debug, Default)]
pub(super) struct Order {
    /// What they cost, and their numbers: in order within each run once it is full.
    keys: Vec<u128>,
    /// The first of each run that is left, and where it is.
    heads: Queue,
    /// Those that are in order.
    merged: Vec<u32>,
}

impl Order {
    /// Adds a transition that costs `cost`, which is not negative.
    pub(super) fn add(&mut self, cost: f64, index: u32) {
        self.keys.push(u128::from(cost.max(0.0).to_bits()) << 64 | u128::from(index));
        if self.keys.len().is_multiple_of(RUN) {
            self.end_run(self.keys.len() - RUN);
        }
    }

    /// Ends the last run: no more are added.
    pub(super) fn end(&mut self) {
        let rest = self.keys.len() % RUN;
        if rest > 0 {
            self.end_run(self.keys.len() - rest);
        }
    }

    /// Takes the next `most`; those that are in order once that was all.
    pub(super) fn merge(&mut self, most: usize) -> Option<Vec<u32>> {
        for _ in 0..most {
            let Some((_, head)) = self.heads.pop() else { return Some(std::mem::take(&mut self.merged)) };
            self.merged.push((head >> 32) as u32);
            let next = head as u32 as usize + 1;
            if next < self.keys.len() && !next.is_multiple_of(RUN) {
                self.wait(next);
            }
        }
        None
    }

    fn end_run(&mut self, first: usize) {
        sort::sort(&mut self.keys[first..]);
        self.wait(first);
    }

    /// The first of what is left of a run waits to be taken: of equal costs the least number.
    fn wait(&mut self, place: usize) {
        let key = self.keys[place];
        self.heads.push(f64::from_bits((key >> 64) as u64), u64::from(key as u32) << 32 | place as u64);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_merged_as_all_are_sorted() {
        for count in [0, 1, RUN, RUN + 1, 5000_usize] {
            let cost = |index: usize| (index * 7919 % 211) as f64 / 7.0;
            let mut order = Order::default();
            (0..count).for_each(|index| order.add(cost(index), index as u32));
            order.end();
            let merged = std::iter::from_fn(|| Some(order.merge(17))).flatten().next().unwrap();
            let mut sorted: Vec<u32> = (0..count as u32).collect();
            sorted.sort_by(|&a, &b| cost(a as usize).total_cmp(&cost(b as usize)));
            assert_eq!(merged, sorted, "{count}");
        }
    }
}
