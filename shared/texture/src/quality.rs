//! How alike two textures are, over active texels only: mean square error, PSNR and structural similarity.
//!
//! This work is based on: Wang, Bovik, Sheikh, Simoncelli, *Image quality assessment: from error visibility to
//! structural similarity*, 2004: Gaussian windows of 11 x 11 with a standard deviation of 1.5, K1 = 0.01, K2 = 0.03. At
//! the edge of a chart a window holds only its active texels, and its weights are normalised again. Colours are compared
//! channel by channel, sRGB-encoded, 0 to 1; the mean over active texels and channels counts.

/// Half the width of a window.
const RADIUS: usize = 5;
const SIGMA: f64 = 1.5;
const C1: f32 = 0.01 * 0.01;
const C2: f32 = 0.03 * 0.03;

/// Mean squared difference of two textures, or of any two lists of equal length; 0 where they are empty.
#[must_use]
pub fn mean_square_error(a: &[f32], b: &[f32]) -> f64 {
    let sum: f64 = a.iter().zip(b).map(|(a, b)| f64::from((a - b) * (a - b))).sum();
    if a.is_empty() { 0.0 } else { sum / a.len() as f64 }
}

/// Peak signal-to-noise ratio in decibels of values from 0 to 1.
#[must_use]
pub fn psnr(mean_square_error: f64) -> f64 {
    -10.0 * mean_square_error.log10()
}

/// Structural similarity of textures over one set of active texels; keeps what the textures share.
#[derive(Clone, Debug)]
pub struct Similarity {
    width: usize,
    texels: Vec<u32>,
    /// What the window's active texels weigh together, for each texel.
    total: Vec<f32>,
    kernel: [f32; 2 * RADIUS + 1],
}

impl Similarity {
    /// Prepares for textures of `width` whose active texels are `active`, row-major.
    #[must_use]
    pub fn new(width: u32, active: &[bool]) -> Self {
        let texels = (0..active.len() as u32).filter(|&texel| active[texel as usize]).collect();
        let weights: Vec<f64> = (0..=2 * RADIUS).map(|k| gaussian(k as f64 - RADIUS as f64)).collect();
        let sum: f64 = weights.iter().sum();
        let kernel = std::array::from_fn(|k| (weights[k] / sum) as f32);
        let mut similarity = Self { width: width.max(1) as usize, texels, total: Vec::new(), kernel };
        let mut mask: Vec<f32> = active.iter().map(|&active| f32::from(u8::from(active))).collect();
        similarity.blur(&mut mask);
        similarity.total = mask;
        similarity
    }

    /// Mean structural similarity of `a` and `b`, 3 values per active texel each: 1 where they are equal.
    #[must_use]
    pub fn of(&self, a: &[f32], b: &[f32]) -> f64 {
        let channels = (0..3).map(|channel| {
            let sum: f64 = self.of_channel(a, b, channel).into_iter().map(f64::from).sum();
            if self.texels.is_empty() { 1.0 } else { sum / self.texels.len() as f64 }
        });
        channels.sum::<f64>() / 3.0
    }

    /// Structural similarity about each active texel, as [`Self::of`] means it: the mean over channels.
    #[must_use]
    pub fn of_texels(&self, a: &[f32], b: &[f32]) -> Vec<f32> {
        let [red, green, blue] = [0, 1, 2].map(|channel| self.of_channel(a, b, channel));
        red.iter().zip(&green).zip(&blue).map(|((red, green), blue)| (red + green + blue) / 3.0).collect()
    }

    /// How much an error of `texture` counts about each active texel: one over the square that lowers similarity to a half
    /// there, mean over channels. Where there is much to see, errors are hard to see.
    #[must_use]
    pub fn sensitivity(&self, texture: &[f32]) -> Vec<f32> {
        let of = |channel: usize| -> Vec<f32> {
            let blurred = |power: i32| {
                let mut plane = vec![0.0; self.total.len()];
                for (k, &texel) in self.texels.iter().enumerate() {
                    plane[texel as usize] = texture[3 * k + channel].powi(power);
                }
                self.blur(&mut plane);
                plane
            };
            let (means, squares) = (blurred(1), blurred(2));
            let about = |&texel: &u32| {
                let scale = 1.0 / self.total[texel as usize];
                let mean = means[texel as usize] * scale;
                1.0 / (2.0 * (squares[texel as usize] * scale - mean * mean).max(0.0) + C2)
            };
            self.texels.iter().map(about).collect()
        };
        let [red, green, blue] = [0, 1, 2].map(of);
        red.iter().zip(&green).zip(&blue).map(|((red, green), blue)| (red + green + blue) / 3.0).collect()
    }

    fn of_channel(&self, a: &[f32], b: &[f32], channel: usize) -> Vec<f32> {
        let blurred = |value: &dyn Fn(f32, f32) -> f32| {
            let mut plane = vec![0.0; self.total.len()];
            for (k, &texel) in self.texels.iter().enumerate() {
                plane[texel as usize] = value(a[3 * k + channel], b[3 * k + channel]);
            }
            self.blur(&mut plane);
            plane
        };
        let mean_a = blurred(&|a, _| a);
        let mean_b = blurred(&|_, b| b);
        let squares = blurred(&|a, b| a * a + b * b);
        let products = blurred(&|a, b| a * b);
        let about = |&texel: &u32| {
            let texel = texel as usize;
            let scale = 1.0 / self.total[texel];
            let (ma, mb) = (mean_a[texel] * scale, mean_b[texel] * scale);
            let variances = squares[texel] * scale - ma * ma - mb * mb;
            let covariance = products[texel] * scale - ma * mb;
            let alike = (2.0 * ma * mb + C1) * (2.0 * covariance + C2);
            alike / ((ma * ma + mb * mb + C1) * (variances + C2))
        };
        self.texels.iter().map(about).collect()
    }

    /// Weighs the neighbourhood of every texel of `plane`, first along rows, then along columns.
    fn blur(&self, plane: &mut [f32]) {
        let width = self.width;
        let mut padded = vec![0.0; width + 2 * RADIUS];
        for row in plane.chunks_exact_mut(width) {
            padded[RADIUS..RADIUS + width].copy_from_slice(row);
            row.fill(0.0);
            for (k, &weight) in self.kernel.iter().enumerate() {
                for (slot, value) in row.iter_mut().zip(&padded[k..k + width]) {
                    *slot += weight * value;
                }
            }
        }
        let source = plane.to_vec();
        let height = plane.len() / width;
        for (y, row) in plane.chunks_exact_mut(width).enumerate() {
            row.fill(0.0);
            for (k, &weight) in self.kernel.iter().enumerate() {
                let from = y + k;
                if from < RADIUS || from - RADIUS >= height {
                    continue;
                }
                let start = (from - RADIUS) * width;
                for (slot, value) in row.iter_mut().zip(&source[start..start + width]) {
                    *slot += weight * value;
                }
            }
        }
    }
}

fn gaussian(x: f64) -> f64 {
    (-0.5 * x * x / (SIGMA * SIGMA)).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// SSIM straight from its definition.
    fn plain(width: usize, active: &[bool], a: &[f32], b: &[f32]) -> f64 {
        let index: Vec<Option<usize>> = active
            .iter()
            .scan(0, |next, &active| {
                *next += usize::from(active);
                Some(active.then(|| *next - 1))
            })
            .collect();
        let height = active.len() / width;
        let mut values = Vec::new();
        for channel in 0..3 {
            for (texel, _) in active.iter().enumerate().filter(|(_, active)| **active) {
                let (x, y) = ((texel % width) as i64, (texel / width) as i64);
                let (mut w, mut sa, mut sb, mut saa, mut sbb, mut sab) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
                for ny in (y - 5).max(0)..=(y + 5).min(height as i64 - 1) {
                    for nx in (x - 5).max(0)..=(x + 5).min(width as i64 - 1) {
                        let Some(k) = index[(ny as usize) * width + nx as usize] else { continue };
                        let weight = gaussian((nx - x) as f64) * gaussian((ny - y) as f64);
                        let (va, vb) = (f64::from(a[3 * k + channel]), f64::from(b[3 * k + channel]));
                        w += weight;
                        sa += weight * va;
                        sb += weight * vb;
                        saa += weight * va * va;
                        sbb += weight * vb * vb;
                        sab += weight * va * vb;
                    }
                }
                let (ma, mb) = (sa / w, sb / w);
                let (va, vb, vab) = (saa / w - ma * ma, sbb / w - mb * mb, sab / w - ma * mb);
                let top = (2.0 * ma * mb + 1e-4) * (2.0 * vab + 9e-4);
                values.push(top / ((ma * ma + mb * mb + 1e-4) * (va + vb + 9e-4)));
            }
        }
        values.iter().sum::<f64>() / values.len() as f64
    }

    #[test]
    fn agrees_with_the_definition() {
        let (width, height) = (23_usize, 17_usize);
        let active: Vec<bool> = (0..width * height).map(|t| (t % width + t / width) % 11 != 3 && t % 7 != 1).collect();
        let count = active.iter().filter(|&&a| a).count();
        let noise = |seed: u32, k: usize| {
            let hash = (k as u32 ^ seed).wrapping_mul(0x9E37_79B9).rotate_left(13).wrapping_mul(0x85EB_CA6B);
            (hash >> 8) as f32 / (1 << 24) as f32
        };
        let a: Vec<f32> = (0..3 * count).map(|k| noise(1, k)).collect();
        let b: Vec<f32> = a.iter().enumerate().map(|(k, a)| 0.7 * a + 0.3 * noise(2, k)).collect();
        let similarity = Similarity::new(width as u32, &active);
        let (fast, slow) = (similarity.of(&a, &b), plain(width, &active, &a, &b));
        assert!((fast - slow).abs() < 1e-4, "{fast} {slow}");
        assert!((similarity.of(&a, &a) - 1.0).abs() < 1e-5);
        assert!(fast < 0.99);
        let each = similarity.of_texels(&a, &b);
        assert_eq!(each.len(), count);
        assert!((each.iter().copied().map(f64::from).sum::<f64>() / count as f64 - fast).abs() < 1e-6);
    }

    #[test]
    fn errors_are_means_of_squares() {
        assert!((mean_square_error(&[0.0, 1.0], &[0.0, 0.5]) - 0.125).abs() < 1e-12);
        assert!((psnr(0.01) - 20.0).abs() < 1e-9);
    }

    #[test]
    fn errors_count_most_where_nothing_is_to_be_seen() {
        let (width, height) = (40_usize, 12_usize);
        let value = |k: usize| if k % width < 20 { 0.5 } else { ((k % width + k / width) % 2) as f32 };
        let texture: Vec<f32> = (0..width * height).flat_map(|k| [value(k); 3]).collect();
        let similarity = Similarity::new(width as u32, &vec![true; width * height]);
        let counts = similarity.sensitivity(&texture);
        assert!((counts[0] * 9e-4 - 1.0).abs() < 0.01, "{}", counts[0]);
        // Ones and noughts in turn have a variance of a quarter.
        assert!((counts[6 * width + 30] - 1.0 / (0.5 + 9e-4)).abs() < 0.05, "{}", counts[6 * width + 30]);
        // What a small error that is seen nowhere else takes from similarity, in both.
        for (texel, error) in [(6 * width + 8, 1e-3), (6 * width + 30, 1e-2)] {
            let noisy: Vec<f32> = (0..texture.len())
                .map(|k| texture[k] + if (k / 3 + k / 3 / width / 2).is_multiple_of(2) { error } else { -error })
                .collect();
            let lost = 1.0 - similarity.of_texels(&texture, &noisy)[texel];
            let told = error * error * counts[texel];
            assert!(lost > 0.5 * told && lost < 1.5 * told, "{texel}: {lost} {told}");
        }
    }
}
