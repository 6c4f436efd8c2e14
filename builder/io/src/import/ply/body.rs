//! The numbers after the header of a PLY file, whatever their encoding.

use std::path::Path;

use super::header::{Encoding, Header, NumberType, Property};
use crate::import::error::ImportError;
use crate::import::text::{not_a_number, split_line};

/// Reads one property after the other.
pub(super) struct Body<'a> {
    bytes: &'a [u8],
    at: usize,
    encoding: Encoding,
    path: &'a Path,
}

impl<'a> Body<'a> {
    pub fn new(bytes: &'a [u8], header: &Header, path: &'a Path) -> Self {
        Self { bytes, at: header.body_start, encoding: header.encoding, path }
    }

    /// Reads a property and calls `each` with the place in the list (0 for a single number) and the value.
    pub fn property(&mut self, property: &Property, each: &mut impl FnMut(usize, f64)) -> Result<(), ImportError> {
        let Some(count_kind) = property.list_count else {
            each(0, self.number(property.kind)?);
            return Ok(());
        };
        let count = self.number(count_kind)?;
        let smallest = if self.encoding == Encoding::Ascii { 2 } else { property.kind.size() };
        let available = (self.bytes.len() - self.at) / smallest + 1;
        if count.fract() != 0.0 {
            return Err(self.wrong(format!("a list \"{}\" of {count} numbers", property.name)));
        }
        if !(count >= 0.0 && count <= available as f64) {
            return Err(self.truncated(format!("a list \"{}\" of {count} numbers", property.name)));
        }
        for place in 0..count as usize {
            each(place, self.number(property.kind)?);
        }
        Ok(())
    }

    /// Whether numbers are written as text.
    pub fn is_text(&self) -> bool {
        self.encoding == Encoding::Ascii
    }

    /// Whether something but the end of a line follows the last number.
    pub fn has_rest(&self) -> bool {
        // Some systems end text with a NUL or a Control-Z.
        let is_end = |b: &u8| b.is_ascii_whitespace() || matches!(b, 0 | 0x1a);
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        if self.encoding == Encoding::Ascii {
            !rest.iter().all(is_end)
        } else {
            rest.len() > 2 || !rest.iter().all(is_end)
        }
    }

    /// An error about the place that was read last.
    pub fn wrong(&self, reason: String) -> ImportError {
        let mut rest = self.bytes.get(..self.at.saturating_sub(1)).unwrap_or_default();
        let mut line = 1;
        while let (_, Some(tail)) = split_line(rest) {
            rest = tail;
            line += 1;
        }
        if self.encoding == Encoding::Ascii {
            ImportError::Syntax { path: self.path.to_owned(), line, reason }
        } else {
            let reason = format!("{reason} (before byte {})", self.at);
            ImportError::Binary { path: self.path.to_owned(), reason }
        }
    }

    fn number(&mut self, kind: NumberType) -> Result<f64, ImportError> {
        match self.encoding {
            Encoding::Ascii => self.word(),
            Encoding::LittleEndian => self.binary(kind, false),
            Encoding::BigEndian => self.binary(kind, true),
        }
    }

    fn word(&mut self) -> Result<f64, ImportError> {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let start = rest.iter().position(|b| !b.is_ascii_whitespace());
        let Some(start) = start else { return Err(self.truncated("the numbers end too early".into())) };
        let length = rest[start..].iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len() - start);
        let word = &rest[start..start + length];
        self.at += start + length;
        let value = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        value.ok_or_else(|| {
            let word = String::from_utf8_lossy(word);
            self.wrong(not_a_number(&word))
        })
    }

    fn binary(&mut self, kind: NumberType, big: bool) -> Result<f64, ImportError> {
        let size = kind.size();
        let Some(bytes) = self.bytes.get(self.at..self.at + size) else {
            return Err(self.truncated(format!("it ends within a number at byte {}", self.at)));
        };
        self.at += size;
        let mut word = [0; 8];
        for (slot, k) in word.iter_mut().zip(0..size) {
            *slot = bytes[if big { size - 1 - k } else { k }];
        }
        let raw = u64::from_le_bytes(word);
        Ok(match kind {
            NumberType::I8 => f64::from(raw as i8),
            NumberType::U8 => f64::from(raw as u8),
            NumberType::I16 => f64::from(raw as i16),
            NumberType::U16 => f64::from(raw as u16),
            NumberType::I32 => f64::from(raw as i32),
            NumberType::U32 => f64::from(raw as u32),
            NumberType::F32 => f64::from(f32::from_bits(raw as u32)),
            NumberType::F64 => f64::from_bits(raw),
        })
    }

    fn truncated(&self, reason: String) -> ImportError {
        ImportError::Truncated { path: self.path.to_owned(), reason }
    }
}
