//! Files that other files name: where they are said to be, or beside the file that names them.
//!
//! Captures move between machines, so that paths in them are often those of another one.

use super::folder::list;
use std::path::{Path, PathBuf};

/// A file that was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct FoundFile {
    pub path: PathBuf,
    /// Whether it lies elsewhere, or is spelt otherwise, than was written.
    pub moved: bool,
}

/// The file that `name` means, as a file in `folder` writes it; `None` where there is none.
///
/// Tried are, in this order: the path as it is written; the same with `\` for `/`; the file of that name in `folder`,
/// which takes the place of a path on another machine; the file that differs from that name in small and capital letters
/// only; and all these again without a `#` comment behind the name.
pub(super) fn find(folder: &Path, name: &str) -> Option<FoundFile> {
    // Names with many of them are no names.
    let commented =
        name.match_indices('#').take(4).map(|(at, _)| name[..at].trim_end()).filter(|name| !name.is_empty());
    std::iter::once(name).chain(commented).find_map(|name| find_one(folder, name))
}

fn find_one(folder: &Path, name: &str) -> Option<FoundFile> {
    let slashes = name.replace('\\', "/");
    for written in [name, slashes.as_str()] {
        let path = folder.join(written);
        if path.is_file() {
            return Some(FoundFile { path, moved: false });
        }
    }
    let alone = slashes.rsplit('/').next().filter(|alone| !alone.is_empty() && *alone != "..")?;
    let path = folder.join(alone);
    if path.is_file() {
        return Some(FoundFile { path, moved: true });
    }
    let files = list(if folder.as_os_str().is_empty() { Path::new(".") } else { folder }).ok()?;
    let same =
        |path: &Path| path.file_name().is_some_and(|n| n.to_string_lossy().to_lowercase() == alone.to_lowercase());
    let path = files.into_iter().find(|path| same(path) && path.is_file())?;
    Some(FoundFile { path, moved: true })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_found_as_written_or_beside() {
        let folder = tempfile::tempdir().unwrap();
        let f = folder.path();
        std::fs::create_dir(f.join("t")).unwrap();
        for name in ["skin.png", "t/face.png", "Map #3.png"] {
            std::fs::write(f.join(name), "").unwrap();
        }
        for (name, path, moved) in [
            ("skin.png", "skin.png", false),
            ("t\\face.png", "t/face.png", false),
            ("C:\\Users\\a b\\skin.png", "skin.png", true),
            ("\\\\server\\x\\skin.png", "skin.png", true),
            ("/home/other/skin.png", "skin.png", true),
            ("SKIN.PNG", "skin.png", true),
            ("Map #3.png", "Map #3.png", false),
            ("skin.png # from D:\\t\\", "skin.png", false),
        ] {
            assert_eq!(find(f, name), Some(FoundFile { path: f.join(path), moved }), "{name}");
        }
        for name in ["face.png", "", "..", "t\\", "#", "x#skin"] {
            assert_eq!(find(f, name), None, "{name}");
        }
    }
}
