//! Files that exist as long as somebody needs them.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::error::ImportError;

/// A folder of textures that were written out of the files that held them; it vanishes with the last copy of this.
#[derive(Clone, Debug)]
pub struct Scratch {
    folder: Arc<tempfile::TempDir>,
}

impl Scratch {
    /// An empty folder among the system's temporary files.
    pub(super) fn new() -> Result<Self, ImportError> {
        let folder = tempfile::tempdir().map_err(|source| ImportError::Io { path: std::env::temp_dir(), source })?;
        Ok(Self { folder: Arc::new(folder) })
    }

    /// Writes a file.
    pub(super) fn write(&self, name: &str, bytes: &[u8]) -> Result<PathBuf, ImportError> {
        let path = self.path().join(name);
        fs::write(&path, bytes).map_err(|source| ImportError::Io { path: path.clone(), source })?;
        Ok(path)
    }

    fn path(&self) -> &Path {
        self.folder.path()
    }
}

impl PartialEq for Scratch {
    /// What it holds is compared elsewhere; where it lies says nothing.
    fn eq(&self, _: &Self) -> bool {
        true
    }
}
