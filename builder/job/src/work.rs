//! Results of stages that last: a folder of entries that are named by what they were made from.
//!
//! An entry's name is a hash of the stage, its version, its options and its input ([`Key`]); so nothing is ever out of date,
//! only unused. Entries are written beside their place and renamed, and checked when they are read: one that is damaged is as
//! good as missing. Two programs may use the folder at once, for what they write under one name is the same.
//!
//! [`WorkFolder::get`] and [`WorkFolder::put`] keep a result as a whole; [`Rows`](crate::rows::Rows) are a table that is
//! filled row by row.

use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// What every entry begins with; the number is the format's.
const MAGIC: &[u8; 8] = b"RPRWORK1";
/// Endings of the files of an entry.
const WHOLE: &str = "whole";
pub(crate) const ROWS: &str = "rows";
pub(crate) const JOURNAL: &str = "journal";

/// What a result was made from.
#[derive(Clone, Debug)]
pub struct Key {
    stage: &'static str,
    hasher: blake3::Hasher,
}

impl Key {
    /// The key of a stage's result. `version` changes whenever the stage computes something else from the same input.
    #[must_use]
    pub fn new(stage: &'static str, version: u32) -> Self {
        let mut hasher = blake3::Hasher::new();
        hasher.update(stage.as_bytes()).update(&version.to_le_bytes());
        Self { stage, hasher }
    }

    /// The same, made from `bytes` too.
    #[must_use]
    pub fn of(mut self, bytes: &[u8]) -> Self {
        // With the length, so that parts cannot be mistaken for each other.
        self.hasher.update(&(bytes.len() as u64).to_le_bytes()).update(bytes);
        self
    }

    /// The same, made from what `value` prints too: options and other small things.
    #[must_use]
    pub fn told(self, value: &impl std::fmt::Debug) -> Self {
        self.of(format!("{value:?}").as_bytes())
    }

    /// The same input for another result.
    #[must_use]
    pub fn part(&self, name: &'static str, number: u64) -> Self {
        self.clone().of(name.as_bytes()).of(&number.to_le_bytes())
    }

    /// The stage.
    #[must_use]
    pub fn stage(&self) -> &'static str {
        self.stage
    }

    /// The hash, as a hexadecimal number.
    #[must_use]
    pub fn hash(&self) -> String {
        self.hasher.finalize().to_hex()[..40].to_owned()
    }
}

/// An entry of a work folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// The stage that it is a result of.
    pub stage: String,
    /// The hash of what it was made from.
    pub hash: String,
    /// Bytes of its files.
    pub bytes: u64,
    /// When it was last written or read.
    pub used: SystemTime,
    files: Vec<PathBuf>,
}

/// A folder that results of stages are kept in.
#[derive(Clone, Debug)]
pub struct WorkFolder {
    root: PathBuf,
}

impl WorkFolder {
    /// The work folder at `root`, which is made where it does not exist.
    ///
    /// # Errors
    /// What the file system says.
    pub fn open(root: &Path) -> io::Result<Self> {
        fs::create_dir_all(root)?;
        Ok(Self { root: root.to_owned() })
    }

    /// Where it is.
    #[must_use]
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// The result of `key`, if it is there and undamaged.
    #[must_use]
    pub fn get(&self, key: &Key) -> Option<Vec<u8>> {
        let path = self.path(key, WHOLE);
        let mut file = File::open(&path).ok()?;
        let mut head = [0; MAGIC.len() + 32];
        file.read_exact(&mut head).ok()?;
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).ok()?;
        let holds = head[..MAGIC.len()] == *MAGIC && head[MAGIC.len()..] == *blake3::hash(&bytes).as_bytes();
        // A time that cannot be set only makes the entry look older than it is.
        let _ = file.set_modified(SystemTime::now());
        holds.then_some(bytes)
    }

    /// Keeps the result of `key`.
    ///
    /// # Errors
    /// What the file system says; nothing is half-written.
    pub fn put(&self, key: &Key, bytes: &[u8]) -> io::Result<()> {
        let path = self.path(key, WHOLE);
        let folder = path.parent().unwrap_or(&self.root);
        fs::create_dir_all(folder)?;
        let mut file = tempfile::Builder::new().prefix(".partial-").tempfile_in(folder)?;
        file.write_all(MAGIC)?;
        file.write_all(blake3::hash(bytes).as_bytes())?;
        file.write_all(bytes)?;
        file.as_file().sync_all()?;
        file.persist(&path).map_err(|error| error.error)?;
        Ok(())
    }

    /// All entries, by stage and hash.
    ///
    /// # Errors
    /// What the file system says.
    pub fn entries(&self) -> io::Result<Vec<Entry>> {
        let mut entries: Vec<Entry> = Vec::new();
        for stage in sorted(&self.root)?.into_iter().filter(|path| path.is_dir()) {
            for path in sorted(&stage)? {
                let ending = path.extension().and_then(|ending| ending.to_str());
                if !matches!(ending, Some(WHOLE | ROWS | JOURNAL)) {
                    continue;
                }
                let Ok(about) = fs::metadata(&path) else { continue };
                let name = |path: Option<&std::ffi::OsStr>| path.unwrap_or_default().to_string_lossy().into_owned();
                let (stage, hash) = (name(stage.file_name()), name(path.file_stem()));
                let used = about.modified().unwrap_or(SystemTime::UNIX_EPOCH);
                match entries.last_mut().filter(|last| last.stage == stage && last.hash == hash) {
                    Some(last) => {
                        last.bytes += about.len();
                        last.used = last.used.max(used);
                        last.files.push(path);
                    }
                    None => entries.push(Entry { stage, hash, bytes: about.len(), used, files: vec![path] }),
                }
            }
        }
        Ok(entries)
    }

    /// Deletes entries; other files in the folder are left alone.
    ///
    /// # Errors
    /// What the file system says; one that is gone already is no error.
    pub fn remove(&self, entry: &Entry) -> io::Result<()> {
        for file in &entry.files {
            match fs::remove_file(file) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
                _ => {}
            }
        }
        if let Some(folder) = entry.files.first().and_then(|file| file.parent()) {
            // It stays where something else is in it.
            let _ = fs::remove_dir(folder);
        }
        Ok(())
    }

    /// Where a file of an entry is.
    pub(crate) fn path(&self, key: &Key, ending: &str) -> PathBuf {
        self.root.join(key.stage()).join(format!("{}.{ending}", key.hash()))
    }
}

fn sorted(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut paths: Vec<PathBuf> =
        fs::read_dir(folder)?.map(|entry| entry.map(|entry| entry.path())).collect::<Result<_, _>>()?;
    paths.sort();
    Ok(paths)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder() -> (tempfile::TempDir, WorkFolder) {
        let temporary = tempfile::tempdir().unwrap();
        let work = WorkFolder::open(&temporary.path().join("work")).unwrap();
        (temporary, work)
    }

    #[test]
    fn what_is_kept_is_found_again_and_nothing_else() {
        let (_temporary, work) = folder();
        let key = Key::new("distances", 1).of(b"poses").told(&0.01);
        assert_eq!(work.get(&key), None);
        work.put(&key, b"result").unwrap();
        assert_eq!(work.get(&key).as_deref(), Some(&b"result"[..]));
        for other in [
            Key::new("distances", 2).of(b"poses").told(&0.01),
            Key::new("distances", 1).of(b"pose").of(b"s").told(&0.01),
            Key::new("distances", 1).of(b"poses").told(&0.02),
            key.part("band", 0),
        ] {
            assert_eq!(work.get(&other), None);
        }
    }

    #[test]
    fn damage_is_as_good_as_missing() {
        let (_temporary, work) = folder();
        let key = Key::new("distances", 1);
        work.put(&key, b"result").unwrap();
        let path = work.path(&key, WHOLE);
        let whole = fs::read(&path).unwrap();
        for length in 0..whole.len() {
            fs::write(&path, &whole[..length]).unwrap();
            assert_eq!(work.get(&key), None, "cut to {length} bytes");
        }
        for place in 0..whole.len() {
            let mut damaged = whole.clone();
            damaged[place] ^= 1;
            fs::write(&path, damaged).unwrap();
            assert_eq!(work.get(&key), None, "byte {place}");
        }
        work.put(&key, b"result").unwrap();
        assert!(work.get(&key).is_some());
    }

    #[test]
    fn entries_are_listed_and_removed_and_strangers_stay() {
        let (_temporary, work) = folder();
        work.put(&Key::new("distances", 1), b"result").unwrap();
        work.put(&Key::new("transitions", 1), b"result").unwrap();
        let stranger = work.root().join("transitions/notes.txt");
        fs::write(&stranger, "mine").unwrap();
        let entries = work.entries().unwrap();
        assert_eq!(entries.iter().map(|entry| entry.stage.as_str()).collect::<Vec<_>>(), ["distances", "transitions"]);
        assert!(entries.iter().all(|entry| entry.bytes == 46));
        entries.iter().for_each(|entry| work.remove(entry).unwrap());
        entries.iter().for_each(|entry| work.remove(entry).unwrap());
        assert!(work.entries().unwrap().is_empty() && stranger.exists() && !work.root().join("distances").exists());
    }
}
