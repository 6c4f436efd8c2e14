//! Principal components of rows in a [`Store`], through their Gram matrix (thesis equations 4.4 to 4.11).
//!
//! Two passes over the store, a stripe of columns at a time: products of all pairs of rows, then the modes. Sums run in a
//! fixed order: neither threads nor vector instructions change a bit.

use rayon::prelude::*;

use super::store::{ScratchError, Store};
use super::symmetric::{Eigen, eigen};
use kernels::simd::{Kernel, Level as Instructions};

/// Lanes of a sum over columns.
const LANES: usize = 16;
/// Rows of either side of a block of products.
const BLOCK: usize = 4;
/// Stripes whose products wait for being added, in order.
const BATCH: usize = 8;
/// A mode whose variance is a smaller part of the first one's is rounding.
const RANK: f64 = 1e-9;

/// Mean, modes and coefficients of some rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PrincipalComponents {
    /// Mean of the training rows.
    pub mean: Vec<f32>,
    /// Modes of unit length by decreasing variance; the largest entry of each is positive.
    pub modes: Vec<Vec<f32>>,
    /// Variance of all training rows along each mode.
    pub variances: Vec<f64>,
    /// Variance of the training rows in all.
    pub total_variance: f64,
    /// Coefficients of all rows of the store, training or not, row-major: `modes.len()` each.
    pub coefficients: Vec<f32>,
}

/// The first `count` components of the rows `training` of `store`, fewer where there are no more.
///
/// # Errors
/// A scratch file that cannot be read.
pub fn components(store: &Store, training: &[usize], count: usize) -> Result<PrincipalComponents, ScratchError> {
    let instructions = Instructions::best();
    let n = training.len();
    let gram = gram(store, training, instructions)?;
    let total: f64 = (0..n).map(|k| gram[k * n + k]).sum();
    let Eigen { values, vectors } = eigen(&gram, n);
    let first = values.first().copied().unwrap_or(0.0);
    let kept = values.iter().take(count.min(n.saturating_sub(1))).take_while(|&&v| v > RANK * first && v > 0.0).count();
    // Mode k is the sum of the centred rows, each times this.
    let factors: Vec<Vec<f32>> =
        (0..kept).map(|k| vectors[k].iter().map(|entry| (entry / values[k].sqrt()) as f32).collect()).collect();
    let (mean, mut modes) = modes(store, training, &factors, instructions)?;
    let mut coefficients = coefficients(store, &mean, &modes, instructions)?;
    for (k, mode) in modes.iter_mut().enumerate() {
        let largest = mode.iter().fold(0.0_f32, |most, &x| if x.abs() > most.abs() { x } else { most });
        if largest < 0.0 {
            mode.iter_mut().for_each(|x| *x = -*x);
            coefficients.iter_mut().skip(k).step_by(kept).for_each(|x| *x = -*x);
        }
    }
    let variances = values.iter().take(kept).map(|v| v / n as f64).collect();
    Ok(PrincipalComponents { mean, modes, variances, total_variance: total / n.max(1) as f64, coefficients })
}

/// Products of all pairs of centred training rows.
fn gram(store: &Store, training: &[usize], instructions: Instructions) -> Result<Vec<f64>, ScratchError> {
    let n = training.len();
    let mut gram = vec![0.0; n * n];
    let stripes: Vec<usize> = (0..store.stripes()).collect();
    for batch in stripes.chunks(BATCH) {
        let products: Vec<Result<Vec<f64>, ScratchError>> = batch
            .par_iter()
            .map(|&stripe| {
                let rows = Centred::read(store, training, stripe)?;
                Ok(instructions.run(Products { rows: &rows }))
            })
            .collect();
        for products in products {
            for (sum, product) in gram.iter_mut().zip(products?) {
                *sum += product;
            }
        }
    }
    for i in 0..n {
        for j in 0..i {
            gram[i * n + j] = gram[j * n + i];
        }
    }
    Ok(gram)
}

/// Some columns of some rows without their mean, padded to whole lanes and blocks with zeros.
struct Centred {
    count: usize,
    width: usize,
    padded: usize,
    values: Vec<f32>,
    mean: Vec<f32>,
}

impl Centred {
    fn read(store: &Store, rows: &[usize], stripe: usize) -> Result<Self, ScratchError> {
        let (width, all) = (store.width(stripe), store.stripe(stripe)?);
        let padded = width.next_multiple_of(LANES);
        let mut sums = vec![0.0_f64; width];
        for &row in rows {
            for (sum, value) in sums.iter_mut().zip(&all[row * width..(row + 1) * width]) {
                *sum += f64::from(*value);
            }
        }
        let mean: Vec<f32> = sums.iter().map(|sum| (sum / rows.len().max(1) as f64) as f32).collect();
        let mut values = vec![0.0; rows.len().next_multiple_of(BLOCK) * padded];
        for (out, &row) in values.chunks_exact_mut(padded.max(1)).zip(rows) {
            for ((out, value), mean) in out.iter_mut().zip(&all[row * width..(row + 1) * width]).zip(&mean) {
                *out = value - mean;
            }
        }
        Ok(Self { count: rows.len(), width, padded, values, mean })
    }

    #[inline(always)]
    fn block(&self, first: usize, from: usize, length: usize) -> [&[f32]; BLOCK] {
        let mut rows = [self.values.as_slice(); BLOCK];
        for k in 0..BLOCK {
            let start = (first + k) * self.padded + from;
            rows[k] = &self.values[start..start + length];
        }
        rows
    }
}

/// Right sides of products that are used again soon, a multiple of [`BLOCK`]: a panel of them is a quarter of a megabyte.
const NEAR: usize = 64;

/// Products of all pairs of rows i <= j.
struct Products<'a> {
    rows: &'a Centred,
}

/// Columns of which products are summed in `f32` before they go on in `f64`.
const PANEL: usize = 1024;

impl Kernel for Products<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn run(self) -> Vec<f64> {
        let rows = self.rows;
        let n = rows.count;
        let mut products = vec![0.0; n * n];
        for from in (0..rows.padded).step_by(PANEL) {
            let length = PANEL.min(rows.padded - from);
            // Some of the right sides at a time, which stay in the processor's second memory.
            for near in (0..n).step_by(NEAR) {
                let end = (near + NEAR).min(n);
                for i in (0..end).step_by(BLOCK) {
                    let a = rows.block(i, from, length);
                    for j in (near.max(i)..end).step_by(BLOCK) {
                        let b = rows.block(j, from, length);
                        let mut sums = [[[0.0_f32; LANES]; BLOCK]; BLOCK];
                        for start in (0..length).step_by(LANES) {
                            for p in 0..BLOCK {
                                let left = &a[p][start..start + LANES];
                                for q in 0..BLOCK {
                                    let right = &b[q][start..start + LANES];
                                    for lane in 0..LANES {
                                        sums[p][q][lane] = left[lane].mul_add(right[lane], sums[p][q][lane]);
                                    }
                                }
                            }
                        }
                        for p in 0..BLOCK.min(n - i) {
                            for q in 0..BLOCK.min(n - j) {
                                let mut total = 0.0;
                                for lane in 0..LANES {
                                    total += f64::from(sums[p][q][lane]);
                                }
                                products[(i + p) * n + j + q] += total;
                            }
                        }
                    }
                }
            }
        }
        products
    }
}

/// The mean of the training rows and the modes, stripe by stripe.
fn modes(
    store: &Store,
    training: &[usize],
    factors: &[Vec<f32>],
    instructions: Instructions,
) -> Result<(Vec<f32>, Vec<Vec<f32>>), ScratchError> {
    let mut mean = Vec::with_capacity(store.columns());
    let mut modes: Vec<Vec<f32>> = factors.iter().map(|_| Vec::with_capacity(store.columns())).collect();
    let stripes: Vec<usize> = (0..store.stripes()).collect();
    for batch in stripes.chunks(BATCH) {
        let parts: Vec<Result<_, ScratchError>> = batch
            .par_iter()
            .map(|&stripe| {
                let rows = Centred::read(store, training, stripe)?;
                let part = instructions.run(Combine { rows: &rows, factors });
                Ok((rows.width, rows.mean, part))
            })
            .collect();
        for part in parts {
            let (width, stripe_mean, part) = part?;
            mean.extend(stripe_mean);
            for (mode, part) in modes.iter_mut().zip(part) {
                mode.extend_from_slice(&part[..width]);
            }
        }
    }
    Ok((mean, modes))
}

/// Sums of rows, each times its factor, for each list of factors.
struct Combine<'a> {
    rows: &'a Centred,
    factors: &'a [Vec<f32>],
}

impl Kernel for Combine<'_> {
    type Output = Vec<Vec<f32>>;

    #[inline(always)]
    fn run(self) -> Vec<Vec<f32>> {
        const WIDE: usize = 4 * LANES;
        let rows = self.rows;
        let mut sums: Vec<Vec<f32>> = Vec::new();
        for _ in 0..self.factors.len() {
            sums.push(vec![0.0; rows.padded]);
        }
        for start in (0..rows.padded).step_by(WIDE) {
            let width = WIDE.min(rows.padded - start);
            for (sum, factors) in sums.iter_mut().zip(self.factors) {
                let mut wide = [0.0_f32; WIDE];
                for (row, &factor) in factors.iter().enumerate() {
                    let at = row * rows.padded + start;
                    if width == WIDE {
                        let values = &rows.values[at..at + WIDE];
                        for lane in 0..WIDE {
                            wide[lane] = values[lane].mul_add(factor, wide[lane]);
                        }
                    } else {
                        for lane in 0..width {
                            wide[lane] = rows.values[at + lane].mul_add(factor, wide[lane]);
                        }
                    }
                }
                sum[start..start + width].copy_from_slice(&wide[..width]);
            }
        }
        sums
    }
}

/// Coefficients of all rows of the store: their products with the modes.
fn coefficients(
    store: &Store,
    mean: &[f32],
    modes: &[Vec<f32>],
    instructions: Instructions,
) -> Result<Vec<f32>, ScratchError> {
    let mut sums = vec![0.0_f64; store.rows() * modes.len()];
    let stripes: Vec<usize> = (0..store.stripes()).collect();
    for batch in stripes.chunks(BATCH) {
        let parts: Vec<Result<Vec<f64>, ScratchError>> = batch
            .par_iter()
            .map(|&stripe| {
                let rows = store.stripe(stripe)?;
                let first = stripe * super::store::STRIPE;
                Ok(instructions.run(Project { rows: &rows, mean, modes, first, width: store.width(stripe) }))
            })
            .collect();
        for part in parts {
            for (sum, part) in sums.iter_mut().zip(part?) {
                *sum += part;
            }
        }
    }
    Ok(sums.into_iter().map(|sum| sum as f32).collect())
}

/// Products of rows, less the mean, with modes, over the columns of a stripe.
struct Project<'a> {
    rows: &'a [f32],
    mean: &'a [f32],
    modes: &'a [Vec<f32>],
    first: usize,
    width: usize,
}

impl Kernel for Project<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn run(self) -> Vec<f64> {
        let Self { rows, mean, modes, first, width } = self;
        let mut sums = Vec::new();
        let mean = &mean[first..first + width];
        let mut centred = vec![0.0; width];
        for row in rows.chunks_exact(width) {
            for k in 0..width {
                centred[k] = row[k] - mean[k];
            }
            for mode in modes {
                sums.push(dot(&centred, &mode[first..first + width]));
            }
        }
        sums
    }
}

/// The sum of products of two lists: lanes in `f32` over panels, panels in `f64`.
#[inline(always)]
fn dot(a: &[f32], b: &[f32]) -> f64 {
    let mut total = 0.0;
    for (a, b) in a.chunks(PANEL).zip(b.chunks(PANEL)) {
        let mut lanes = [0.0_f32; LANES];
        let (a, b) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
        let mut rest = 0.0;
        for (a, b) in a.remainder().iter().zip(b.remainder()) {
            rest += f64::from(a * b);
        }
        for (a, b) in a.zip(b) {
            for lane in 0..LANES {
                lanes[lane] = a[lane].mul_add(b[lane], lanes[lane]);
            }
        }
        for lane in lanes {
            rest += f64::from(lane);
        }
        total += rest;
    }
    total
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::STRIPE;

    fn noise(k: usize) -> f32 {
        let hash = (k as u32 ^ 0x2545).wrapping_mul(0x9E37_79B9).rotate_left(13).wrapping_mul(0x85EB_CA6B);
        (hash >> 8) as f32 / (1 << 24) as f32 - 0.5
    }

    fn filled(rows: usize, columns: usize) -> Store {
        let store = Store::new(rows, columns, 2.0).unwrap();
        for row in 0..rows {
            // A few strong modes and noise.
            let values: Vec<f32> = (0..columns)
                .map(|c| {
                    let strong: f32 =
                        (0..3).map(|m| noise(row * 7 + m) * noise(c * 3 + m + 90_000) / (m + 1) as f32).sum();
                    strong + 0.1 * noise(row * columns + c) + 0.2
                })
                .collect();
            store.write(row, &values).unwrap();
        }
        store
    }

    #[test]
    fn all_components_reproduce_and_variances_are_those_of_the_covariance() {
        let (rows, columns) = (11, STRIPE + 333);
        let store = filled(rows, columns);
        let all: Vec<usize> = (0..rows).collect();
        let found = components(&store, &all, rows).unwrap();
        assert_eq!(found.modes.len(), rows - 1);
        for row in 0..rows {
            let original = store.row(row).unwrap();
            for c in (0..columns).step_by(97) {
                let mut value = found.mean[c];
                for (mode, factor) in found.modes.iter().zip(&found.coefficients[row * (rows - 1)..]) {
                    value += factor * mode[c];
                }
                assert!((value - original[c]).abs() < 1e-4);
            }
        }
        for (k, mode) in found.modes.iter().enumerate() {
            for (l, other) in found.modes.iter().enumerate() {
                let product: f64 = mode.iter().zip(other).map(|(a, b)| f64::from(a * b)).sum();
                assert!((product - f64::from(u8::from(k == l))).abs() < 1e-4, "{k} {l} {product}");
            }
            let largest = mode.iter().fold(0.0_f32, |most, &x| if x.abs() > most.abs() { x } else { most });
            assert!(largest > 0.0);
            let own: f64 = found.coefficients[k..].iter().step_by(rows - 1).map(|c| f64::from(*c).powi(2)).sum();
            assert!((own / rows as f64 / found.variances[k] - 1.0).abs() < 1e-3);
        }
        assert!(found.variances.windows(2).all(|pair| pair[0] >= pair[1]));
        assert!((found.variances.iter().sum::<f64>() / found.total_variance - 1.0).abs() < 1e-6);
    }

    #[test]
    fn modes_are_those_of_a_plain_power_iteration() {
        let (rows, columns) = (9, 700);
        let store = filled(rows, columns);
        let all: Vec<usize> = (0..rows).collect();
        let found = components(&store, &all, 1).unwrap();
        let data: Vec<Vec<f64>> =
            all.iter().map(|&r| store.row(r).unwrap().into_iter().map(f64::from).collect()).collect();
        let mean: Vec<f64> = (0..columns).map(|c| data.iter().map(|row| row[c]).sum::<f64>() / rows as f64).collect();
        let mut mode: Vec<f64> = (0..columns).map(|c| f64::from(noise(c))).collect();
        for _ in 0..500 {
            let mut next = vec![0.0; columns];
            for row in &data {
                let along: f64 = (0..columns).map(|c| (row[c] - mean[c]) * mode[c]).sum();
                for c in 0..columns {
                    next[c] += along * (row[c] - mean[c]);
                }
            }
            let length = next.iter().map(|x| x * x).sum::<f64>().sqrt();
            mode = next.into_iter().map(|x| x / length).collect();
        }
        let product: f64 = mode.iter().zip(&found.modes[0]).map(|(a, b)| a * f64::from(*b)).sum();
        assert!((product.abs() - 1.0).abs() < 1e-5, "{product}");
    }

    #[test]
    fn threads_and_instruction_sets_give_the_same_bits() {
        let store = filled(10, 2 * STRIPE + 5);
        let training = [0, 2, 3, 4, 6, 7, 9];
        let of = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| components(&store, &training, 5).unwrap())
        };
        assert_eq!(of(1), of(2));
        let levels = Instructions::available();
        let first = gram(&store, &training, levels[0]).unwrap();
        for level in levels {
            assert_eq!(gram(&store, &training, level).unwrap(), first, "{level:?}");
        }
    }
}
