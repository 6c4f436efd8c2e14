//! Rows of numbers that change over time: smoothed, and between two of them.

/// Each column of `rows` smoothed by a Gaussian of deviation `deviation` rows. Beyond the ends a column goes on as if it were turned by
/// half a circle about its end, so that what rises steadily goes on rising.
#[must_use]
pub fn smoothed(rows: &[Vec<f64>], deviation: f64) -> Vec<Vec<f64>> {
    let reach = (3.0 * deviation).ceil() as i64;
    if reach == 0 || rows.len() < 2 {
        return rows.to_vec();
    }
    let weights: Vec<f64> = (-reach..=reach).map(|k| (-0.5 * (k as f64 / deviation).powi(2)).exp()).collect();
    let total: f64 = weights.iter().sum();
    let smooth = |middle: usize| {
        let mut sum = vec![0.0; rows[middle].len()];
        for (k, weight) in (-reach..=reach).zip(&weights) {
            for (column, sum) in sum.iter_mut().enumerate() {
                *sum += weight / total * beyond(rows, middle as i64 + k, column);
            }
        }
        sum
    };
    (0..rows.len()).map(smooth).collect()
}

/// Entry `row` of a column, which may lie beyond its ends.
fn beyond(rows: &[Vec<f64>], row: i64, column: usize) -> f64 {
    let last = rows.len() as i64 - 1;
    let inside = |row: i64| rows[row.clamp(0, last) as usize][column];
    if row < 0 {
        2.0 * inside(0) - inside(-row)
    } else if row > last {
        2.0 * inside(last) - inside(2 * last - row)
    } else {
        inside(row)
    }
}

/// The row `at` a place between rows, on a smooth curve through them (Catmull and Rom 1974).
#[must_use]
pub fn between(rows: &[Vec<f64>], at: f64) -> Vec<f64> {
    let last = rows.len().saturating_sub(1);
    let at = at.clamp(0.0, last as f64);
    let before = (at.floor() as usize).min(last.saturating_sub(1));
    let t = at - before as f64;
    let row = |k: i64| &rows[(before as i64 + k).clamp(0, last as i64) as usize];
    let [a, b, c, d] = [row(-1), row(0), row(1), row(2)];
    let value = |k: usize| {
        let (p, q) = (c[k] - a[k], d[k] - b[k]);
        b[k] + t * (0.5 * p + t * (3.0 * (c[k] - b[k]) - p - 0.5 * q + t * (2.0 * (b[k] - c[k]) + 0.5 * (p + q))))
    };
    (0..b.len()).map(value).collect()
}

/// From 0 to 1 as `x` goes from 0 to 1, at rest at both ends.
#[must_use]
pub fn ramp(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_stays_a_line() {
        let line: Vec<Vec<f64>> = (0..30).map(|k| vec![0.3 * f64::from(k) - 1.0]).collect();
        for (smooth, line) in smoothed(&line, 4.0).iter().zip(&line) {
            assert!((smooth[0] - line[0]).abs() < 1e-12);
        }
        assert!((between(&line, 7.25)[0] - (0.3 * 7.25 - 1.0)).abs() < 1e-12);
        assert_eq!(between(&line, 12.0), line[12]);
        assert_eq!(between(&line[..1], 3.0), line[0]);
        assert_eq!(smoothed(&line[..1], 4.0), line[..1]);
    }
}
