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

/// Pairs of a band at most: a band takes 24 bytes a pair while it is measured.
const MOST_PAIRS: usize = 1 << 22;
/// Terms of all sums of a band at most, some ten seconds of work: what is lost when the program is killed.
const MOST_TERMS: usize = 1 << 34;

/// All frames, cut into bands of rows that are whole tiles. Depends on the numbers of frames and of terms of a sum only.
pub(super) fn bands(frame_count: usize, terms: usize) -> Vec<Range<usize>> {
    let most = MOST_PAIRS.min(MOST_TERMS / terms.max(1));
    let mut bands = Vec::new();
    let mut start = 0;
    while start < frame_count {
        let mut end = (start + SIDE).min(frame_count);
        while end < frame_count && pairs(frame_count, start..(end + SIDE).min(frame_count)) <= most {
            end = (end + SIDE).min(frame_count);
        }
        bands.push(start..end);
        start = end;
    }
    bands
}

/// Number of pairs (i, j), i < j, with i in `rows`.
pub(super) fn pairs(frame_count: usize, rows: Range<usize>) -> usize {
    let after = |i: usize| (frame_count - i) * (frame_count - i).saturating_sub(1) / 2;
    after(rows.start) - after(rows.end)
}

/// Tiles that cover all pairs (i, j), i < j, with i in `rows`, which are whole tiles.
pub(super) fn tiles(frame_count: usize, rows: Range<usize>) -> Vec<Tile> {
    let columns = || (0..frame_count).step_by(SIDE);
    rows.step_by(SIDE)
        .flat_map(|first_i| columns().filter(move |&first_j| first_j >= first_i).map(move |first_j| (first_i, first_j)))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_cover_every_pair_once() {
        for frame_count in [0, 1, 31, 32, 33, 1000, 20_000] {
            for terms in [0, 1, 500, 10_000, usize::MAX] {
                let bands = bands(frame_count, terms);
                let mut next = 0;
                for band in &bands {
                    assert!(band.start == next && band.end > band.start);
                    assert!(band.end % SIDE == 0 || band.end == frame_count);
                    let most = MOST_PAIRS.min(MOST_TERMS / terms.max(1));
                    assert!(band.len() <= SIDE || pairs(frame_count, band.clone()) <= most);
                    next = band.end;
                }
                assert_eq!(next, frame_count);
                let all: usize = bands.into_iter().map(|band| pairs(frame_count, band)).sum();
                assert_eq!(all, frame_count * frame_count.saturating_sub(1) / 2);
            }
        }
    }
}
