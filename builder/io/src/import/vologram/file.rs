//! Where the frames of a vologram lie: each begins with its number, its size and whether it is a keyframe, and ends with its
//! size once more.

use std::fs::File;
use std::io::{Read as _, Seek as _, SeekFrom};
use std::path::Path;

use super::super::error::ImportError;
use super::header::Header;

/// Bytes before a frame's arrays, and behind them.
const BEFORE: u64 = 9;
const BEHIND: u64 = 4;

/// A file of frames.
pub(super) struct FrameFile<'a> {
    path: &'a Path,
    header: &'a Header,
    file: File,
    length: u64,
    /// Where the first frame begins.
    start: u64,
}

/// The arrays of a frame.
pub(super) struct Frame {
    pub bytes: Vec<u8>,
    /// Whether it says how its vertices are joined.
    pub key: bool,
}

/// Where the arrays of a frame lie.
#[derive(Clone, Copy)]
struct Place {
    at: u64,
    size: u64,
    key: bool,
}

impl<'a> FrameFile<'a> {
    /// Opens `path`, whose frames `header` describes.
    pub fn open(path: &'a Path, header: &'a Header) -> Result<Self, ImportError> {
        let file = File::open(path).map_err(|source| ImportError::Io { path: path.to_owned(), source })?;
        let length = file.metadata().map_err(|source| ImportError::Io { path: path.to_owned(), source })?.len();
        let start = if super::header::read(path).is_ok() { header.body } else { 0 };
        Ok(Self { path, header, file, length, start })
    }

    /// Whether anything lies behind the header.
    pub fn holds_frames(&self) -> bool {
        self.length > self.start
    }

    /// Number of frames.
    pub fn count(&mut self) -> Result<usize, ImportError> {
        let (mut at, mut count) = (self.start, 0);
        while at < self.length {
            let place = self.place(at, count)?;
            if count == 0 && !place.key {
                return Err(self.wrong(0, "is no keyframe, so that nothing says how its vertices are joined"));
            }
            (at, count) = (place.at + place.size + BEHIND, count + 1);
        }
        Ok(count)
    }

    /// The arrays of frame `number`, and of the keyframe that says how its vertices are joined.
    pub fn frame(&mut self, number: usize) -> Result<(Frame, Frame), ImportError> {
        let (mut at, mut key) = (self.start, None);
        for frame in 0..=number {
            let place = self.place(at, frame)?;
            if place.key {
                key = Some(place);
            }
            if frame == number {
                let key = key.ok_or_else(|| self.wrong(number, "comes before the first keyframe"))?;
                return Ok((self.arrays(place, number)?, self.arrays(key, number)?));
            }
            at = place.at + place.size + BEHIND;
        }
        Err(self.wrong(number, "is not there"))
    }

    /// The frame that begins at `at`.
    fn place(&mut self, at: u64, number: usize) -> Result<Place, ImportError> {
        let mut head = [0; BEFORE as usize];
        self.read(at, &mut head, number)?;
        let word = |at: usize| u32::from_le_bytes([head[at], head[at + 1], head[at + 2], head[at + 3]]);
        let (said, key) = (word(4), head[8] == 1 || head[8] == 2 && self.header.version >= 12);
        if self.header.version < 13 && head[8] > 2 {
            return Err(self.wrong(number, &format!("is of kind {}, where 0 to 2 are known", head[8])));
        }
        // Up to 1.1 the size leaves out the lengths of some of the arrays, or of all; the one behind them tells.
        let (header, data) = (self.header, at + BEFORE);
        let mut sizes = vec![u64::from(said)];
        if header.version < 12 {
            let lengths =
                [true, header.normals, key, key, header.textured].iter().filter(|&&there| there).count() as u64;
            sizes.extend([4 * lengths, 4 * (lengths - 1)].map(|more| u64::from(said) + more));
        }
        let mut last = [0; BEHIND as usize];
        for &size in &sizes {
            if data + size + BEHIND <= self.length {
                self.read(data + size, &mut last, number)?;
                if u32::from_le_bytes(last) == said {
                    return Ok(Place { at: data, size, key });
                }
            }
        }
        if data + u64::from(said) + BEHIND > self.length {
            return Err(self.cut(number));
        }
        Err(self.wrong(number, &format!("does not end where its size ({said} bytes) says")))
    }

    fn arrays(&mut self, place: Place, number: usize) -> Result<Frame, ImportError> {
        let mut bytes = vec![0; place.size as usize];
        self.read(place.at, &mut bytes, number)?;
        Ok(Frame { bytes, key: place.key })
    }

    fn read(&mut self, at: u64, into: &mut [u8], number: usize) -> Result<(), ImportError> {
        if at + into.len() as u64 > self.length {
            return Err(self.cut(number));
        }
        let read = self.file.seek(SeekFrom::Start(at)).and_then(|_| self.file.read_exact(into));
        read.map_err(|source| ImportError::Io { path: self.path.to_owned(), source })
    }

    fn cut(&self, number: usize) -> ImportError {
        self.wrong(number, "is cut short by the end of the file: fetch the whole file")
    }

    fn wrong(&self, number: usize, what: &str) -> ImportError {
        ImportError::Binary { path: self.path.to_owned(), reason: format!("frame {number} {what}") }
    }
}
