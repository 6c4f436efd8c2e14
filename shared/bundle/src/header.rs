//! The header: what the file is, whether it is whole, and where its sections lie.

use super::checksum::checksum;
use super::error::BundleError;
use super::kind::{MAGIC, SectionKind, VERSION_MAJOR};
use super::limits::{MAX_BYTES, MAX_SECTION_BYTES, MAX_SECTIONS};

/// Bytes before the section table.
pub(super) const FIXED_BYTES: usize = 48;
/// Bytes of an entry of the section table.
pub(super) const ENTRY_BYTES: usize = 40;
const CHECKSUM_AT: usize = 28;
const MAY_BE_SKIPPED: u8 = 1;

/// How a section's bytes are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Codec {
    /// As they are (which may well be entropy coded).
    Stored,
    /// As a raw deflate stream.
    Deflate,
}

impl Codec {
    fn number(self) -> u8 {
        match self {
            Self::Stored => 0,
            Self::Deflate => 1,
        }
    }
}

/// Where a section lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SectionEntry {
    /// What it holds; `None` for a kind that this version does not know and that may be skipped.
    pub kind: Option<SectionKind>,
    /// The number of its kind.
    pub number: u16,
    /// How it is stored.
    pub codec: Codec,
    /// Which one of its kind, from 0.
    pub ordinal: u32,
    /// Its first byte in the file.
    pub offset: u64,
    /// Its bytes in the file.
    pub stored: u64,
    /// Its bytes once decompressed.
    pub raw: u64,
    /// CRC-32 of the stored bytes.
    pub checksum: u32,
}

/// A header that has been checked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Header {
    /// Major version of the file.
    pub major: u16,
    /// Minor version of the file.
    pub minor: u16,
    /// Bytes of the whole file.
    pub total: u64,
    /// The sections, in the order of the file, without a gap between them.
    pub sections: Vec<SectionEntry>,
}

impl Header {
    /// Reads the header at the beginning of `bytes`; `None` where more bytes are needed to tell.
    ///
    /// # Errors
    /// Not ours, too new, damaged, or a table that makes no sense.
    pub fn parse(bytes: &[u8]) -> Result<Option<Self>, BundleError> {
        let known = bytes.len().min(MAGIC.len());
        if bytes[..known] != MAGIC[..known] {
            return Err(BundleError::NotOurs);
        }
        let Some((fixed, rest)) = bytes.split_at_checked(FIXED_BYTES) else { return Ok(None) };
        let major = u16_at(fixed, 8);
        if major > VERSION_MAJOR {
            return Err(BundleError::TooNew { major });
        }
        let (count, length) = (u32_at(fixed, 16), u32_at(fixed, 12));
        if count > MAX_SECTIONS || length as usize != FIXED_BYTES + ENTRY_BYTES * count as usize {
            return Err(BundleError::header("declares a length that does not fit its table"));
        }
        let Some(table) = rest.get(..ENTRY_BYTES * count as usize) else { return Ok(None) };
        check_checksum(fixed, table)?;
        if major == 0 || fixed[32..FIXED_BYTES].iter().any(|&byte| byte != 0) {
            return Err(BundleError::header("has reserved bytes that are not zero, or version 0"));
        }
        let sections = table.chunks_exact(ENTRY_BYTES).map(entry).collect::<Result<Vec<_>, _>>()?;
        let header = Self { major, minor: u16_at(fixed, 10), total: u64_at(fixed, 20), sections };
        header.check_layout(u64::from(length))?;
        Ok(Some(header))
    }

    /// Bytes of the header itself.
    #[must_use]
    pub fn byte_length(&self) -> usize {
        FIXED_BYTES + ENTRY_BYTES * self.sections.len()
    }

    /// The first byte in the file and the bytes of group `ordinal` of scanned frames.
    #[must_use]
    pub fn scanned_group(&self, ordinal: u32) -> Option<(u64, u64)> {
        let entry = self.scanned_entry(ordinal)?;
        Some((entry.offset, entry.stored))
    }

    /// The entry of group `ordinal` of scanned frames.
    pub(super) fn scanned_entry(&self, ordinal: u32) -> Option<&SectionEntry> {
        let is = |entry: &&SectionEntry| entry.kind == Some(SectionKind::ScannedGroup) && entry.ordinal == ordinal;
        self.sections.iter().find(is)
    }

    /// The header's bytes.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend(self.major.to_le_bytes());
        bytes.extend(self.minor.to_le_bytes());
        bytes.extend((self.byte_length() as u32).to_le_bytes());
        bytes.extend((self.sections.len() as u32).to_le_bytes());
        bytes.extend(self.total.to_le_bytes());
        bytes.resize(FIXED_BYTES, 0);
        for section in &self.sections {
            bytes.extend(section.number.to_le_bytes());
            bytes.push(if section.kind.is_some_and(|kind| kind.since() == 0) { 0 } else { MAY_BE_SKIPPED });
            bytes.push(section.codec.number());
            bytes.extend(section.ordinal.to_le_bytes());
            bytes.extend(section.offset.to_le_bytes());
            bytes.extend(section.stored.to_le_bytes());
            bytes.extend(section.raw.to_le_bytes());
            bytes.extend(section.checksum.to_le_bytes());
            bytes.extend([0; 4]);
        }
        let checksum = checksum(&[&bytes]);
        bytes[CHECKSUM_AT..CHECKSUM_AT + 4].copy_from_slice(&checksum.to_le_bytes());
        bytes
    }

    /// Sections must follow each other without a gap, so that no byte of the file is unaccounted for.
    fn check_layout(&self, header_length: u64) -> Result<(), BundleError> {
        let mut end = header_length;
        for section in &self.sections {
            if section.offset != end {
                return Err(BundleError::header("has a gap or an overlap between its sections"));
            }
            if section.stored > MAX_SECTION_BYTES || section.raw > MAX_SECTION_BYTES {
                return Err(BundleError::header("declares a section that is too large"));
            }
            end += section.stored;
        }
        if end != self.total || end > MAX_BYTES {
            return Err(BundleError::header("declares a size that its sections do not have"));
        }
        Ok(())
    }
}

fn check_checksum(fixed: &[u8], table: &[u8]) -> Result<(), BundleError> {
    let expected = u32_at(fixed, CHECKSUM_AT);
    let found = checksum(&[&fixed[..CHECKSUM_AT], &[0; 4], &fixed[CHECKSUM_AT + 4..], table]);
    if found == expected { Ok(()) } else { Err(BundleError::Damaged { kind: None, ordinal: 0, expected, found }) }
}

fn entry(bytes: &[u8]) -> Result<SectionEntry, BundleError> {
    let (number, flags) = (u16_at(bytes, 0), bytes[2]);
    let kind = SectionKind::from_number(number);
    if flags & !MAY_BE_SKIPPED != 0 || bytes[36..40].iter().any(|&byte| byte != 0) {
        return Err(BundleError::header("has reserved bytes that are not zero in its table"));
    }
    if kind.is_none() && flags & MAY_BE_SKIPPED == 0 {
        return Err(BundleError::UnknownSection { kind: number });
    }
    let codec = match (bytes[3], kind) {
        (0, _) | (_, None) => Codec::Stored,
        (1, _) => Codec::Deflate,
        _ => return Err(BundleError::header("names a compression that does not exist")),
    };
    Ok(SectionEntry {
        kind,
        number,
        codec,
        ordinal: u32_at(bytes, 4),
        offset: u64_at(bytes, 8),
        stored: u64_at(bytes, 16),
        raw: u64_at(bytes, 24),
        checksum: u32_at(bytes, 32),
    })
}

/// Little-endian numbers of `bytes`, which must reach beyond them.
fn u16_at(bytes: &[u8], at: usize) -> u16 {
    u16::from_le_bytes([bytes[at], bytes[at + 1]])
}

fn u32_at(bytes: &[u8], at: usize) -> u32 {
    u32::from(u16_at(bytes, at)) | u32::from(u16_at(bytes, at + 2)) << 16
}

fn u64_at(bytes: &[u8], at: usize) -> u64 {
    u64::from(u32_at(bytes, at)) | u64::from(u32_at(bytes, at + 4)) << 32
}
