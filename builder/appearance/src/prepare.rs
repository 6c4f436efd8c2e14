//! What flows are found on: brightness, equalised and smoothed between edges.
//!
//! Thesis section 4.4.1 equalises the histogram of each texture and filters it bilaterally (diameter 80, colours 15 of
//! 255, space 80, for textures of 4096 texels), so that light that changes matters less than edges that move. We do so
//! with brightness alone, and filter by the bilateral grid of Chen, Paris, Durand, *Real-time edge-aware image
//! processing with the bilateral grid*, 2007, at a width that follows the texture's size.

use kernels::simd::{Kernel, Level as Instructions};

use super::textures::Texture;

/// Standard deviation in space, as a part of the texture's longer side.
const SPACE: f32 = 80.0 / 4096.0;
/// Standard deviation of values.
const RANGE: f32 = 15.0 / 255.0;
/// Values that histograms tell apart.
const BINS: usize = 256;

/// Prepared brightness of all texels, 0 to 1, row-major; 0 where `labels` are 0. Texels that were not seen count for
/// nothing.
#[must_use]
pub fn prepare(texture: &Texture, labels: &[u32]) -> Vec<f32> {
    let counts = |texel: usize| labels[texel] != 0 && texture.seen(texel);
    let mut values: Vec<f32> = texture.colours.iter().map(|&colour| brightness(colour)).collect();
    equalise(&mut values, &counts);
    bilateral(&values, texture.width as usize, labels, &counts)
}

/// Luma of an encoded colour (Rec. 709), 0 to 1.
fn brightness([red, green, blue]: [u8; 3]) -> f32 {
    (0.2126 * f32::from(red) + 0.7152 * f32::from(green) + 0.0722 * f32::from(blue)) / 255.0
}

/// Maps values so that those that count are spread evenly over 0 to 1.
fn equalise(values: &mut [f32], counts: &impl Fn(usize) -> bool) {
    let place = |value: f32| value.clamp(0.0, 1.0) * (BINS - 1) as f32;
    let mut histogram = [0_u64; BINS];
    for (texel, &value) in values.iter().enumerate() {
        if counts(texel) {
            histogram[(place(value) + 0.5) as usize] += 1;
        }
    }
    let total: u64 = histogram.iter().sum();
    if total == 0 {
        return;
    }
    let mut below = 0;
    let mut ranks = [0.0_f32; BINS];
    for (rank, count) in ranks.iter_mut().zip(histogram) {
        *rank = ((below as f64 + 0.5 * count as f64) / total as f64) as f32;
        below += count;
    }
    for value in values {
        let at = place(*value);
        let low = at as usize;
        let high = (low + 1).min(BINS - 1);
        *value = ranks[low] + (at - low as f32) * (ranks[high] - ranks[low]);
    }
}

/// Means of what lies near in space and in value; 0 where `labels` are 0.
fn bilateral(values: &[f32], width: usize, labels: &[u32], counts: &impl Fn(usize) -> bool) -> Vec<f32> {
    let height = values.len() / width.max(1);
    let cell = (SPACE * width.max(height) as f32).max(1.0);
    // A margin of one cell on all sides, and room for interpolation.
    let size = |texels: usize| (texels as f32 / cell) as usize + 4;
    let (columns, rows, layers) = (size(width), size(height), (1.0 / RANGE) as usize + 4);
    let mut grid = Grid { size: [layers, columns, rows], cells: vec![[0.0; 2]; layers * columns * rows] };
    let across: Vec<f32> = (0..width).map(|x| x as f32 / cell + 1.0).collect();
    let along: Vec<f32> = (0..height).map(|y| y as f32 / cell + 1.0).collect();
    for (y, (&along, values)) in along.iter().zip(values.chunks_exact(width.max(1))).enumerate() {
        let line = (along + 0.5) as usize * columns;
        for (x, (&across, &value)) in across.iter().zip(values).enumerate() {
            if counts(y * width + x) {
                let layer = (value / RANGE + 1.0 + 0.5) as usize;
                let cell = &mut grid.cells[(line + (across + 0.5) as usize) * layers + layer];
                cell[0] += value;
                cell[1] += 1.0;
            }
        }
    }
    for (step, count) in [(1, layers), (layers, columns), (layers * columns, rows)] {
        grid.blur(step, count);
    }
    let grid = &grid;
    Instructions::best().run(Slice { grid, values, labels, across: &across, along: &along })
}

/// The means of a grid at all texels.
struct Slice<'a> {
    grid: &'a Grid,
    values: &'a [f32],
    labels: &'a [u32],
    /// The column of cells of each column of texels, and the row of each row.
    across: &'a [f32],
    along: &'a [f32],
}

impl Kernel for Slice<'_> {
    type Output = Vec<f32>;

    #[inline(always)]
    fn run(self) -> Vec<f32> {
        let Self { grid, values, labels, across, along } = self;
        let mut means = vec![0.0; values.len()];
        for y in 0..along.len() {
            for x in 0..across.len() {
                let texel = y * across.len() + x;
                if labels[texel] != 0 {
                    let value = values[texel];
                    let [sum, weight] = grid.at([value / RANGE + 1.0, across[x], along[y]]);
                    means[texel] = if weight > 1e-6 { sum / weight } else { value };
                }
            }
        }
        means
    }
}

/// Sums of values and of weights over layers of value, columns and rows.
struct Grid {
    size: [usize; 3],
    cells: Vec<[f32; 2]>,
}

impl Grid {
    /// A Gaussian of standard deviation 1 along the axis whose `count` cells lie `step` apart.
    fn blur(&mut self, step: usize, count: usize) {
        let weights = [0.054_5, 0.244_2, 0.402_6, 0.244_2, 0.054_5];
        let source = self.cells.clone();
        for (index, cell) in self.cells.iter_mut().enumerate() {
            let at = index / step % count;
            *cell = [0.0; 2];
            for (k, weight) in weights.into_iter().enumerate() {
                if at + k < 2 || at + k - 2 >= count {
                    continue;
                }
                let from = source[index + k * step - 2 * step];
                cell[0] += weight * from[0];
                cell[1] += weight * from[1];
            }
        }
    }

    /// Both sums at a place between cells.
    #[inline(always)]
    fn at(&self, place: [f32; 3]) -> [f32; 2] {
        let [layers, columns, _] = self.size;
        let low = place.map(|at| at as usize);
        let share = [place[0] - low[0] as f32, place[1] - low[1] as f32, place[2] - low[2] as f32];
        let first = (low[2] * columns + low[1]) * layers + low[0];
        let mut sums = [0.0; 2];
        for (corner, y) in [(0, 1.0 - share[2]), (layers * columns, share[2])] {
            for (beside, x) in [(0, 1.0 - share[1]), (layers, share[1])] {
                let at = first + corner + beside;
                let (near, far) = (self.cells[at], self.cells[at + 1]);
                for k in 0..2 {
                    sums[k] += y * x * (near[k] + share[0] * (far[k] - near[k]));
                }
            }
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equalised_values_are_ranks() {
        let mut values: Vec<f32> = (0..1000).map(|k| (k as f32 / 999.0).powi(3)).collect();
        equalise(&mut values, &|_| true);
        assert!(values.windows(2).all(|pair| pair[0] <= pair[1]));
        assert!((values[750] - 0.75).abs() < 0.02, "{}", values[750]);
    }

    #[test]
    fn edges_stay_and_noise_goes() {
        let (width, height) = (64, 64);
        let noise = |k: usize| ((k * 7919) % 17) as f32 / 17.0 * 0.04 - 0.02;
        let values: Vec<f32> = (0..width * height).map(|k| if k % width < 32 { 0.2 } else { 0.8 } + noise(k)).collect();
        let filtered = bilateral(&values, width, &vec![1; values.len()], &|_| true);
        let spread = |values: &[f32]| {
            let row = &values[32 * width..32 * width + 28];
            row.iter().fold(0.0_f32, |most, v| most.max((v - 0.2).abs()))
        };
        assert!(spread(&filtered) < 0.5 * spread(&values));
        assert!(filtered[32 * width + 30] < 0.25 && filtered[32 * width + 33] > 0.75);
    }
}
