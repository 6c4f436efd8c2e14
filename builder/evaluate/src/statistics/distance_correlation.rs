//! Distance correlation of two samples of numbers, exactly, in O(P log P).
//!
//! Székely, Rizzo and Bakirov, "Measuring and testing dependence by correlation of distances" (2007); thesis equations
//! 2.19 to 2.22. For numbers, the P^2 products |x_i - x_j| |y_i - y_j| need not be formed (Huo and Székely, "Fast
//! computing for distance covariance", 2016): in the order of x, each is (x_j - x_i) (y_j - y_i) with a sign that says
//! which y is greater, and sums of 1, x, y and xy over the smaller y are kept in a Fenwick tree.

/// The distance correlation R of two samples of the same number of values, in [0, 1].
///
/// 0 where one of them is constant.
#[must_use]
pub fn distance_correlation(x: &[f32], y: &[f32]) -> f64 {
    let variances = distance_covariance(x, x) * distance_covariance(y, y);
    if variances > 0.0 { (distance_covariance(x, y).max(0.0) / variances.sqrt()).sqrt() } else { 0.0 }
}

/// The squared distance covariance V^2 of two samples of the same number of values: the mean product of their doubly
/// centred distances.
#[must_use]
pub fn distance_covariance(x: &[f32], y: &[f32]) -> f64 {
    let n = x.len().min(y.len());
    if n == 0 {
        return 0.0;
    }
    let (x, y) = (centred(&x[..n]), centred(&y[..n]));
    let (rows_x, rows_y) = (row_sums(&x), row_sums(&y));
    let count = n as f64;
    // The mean of A B is the mean of a b, less twice that of their row means' product, plus that of both means.
    let products = 2.0 * sum_of_products(&x, &y) / (count * count);
    let rows = rows_x.iter().zip(&rows_y).map(|(a, b)| a * b).sum::<f64>() / (count * count * count);
    let mean = |rows: &[f64]| rows.iter().sum::<f64>() / (count * count);
    products - 2.0 * rows + mean(&rows_x) * mean(&rows_y)
}

fn centred(values: &[f32]) -> Vec<f64> {
    let mean = values.iter().map(|&value| f64::from(value)).sum::<f64>() / values.len() as f64;
    values.iter().map(|&value| f64::from(value) - mean).collect()
}

/// Places of the values, from the least to the greatest.
fn order(values: &[f64]) -> Vec<u32> {
    let mut order: Vec<u32> = (0..values.len() as u32).collect();
    order.sort_unstable_by(|&a, &b| values[a as usize].total_cmp(&values[b as usize]).then(a.cmp(&b)));
    order
}

/// The sum of each value's distances to all values.
fn row_sums(values: &[f64]) -> Vec<f64> {
    let (total, mut below) = (values.iter().sum::<f64>(), 0.0);
    let mut sums = vec![0.0; values.len()];
    for (smaller, &place) in order(values).iter().enumerate() {
        let (value, smaller) = (values[place as usize], smaller as f64);
        let greater = values.len() as f64 - smaller;
        sums[place as usize] = (value * smaller - below) + (total - below - value * greater);
        below += value;
    }
    sums
}

/// The sum over all i < j of |x_i - x_j| |y_i - y_j|.
fn sum_of_products(x: &[f64], y: &[f64]) -> f64 {
    let n = x.len();
    let mut rank = vec![0; n];
    for (place, &index) in order(y).iter().enumerate() {
        rank[index as usize] = place;
    }
    // Sums of 1, x, y, xy.
    let mut tree = vec![[0.0_f64; 4]; n + 1];
    let (mut all, mut sum) = ([0.0_f64; 4], 0.0);
    for &index in &order(x) {
        let (x, y, rank) = (x[index as usize], y[index as usize], rank[index as usize]);
        let mut less = [0.0; 4];
        let mut node = rank;
        while node > 0 {
            (0..4).for_each(|k| less[k] += tree[node][k]);
            node &= node - 1;
        }
        // Those of less y count positive, the others negative.
        let [count, sx, sy, sxy]: [f64; 4] = std::array::from_fn(|k| 2.0 * less[k] - all[k]);
        sum += x * y * count - y * sx - x * sy + sxy;
        let entry = [1.0, x, y, x * y];
        (0..4).for_each(|k| all[k] += entry[k]);
        let mut node = rank + 1;
        while node <= n {
            (0..4).for_each(|k| tree[node][k] += entry[k]);
            node += node & node.wrapping_neg();
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use kernels::random::signed;

    /// Thesis equations 2.19 to 2.22, word for word.
    fn plain_covariance(x: &[f32], y: &[f32]) -> f64 {
        let n = x.len();
        let doubly_centred = |values: &[f32]| {
            let a = |i: usize, j: usize| f64::from((values[i] - values[j]).abs());
            let rows: Vec<f64> = (0..n).map(|i| (0..n).map(|j| a(i, j)).sum::<f64>() / n as f64).collect();
            let mean = rows.iter().sum::<f64>() / n as f64;
            (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).map(|(i, j)| a(i, j) - rows[i] - rows[j] + mean).collect()
        };
        let (a, b): (Vec<f64>, Vec<f64>) = (doubly_centred(x), doubly_centred(y));
        a.iter().zip(&b).map(|(a, b)| a * b).sum::<f64>() / (n * n) as f64
    }

    #[test]
    fn matches_the_plain_formula() {
        for seed in 0..20 {
            let n = 1 + seed as usize * 7;
            // Coarse values, so that there are ties.
            let x: Vec<f32> = (0..n as u64).map(|i| (signed(seed, i) * 8.0).round()).collect();
            let y: Vec<f32> = (0..n).map(|i| x[i] * 0.3 + signed(seed + 100, i as u64)).collect();
            for (a, b) in [(&x, &y), (&x, &x), (&y, &x)] {
                let (fast, plain) = (distance_covariance(a, b), plain_covariance(a, b));
                assert!((fast - plain).abs() < 1e-6 * (1.0 + plain), "{seed}: {fast} {plain}");
            }
        }
    }

    #[test]
    fn sees_what_pearson_does_not() {
        // The thesis's own example: y = x^2 on -10..10 has a Pearson correlation of 0 and a distance correlation of
        // nearly a half.
        let x: Vec<f32> = (-10..=10_i8).map(f32::from).collect();
        let y: Vec<f32> = x.iter().map(|x| x * x).collect();
        assert!(super::super::pearson(&x, &y).abs() < 1e-12);
        let correlation = distance_correlation(&x, &y);
        assert!((0.45..0.55).contains(&correlation), "{correlation}");
        let line: Vec<f32> = x.iter().map(|x| 3.0 - 2.0 * x).collect();
        assert!((distance_correlation(&x, &line) - 1.0).abs() < 1e-9);
        assert_eq!(distance_correlation(&x, &[1.0; 21]), 0.0);
    }
}
