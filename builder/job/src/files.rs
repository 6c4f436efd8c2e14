//! Files that are there in full or not at all.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;

/// Writes `bytes` beside `path`, then renames: `path` is never half-written.
///
/// # Errors
/// What the file system says; a file that was at `path` is still there then.
pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    replace(path, |file| file.write_all(bytes))
}

/// Like [`write_whole`], and waits until the bytes are on the disc: for what took long to make.
///
/// # Errors
/// See [`write_whole`].
pub fn write_for_good(path: &Path, bytes: &[u8]) -> io::Result<()> {
    replace(path, |file| file.write_all(bytes).and_then(|()| file.sync_all()))
}

/// As [`write_for_good`], of what `write` writes.
///
/// # Errors
/// What the file system says, or `write`; a file that was at `path` is still there then.
pub fn write_for_good_by(path: &Path, write: impl FnOnce(&mut File) -> io::Result<()>) -> io::Result<()> {
    replace(path, |file| write(file).and_then(|()| file.sync_all()))
}

fn replace(path: &Path, write: impl FnOnce(&mut File) -> io::Result<()>) -> io::Result<()> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut beside = tempfile::Builder::new();
    beside.prefix(".partial-");
    // As any file that is made, not for this user's eyes alone.
    #[cfg(unix)]
    beside.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut temporary = beside.tempfile_in(folder)?;
    write(temporary.as_file_mut())?;
    temporary.persist(path).map_err(|error| error.error)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn a_file_is_replaced_or_stays_and_nothing_is_left_over() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("walk.glb");
        write_whole(&path, b"first").unwrap();
        write_for_good(&path, b"second").unwrap();
        let torn = replace(&path, |file| file.write_all(b"thi").and_then(|()| Err(io::Error::other("torn"))));
        assert_eq!(torn.unwrap_err().to_string(), "torn");
        assert_eq!(fs::read(&path).unwrap(), b"second");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        assert!(write_whole(&folder.path().join("missing/walk.glb"), b"").is_err());
    }
}
