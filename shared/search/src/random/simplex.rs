//! Changes to a chain that leave the probabilities of each state with the sum 1.

use super::chain::Chain;

impl Chain {
    /// Mixes a share of equal probabilities in.
    pub(super) fn open(&mut self, share: f64) {
        for state in 0..self.states() {
            let row = self.row(state);
            let even = share / row.len() as f64;
            self.probabilities[row].iter_mut().for_each(|p| *p = (1.0 - share) * *p + even);
        }
    }

    /// Moves against `gradient` and back onto the rows' simplices.
    pub(super) fn moved(&self, from: &[f64], gradient: &[f64], step: f64) -> Vec<f64> {
        let mut to: Vec<f64> = from.iter().zip(gradient).map(|(p, g)| p - step * g).collect();
        for state in 0..self.states() {
            project(&mut to[self.row(state)]);
        }
        to
    }
}

/// The nearest point whose coordinates are not negative and have the sum 1 (Held, Wolfe and Crowder 1974).
fn project(row: &mut [f64]) {
    if let [only] = row {
        *only = 1.0;
        return;
    }
    let mut sorted = row.to_vec();
    // Rows are short, and a sort of their own would weigh 2 KB on the page.
    for end in 1..sorted.len() {
        let mut at = end;
        while at > 0 && sorted[at - 1] < sorted[at] {
            sorted.swap(at - 1, at);
            at -= 1;
        }
    }
    let (mut sum, mut shift) = (0.0, 0.0);
    for (index, value) in sorted.iter().enumerate() {
        sum += value;
        let candidate = (sum - 1.0) / (index + 1) as f64;
        if value - candidate > 0.0 {
            shift = candidate;
        }
    }
    row.iter_mut().for_each(|value| *value = (*value - shift).max(0.0));
}
