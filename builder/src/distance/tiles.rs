//! All pairs of frames, cut into square tiles: what a tile touches stays in a core's second-level cache, and each tile
//! is summed by one thread in a fixed order, whatever the number of threads.

use rayon::prelude::*;

/// Frames along a tile's side.
pub(super) const SIDE: usize = 32;

/// The pairs (i, j), i < j, with i and j each in one run of [`SIDE`] frames.
pub(super) struct Tile {
    first_i: usize,
    first_j: usize,
    frame_count: usize,
    /// Two sums over the vertices for each pair, then the pair's yaw.
    pub(super) alignment: Vec<[f64; 2]>,
    /// The sum over the triangles (or vertices) for each pair.
    pub(super) sum: Vec<f64>,
}

impl Tile {
    /// Calls `visit(i, j, slot)` for each pair of the tile; `slot` counts within the tile.
    #[inline(always)]
    pub(super) fn for_each_pair(
        (first_i, first_j, frame_count): (usize, usize, usize),
        mut visit: impl FnMut(usize, usize, usize),
    ) {
        for i in first_i..(first_i + SIDE).min(frame_count) {
            for j in first_j.max(i + 1)..(first_j + SIDE).min(frame_count) {
                visit(i, j, (i - first_i) * SIDE + (j - first_j));
            }
        }
    }

    /// What [`Self::for_each_pair`] needs to know.
    pub(super) fn bounds(&self) -> (usize, usize, usize) {
        (self.first_i, self.first_j, self.frame_count)
    }
}

/// Tiles that cover all pairs of `frame_count` frames.
pub(super) fn tiles(frame_count: usize) -> Vec<Tile> {
    let starts = || (0..frame_count).step_by(SIDE);
    starts()
        .flat_map(|first_i| starts().filter(move |&first_j| first_j >= first_i).map(move |first_j| (first_i, first_j)))
        .map(|(first_i, first_j)| Tile {
            first_i,
            first_j,
            frame_count,
            alignment: vec![[0.0; 2]; SIDE * SIDE],
            sum: vec![0.0; SIDE * SIDE],
        })
        .collect()
}

/// Calls `visit` on all tiles, in parallel.
pub(super) fn for_each(tiles: &mut [Tile], visit: impl Fn(&mut Tile) + Send + Sync) {
    tiles.par_iter_mut().for_each(visit);
}
