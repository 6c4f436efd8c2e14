//! All pairs of frames, cut into square tiles: what a tile touches stays in a core's second-level cache, and each tile
//! is summed by one thread in a fixed order, whatever the number of threads.

use std::ops::Range;

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
    /// The frames i of the tile.
    #[inline(always)]
    pub(super) fn rows(&self) -> Range<usize> {
        self.first_i..(self.first_i + SIDE).min(self.frame_count)
    }

    /// The frames j > i of the tile.
    #[inline(always)]
    pub(super) fn columns(&self, i: usize) -> Range<usize> {
        self.first_j.max(i + 1)..(self.first_j + SIDE).min(self.frame_count)
    }

    /// The place of the pair (i, j) in the tile's sums.
    #[inline(always)]
    pub(super) fn slot(&self, i: usize, j: usize) -> usize {
        (i - self.first_i) * SIDE + (j - self.first_j)
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
