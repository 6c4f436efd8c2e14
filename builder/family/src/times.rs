//! Smooth maps of time that meet given points and never run back.

/// A monotone map through points: cubic between them, without overshoot (Fritsch and Carlson 1980, with harmonic means).
#[derive(Clone, Debug, PartialEq)]
pub struct TimeMap {
    at: Vec<f32>,
    values: Vec<f32>,
    slopes: Vec<f32>,
}

impl TimeMap {
    /// Through `points` of (time, value), both rising, at least two. Where `cyclic`, it goes on after the last point as it began.
    #[must_use]
    pub fn new(points: &[(f32, f32)], cyclic: bool) -> Self {
        let (at, values): (Vec<f32>, Vec<f32>) = points.iter().copied().unzip();
        let rates: Vec<f32> =
            (1..at.len()).map(|k| (values[k] - values[k - 1]) / (at[k] - at[k - 1]).max(f32::MIN_POSITIVE)).collect();
        let mean = |a: f32, b: f32| if a * b <= 0.0 { 0.0 } else { 2.0 * a * b / (a + b) };
        let slope = |k: usize| match (k.checked_sub(1).and_then(|k| rates.get(k)), rates.get(k)) {
            (Some(&before), Some(&after)) => mean(before, after),
            (Some(&before), None) => {
                if cyclic {
                    mean(before, rates[0])
                } else {
                    before
                }
            }
            (None, Some(&after)) => {
                if cyclic {
                    mean(after, rates[rates.len() - 1])
                } else {
                    after
                }
            }
            (None, None) => 0.0,
        };
        let slopes = (0..at.len()).map(slope).collect();
        Self { at, values, slopes }
    }

    /// The value at `time`, which is held between the first and the last point.
    #[must_use]
    pub fn value(&self, time: f32) -> f32 {
        let last = self.at.len() - 1;
        let time = time.clamp(self.at[0], self.at[last]);
        let k = self.at.partition_point(|&at| at <= time).clamp(1, last.max(1)) - 1;
        if last == 0 {
            return self.values[0];
        }
        let width = (self.at[k + 1] - self.at[k]).max(f32::MIN_POSITIVE);
        let u = (time - self.at[k]) / width;
        let (u2, u3) = (u * u, u * u * u);
        self.values[k] * (2.0 * u3 - 3.0 * u2 + 1.0)
            + self.values[k + 1] * (3.0 * u2 - 2.0 * u3)
            + width * (self.slopes[k] * (u3 - 2.0 * u2 + u) + self.slopes[k + 1] * (u3 - u2))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_meets_its_points_and_never_runs_back() {
        let points = [(0.0, 0.0), (0.5, 0.9), (0.6, 0.95), (1.0, 2.0)];
        for cyclic in [false, true] {
            let map = TimeMap::new(&points, cyclic);
            for (time, value) in points {
                assert!((map.value(time) - value).abs() < 1e-6);
            }
            let values: Vec<f32> = (0..=1000).map(|k| map.value(k as f32 / 1000.0)).collect();
            assert!(values.windows(2).all(|pair| pair[1] >= pair[0]));
        }
        let straight = TimeMap::new(&[(0.0, 0.0), (2.0, 6.0)], false);
        assert!((straight.value(0.7) - 2.1).abs() < 1e-6 && straight.value(9.0) == 6.0);
    }
}
