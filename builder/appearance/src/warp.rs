//! Moving a texture by a warp within its charts: directly, or by Poisson reconstruction.
//!
//! Thesis section 4.4.1: the warped texture A minimises `sum |laplacian A - div g|^2 + weight^2 |A - c|^2`, c the
//! colours and g the gradients of the texture, both moved by the warp. The weight is once lambda (thesis equation 4.1)
//! and once lambda^2 (thesis equation 4.3, the system that is solved); we take the latter. L is the Laplacian of the
//! graph that links active texels of one chart: the border of a chart is natural and nothing flows across it.
//!
//! With A = c + e and r = div g - L c the normal equations are `(L^2 + weight^2) e = L r`, and L / (L^2 + weight^2) is the
//! real part of 1 / (L - i weight): one complex system of the Laplacian's own stencil, whose condition is the root of
//! that of the normal equations. L is the same for the whole data set and influence fades within some
//! 1 / sqrt(weight) = 7 texels, so conjugate gradients from c need few steps; a factor over a million unknowns would
//! only cost memory.

use super::charts::Charts;
use super::flow::Flow;
use super::level::Level;
use super::sampling::{Direct, Inverse, Places, Plane, sample};
use super::screened::{self, Stretches};
use kernels::simd::Level as Instructions;

/// Weight of colours against gradients, lambda of thesis equations 4.1 to 4.3.
pub const COLOUR_WEIGHT: f32 = 0.02;
/// Moves textures over one atlas.
#[derive(Clone, Debug)]
pub struct TextureWarper {
    level: Level,
    places: Places,
    stretches: Stretches,
    instructions: Instructions,
}

/// How a texture is moved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WarpMethod {
    /// Each texel takes the colour where its warp points.
    Direct,
    /// Colours and gradients are moved, and the texture is solved for.
    #[default]
    Poisson,
}

impl TextureWarper {
    /// Prepares for textures over `charts`.
    #[must_use]
    pub fn new(charts: &Charts) -> Self {
        let level = Level::new(charts.clone());
        Self {
            places: Places::new(&level),
            stretches: Stretches::new(&level),
            level,
            instructions: Instructions::best(),
        }
    }

    /// Number of active texels.
    #[must_use]
    pub fn texel_count(&self) -> usize {
        self.places.index.len()
    }

    /// `values`, `channels` of them per active texel and at most four, moved: active texel x of the result shows what lies at
    /// `x + warp(x)`. `warp` has two values per active texel.
    #[must_use]
    pub fn warp(&self, values: &[f32], channels: usize, warp: &[f32], how: WarpMethod) -> Vec<f32> {
        match channels {
            1 => self.moved::<1>(values, channels, warp, how),
            2 => self.moved::<2>(values, channels, warp, how),
            // Four are a vector of the processor.
            _ => self.moved::<4>(values, channels, warp, how),
        }
    }

    fn moved<const C: usize>(&self, values: &[f32], channels: usize, warp: &[f32], how: WarpMethod) -> Vec<f32> {
        let plane = self.places.spread::<C>(&self.level, values, channels);
        let direct = Direct { level: &self.level, places: &self.places, plane: &plane, channels, warp };
        let mut result = self.instructions.run(direct);
        if how == WarpMethod::Poisson {
            let mut colours = vec![[0.0; C]; plane.len()];
            for (&place, value) in self.places.index.iter().zip(result.chunks_exact(channels)) {
                colours[place as usize][..channels].copy_from_slice(value);
            }
            let divergence = self.divergence(&plane, &colours, warp);
            for channel in 0..channels {
                let right: Vec<f32> = divergence.iter().map(|more| more[channel]).collect();
                let z = screened::solve(&self.level, &self.stretches, COLOUR_WEIGHT, right, self.instructions);
                for (&place, result) in self.places.index.iter().zip(result.chunks_exact_mut(channels)) {
                    result[channel] = z.re[place as usize] + colours[place as usize][channel];
                }
            }
        }
        result
    }

    /// Gives the active texels `unseen` colours from around them; three values per active texel.
    pub fn fill(&self, colours: &mut [f32], unseen: &[u32]) {
        if unseen.is_empty() {
            return;
        }
        let mut unknown = vec![false; self.level.labels.len()];
        unseen.iter().for_each(|&k| unknown[self.places.index[k as usize] as usize] = true);
        let mut planes = vec![vec![0.0; self.level.labels.len()]; 4];
        for (&place, colour) in self.places.index.iter().zip(colours.chunks_exact(3)) {
            planes.iter_mut().zip(colour).for_each(|(plane, &value)| plane[place as usize] = value);
        }
        for pair in planes.chunks_exact_mut(2) {
            if let [a, b] = pair {
                self.level.fill(&unknown, a, b);
            }
        }
        for (&place, colour) in self.places.index.iter().zip(colours.chunks_exact_mut(3)) {
            colour.iter_mut().zip(&planes).for_each(|(value, plane)| *value = plane[place as usize]);
        }
    }

    /// The warp of active texels from a flow over all texels.
    #[must_use]
    pub fn compact(&self, flow: &Flow) -> Vec<f32> {
        let charts = &self.level.charts;
        let texels = charts.labels.iter().enumerate().filter(|(_, label)| **label != 0);
        texels.flat_map(|(texel, _)| [flow.x[texel], flow.y[texel]]).collect()
    }

    /// A flow over all texels from the warp of active ones.
    #[must_use]
    pub fn spread(&self, warp: &[f32]) -> Flow {
        let charts = &self.level.charts;
        let mut flow = Flow { x: vec![0.0; charts.labels.len()], y: vec![0.0; charts.labels.len()] };
        let texels = charts.labels.iter().enumerate().filter(|(_, label)| **label != 0);
        for ((texel, _), way) in texels.zip(warp.chunks_exact(2)) {
            (flow.x[texel], flow.y[texel]) = (way[0], way[1]);
        }
        flow
    }

    /// The warp that undoes `warp`: w'(y) = -w(y + w'(y)), by fixed-point iteration, to a thousandth of a texel.
    #[must_use]
    pub fn inverse(&self, warp: &[f32]) -> Vec<f32> {
        let plane = self.places.spread::<2>(&self.level, warp, 2);
        self.instructions.run(Inverse { level: &self.level, places: &self.places, plane: &plane })
    }

    /// How much each moved gradient differs from the gradient of the moved `colours`, gathered as a divergence.
    fn divergence<const C: usize>(&self, plane: &Plane<C>, colours: &Plane<C>, warp: &[f32]) -> Vec<[f32; C]> {
        let Level { stride, right, down, .. } = &self.level;
        let mut ways = vec![[0.0; 2]; plane.len()];
        for (&place, way) in self.places.index.iter().zip(warp.chunks_exact(2)) {
            ways[place as usize] = [way[0], way[1]];
        }
        let mut divergence = vec![[0.0; C]; plane.len()];
        self.places.each(|_, i, [x, y]| {
            for (linked, step, ex, ey) in [(right[i], 1, 1.0, 0.0), (down[i], *stride, 0.0, 1.0)] {
                if linked == 0.0 {
                    continue;
                }
                let j = i + step;
                let (wx, wy) = (0.5 * (ways[i][0] + ways[j][0]), 0.5 * (ways[i][1] + ways[j][1]));
                let ahead = sample(&self.level, plane, i, [x + (wx + ex), y + (wy + ey)]);
                let here = sample(&self.level, plane, i, [x + wx, y + wy]);
                for c in 0..C {
                    let more = ahead[c] - here[c] - (colours[j][c] - colours[i][c]);
                    divergence[i][c] += more;
                    divergence[j][c] -= more;
                }
            }
        });
        divergence
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn charts() -> Charts {
        let (width, height) = (14, 11);
        let label = |x: usize, y: usize| match (x, y) {
            (0..7, 1..10) => 1,
            (7..13, 0..8) if (x, y) != (9, 4) => 2,
            _ => 0,
        };
        Charts { width, height, labels: (0..width * height).map(|k| label(k % width, k / width)).collect() }
    }

    fn noise(k: usize) -> f32 {
        let hash = (k as u32 ^ 0x51ED).wrapping_mul(0x9E37_79B9).rotate_left(11).wrapping_mul(0x85EB_CA6B);
        (hash >> 8) as f32 / (1 << 24) as f32
    }

    /// One channel, one texel at a time.
    fn plainly(charts: &Charts, values: &[f32], warp: &[f32]) -> Vec<f32> {
        let level = Level::new(charts.clone());
        let places: Vec<usize> = (0..level.labels.len()).filter(|&place| level.labels[place] != 0).collect();
        let mut plane = vec![0.0; level.labels.len()];
        places.iter().zip(values).for_each(|(&place, &value)| plane[place] = value);
        level.extend(&mut plane);
        let at = |(&place, way): (&usize, &[f32])| {
            let (x, y) = ((place % level.stride) as f32 + way[0], (place / level.stride) as f32 + way[1]);
            let (left, top) = (x.floor(), y.floor());
            let (mut sum, mut weight) = (0.0, 0.0);
            let (last_column, last_row) = ((level.stride - 1) as f32, (level.rows - 1) as f32);
            let inside = (0.0..last_column).contains(&left) && (0.0..last_row).contains(&top);
            for (row, down) in [(top, 1.0 - (y - top)), (top + 1.0, y - top)] {
                for (column, along) in [(left, 1.0 - (x - left)), (left + 1.0, x - left)] {
                    let corner = if inside { row as usize * level.stride + column as usize } else { 0 };
                    if inside && level.territory[corner] == level.labels[place] {
                        sum += along * down * plane[corner];
                        weight += along * down;
                    }
                }
            }
            if weight > 1e-3 { sum / weight } else { plane[place] }
        };
        places.iter().zip(warp.chunks_exact(2)).map(at).collect()
    }

    #[test]
    fn all_channels_move_as_each_alone() {
        let charts = charts();
        let warper = TextureWarper::new(&charts);
        let n = warper.texel_count();
        // Far enough to leave the chart, its territory and the plane.
        let mut warp: Vec<f32> = (0..2 * n).map(|k| 30.0 * (noise(k + 7) - 0.5).powi(3) * 8.0).collect();
        (warp[4], warp[11]) = (f32::NAN, f32::INFINITY);
        for channels in 1..=4 {
            let values: Vec<f32> = (0..channels * n).map(noise).collect();
            let moved = warper.warp(&values, channels, &warp, WarpMethod::Direct);
            for channel in 0..channels {
                let of = |all: &[f32]| -> Vec<f32> { all.iter().skip(channel).step_by(channels).copied().collect() };
                assert_eq!(of(&moved), plainly(&charts, &of(&values), &warp), "channel {channel} of {channels}");
            }
        }
    }

    #[test]
    fn no_warp_changes_nothing() {
        let warper = TextureWarper::new(&charts());
        let values: Vec<f32> = (0..3 * warper.texel_count()).map(noise).collect();
        let still = vec![0.0; 2 * warper.texel_count()];
        for how in [WarpMethod::Direct, WarpMethod::Poisson] {
            let moved = warper.warp(&values, 3, &still, how);
            assert!(moved.iter().zip(&values).all(|(a, b)| (a - b).abs() < 1e-6), "{how:?}");
        }
    }

    /// The minimum by a dense solve of its normal equations in `f64`, everything written out.
    fn plain(charts: &Charts, values: &[f32], warp: &[f32]) -> Vec<f64> {
        let warper = TextureWarper::new(charts);
        let texels = charts.texels();
        let n = texels.len();
        let index = |x: i64, y: i64| -> Option<usize> {
            let inside = x >= 0 && y >= 0 && x < charts.width as i64 && y < charts.height as i64;
            inside.then(|| texels.binary_search(&((y * charts.width as i64 + x) as u32)).ok()).flatten()
        };
        let colours = warper.warp(values, 1, warp, WarpMethod::Direct);
        let mut laplacian = vec![vec![0.0; n]; n];
        let mut divergence = vec![0.0; n];
        for i in 0..n {
            let (x, y) = (i64::from(texels[i]) % charts.width as i64, i64::from(texels[i]) / charts.width as i64);
            for (ex, ey) in [(1, 0), (0, 1)] {
                let Some(j) = index(x + ex, y + ey) else { continue };
                if charts.labels[texels[i] as usize] != charts.labels[texels[j] as usize] {
                    continue;
                }
                for (a, b) in [(i, j), (j, i)] {
                    laplacian[a][b] += 1.0;
                    laplacian[a][a] -= 1.0;
                }
                let mean = [0, 1].map(|c| 0.5 * (warp[2 * i + c] + warp[2 * j + c]));
                let at = |dx: f32, dy: f32| {
                    let mut way = vec![0.0; 2 * n];
                    (way[2 * i], way[2 * i + 1]) = (mean[0] + dx, mean[1] + dy);
                    f64::from(warper.warp(values, 1, &way, WarpMethod::Direct)[i])
                };
                let gradient = at(ex as f32, ey as f32) - at(0.0, 0.0);
                divergence[i] += gradient;
                divergence[j] -= gradient;
            }
        }
        let weight = f64::from(COLOUR_WEIGHT).powi(2);
        let mut matrix = vec![vec![0.0; n + 1]; n];
        for i in 0..n {
            for j in 0..n {
                matrix[i][j] = (0..n).map(|k| laplacian[k][i] * laplacian[k][j]).sum();
            }
            matrix[i][i] += weight;
            matrix[i][n] =
                (0..n).map(|k| laplacian[k][i] * divergence[k]).sum::<f64>() + weight * f64::from(colours[i]);
        }
        eliminate(matrix)
    }

    fn eliminate(mut matrix: Vec<Vec<f64>>) -> Vec<f64> {
        let n = matrix.len();
        for i in 0..n {
            for k in i + 1..n {
                let factor = matrix[k][i] / matrix[i][i];
                for j in i..=n {
                    matrix[k][j] -= factor * matrix[i][j];
                }
            }
        }
        let mut x = vec![0.0; n];
        for i in (0..n).rev() {
            let known: f64 = (i + 1..n).map(|j| matrix[i][j] * x[j]).sum();
            x[i] = (matrix[i][n] - known) / matrix[i][i];
        }
        x
    }

    #[test]
    fn poisson_warping_is_the_minimum_of_its_energy() {
        let charts = charts();
        let warper = TextureWarper::new(&charts);
        let n = warper.texel_count();
        let values: Vec<f32> = (0..n).map(noise).collect();
        let warp: Vec<f32> = (0..2 * n).map(|k| 1.5 * (noise(k + 999) - 0.5)).collect();
        let fast = warper.warp(&values, 1, &warp, WarpMethod::Poisson);
        let exact = plain(&charts, &values, &warp);
        let direct = warper.warp(&values, 1, &warp, WarpMethod::Direct);
        let off = |values: &[f32]| {
            values.iter().zip(&exact).map(|(a, b)| (f64::from(*a) - b).powi(2)).sum::<f64>().sqrt() / (n as f64).sqrt()
        };
        assert!(off(&fast) < 5e-3, "{}", off(&fast));
        assert!(off(&direct) > 5e-2, "{}", off(&direct));
    }

    #[test]
    fn an_inverse_undoes_a_warp() {
        let size = 48;
        let warper = TextureWarper::new(&Charts::whole(size, size));
        let place = |k: usize| ((k % size) as f32, (k / size) as f32);
        let warp: Vec<f32> = (0..size * size)
            .flat_map(|k| [1.5 * (0.15 * place(k).0).sin(), 1.5 * (0.13 * place(k).1 + 1.0).cos()])
            .collect();
        let inverse = warper.inverse(&warp);
        let there = warper.warp(&warp, 2, &inverse, WarpMethod::Direct);
        for k in (0..size * size).filter(|k| (4..size - 4).contains(&(k % size)) && (4..size - 4).contains(&(k / size)))
        {
            assert!((there[2 * k] + inverse[2 * k]).abs() < 1e-3);
        }
    }
}
