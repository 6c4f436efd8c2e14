//! Products, factors and inverses in blocks that stay in registers.
//!
//! All are made of one thing: a tile of `left^T * right`, whose sums go from the first row to the last. So each entry is rounded in the same
//! order at every level of instructions, and whatever the size of a register. Matrices are filled up to whole tiles.

use kernels::simd::Kernel;

/// Rows and columns of a tile.
const ROWS: usize = 4;
const COLUMNS: usize = 8;
/// Rows of a factor that are found one by one, before all rows below learn of them.
const BLOCK: usize = 16;

/// A matrix, row-major, filled up with zeros to whole tiles.
#[derive(Clone, Debug, PartialEq)]
pub struct Padded {
    rows: usize,
    columns: usize,
    values: Vec<f64>,
}

impl Padded {
    fn zeros(rows: usize, columns: usize) -> Self {
        let [rows, columns] = [rows, columns].map(|size| size.next_multiple_of(COLUMNS));
        Self { rows, columns, values: vec![0.0; rows * columns] }
    }

    /// A matrix, row-major.
    pub fn of(values: &[f64], [rows, columns]: [usize; 2]) -> Self {
        let mut padded = Self::zeros(rows, columns);
        let stride = padded.columns.max(1);
        for (own, values) in padded.values.chunks_exact_mut(stride).zip(values.chunks_exact(columns.max(1))) {
            own[..columns].copy_from_slice(values);
        }
        padded
    }

    /// A matrix, row-major, transposed.
    pub fn transposed(values: &[f64], [rows, columns]: [usize; 2]) -> Self {
        let mut padded = Self::zeros(columns, rows);
        for (row, values) in values.chunks_exact(columns.max(1)).enumerate() {
            for (column, value) in values.iter().enumerate() {
                padded.values[column * padded.columns + row] = *value;
            }
        }
        padded
    }

    /// Ones on the diagonal from `first` on.
    pub fn fill_diagonal(&mut self, first: usize) {
        (first..self.rows).for_each(|k| self.values[k * self.columns + k] = 1.0);
    }

    /// A row.
    pub fn row(&self, row: usize) -> &[f64] {
        &self.values[row * self.columns..(row + 1) * self.columns]
    }

    /// Its first rows and columns, row-major.
    pub fn trimmed(&self, [rows, columns]: [usize; 2]) -> Vec<f64> {
        (0..rows).flat_map(|row| self.row(row)[..columns].iter().copied()).collect()
    }
}

/// Sums over the first `depth` rows of `left^T * right`, of which both are seen from their first entry in the tile on.
#[inline(always)]
fn tile(left: &[f64], right: &[f64], strides: [usize; 2], depth: usize) -> [[f64; COLUMNS]; ROWS] {
    let mut sums = [[0.0; COLUMNS]; ROWS];
    for (left, right) in left.chunks(strides[0]).zip(right.chunks(strides[1])).take(depth) {
        let (Some(left), Some(right)) = (left.first_chunk::<ROWS>(), right.first_chunk::<COLUMNS>()) else { break };
        for row in 0..ROWS {
            for column in 0..COLUMNS {
                sums[row][column] = left[row].mul_add(right[column], sums[row][column]);
            }
        }
    }
    sums
}

/// What begins with entry `first`: nothing of a matrix without rows.
#[inline(always)]
fn from(values: &[f64], first: usize) -> &[f64] {
    values.get(first..).unwrap_or_default()
}

/// Takes a tile off `values`, seen from its first entry on.
#[inline(always)]
fn take_off(values: &mut [f64], stride: usize, sums: &[[f64; COLUMNS]; ROWS]) {
    for (own, sums) in values.chunks_mut(stride).zip(sums) {
        let Some(own) = own.first_chunk_mut::<COLUMNS>() else { break };
        for column in 0..COLUMNS {
            own[column] -= sums[column];
        }
    }
}

/// Writes a tile.
#[inline(always)]
fn put(values: &mut [f64], stride: usize, sums: &[[f64; COLUMNS]; ROWS]) {
    for (own, sums) in values.chunks_mut(stride).zip(sums) {
        let Some(own) = own.first_chunk_mut::<COLUMNS>() else { break };
        *own = *sums;
    }
}

/// Adds `share` times `other`.
#[inline(always)]
pub fn add_multiple(own: &mut [f64], share: f64, other: &[f64]) {
    for (own, other) in own.iter_mut().zip(other) {
        *own = share.mul_add(*other, *own);
    }
}

/// `left^T * right`.
pub struct Product<'a> {
    pub left: &'a Padded,
    pub right: &'a Padded,
}

impl Kernel for Product<'_> {
    type Output = Padded;

    #[inline(always)]
    fn run(self) -> Padded {
        let (left, right) = (self.left, self.right);
        let mut all = Padded::zeros(left.columns, right.columns);
        let strides = [left.columns, right.columns];
        for i in (0..left.columns).step_by(ROWS) {
            for j in (0..right.columns).step_by(COLUMNS) {
                let sums = tile(from(&left.values, i), from(&right.values, j), strides, left.rows);
                put(&mut all.values[i * strides[1] + j..], strides[1], &sums);
            }
        }
        all
    }
}

/// `values^T * values`, on and above the diagonal.
pub struct Gram<'a> {
    pub values: &'a Padded,
    /// Whether the values are a lower triangle: of a column nothing is above the diagonal.
    pub is_lower: bool,
}

impl Kernel for Gram<'_> {
    type Output = Padded;

    #[inline(always)]
    fn run(self) -> Padded {
        let (n, values) = (self.values.columns, &self.values.values);
        let mut all = Padded::zeros(n, n);
        for i in (0..n).step_by(ROWS) {
            for j in (i - i % COLUMNS..n).step_by(COLUMNS) {
                let first = if self.is_lower { j } else { 0 };
                let (left, right) = (from(values, first * n + i), from(values, first * n + j));
                let sums = tile(left, right, [n, n], self.values.rows - first);
                put(&mut all.values[i * n + j..], n, &sums);
            }
        }
        all
    }
}

/// Cholesky's factor of a matrix whose upper triangle is read: U of U^T U, in its upper triangle. `None` where there is none.
pub struct Factorise {
    pub values: Padded,
}

impl Kernel for Factorise {
    type Output = Option<Padded>;

    #[inline(always)]
    fn run(mut self) -> Option<Padded> {
        let n = self.values.columns;
        let values = &mut self.values.values;
        for first in (0..n).step_by(BLOCK) {
            let end = n.min(first + BLOCK);
            for k in first..end {
                let (done, below) = values.split_at_mut((k + 1) * n);
                let row = &mut done[k * n..];
                if !(row[k] > 0.0 && row[k].is_finite()) {
                    return None;
                }
                let root = row[k].sqrt();
                for value in &mut row[k..] {
                    *value /= root;
                }
                for (i, other) in (k + 1..end).zip(below.chunks_exact_mut(n)) {
                    add_multiple(&mut other[i..], -row[i], &row[i..]);
                }
            }
            let (done, below) = values.split_at_mut(end * n);
            let panel = &done[first * n..];
            for i in (end..n).step_by(ROWS) {
                for j in (i - i % COLUMNS..n).step_by(COLUMNS) {
                    let sums = tile(&panel[i..], &panel[j..], [n, n], end - first);
                    take_off(&mut below[(i - end) * n + j..], n, &sums);
                }
            }
        }
        Some(self.values)
    }
}

/// The inverse of the transposed factor: a lower triangle.
pub struct Invert<'a> {
    pub factor: &'a Padded,
}

impl Kernel for Invert<'_> {
    type Output = Padded;

    #[inline(always)]
    fn run(self) -> Padded {
        let (n, factor) = (self.factor.columns, &self.factor.values);
        let mut inverse = Padded::zeros(n, n);
        for first in (0..n).step_by(BLOCK) {
            let end = n.min(first + BLOCK);
            let (done, rows) = inverse.values.split_at_mut(first * n);
            for i in (first..end).step_by(ROWS) {
                for j in (0..first).step_by(COLUMNS) {
                    let sums = tile(&factor[j * n + i..], &done[j * n + j..], [n, n], first - j);
                    take_off(&mut rows[(i - first) * n + j..], n, &sums);
                }
            }
            for i in first..end {
                let (above, own) = rows.split_at_mut((i - first) * n);
                let own = &mut own[..n];
                own[i] = 1.0;
                for (k, above) in (first..i).zip(above.chunks_exact(n)) {
                    add_multiple(&mut own[..=k], -factor[k * n + i], &above[..=k]);
                }
                for value in &mut own[..=i] {
                    *value /= factor[i * n + i];
                }
            }
        }
        inverse
    }
}

/// X of U^T U X = `right`.
pub struct Solve<'a> {
    pub factor: &'a Padded,
    pub right: Padded,
}

impl Kernel for Solve<'_> {
    type Output = Padded;

    #[inline(always)]
    fn run(mut self) -> Padded {
        let (n, width) = (self.factor.columns, self.right.columns);
        let (factor, right) = (&self.factor.values, &mut self.right.values);
        if width == 0 {
            return self.right;
        }
        for first in (0..n).step_by(BLOCK) {
            let end = n.min(first + BLOCK);
            let (done, rows) = right.split_at_mut(first * width);
            for i in (first..end).step_by(ROWS) {
                for j in (0..width).step_by(COLUMNS) {
                    // Of the first rows nothing is known yet.
                    let sums = tile(&factor[i..], from(done, j), [n, width], first);
                    take_off(&mut rows[(i - first) * width + j..], width, &sums);
                }
            }
            for i in first..end {
                let (above, own) = rows.split_at_mut((i - first) * width);
                let own = &mut own[..width];
                for (k, above) in (first..i).zip(above.chunks_exact(width)) {
                    add_multiple(own, -factor[k * n + i], above);
                }
                for value in own {
                    *value /= factor[i * n + i];
                }
            }
        }
        // Back, from the last row to the first: each takes what it makes off those above it.
        for i in (0..n).rev() {
            let (above, own) = right.split_at_mut(i * width);
            let own = &mut own[..width];
            for value in own.iter_mut() {
                *value /= factor[i * n + i];
            }
            for (k, above) in above.chunks_exact_mut(width).enumerate() {
                add_multiple(above, -factor[k * n + i], own);
            }
        }
        self.right
    }
}
