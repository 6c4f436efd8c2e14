//! Smooth curves through keys in time.

/// A value that passes through keys without overshooting them, constant before the first and after the last.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    keys: Vec<(f32, f32)>,
    slopes: Vec<f32>,
}

impl Curve {
    /// A curve through `keys`, pairs of time and value, in ascending time.
    #[must_use]
    pub fn new(keys: &[(f32, f32)]) -> Self {
        let slopes = (0..keys.len()).map(|k| slope(keys, k)).collect();
        Self { keys: keys.to_vec(), slopes }
    }

    /// The value at time `t`; 0 without keys.
    #[must_use]
    pub fn at(&self, t: f32) -> f32 {
        let next = self.keys.partition_point(|key| key.0 <= t);
        if next == 0 || next == self.keys.len() {
            let end = if next == 0 { self.keys.first() } else { self.keys.last() };
            return end.map_or(0.0, |key| key.1);
        }
        let ((t0, v0), (t1, v1)) = (self.keys[next - 1], self.keys[next]);
        let width = t1 - t0;
        let u = (t - t0) / width;
        let (u2, u3) = (u * u, u * u * u);
        v0 * (2.0 * u3 - 3.0 * u2 + 1.0)
            + v1 * (3.0 * u2 - 2.0 * u3)
            + width * (self.slopes[next - 1] * (u3 - 2.0 * u2 + u) + self.slopes[next] * (u3 - u2))
    }
}

/// The slope at key `k`: none at extremes and ends, else the harmonic mean of both sides (Fritsch and Butland, 1984).
fn slope(keys: &[(f32, f32)], k: usize) -> f32 {
    if k == 0 || k + 1 == keys.len() {
        return 0.0;
    }
    let rise = |a: (f32, f32), b: (f32, f32)| (b.1 - a.1) / (b.0 - a.0).max(1e-6);
    let (before, after) = (rise(keys[k - 1], keys[k]), rise(keys[k], keys[k + 1]));
    if before * after <= 0.0 { 0.0 } else { 2.0 * before * after / (before + after) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_through_its_keys_and_never_beyond() {
        let curve = Curve::new(&[(0.0, 0.0), (1.0, 2.0), (1.5, 2.5), (3.0, -1.0)]);
        for (t, value) in [(-1.0, 0.0), (1.0, 2.0), (1.5, 2.5), (9.0, -1.0)] {
            assert!((curve.at(t) - value).abs() < 1e-6);
        }
        assert!((0..300).all(|k| (-1.0..=2.5001).contains(&curve.at(k as f32 * 0.01))));
    }
}
