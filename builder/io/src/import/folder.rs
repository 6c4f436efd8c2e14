//! What lies in a folder.

use std::fs;
use std::path::{Path, PathBuf};

use super::error::ImportError;
use super::numbered::natural;

/// The entries of a folder that are not hidden, by name.
pub(super) fn list(folder: &Path) -> Result<Vec<PathBuf>, ImportError> {
    let fail = |source| ImportError::Io { path: folder.to_owned(), source };
    let entries = fs::read_dir(folder).map_err(fail)?;
    let mut paths = entries.map(|e| e.map(|e| e.path()).map_err(fail)).collect::<Result<Vec<_>, _>>()?;
    // Hidden files are no frames: macOS leaves "._" twins behind.
    paths.retain(|path| path.file_name().is_none_or(|name| !name.to_string_lossy().starts_with('.')));
    paths.sort_by(|a, b| natural(&a.to_string_lossy(), &b.to_string_lossy()));
    Ok(paths)
}
