//! Curves over time, smoothed.

use std::ops::{Add, Mul};

use kernels::scalar::exp;

/// `curve` smoothed by a Gaussian of `sigma` frames; what lies beyond the ends is as the ends are.
#[must_use]
pub fn gaussian<T: Copy + Add<Output = T> + Mul<f32, Output = T>>(curve: &[T], sigma: f32) -> Vec<T> {
    if sigma < 0.3 || curve.len() < 2 {
        return curve.to_vec();
    }
    let reach = ((3.0 * sigma).ceil() as i64).min(curve.len() as i64);
    let weights: Vec<f32> = (-reach..=reach).map(|k| exp(-0.5 * (k as f32 / sigma).powi(2))).collect();
    let all: f32 = weights.iter().sum();
    let at = |frame: i64| curve[frame.clamp(0, curve.len() as i64 - 1) as usize];
    let one = |frame: usize| {
        let frame = frame as i64;
        let mut sum = at(frame - reach) * (weights[0] / all);
        for (k, weight) in (-reach..=reach).zip(&weights).skip(1) {
            sum = sum + at(frame + k) * (weight / all);
        }
        sum
    };
    (0..curve.len()).map(one).collect()
}

/// The largest value within `reach` frames.
#[must_use]
pub fn dilated(curve: &[f32], reach: usize) -> Vec<f32> {
    let around = |frame: usize| &curve[frame.saturating_sub(reach)..(frame + reach + 1).min(curve.len())];
    (0..curve.len()).map(|frame| around(frame).iter().copied().fold(f32::NEG_INFINITY, f32::max)).collect()
}

/// 0 at 0 and 1 at 1, level at both.
#[must_use]
pub fn ease(u: f32) -> f32 {
    let u = u.clamp(0.0, 1.0);
    u * u * (3.0 - 2.0 * u)
}

/// The value below which the share `share` of `values` is; 0 where there is none.
#[must_use]
pub fn quantile(mut values: Vec<f32>, share: f32) -> f32 {
    values.sort_by(f32::total_cmp);
    let at = (share * values.len() as f32) as usize;
    values.get(at.min(values.len().saturating_sub(1))).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_level_stays_and_peaks_are_kept_by_dilation() {
        assert!(gaussian(&[2.0_f32; 9], 2.0).iter().all(|v| (v - 2.0).abs() < 1e-5));
        assert_eq!(dilated(&[0.0, 1.0, 0.0, 0.0], 1), [1.0, 1.0, 1.0, 0.0]);
        assert_eq!(quantile(vec![3.0, 1.0, 2.0], 0.5), 2.0);
    }
}
