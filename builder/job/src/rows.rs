//! A table of rows on disk that is filled row by row, and survives being killed.
//!
//! Rows may be cut into stripes of columns that lie together, for work that reads the same columns of all rows. A journal
//! beside the table tells which rows are there, each with its checksum: a row is believed only if it still has it.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::sync::Mutex;

use crate::work::{JOURNAL, Key, ROWS, WorkFolder};

/// Bytes of a journal's record: a row's number and its checksum.
const RECORD: usize = 4 + 8;

/// A table of rows of bytes, of which each is there in full or not at all.
#[derive(Debug)]
pub struct Rows {
    file: Mutex<File>,
    journal: Option<Mutex<File>>,
    has: Mutex<Vec<bool>>,
    rows: usize,
    row_bytes: usize,
    stripe_bytes: usize,
}

impl Rows {
    /// An empty table of `rows` rows of `row_bytes` bytes, in stripes of `stripe_bytes`; it vanishes with this.
    ///
    /// # Errors
    /// Where no scratch file can be made.
    pub fn scratch(rows: usize, row_bytes: usize, stripe_bytes: usize) -> io::Result<Self> {
        let (file, has) = (Mutex::new(tempfile::tempfile()?), Mutex::new(vec![false; rows]));
        Ok(Self { file, journal: None, has, rows, row_bytes, stripe_bytes: stripe_bytes.max(1) })
    }

    /// The table of `key` in `work` with the rows that it holds, or an empty one; without a work folder as
    /// [`Self::scratch`].
    ///
    /// # Errors
    /// What the file system says.
    pub fn open(
        work: Option<(&WorkFolder, &Key)>,
        rows: usize,
        row_bytes: usize,
        stripe_bytes: usize,
    ) -> io::Result<Self> {
        let Some((work, key)) = work else { return Self::scratch(rows, row_bytes, stripe_bytes) };
        let path = work.path(key, ROWS);
        fs::create_dir_all(path.parent().unwrap_or(work.root()))?;
        let file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path)?;
        let mut journal = OpenOptions::new().read(true).append(true).create(true).open(work.path(key, JOURNAL))?;
        let mut records = Vec::new();
        journal.read_to_end(&mut records)?;
        if records.len() % RECORD != 0 {
            // The last record was being written when the program was killed: what comes next must not follow half of it.
            journal.set_len((records.len() / RECORD * RECORD) as u64)?;
        }
        let has = Mutex::new(vec![false; rows]);
        let table =
            Self { file: Mutex::new(file), journal: None, has, rows, row_bytes, stripe_bytes: stripe_bytes.max(1) };
        table.believe(&records);
        Ok(Self { journal: Some(Mutex::new(journal)), ..table })
    }

    /// Marks the rows of a journal that still have their checksum.
    fn believe(&self, records: &[u8]) {
        let mut row_bytes = vec![0; self.row_bytes];
        for record in records.chunks_exact(RECORD) {
            let (row, sum) = record.split_at(4);
            let row = row.try_into().map_or(usize::MAX, |row| u32::from_le_bytes(row) as usize);
            if row < self.rows && self.read(row, &mut row_bytes).is_ok() && checksum(&row_bytes) == sum {
                locked(&self.has)[row] = true;
            }
        }
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Whether a row is there.
    #[must_use]
    pub fn has(&self, row: usize) -> bool {
        locked(&self.has)[row]
    }

    /// Writes a row, which must have the table's length.
    ///
    /// # Errors
    /// What the file system says; the row is then missing.
    pub fn write(&self, row: usize, bytes: &[u8]) -> io::Result<()> {
        {
            let mut file = locked(&self.file);
            for (stripe, bytes) in bytes.chunks(self.stripe_bytes).enumerate() {
                file.seek(SeekFrom::Start(self.offset(stripe, row)))?;
                file.write_all(bytes)?;
            }
        }
        if let Some(journal) = &self.journal {
            let mut record = (row as u32).to_le_bytes().to_vec();
            record.extend(checksum(bytes));
            locked(journal).write_all(&record)?;
        }
        locked(&self.has)[row] = true;
        Ok(())
    }

    /// Reads a row.
    ///
    /// # Errors
    /// What the file system says, or a row that was never written.
    pub fn read(&self, row: usize, bytes: &mut [u8]) -> io::Result<()> {
        let mut file = locked(&self.file);
        for (stripe, bytes) in bytes.chunks_mut(self.stripe_bytes).enumerate() {
            file.seek(SeekFrom::Start(self.offset(stripe, row)))?;
            file.read_exact(bytes)?;
        }
        Ok(())
    }

    /// Reads a stripe of all rows, row after row.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn read_stripe(&self, stripe: usize, bytes: &mut [u8]) -> io::Result<()> {
        let mut file = locked(&self.file);
        file.seek(SeekFrom::Start(self.offset(stripe, 0)))?;
        file.read_exact(bytes)
    }

    fn offset(&self, stripe: usize, row: usize) -> u64 {
        let width = self.stripe_bytes.min(self.row_bytes - stripe * self.stripe_bytes);
        (stripe * self.stripe_bytes * self.rows + row * width) as u64
    }
}

fn checksum(bytes: &[u8]) -> [u8; 8] {
    let mut sum = [0; 8];
    sum.copy_from_slice(&blake3::hash(bytes).as_bytes()[..8]);
    sum
}

fn locked<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(number: usize, length: usize) -> Vec<u8> {
        (0..length).map(|k| (k * 7 + number * 13) as u8).collect()
    }

    #[test]
    fn rows_survive_a_kill_at_any_byte() {
        const LENGTH: usize = 23;
        let temporary = tempfile::tempdir().unwrap();
        let work = WorkFolder::open(temporary.path()).unwrap();
        let key = Key::new("rows", 1);
        {
            let rows = Rows::open(Some((&work, &key)), 4, LENGTH, 10).unwrap();
            for number in [2, 0] {
                rows.write(number, &row(number, LENGTH)).unwrap();
            }
        }
        let journal = fs::read(work.path(&key, JOURNAL)).unwrap();
        for length in 0..=journal.len() {
            fs::write(work.path(&key, JOURNAL), &journal[..length]).unwrap();
            let rows = Rows::open(Some((&work, &key)), 4, LENGTH, 10).unwrap();
            let has: Vec<usize> = (0..4).filter(|&number| rows.has(number)).collect();
            assert_eq!(has.len(), length / RECORD);
            rows.write(1, &row(1, LENGTH)).unwrap();
            let again = Rows::open(Some((&work, &key)), 4, LENGTH, 10).unwrap();
            assert!(again.has(1) && has.iter().all(|&number| again.has(number)));
            let mut bytes = vec![0; LENGTH];
            for number in has {
                again.read(number, &mut bytes).unwrap();
                assert_eq!(bytes, row(number, LENGTH));
            }
        }
        // A row that was written over by something else is missing.
        let damaged = vec![0; fs::read(work.path(&key, ROWS)).unwrap().len()];
        fs::write(work.path(&key, ROWS), damaged).unwrap();
        let rows = Rows::open(Some((&work, &key)), 4, LENGTH, 10).unwrap();
        assert!((0..4).all(|number| !rows.has(number)));
    }

    #[test]
    fn stripes_hold_the_same_columns_of_all_rows() {
        let rows = Rows::scratch(3, 25, 10).unwrap();
        (0..3).for_each(|number| rows.write(number, &row(number, 25)).unwrap());
        let mut stripe = vec![0; 3 * 5];
        rows.read_stripe(2, &mut stripe).unwrap();
        for number in 0..3 {
            assert_eq!(stripe[5 * number..5 * number + 5], row(number, 25)[20..]);
        }
    }
}
