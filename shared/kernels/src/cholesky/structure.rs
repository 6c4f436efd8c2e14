//! Which entries a Cholesky factor has: its columns grouped into supernodes, runs of neighbouring columns that share the
//! rows below them and are kept as one dense block.
//!
//! This work is based on: Davis, "Direct Methods for Sparse Linear Systems" (2006), chapter 4; the thresholds of what is
//! merged are those of Chen, Davis, Hager and Rajamanickam, "Algorithm 887: CHOLMOD" (2008).

use std::ops::Range;

/// Up to how many columns two supernodes are merged, and the largest part of the merged block that may be zeros.
const MERGED: [(usize, f64); 4] = [(4, 1.0), (16, 0.8), (48, 0.1), (usize::MAX, 0.05)];

/// The supernodes of a factor.
#[derive(Debug, Default)]
pub(super) struct Structure {
    /// First column of each supernode, and the number of columns.
    first_column: Vec<u32>,
    /// Where the rows of each supernode begin in `rows`.
    row_start: Vec<u32>,
    /// Rows below the supernodes' own columns, in order.
    rows: Vec<u32>,
    /// Where each supernode's block begins, and the length of all.
    value_start: Vec<usize>,
}

/// One supernode: its columns, and the rows below them that its columns reach.
#[derive(Clone, Copy, Debug)]
pub(super) struct Supernode<'a> {
    pub start: usize,
    pub end: usize,
    pub rows: &'a [u32],
    /// Where its block begins: `height` numbers a column, the rows of its own columns first.
    pub value_start: usize,
}

impl Supernode<'_> {
    pub fn columns(&self) -> usize {
        self.end - self.start
    }

    pub fn height(&self) -> usize {
        self.columns() + self.rows.len()
    }
}

/// A run of columns, each the parent of the one before: the rows of the last are those of all.
struct Run {
    columns: Range<usize>,
    /// Entries that are no zeros.
    entries: usize,
}

impl Run {
    fn size(&self, rows_below: usize) -> usize {
        let columns = self.columns.len();
        columns * (columns + 1) / 2 + columns * rows_below
    }
}

impl Structure {
    /// Analyses a symmetric matrix of `n` rows that has entries where each row's `neighbours` say, in any order; those
    /// above `n` do not count. `None` where the factor has more than `most` entries.
    pub fn new<I: Iterator<Item = u32>>(n: usize, most: usize, neighbours: impl Fn(usize) -> I) -> Option<Self> {
        let reach = reach(n, most, neighbours)?;
        let mut runs: Vec<Run> = Vec::new();
        for column in 0..reach.len() {
            let below = reach[column].len();
            runs.push(Run { columns: column..column + 1, entries: 1 + below });
            while let [.., child, last] = runs.as_slice() {
                let merged =
                    Run { columns: child.columns.start..last.columns.end, entries: child.entries + last.entries };
                let is_child = reach[child.columns.end - 1].first() == Some(&(last.columns.start as u32));
                if !(is_child && is_worth_it(&merged, below)) {
                    break;
                }
                runs.truncate(runs.len() - 2);
                runs.push(merged);
            }
        }
        let mut structure = Self { row_start: vec![0], value_start: vec![0], ..Self::default() };
        let mut values = 0;
        for run in &runs {
            let below = &reach[run.columns.end - 1];
            structure.first_column.push(run.columns.start as u32);
            structure.rows.extend_from_slice(below);
            structure.row_start.push(structure.rows.len() as u32);
            values += run.columns.len() * (run.columns.len() + below.len());
            structure.value_start.push(values);
        }
        structure.first_column.push(reach.len() as u32);
        Some(structure)
    }

    pub fn columns(&self) -> usize {
        self.first_column.last().map_or(0, |&columns| columns as usize)
    }

    pub fn supernodes(&self) -> usize {
        self.first_column.len().saturating_sub(1)
    }

    pub fn values(&self) -> usize {
        self.value_start.last().copied().unwrap_or(0)
    }

    /// The supernode of a column.
    pub fn owner(&self, column: usize) -> usize {
        self.first_column.partition_point(|&first| first as usize <= column) - 1
    }

    pub fn supernode(&self, index: usize) -> Supernode<'_> {
        Supernode {
            start: self.first_column[index] as usize,
            end: self.first_column[index + 1] as usize,
            rows: &self.rows[self.row_start[index] as usize..self.row_start[index + 1] as usize],
            value_start: self.value_start[index],
        }
    }
}

/// Whether a merged block holds few zeros enough.
fn is_worth_it(run: &Run, rows_below: usize) -> bool {
    let size = run.size(rows_below);
    let zeros = (size - run.entries) as f64 / size as f64;
    MERGED.iter().any(|&(columns, part)| run.columns.len() <= columns && zeros <= part)
}

/// The rows below the diagonal of each column of the factor, in order. Each row of the matrix reaches the columns on the
/// ways from its entries up the tree in which a column's parent is the first row that it reaches.
fn reach<I: Iterator<Item = u32>>(n: usize, most: usize, neighbours: impl Fn(usize) -> I) -> Option<Vec<Vec<u32>>> {
    let mut entries = n;
    let mut reach: Vec<Vec<u32>> = vec![Vec::new(); n];
    let mut seen_by = vec![n; n];
    for row in 0..n {
        seen_by[row] = row;
        for column in neighbours(row).filter(|&column| (column as usize) < row) {
            let mut column = column as usize;
            while seen_by[column] != row {
                seen_by[column] = row;
                reach[column].push(row as u32);
                entries += 1;
                column = reach[column][0] as usize;
            }
        }
        if entries > most {
            return None;
        }
    }
    Some(reach)
}
