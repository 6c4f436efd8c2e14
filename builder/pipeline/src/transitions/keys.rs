//! Sums of distances and numbers of nodes as one number, exactly.
//!
//! Distances are rounded to multiples of 2^-s, s as large as the capture allows (36 for the papers' lengths and
//! distances of a radian or so, an error of 1e-11). A path of L nodes and a sum of D multiples is the *key*
//! `D 2^b + L`, an integer below 2^53, so an `f64` holds it and adds it without rounding. Then the smaller key is the
//! path of the smaller sum, and of two equal sums the shorter path; no result depends on the order of additions.

use super::options::{HASTE_SPEED, Lengths, TransitionError};
use crate::distance::DistanceMatrix;

/// How distances are turned into keys and back.
#[derive(Clone, Copy, Debug)]
pub(super) struct Keys {
    /// 2^s.
    multiples: f64,
    /// 2^b, more than the nodes of any path.
    nodes: f64,
    /// 2^-b.
    inverse_nodes: f64,
    /// What the square of the sum of multiples is times for [`Self::haste`].
    hurry: f64,
}

impl Keys {
    /// Keys for paths through grids of `lengths` over `distances`.
    pub(super) fn new(distances: &DistanceMatrix, lengths: Lengths, fps: f32) -> Result<Self, TransitionError> {
        let mut largest = 0.0_f32;
        for i in 0..distances.frame_count() {
            let row = distances.row(i);
            if let Some(j) = row.iter().position(|d| !(d.is_finite() && *d >= 0.0)) {
                return Err(TransitionError::Distance(i, j));
            }
            largest = row.iter().fold(largest, |a, &b| a.max(b));
        }
        let most_nodes = (2 * lengths.longest) as f64;
        let node_bits = exponent_above(most_nodes);
        let sum_bits = exponent_above(most_nodes * f64::from(largest.max(f32::MIN_POSITIVE)));
        let multiples = 2.0_f64.powi((53 - node_bits - sum_bits).min(64));
        let hurry = f64::from(fps) / (HASTE_SPEED * multiples);
        Ok(Self {
            multiples,
            nodes: 2.0_f64.powi(node_bits),
            inverse_nodes: 2.0_f64.powi(-node_bits),
            hurry: hurry * hurry,
        })
    }

    /// The key of one node.
    #[inline(always)]
    pub(super) fn of_distance(self, distance: f32) -> f64 {
        (f64::from(distance) * self.multiples).round() * self.nodes + 1.0
    }

    /// The sum of distances D and the number of nodes L of a key.
    #[inline(always)]
    pub(super) fn split(self, key: f64) -> (f64, f64) {
        let multiples = self.multiples_of(key);
        (multiples / self.multiples, self.nodes_of(key, multiples))
    }

    /// D in multiples. The nodes are more than 0 and less than 2^b, so that rounding takes them away.
    #[inline(always)]
    pub(super) fn multiples_of(self, key: f64) -> f64 {
        /// Adding it leaves no fraction.
        const WHOLE: f64 = 6_755_399_441_055_744.0;
        ((key * self.inverse_nodes - 0.5) + WHOLE) - WHOLE
    }

    /// L, given D in multiples.
    #[inline(always)]
    pub(super) fn nodes_of(self, key: f64, multiples: f64) -> f64 {
        key - multiples * self.nodes
    }

    /// Whether key `a` has the smaller mean D / L, or the same mean and a smaller sum. The products are exact: a sum
    /// has at most 53 - b bits, a number of nodes b.
    #[inline(always)]
    pub(super) fn smaller_mean(self, a: f64, b: f64) -> bool {
        let (multiples_a, multiples_b) = (self.multiples_of(a), self.multiples_of(b));
        let left = multiples_a * self.nodes_of(b, multiples_b);
        let right = multiples_b * self.nodes_of(a, multiples_a);
        // No path has an infinite key, and no mean: neither comparison of products holds then.
        left < right || (a < b && (left == right || b == f64::INFINITY))
    }

    /// The haste of a path, in frames: (D / (L w))^2 fps^2 / (L - 1) + L - 1. A path of one node is all haste; no path is
    /// infinitely hasty.
    #[inline(always)]
    pub(super) fn haste(self, key: f64) -> f64 {
        let multiples = self.multiples_of(key);
        let nodes = self.nodes_of(key, multiples);
        // The key of no path leaves no number of nodes.
        let steps = if key < f64::INFINITY { nodes - 1.0 } else { 0.0 };
        let mean = multiples / nodes;
        if steps > 0.0 { mean * mean * self.hurry / steps + steps } else { f64::INFINITY }
    }

    /// Whether key `a` has the smaller haste, or the same and a smaller sum.
    #[inline(always)]
    pub(super) fn smaller_haste(self, a: f64, b: f64) -> bool {
        let (hastes_a, hastes_b) = (self.haste(a), self.haste(b));
        hastes_a < hastes_b || (hastes_a == hastes_b && a < b)
    }
}

/// The least e with 2^e > x > 0.
fn exponent_above(x: f64) -> i32 {
    x.log2().floor() as i32 + 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_come_apart_again() {
        let lengths = Lengths { shortest: 15, longest: 100 };
        let distances = DistanceMatrix::from_fn(3, |i, j| 0.3 + 0.9 * (i + j) as f32);
        let keys = Keys::new(&distances, lengths, 25.0).unwrap();
        let node = keys.of_distance(3.0);
        let sum: f64 = (0..199).map(|_| node).sum();
        assert_eq!(keys.split(sum), (597.0, 199.0));
        assert!(sum + 1.0 < 2.0_f64.powi(53));
        assert!(keys.smaller_mean(keys.of_distance(0.5) * 2.0, keys.of_distance(0.6)));
        assert!(!keys.smaller_mean(keys.of_distance(0.5) * 2.0, keys.of_distance(0.5)));
        for (a, b) in [(f64::INFINITY, node), (f64::INFINITY, f64::INFINITY)] {
            assert!(!keys.smaller_mean(a, b));
        }
        assert!(keys.smaller_mean(node, f64::INFINITY));
        let bad = DistanceMatrix::from_fn(3, |_, j| if j == 2 { f32::NAN } else { 1.0 });
        assert!(matches!(Keys::new(&bad, lengths, 25.0), Err(TransitionError::Distance(0, 2))));
    }
}
