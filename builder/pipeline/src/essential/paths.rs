//! Shortest paths between all pairs of nodes of a dense digraph: Floyd and Warshall's algorithm in blocks.
//!
//! Venkataraman, Sahni and Mukhopadhyaya, "A blocked all-pairs shortest-paths algorithm", 2003. A round closes a
//! diagonal block over its own nodes, extends it to its row and its column of blocks, and relaxes all other blocks with
//! min-plus products of those two; nearly all the time goes into these products, which are vectorised.

use rayon::prelude::*;

use kernels::simd::{Kernel, Level};

/// Nodes along a block's side.
const SIDE: usize = 64;
/// Rows and columns of the part of a product that is kept in registers.
const ROWS: usize = 4;
const COLUMNS: usize = 16;

/// Lengths of shortest paths of at least one edge; infinite where there is none.
pub struct PathLengths {
    nodes: usize,
    /// Columns of the storage: `nodes` rounded up to whole blocks.
    stride: usize,
    lengths: Vec<f64>,
}

impl PathLengths {
    /// Shortest paths between `nodes` nodes with edges of cost `edge(i, j)` >= 0, infinite for none.
    pub fn new(level: Level, nodes: usize, edge: impl Fn(usize, usize) -> f64 + Sync) -> Self {
        Self::of_rows(level, nodes, |i, row| {
            for (j, length) in row.iter_mut().enumerate() {
                *length = edge(i, j);
            }
        })
    }

    /// The same where `fill(i, row)` writes the costs of the edges from node i into a row of infinities.
    pub fn of_rows(level: Level, nodes: usize, fill: impl Fn(usize, &mut [f64]) + Sync) -> Self {
        let stride = nodes.next_multiple_of(SIDE);
        let mut lengths = vec![f64::INFINITY; stride * stride];
        lengths.par_chunks_mut(stride.max(1)).take(nodes).enumerate().for_each(|(i, row)| {
            fill(i, &mut row[..nodes]);
        });
        let mut paths = Self { nodes, stride, lengths };
        for block in 0..stride / SIDE {
            paths.relax_through(level, block);
        }
        paths
    }

    /// Lengths of the shortest paths from node `i`.
    pub fn from(&self, i: usize) -> &[f64] {
        &self.lengths[i * self.stride..][..self.nodes]
    }

    /// Admits the nodes of `block` as inner nodes of paths.
    fn relax_through(&mut self, level: Level, block: usize) {
        let (stride, first) = (self.stride, block * SIDE);
        let mut row = self.lengths[first * stride..][..SIDE * stride].to_vec();
        let mut diagonal = columns_of(&row, stride, first);
        close(&mut diagonal);
        let old = row.clone();
        level.run(Product { to: &mut row, left: &diagonal, right: &old, stride });
        let row = &row;
        self.lengths.par_chunks_mut(SIDE * stride).enumerate().for_each(|(i, rows)| {
            if i == block {
                rows.copy_from_slice(row);
            } else {
                // The column of blocks needs no step of its own: its paths through the closed diagonal block are among
                // those through the extended row.
                let left = columns_of(rows, stride, first);
                level.run(Product { to: rows, left: &left, right: row, stride });
            }
        });
    }
}

/// The block of columns from `first` on of a row of blocks.
fn columns_of(rows: &[f64], stride: usize, first: usize) -> Vec<f64> {
    rows.chunks_exact(stride).flat_map(|row| &row[first..first + SIDE]).copied().collect()
}

/// Floyd and Warshall's algorithm on one block.
fn close(block: &mut [f64]) {
    for k in 0..SIDE {
        for i in 0..SIDE {
            let to_k = block[i * SIDE + k];
            for j in 0..SIDE {
                block[i * SIDE + j] = block[i * SIDE + j].min(to_k + block[k * SIDE + j]);
            }
        }
    }
}

/// `to = min(to, left (x) right)` with `(left (x) right)(i, j) = min over k of left(i, k) + right(k, j)`, for rows of
/// blocks `to` and `right` and a block `left`.
struct Product<'a> {
    to: &'a mut [f64],
    left: &'a [f64],
    right: &'a [f64],
    stride: usize,
}

impl Kernel for Product<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        for column in (0..self.stride).step_by(COLUMNS) {
            for row in (0..SIDE).step_by(ROWS) {
                let mut least = [[0.0; COLUMNS]; ROWS];
                for r in 0..ROWS {
                    least[r].copy_from_slice(&self.to[(row + r) * self.stride + column..][..COLUMNS]);
                }
                for k in 0..SIDE {
                    let mut right = [0.0; COLUMNS];
                    right.copy_from_slice(&self.right[k * self.stride + column..][..COLUMNS]);
                    for r in 0..ROWS {
                        let left = self.left[(row + r) * SIDE + k];
                        for c in 0..COLUMNS {
                            let sum = left + right[c];
                            least[r][c] = if sum < least[r][c] { sum } else { least[r][c] };
                        }
                    }
                }
                for r in 0..ROWS {
                    self.to[(row + r) * self.stride + column..][..COLUMNS].copy_from_slice(&least[r]);
                }
            }
        }
    }
}
