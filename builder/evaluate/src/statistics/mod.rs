//! The statistics of the evaluation, in plain `f64` and in a fixed order of summation.

mod correlation;
mod distance_correlation;
mod mantel;

pub use self::correlation::pearson;
pub use self::distance_correlation::{distance_correlation, distance_covariance};
pub use self::mantel::{Classes, Correlogram, Mantel, mantel, mantel_correlogram, permutation, upper_triangle};

/// Number, mean and (population) standard deviation of a sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    /// Number of values.
    pub count: u64,
    /// Their mean; 0 where there is none.
    pub mean: f64,
    sum_of_squares: f64,
}

impl Moments {
    /// The moments of `values`.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        values.into_iter().fold(Self::default(), |mut moments, value| {
            moments.add(value);
            moments
        })
    }

    /// Takes in a value (Welford's update).
    pub fn add(&mut self, value: f64) {
        self.count += 1;
        let difference = value - self.mean;
        self.mean += difference / self.count as f64;
        self.sum_of_squares += difference * (value - self.mean);
    }

    /// Takes in another sample (Chan, Golub and LeVeque).
    pub fn merge(&mut self, other: &Self) {
        if other.count == 0 {
            return;
        }
        let (count, difference) = (self.count + other.count, other.mean - self.mean);
        let share = other.count as f64 / count as f64;
        self.sum_of_squares += other.sum_of_squares + difference * difference * share * self.count as f64;
        self.mean += difference * share;
        self.count = count;
    }

    /// The standard deviation.
    #[must_use]
    pub fn deviation(&self) -> f64 {
        if self.count == 0 { 0.0 } else { (self.sum_of_squares / self.count as f64).sqrt() }
    }
}

/// The value below which the share `share` of `values` lies, linear between two of them; `None` without values.
#[must_use]
pub fn percentile(values: &[f64], share: f64) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let place = share.clamp(0.0, 1.0) * sorted.len().checked_sub(1)? as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(sorted.len() - 1);
    Some(sorted[below] + (sorted[above] - sorted[below]) * (place - below as f64))
}

/// A straight line through points, by least squares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Its slope.
    pub slope: f64,
    /// Its value at zero.
    pub offset: f64,
    /// Share of the variance that it explains, R^2.
    pub explained: f64,
}

/// The line through `points` (x, y); `None` where fewer than two x differ.
#[must_use]
pub fn fit_line(points: &[(f64, f64)]) -> Option<Line> {
    let n = points.len() as f64;
    let (mx, my) = points.iter().fold((0.0, 0.0), |sum, point| (sum.0 + point.0 / n, sum.1 + point.1 / n));
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for &(x, y) in points {
        xx += (x - mx) * (x - mx);
        xy += (x - mx) * (y - my);
        yy += (y - my) * (y - my);
    }
    let slope = (xx > 0.0).then(|| xy / xx)?;
    let explained = if yy > 0.0 { xy * xy / (xx * yy) } else { 1.0 };
    Some(Line { slope, offset: my - slope * mx, explained })
}

/// The exponent of a power law `y = c x^e` through `points`, with R^2 of the line through their logarithms.
#[must_use]
pub fn fit_exponent(points: &[(f64, f64)]) -> Option<Line> {
    let positive = points.iter().filter(|point| point.0 > 0.0 && point.1 > 0.0);
    fit_line(&positive.map(|point| (point.0.ln(), point.1.ln())).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_of_known_samples() {
        let whole = Moments::of([2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0]);
        assert_eq!((whole.count, whole.mean, whole.deviation()), (8, 5.0, 2.0));
        let mut parts = Moments::of([2.0, 4.0, 4.0]);
        parts.merge(&Moments::default());
        parts.merge(&Moments::of([4.0, 5.0, 5.0, 7.0, 9.0]));
        assert!((parts.mean - 5.0).abs() < 1e-12 && (parts.deviation() - 2.0).abs() < 1e-12);
        assert_eq!(Moments::default().deviation(), 0.0);
    }

    #[test]
    fn percentiles_are_linear_between_values() {
        let values = [3.0, 1.0, 2.0, 4.0];
        assert_eq!(percentile(&values, 0.0), Some(1.0));
        assert_eq!(percentile(&values, 0.5), Some(2.5));
        assert_eq!(percentile(&values, 1.0), Some(4.0));
        assert_eq!(percentile(&[], 0.5), None);
    }

    #[test]
    fn exponents_of_power_laws() {
        let points: Vec<_> = (1..6).map(|x| (f64::from(x), 3.0 * f64::from(x).powf(1.7))).collect();
        let fit = fit_exponent(&points).unwrap();
        assert!((fit.slope - 1.7).abs() < 1e-12 && (fit.explained - 1.0).abs() < 1e-12);
        assert!(fit_line(&[(1.0, 2.0), (1.0, 3.0)]).is_none());
    }
}
