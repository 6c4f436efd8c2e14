//! Looking up where the warp of a texel points: all channels of a texture at once, since finding the place costs more
//! than reading it.

use kernels::simd::Kernel;

use super::level::Level;

/// A texture on the planes of a level, its channels side by side; territories hold what lies nearest in their chart.
pub(super) type Plane<const C: usize> = [[f32; C]];

/// The active texels of a level by their places on its planes.
#[derive(Clone, Debug)]
pub(super) struct Places {
    /// Index into planes, ascending.
    pub index: Vec<u32>,
    /// Column and row, with margins.
    at: Vec<[u16; 2]>,
}

impl Places {
    pub fn new(level: &Level) -> Self {
        let index: Vec<u32> =
            (0..level.labels.len() as u32).filter(|&place| level.labels[place as usize] != 0).collect();
        let at = |&place: &u32| [place as usize % level.stride, place as usize / level.stride].map(|axis| axis as u16);
        Self { at: index.iter().map(at).collect(), index }
    }

    /// The plane of `values`, `channels` of them per active texel; further channels of the plane stay 0.
    pub fn spread<const C: usize>(&self, level: &Level, values: &[f32], channels: usize) -> Vec<[f32; C]> {
        let mut plane = vec![[0.0; C]; level.labels.len()];
        for (&place, values) in self.index.iter().zip(values.chunks_exact(channels)) {
            plane[place as usize][..channels].copy_from_slice(values);
        }
        level.extend(&mut plane);
        plane
    }

    /// Calls `visit` with each active texel's number, its index into planes, and where it lies.
    pub fn each(&self, mut visit: impl FnMut(usize, usize, [f32; 2])) {
        for (number, (&place, at)) in self.index.iter().zip(&self.at).enumerate() {
            visit(number, place as usize, at.map(f32::from));
        }
    }
}

/// Takes for each active texel what lies where its `warp` points, the first `channels` of a plane's.
pub(super) struct Direct<'a, const C: usize> {
    pub level: &'a Level,
    pub places: &'a Places,
    pub plane: &'a Plane<C>,
    pub channels: usize,
    pub warp: &'a [f32],
}

impl<const C: usize> Kernel for Direct<'_, C> {
    type Output = Vec<f32>;

    #[inline(always)]
    fn run(self) -> Vec<f32> {
        let Self { level, places, plane, channels, warp } = self;
        let mut values = vec![0.0; channels * places.index.len()];
        for number in 0..places.index.len() {
            let [x, y] = places.at[number];
            let there = [f32::from(x) + warp[2 * number], f32::from(y) + warp[2 * number + 1]];
            let value = sample(level, plane, places.index[number] as usize, there);
            for channel in 0..channels.min(C) {
                values[number * channels + channel] = value[channel];
            }
        }
        values
    }
}

/// Steps of the fixed-point iteration for the inverse of a warp.
const INVERSE_STEPS: usize = 8;
/// A step that is shorter, in texels, ends it: stores keep a warp to a 256th.
const SHORT: f32 = 1.0 / 1024.0;

/// The warp that undoes another, which is on a plane: w'(y) = -w(y + w'(y)), by fixed-point iteration.
pub(super) struct Inverse<'a> {
    pub level: &'a Level,
    pub places: &'a Places,
    pub plane: &'a Plane<2>,
}

impl Kernel for Inverse<'_> {
    type Output = Vec<f32>;

    #[inline(always)]
    fn run(self) -> Vec<f32> {
        let Self { level, places, plane } = self;
        let mut inverse = vec![0.0; 2 * places.index.len()];
        for number in 0..places.index.len() {
            let place = places.index[number] as usize;
            let [column, row] = places.at[number];
            let (column, row) = (f32::from(column), f32::from(row));
            let [mut x, mut y] = [-plane[place][0], -plane[place][1]];
            for _ in 0..INVERSE_STEPS {
                let there = sample(level, plane, place, [column + x, row + y]);
                let (further_x, further_y) = (-there[0] - x, -there[1] - y);
                (x, y) = (-there[0], -there[1]);
                if further_x.abs() < SHORT && further_y.abs() < SHORT {
                    break;
                }
            }
            inverse[2 * number] = x;
            inverse[2 * number + 1] = y;
        }
        inverse
    }
}

/// The value of `plane` at column `x` and row `y`, interpolated among texels of the territory that the texel `place` lies
/// in; where there are none, that texel's own value.
#[inline(always)]
pub(super) fn sample<const C: usize>(level: &Level, plane: &Plane<C>, place: usize, [x, y]: [f32; 2]) -> [f32; C] {
    let (stride, rows) = (level.stride, level.rows);
    // Written so that NaN is outside.
    let inside = x >= 0.0 && y >= 0.0 && x < (stride - 1) as f32 && y < (rows - 1) as f32;
    if !inside {
        return plane[place];
    }
    let (left, top) = (x as u32, y as u32);
    let (fx, fy) = (x - left as f32, y - top as f32);
    let above = top as usize * stride + left as usize;
    let below = above + stride;
    let label = level.labels[place];
    let shares = [(1.0 - fx) * (1.0 - fy), fx * (1.0 - fy), (1.0 - fx) * fy, fx * fy];
    let corners = [above, above + 1, below, below + 1];
    // Nearly everywhere all four are of the territory.
    let alike = level.quads[above] == label;
    let (mut sum, mut weight) = ([0.0; C], 0.0);
    for k in 0..4 {
        // Which corners count changes along every border. Values are finite.
        let share = if alike || level.territory[corners[k]] == label { shares[k] } else { 0.0 };
        let value = plane[corners[k]];
        for channel in 0..C {
            sum[channel] += share * value[channel];
        }
        weight += share;
    }
    if weight > 1e-3 { sum.map(|sum| sum / weight) } else { plane[place] }
}
