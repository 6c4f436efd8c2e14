//! The numbers of a Cholesky factor, supernode by supernode: what the supernodes before it take away, then a dense
//! factorisation of its own block.
//!
//! This work is based on: Ng and Peyton, "Block sparse Cholesky algorithms on advanced uniprocessor computers" (1993),
//! the left-looking supernodal method. All products of dense blocks go through [`tile`].

use super::structure::{Structure, Supernode};

/// Rows and columns of a tile of a product.
const TILE: usize = 4;

/// The end of a list of supernodes.
const NONE: u32 = u32::MAX;

/// Memory that a factorisation needs and keeps.
#[derive(Default)]
pub(super) struct Scratch {
    /// Row within the present supernode's block of each row of the matrix that it reaches.
    place: Vec<u32>,
    /// The supernodes that have something to take away from each supernode next, as lists.
    first: Vec<u32>,
    next: Vec<u32>,
    /// How many rows of each supernode are done with.
    done: Vec<u32>,
    /// Supernode of each column.
    owner: Vec<u32>,
    /// Places of the rows of the supernode that takes away.
    target: Vec<usize>,
}

/// Factorises the matrix whose lower triangle has the entries `lower` at `rows`, in compressed columns.
/// `values` becomes the supernodes' blocks, column by column.
///
/// # Errors
/// The first column whose pivot is not positive.
pub(super) fn factorise(
    structure: &Structure,
    (column_start, rows, lower): (&[u32], &[u32], &[f64]),
    values: &mut Vec<f64>,
    scratch: &mut Scratch,
) -> Result<(), usize> {
    values.clear();
    // Tiles read past the last row of a column: into the next column, or into this filling.
    values.resize(structure.values() + TILE, 0.0);
    scratch.reset(structure);
    for index in 0..structure.supernodes() {
        let node = structure.supernode(index);
        let height = node.height();
        for (place, column) in (node.start..node.end).enumerate() {
            scratch.place[column] = place as u32;
        }
        for (place, &row) in (node.columns()..).zip(node.rows) {
            scratch.place[row as usize] = place as u32;
        }
        for (own, column) in values[node.value_start..].chunks_mut(height).zip(node.start..node.end) {
            let entries = column_start[column] as usize..column_start[column + 1] as usize;
            for (&row, &entry) in rows[entries.clone()].iter().zip(&lower[entries]) {
                own[scratch.place[row as usize] as usize] = entry;
            }
        }
        let mut descendant = scratch.first[index];
        while descendant != NONE {
            let following = scratch.next[descendant as usize];
            let taken = structure.supernode(descendant as usize);
            take_away(taken, descendant, node, values, scratch);
            scratch.link(taken, descendant);
            descendant = following;
        }
        dense(values, node).map_err(|column| node.start + column)?;
        scratch.link(node, index as u32);
    }
    Ok(())
}

impl Scratch {
    fn reset(&mut self, structure: &Structure) {
        let (columns, supernodes) = (structure.columns(), structure.supernodes());
        self.place.resize(columns, 0);
        self.owner.resize(columns, 0);
        for index in 0..supernodes {
            let node = structure.supernode(index);
            self.owner[node.start..node.end].fill(index as u32);
        }
        self.next.resize(supernodes, NONE);
        self.first.clear();
        self.first.resize(supernodes, NONE);
        self.done.clear();
        self.done.resize(supernodes, 0);
    }

    /// Puts a supernode on the list of the one that holds its next row.
    fn link(&mut self, node: Supernode<'_>, index: u32) {
        if let Some(&row) = node.rows.get(self.done[index as usize] as usize) {
            let owner = self.owner[row as usize] as usize;
            self.next[index as usize] = self.first[owner];
            self.first[owner] = index;
        }
    }
}

/// Takes the product of a descendant's rows from a supernode's block.
fn take_away(descendant: Supernode<'_>, index: u32, node: Supernode<'_>, values: &mut [f64], scratch: &mut Scratch) {
    let done = scratch.done[index as usize] as usize;
    let rows = &descendant.rows[done..];
    let columns = rows.partition_point(|&row| (row as usize) < node.end);
    scratch.done[index as usize] = (done + columns) as u32;
    scratch.target.clear();
    scratch.target.extend(rows.iter().map(|&row| scratch.place[row as usize] as usize));
    let first = descendant.columns() + done;
    let mut column = 0;
    while column < columns {
        let width = tile_width(columns - column);
        for row in (column..rows.len()).step_by(TILE) {
            let product = product(values, descendant, descendant.columns(), [first + row, first + column], width);
            for (product, &place) in product.iter().zip(&scratch.target[column..columns]) {
                let own = &mut values[node.value_start + place * node.height()..][..node.height()];
                for (&product, &place) in product.iter().zip(&scratch.target[row..]) {
                    own[place] -= product;
                }
            }
        }
        column += width;
    }
}

/// Replaces a supernode's block by its dense factor.
fn dense(values: &mut [f64], node: Supernode<'_>) -> Result<(), usize> {
    let (columns, height) = (node.columns(), node.height());
    for first in (0..columns).step_by(TILE) {
        let width = TILE.min(columns - first);
        for row in (first..height).step_by(TILE) {
            let product = product(values, node, first, [row, first], tile_width(width));
            let panel = values[node.value_start + first * height..].chunks_mut(height);
            for (product, column) in product[..width].iter().zip(panel) {
                for (value, &product) in column[row..].iter_mut().zip(product) {
                    *value -= product;
                }
            }
        }
        for own in first..first + width {
            let (before, column) = values[node.value_start + first * height..].split_at_mut((own - first) * height);
            let column = &mut column[own..height];
            for before in before.chunks_exact(height) {
                let factor = before[own];
                for (value, &before) in column.iter_mut().zip(&before[own..]) {
                    *value -= factor * before;
                }
            }
            let root = column[0].sqrt();
            if !(root > 0.0 && root.is_finite()) {
                return Err(own);
            }
            column[0] = root;
            for value in &mut column[1..] {
                *value /= root;
            }
        }
    }
    Ok(())
}

/// Columns that a tile takes of so many.
fn tile_width(columns: usize) -> usize {
    if columns == 3 { TILE } else { columns.min(TILE) }
}

/// Products of up to [`TILE`] rows of a supernode's block with others, over its first `columns`: by column, then by row.
/// Rows beyond the block's height hold no meaning.
fn product(values: &[f64], node: Supernode<'_>, columns: usize, rows: [usize; 2], width: usize) -> [[f64; TILE]; TILE] {
    let mut product = [[0.0; TILE]; TILE];
    let (values, height) = (&values[node.value_start..], node.height());
    match width {
        1 => product[..1].copy_from_slice(&tile::<1>(values, height, columns, rows)),
        2 => product[..2].copy_from_slice(&tile::<2>(values, height, columns, rows)),
        _ => product = tile::<TILE>(values, height, columns, rows),
    }
    product
}

#[inline(always)]
fn tile<const WIDTH: usize>(
    values: &[f64],
    height: usize,
    columns: usize,
    [row, other]: [usize; 2],
) -> [[f64; TILE]; WIDTH] {
    let mut sums = [[0.0; TILE]; WIDTH];
    for column in 0..columns {
        let start = column * height;
        let (Some(rows), Some(others)) =
            (values[start + row..].first_chunk::<TILE>(), values[start + other..].first_chunk::<WIDTH>())
        else {
            break;
        };
        for (sums, other) in sums.iter_mut().zip(others) {
            for (sum, row) in sums.iter_mut().zip(rows) {
                *sum += row * other;
            }
        }
    }
    sums
}
