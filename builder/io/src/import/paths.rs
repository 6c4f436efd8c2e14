//! Parts of the paths of files.

use std::path::Path;

/// The file name without its ending.
pub(super) fn stem(path: &Path) -> String {
    path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_else(|| "capture".to_owned())
}

/// The ending in lower case.
pub(super) fn ending(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}

/// The folder that holds a file, also where its path has none.
pub(super) fn folder_of(path: &Path) -> &Path {
    let folder = path.parent().unwrap_or(Path::new(""));
    if folder.as_os_str().is_empty() { Path::new(".") } else { folder }
}

/// The name of a folder, also of the one that is worked in; empty at the root.
pub(super) fn name_of_folder(folder: &Path) -> String {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    match folder.file_name() {
        Some(name) => name.to_string_lossy().into_owned(),
        None => {
            let whole = folder.canonicalize().unwrap_or_default();
            whole.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
        }
    }
}
