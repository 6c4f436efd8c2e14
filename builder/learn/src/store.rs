//! Many long rows of numbers on disk, read back a stripe of columns at a time.
//!
//! A row is what one frame gives (a texture, a warp), a stripe the same columns of all rows. Whatever an analysis over
//! frames needs, it gets from one stripe at a time: memory stays flat however many frames there are. Numbers are kept in
//! 16 bits of a fixed range.

use std::io;
use std::path::PathBuf;

use job::rows::Rows;
use job::work::{Key, WorkFolder};
use thiserror::Error;

/// Columns of a stripe.
pub const STRIPE: usize = 8192;

/// The file that holds the rows failed.
#[derive(Debug, Error)]
#[error("cannot use a scratch file in {folder}: {source}. Make room, or set TMPDIR to another folder")]
pub struct ScratchError {
    /// The folder of temporary files.
    pub folder: PathBuf,
    /// What the operating system says.
    pub source: io::Error,
}

/// Rows of numbers in a scratch file, or in a work folder.
#[derive(Debug)]
pub struct Store {
    file: Rows,
    columns: usize,
    range: f32,
}

impl Store {
    /// Room for `rows` of `columns` numbers, each from `-range` to `range`, in a scratch file that vanishes with this.
    ///
    /// # Errors
    /// Where no scratch file can be made.
    pub fn new(rows: usize, columns: usize, range: f32) -> Result<Self, ScratchError> {
        Self::kept(None, rows, columns, range)
    }

    /// The same with the rows that `work` holds for a key, and kept there; a scratch file where there is no work folder.
    ///
    /// # Errors
    /// Where the file cannot be made or read.
    pub fn kept(
        work: Option<(&WorkFolder, &Key)>,
        rows: usize,
        columns: usize,
        range: f32,
    ) -> Result<Self, ScratchError> {
        let file = Rows::open(work, rows, 2 * columns, 2 * STRIPE).map_err(scratch)?;
        Ok(Self { file, columns, range })
    }

    /// Whether a row was written.
    #[must_use]
    pub fn has(&self, row: usize) -> bool {
        self.file.has(row)
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.file.rows()
    }

    /// Number of columns.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// The largest number that it holds.
    #[must_use]
    pub fn range(&self) -> f32 {
        self.range
    }

    /// Number of stripes; the last may be narrower.
    #[must_use]
    pub fn stripes(&self) -> usize {
        self.columns.div_ceil(STRIPE)
    }

    /// Writes a row; numbers out of range are clamped.
    ///
    /// # Errors
    /// Where the file cannot be written, for example because the disk is full.
    pub fn write(&self, row: usize, values: &[f32]) -> Result<(), ScratchError> {
        let scale = f32::from(i16::MAX) / self.range;
        let numbers: Vec<i16> = values.iter().map(|value| (value * scale).round() as i16).collect();
        self.file.write(row, bytemuck::cast_slice(&numbers)).map_err(scratch)
    }

    /// The columns of a stripe, row after row.
    ///
    /// # Errors
    /// Where the file cannot be read.
    pub fn stripe(&self, stripe: usize) -> Result<Vec<f32>, ScratchError> {
        let mut numbers = vec![0_i16; self.rows() * self.width(stripe)];
        self.file.read_stripe(stripe, bytemuck::cast_slice_mut(&mut numbers)).map_err(scratch)?;
        let scale = self.range / f32::from(i16::MAX);
        Ok(numbers.into_iter().map(|number| f32::from(number) * scale).collect())
    }

    /// One row.
    ///
    /// # Errors
    /// Where the file cannot be read.
    pub fn row(&self, row: usize) -> Result<Vec<f32>, ScratchError> {
        let mut numbers = vec![0_i16; self.columns];
        self.file.read(row, bytemuck::cast_slice_mut(&mut numbers)).map_err(scratch)?;
        let scale = self.range / f32::from(i16::MAX);
        Ok(numbers.into_iter().map(|number| f32::from(number) * scale).collect())
    }

    /// Number of columns of a stripe.
    #[must_use]
    pub fn width(&self, stripe: usize) -> usize {
        STRIPE.min(self.columns - stripe * STRIPE)
    }
}

fn scratch(source: io::Error) -> ScratchError {
    ScratchError { folder: std::env::temp_dir(), source }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_and_stripes_are_the_same_numbers() {
        let columns = STRIPE + 77;
        let store = Store::new(3, columns, 2.0).unwrap();
        let value = |row: usize, column: usize| ((row * 31 + column * 7) % 400) as f32 / 100.0 - 2.0;
        for row in [2, 0, 1] {
            store.write(row, &(0..columns).map(|column| value(row, column)).collect::<Vec<_>>()).unwrap();
        }
        for stripe in 0..store.stripes() {
            let width = store.width(stripe);
            for (k, got) in store.stripe(stripe).unwrap().into_iter().enumerate() {
                assert!((got - value(k / width, stripe * STRIPE + k % width)).abs() < 1e-4);
            }
        }
        for (column, got) in store.row(1).unwrap().into_iter().enumerate() {
            assert!((got - value(1, column)).abs() < 1e-4);
        }
    }
}
