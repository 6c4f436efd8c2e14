//! Mantel's test and correlogram: whether two matrices of distances between the same items are correlated.
//!
//! Mantel, "The detection of disease clustering" (1967); Oden and Sokal, "Directional autocorrelation" (1986); thesis
//! section 2.3.2. Distances of one item are not independent, so it is the items that are permuted, rows and columns
//! alike.

use rayon::prelude::*;

use super::pearson;
use kernels::random::mix;

/// Result of a Mantel test of several distances against one reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Mantel {
    /// Pearson's correlation of each distance with the reference.
    pub correlation: Vec<f64>,
    /// The same once the reference's items are permuted, for each permutation.
    pub permuted: Vec<Vec<f64>>,
}

impl Mantel {
    /// The share of permutations whose correlation is at least that of distance `which` as it is.
    #[must_use]
    pub fn p_value(&self, which: usize) -> f64 {
        let least = self.correlation[which];
        let as_good = self.permuted.iter().filter(|permuted| permuted[which] >= least).count();
        as_good as f64 / self.permuted.len().max(1) as f64
    }
}

/// The values above the diagonal of an n x n matrix, row after row.
pub fn upper_triangle(n: usize, value: impl Fn(usize, usize) -> f32) -> Vec<f32> {
    (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j))).map(|(i, j)| value(i, j)).collect()
}

/// A permutation of 0..n that depends on `seed` and `index` only (Fisher and Yates).
#[must_use]
pub fn permutation(n: usize, seed: u64, index: u64) -> Vec<u32> {
    let seed = mix(seed, index);
    let mut order: Vec<u32> = (0..n as u32).collect();
    for place in (1..n).rev() {
        let other = mix(seed, place as u64) % (place as u64 + 1);
        order.swap(place, other as usize);
    }
    order
}

/// Correlates each of `distances` with `reference`, all n x n, symmetric and row after row, and again with the
/// reference's items permuted `permutations` times.
#[must_use]
pub fn mantel(n: usize, reference: &[f32], distances: &[&[f32]], permutations: usize, seed: u64) -> Mantel {
    let upper = |matrix: &[f32]| upper_triangle(n, |i, j| matrix[i * n + j]);
    let reference_upper = upper(reference);
    let correlation = distances.iter().map(|distance| pearson(&upper(distance), &reference_upper)).collect();
    // A permuted reference has the same mean and deviation, so only the products change.
    let standard: Vec<Vec<f32>> = distances.iter().map(|distance| standardised(n, distance)).collect();
    let reference = standardised(n, reference);
    let pairs = (n * n.saturating_sub(1) / 2).max(1) as f64;
    let permuted = (0..permutations as u64)
        .into_par_iter()
        .map(|index| {
            let order = permutation(n, seed, index);
            let mut sums = vec![0.0_f64; standard.len()];
            let mut row = vec![0.0_f32; n];
            for i in 0..n {
                let from = &reference[order[i] as usize * n..][..n];
                for j in i + 1..n {
                    row[j] = from[order[j] as usize];
                }
                for (sum, distance) in sums.iter_mut().zip(&standard) {
                    *sum += f64::from(dot(&distance[i * n + i + 1..(i + 1) * n], &row[i + 1..]));
                }
            }
            sums.iter().map(|sum| sum / pairs).collect()
        })
        .collect();
    Mantel { correlation, permuted }
}

/// In eight lanes, so that the order of summation is fixed and still vectorised.
fn dot(a: &[f32], b: &[f32]) -> f32 {
    let mut lanes = [0.0_f32; 8];
    let (whole_a, whole_b) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f32 = whole_a.remainder().iter().zip(whole_b.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in whole_a.zip(whole_b) {
        (0..8).for_each(|lane| lanes[lane] += x[lane] * y[lane]);
    }
    lanes.iter().sum::<f32>() + rest
}

/// A matrix less its mean, over its deviation, both of the values above the diagonal.
fn standardised(n: usize, matrix: &[f32]) -> Vec<f32> {
    let moments = super::Moments::of(upper_triangle(n, |i, j| matrix[i * n + j]).into_iter().map(f64::from));
    let deviation = if moments.deviation() > 0.0 { moments.deviation() } else { f64::INFINITY };
    matrix.iter().map(|&value| ((f64::from(value) - moments.mean) / deviation) as f32).collect()
}

/// Classes of pairs by their reference distance, of equal width from the least to the greatest.
#[derive(Clone, Debug, PartialEq)]
pub struct Classes {
    /// The least distance of the first class, then the greatest of each.
    pub bounds: Vec<f64>,
    /// The class of each pair above the diagonal.
    pub class_of_pair: Vec<u8>,
}

impl Classes {
    /// `count` classes over the reference distances `upper` of all pairs.
    #[must_use]
    pub fn new(upper: &[f32], count: u8) -> Self {
        let least = upper.iter().copied().fold(f32::INFINITY, f32::min);
        let greatest = upper.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let (least, width) = (f64::from(least), f64::from(greatest - least) / f64::from(count));
        let class = |&value: &f32| ((f64::from(value) - least) / width) as u8;
        Self {
            bounds: (0..=count).map(|bound| least + width * f64::from(bound)).collect(),
            class_of_pair: upper.iter().map(class).map(|class| class.min(count - 1)).collect(),
        }
    }

    fn count(&self) -> usize {
        self.bounds.len().saturating_sub(1)
    }
}

/// One distance's correlogram.
#[derive(Clone, Debug, PartialEq)]
pub struct Correlogram {
    /// Pairs of each class.
    pub pairs: Vec<u64>,
    /// Correlation of being in the class with being close: positive where the pairs of a class have small distances.
    pub membership: Vec<f64>,
    /// Bounds of 95 % of the same under permutations of the items.
    pub null: Vec<[f64; 2]>,
    /// Pearson's correlation with the reference among the pairs of the class alone.
    pub within: Vec<f64>,
}

/// The correlogram of `distance`, n x n, over the classes of a reference distance, given for all pairs as well.
#[must_use]
pub fn mantel_correlogram(
    n: usize,
    reference_upper: &[f32],
    classes: &Classes,
    distance: &[f32],
    permutations: usize,
    seed: u64,
) -> Correlogram {
    let standard = standardised(n, distance);
    let membership = |order: &[u32]| {
        let (mut sums, mut counts) = (vec![0.0_f64; classes.count()], vec![0_u64; classes.count()]);
        let mut pair = 0;
        for i in 0..n {
            let row = &standard[order[i] as usize * n..][..n];
            for j in i + 1..n {
                let class = usize::from(classes.class_of_pair[pair]);
                sums[class] += f64::from(row[order[j] as usize]);
                counts[class] += 1;
                pair += 1;
            }
        }
        let total = pair.max(1) as f64;
        let correlation = sums.iter().zip(&counts).map(|(sum, &count)| {
            let share = count as f64 / total;
            let deviation = (share * (1.0 - share)).sqrt();
            if deviation > 0.0 { -sum / total / deviation } else { 0.0 }
        });
        (correlation.collect::<Vec<f64>>(), counts)
    };
    let identity: Vec<u32> = (0..n as u32).collect();
    let (observed, pairs) = membership(&identity);
    let permuted: Vec<Vec<f64>> =
        (0..permutations as u64).into_par_iter().map(|index| membership(&permutation(n, seed, index)).0).collect();
    let null = (0..classes.count())
        .map(|class| {
            let values: Vec<f64> = permuted.iter().map(|permuted| permuted[class]).collect();
            [0.025, 0.975].map(|share| super::percentile(&values, share).unwrap_or(0.0))
        })
        .collect();
    let distance_upper = upper_triangle(n, |i, j| distance[i * n + j]);
    let within = (0..classes.count())
        .map(|class| {
            let members = || classes.class_of_pair.iter().enumerate().filter(|(_, c)| usize::from(**c) == class);
            let of = |values: &[f32]| members().map(|(pair, _)| values[pair]).collect::<Vec<_>>();
            pearson(&of(&distance_upper), &of(reference_upper))
        })
        .collect();
    Correlogram { pairs, membership: observed, null, within }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kernels::random::signed;

    fn matrix(points: &[f32]) -> Vec<f32> {
        points.iter().flat_map(|a| points.iter().map(move |b| (a - b).abs())).collect()
    }

    fn points(seed: u64) -> Vec<f32> {
        (0..40).map(|index| signed(seed, index)).collect()
    }

    #[test]
    fn permutations_are_permutations() {
        let mut seen = std::collections::HashSet::new();
        for index in 0..50 {
            let order = permutation(7, 3, index);
            let mut sorted = order.clone();
            sorted.sort_unstable();
            assert_eq!(sorted, [0, 1, 2, 3, 4, 5, 6]);
            seen.insert(order);
        }
        assert!(seen.len() > 45);
    }

    #[test]
    fn tells_related_from_unrelated() {
        let (a, unrelated) = (matrix(&points(1)), matrix(&points(2)));
        let related: Vec<f32> = a.iter().map(|x| 2.0 * x + 0.1 * x * x).collect();
        let test = mantel(40, &a, &[&related, &unrelated], 400, 5);
        assert_eq!(test.p_value(0), 0.0);
        assert!(test.p_value(1) > 0.01);
        assert!(test.correlation[0] > 0.99 && test.correlation[1].abs() < 0.3);
        // The mean over permutations of a correlation is nought.
        let mean = test.permuted.iter().map(|p| p[0]).sum::<f64>() / 400.0;
        assert!(mean.abs() < 0.02, "{mean}");
    }

    #[test]
    fn permuted_correlations_match_the_plain_formula() {
        let (a, b) = (matrix(&points(1)), matrix(&points(2)));
        let test = mantel(40, &a, &[&b], 5, 9);
        for (index, permuted) in test.permuted.iter().enumerate() {
            let order = permutation(40, 9, index as u64);
            let moved = upper_triangle(40, |i, j| a[order[i] as usize * 40 + order[j] as usize]);
            let plain = pearson(&upper_triangle(40, |i, j| b[i * 40 + j]), &moved);
            assert!((permuted[0] - plain).abs() < 1e-5);
        }
    }

    #[test]
    fn correlogram_falls_with_the_reference_distance() {
        let a = matrix(&points(1));
        let upper = upper_triangle(40, |i, j| a[i * 40 + j]);
        let classes = Classes::new(&upper, 5);
        let correlogram = mantel_correlogram(40, &upper, &classes, &a, 100, 1);
        assert_eq!(correlogram.pairs.iter().sum::<u64>(), 40 * 39 / 2);
        assert!(correlogram.membership.windows(2).all(|pair| pair[0] > pair[1]) || correlogram.membership[0] > 0.3);
        assert!(correlogram.membership[0] > correlogram.null[0][1] && correlogram.membership[4] < 0.0);
        assert!(correlogram.within.iter().all(|&within| within > 0.99));
        // The first class by Pearson's formula.
        let member: Vec<f32> = classes.class_of_pair.iter().map(|&class| f32::from(class == 0)).collect();
        assert!((correlogram.membership[0] + pearson(&member, &upper)).abs() < 1e-6);
    }
}
