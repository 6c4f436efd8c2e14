//! A bundle that was made: its bytes, and what lies behind them on the disk because it is too much for the memory.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
#[cfg(feature = "scans")]
use std::path::Path;

/// A bundle: what was made of it in memory, and the groups of scanned frames, which come last.
pub struct Packed {
    pub(crate) bytes: Vec<u8>,
    pub(crate) rest: Option<Spool>,
}

impl Packed {
    /// Writes all of it.
    ///
    /// # Errors
    /// What the file system says.
    pub fn write(&mut self, to: &mut impl Write) -> io::Result<()> {
        to.write_all(&self.bytes)?;
        if let Some(rest) = &mut self.rest {
            io::copy(&mut rest.read()?, to)?;
        }
        Ok(())
    }

    /// All of it in memory.
    pub(crate) fn whole(mut self) -> io::Result<Vec<u8>> {
        if let Some(mut rest) = self.rest.take() {
            rest.read()?.read_to_end(&mut self.bytes)?;
        }
        Ok(self.bytes)
    }
}

/// Bytes that wait on the disk, in a file without a name: it is gone with the process, however that ends.
pub(crate) struct Spool {
    file: File,
    length: u64,
}

impl Spool {
    /// An empty one in `folder`.
    #[cfg(feature = "scans")]
    pub fn new(folder: &Path) -> io::Result<Self> {
        Ok(Self { file: tempfile::tempfile_in(folder)?, length: 0 })
    }

    /// Takes `bytes` behind those that it has.
    #[cfg(feature = "scans")]
    pub fn push(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.length += bytes.len() as u64;
        self.file.write_all(bytes)
    }

    /// What it has, from the beginning.
    fn read(&mut self) -> io::Result<impl Read> {
        self.file.seek(SeekFrom::Start(0))?;
        Ok((&mut self.file).take(self.length))
    }
}

#[cfg(all(test, feature = "scans"))]
mod tests {
    use super::*;

    #[test]
    fn what_waits_comes_last_whenever_it_is_asked_for() {
        let folder = tempfile::tempdir().unwrap();
        let mut spool = Spool::new(folder.path()).unwrap();
        spool.push(b"and ").unwrap();
        spool.push(b"later").unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
        let mut packed = Packed { bytes: b"first ".to_vec(), rest: Some(spool) };
        for _ in 0..2 {
            let mut written = Vec::new();
            packed.write(&mut written).unwrap();
            assert_eq!(written, b"first and later");
        }
        assert_eq!(packed.whole().unwrap(), b"first and later");
    }
}
