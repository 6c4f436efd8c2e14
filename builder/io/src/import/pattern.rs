//! Frame patterns: `frame_%05d.obj:START:END:STEP`.
//!
//! `%d` stands for the frame's number, `%05d` for the number with zeros to five digits; exactly one of them must appear.
//! After the name may follow `:START:END` or `:START:END:STEP`; END belongs to the range, STEP is 1 where left out.
//! With a range every file of it must exist. Without one, the files of the folder that fit are taken, by number. Numbers
//! may be negative; whether the minus counts as one of the five digits is as the files have it.

use std::fs;
use std::path::{Path, PathBuf};

use actor::timeline::Timeline;

use super::error::ImportError;

/// A file name with a place for a number.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Pattern {
    text: String,
    before: String,
    width: usize,
    after: String,
    range: Option<Range>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Range {
    start: i64,
    end: i64,
    step: i64,
}

impl Pattern {
    /// Whether `input` is meant as a pattern.
    pub fn looks_like(input: &str) -> bool {
        conversion(input).is_some()
    }

    /// Reads `input` as a pattern.
    pub fn parse(input: &str) -> Result<Self, ImportError> {
        let wrong = |reason: &str| ImportError::Pattern { pattern: input.to_owned(), reason: reason.to_owned() };
        let (start, end) = conversion(input).ok_or_else(|| wrong("a pattern needs %d or %05d"))?;
        let before = &input[..start];
        let (after, range) = split_range(&input[end..]).map_err(|reason| wrong(&reason))?;
        if conversion(after).is_some() {
            return Err(wrong("a pattern has one %d only"));
        }
        let width = &input[start + 1..end - 1];
        let width = if width.is_empty() { Ok(0) } else { width.parse() };
        let width: usize = width.ok().filter(|&w| w <= 18).ok_or_else(|| wrong("at most %018d"))?;
        if range.is_none() && after.contains(['/', std::path::MAIN_SEPARATOR]) {
            return Err(wrong("a pattern whose number is in a folder's name needs :START:END"));
        }
        Ok(Self { text: input.to_owned(), before: before.to_owned(), width, after: after.to_owned(), range })
    }

    /// Whether the pattern says which numbers it means.
    pub fn has_range(&self) -> bool {
        self.range.is_some()
    }

    /// The existing files that the pattern means, in the order of their numbers, seen from `base`.
    pub fn files(&self, base: &Path) -> Result<Vec<PathBuf>, ImportError> {
        match self.range {
            Some(range) => self.range_files(base, range),
            None => self.folder_files(base),
        }
    }

    /// The names that the pattern may write for a number: a minus is a digit more, or counts as one.
    fn names(&self, number: i64) -> [String; 2] {
        let (width, digits) = (self.width, number.unsigned_abs());
        let sign = if number < 0 { "-" } else { "" };
        [format!("{sign}{digits:0width$}"), format!("{number:0width$}")]
            .map(|number| format!("{}{number}{}", self.before, self.after))
    }

    fn range_files(&self, base: &Path, range: Range) -> Result<Vec<PathBuf>, ImportError> {
        (range.start..=range.end)
            .step_by(usize::try_from(range.step).unwrap_or(usize::MAX))
            .map(|number| {
                let [path, other] = self.names(number).map(|name| base.join(name));
                let found = [&path, &other].into_iter().find(|path| path.is_file()).cloned();
                found.ok_or(ImportError::MissingFrame { path, number })
            })
            .collect()
    }

    fn folder_files(&self, base: &Path) -> Result<Vec<PathBuf>, ImportError> {
        let [sample, _] = self.names(0).map(|name| base.join(name));
        let folder = match sample.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
            _ => PathBuf::from("."),
        };
        let stem = self.before.rsplit(['/', std::path::MAIN_SEPARATOR]).next().unwrap_or_default();
        let entries = fs::read_dir(&folder).map_err(|source| ImportError::Io { path: folder.clone(), source })?;
        let mut found = Vec::new();
        for entry in entries {
            let entry = entry.map_err(|source| ImportError::Io { path: folder.clone(), source })?;
            let name = entry.file_name();
            let digits =
                name.to_str().and_then(|n| n.strip_prefix(stem)).and_then(|n| n.strip_suffix(self.after.as_str()));
            // No plus, and nothing else that a number may be written with.
            let plain = |d: &&str| d.strip_prefix('-').unwrap_or(d).bytes().all(|c| c.is_ascii_digit());
            let number = digits.filter(plain).and_then(|d| d.parse::<i64>().ok());
            // Only names that the pattern itself would write: frame_7 is not meant by frame_%05d.
            if let (Some(number), Some(name)) = (number, name.to_str())
                && self.names(number).iter().any(|own| own.ends_with(name))
            {
                found.push((number, folder.join(name)));
            }
        }
        if found.is_empty() {
            return Err(ImportError::NoMatch {
                pattern: base.join(&self.text).to_string_lossy().into_owned(),
                hint: String::new(),
            });
        }
        found.sort();
        Ok(found.into_iter().map(|(_, path)| path).collect())
    }
}

/// Where the first `%d` or `%05d` of `text` begins and ends.
fn conversion(text: &str) -> Option<(usize, usize)> {
    text.match_indices('%').find_map(|(start, _)| {
        let digits = text[start + 1..].bytes().take_while(u8::is_ascii_digit).count();
        let end = start + 1 + digits;
        text[end..].starts_with('d').then_some((start, end + 1))
    })
}

/// Takes `:START:END` or `:START:END:STEP` off what follows the number.
fn split_range(after: &str) -> Result<(&str, Option<Range>), String> {
    let Some((name, range)) = after.split_once(':') else { return Ok((after, None)) };
    let numbers: Vec<i64> = range
        .split(':')
        .map(|n| n.parse().map_err(|_| format!("\"{n}\" is not a number; a range is :START:END or :START:END:STEP")))
        .collect::<Result<_, _>>()?;
    let range = match numbers[..] {
        [start, end] => Range { start, end, step: 1 },
        [start, end, step] => Range { start, end, step },
        _ => return Err("a range is :START:END or :START:END:STEP".into()),
    };
    if range.step <= 0 || range.end < range.start {
        return Err("a range needs START at or before END, and STEP at least 1".into());
    }
    let span = i128::from(range.end) - i128::from(range.start);
    if span / i128::from(range.step) >= i128::from(Timeline::MAX_FRAMES) {
        return Err(format!("a range holds at most {} frames", Timeline::MAX_FRAMES));
    }
    Ok((name, Some(range)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tells_patterns_from_names() {
        assert!(Pattern::looks_like("frame_%05d.obj"));
        assert!(Pattern::looks_like("100%/f%d.ply"));
        assert!(!Pattern::looks_like("100%.obj"));
        assert!(!Pattern::looks_like("frame.obj"));
        assert_eq!(Pattern::parse("C:/100%/f%03d.ply:1:2").unwrap().names(7)[0], "C:/100%/f007.ply");
    }

    #[test]
    fn refuses_what_is_no_pattern() {
        for bad in
            ["f%05x", "f%d%d", "f%d:1", "f%d:5:4", "f%d:1:2:0", "f%d:a:2", "d%d/f.obj", "f%099d", "f%d:0:9999999"]
        {
            let error = Pattern::parse(bad).unwrap_err();
            assert_eq!(error.code(), "E_PATTERN", "{bad}");
        }
    }

    #[test]
    fn ranges_and_folders_name_files() {
        let folder = tempfile::tempdir().unwrap();
        for n in [2, 4, 6, 10] {
            fs::write(folder.path().join(format!("f_{n:03}.obj")), "").unwrap();
        }
        fs::write(folder.path().join("f_7.obj"), "").unwrap();
        let names = |pattern: &str| -> Result<Vec<String>, ImportError> {
            let files = Pattern::parse(pattern)?.files(folder.path())?;
            Ok(files.iter().map(|p| p.file_name().unwrap().to_string_lossy().into_owned()).collect())
        };
        assert_eq!(names("f_%03d.obj").unwrap(), ["f_002.obj", "f_004.obj", "f_006.obj", "f_010.obj"]);
        assert_eq!(names("f_%03d.obj:2:7:2").unwrap(), ["f_002.obj", "f_004.obj", "f_006.obj"]);
        assert!(matches!(names("f_%03d.obj:2:4"), Err(ImportError::MissingFrame { number: 3, .. })));
        assert!(matches!(names("g_%03d.obj"), Err(ImportError::NoMatch { .. })));
    }

    #[test]
    fn numbers_may_be_negative() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["f_-0003.obj", "f_-0001.obj", "f_0000.obj", "f_0002.obj", "g_-03.obj", "g_000.obj"] {
            fs::write(folder.path().join(name), "").unwrap();
        }
        let names = |pattern: &str| -> Vec<String> {
            let files = Pattern::parse(pattern).unwrap().files(folder.path()).unwrap();
            files.iter().map(|p| p.file_name().unwrap().to_string_lossy().into_owned()).collect()
        };
        let f = ["f_-0003.obj", "f_-0001.obj", "f_0000.obj", "f_0002.obj"];
        assert_eq!(names("f_%04d.obj"), f);
        assert_eq!(names("f_%04d.obj:-3:-1:2"), f[..2]);
        // Here the minus is one of the digits.
        assert_eq!(names("g_%03d.obj"), ["g_-03.obj", "g_000.obj"]);
        assert_eq!(names("g_%03d.obj:-3:0:3"), ["g_-03.obj", "g_000.obj"]);
    }
}
