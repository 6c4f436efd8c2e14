//! Looking up where the warp of a texel points: all channels of a texture at once, since finding the place costs more
//! than reading it.

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
    let pairs = [
        (&level.territory[above..above + 2], &plane[above..above + 2], 1.0 - fy),
        (&level.territory[below..below + 2], &plane[below..below + 2], fy),
    ];
    let (mut sum, mut weight) = ([0.0; C], 0.0);
    for (territory, values, down) in pairs {
        for (k, along) in [1.0 - fx, fx].into_iter().enumerate() {
            // No branch: which corners count changes along every border. Values are finite.
            let share = if territory[k] == label { along * down } else { 0.0 };
            for (sum, value) in sum.iter_mut().zip(values[k]) {
                *sum += share * value;
            }
            weight += share;
        }
    }
    if weight > 1e-3 { sum.map(|sum| sum / weight) } else { plane[place] }
}
