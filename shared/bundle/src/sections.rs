//! Sections: compression, checksums, and the list that `builder inspect` prints.

use miniz_oxide::deflate::compress_to_vec;
use miniz_oxide::inflate::decompress_to_vec_with_limit;

use super::checksum::checksum;
use super::error::BundleError;
use super::header::{Codec, Header, SectionEntry};
use super::kind::{SectionKind, VERSION_MAJOR};

/// A line of the list of sections.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SectionInfo {
    /// Name of its kind; `unknown` where this version does not know it.
    pub name: &'static str,
    /// Number of its kind.
    pub number: u16,
    /// Which one of its kind.
    pub ordinal: u32,
    /// Its first byte in the file.
    pub offset: u64,
    /// Its bytes in the file.
    pub stored: u64,
    /// Its bytes once decompressed.
    pub raw: u64,
}

impl From<&SectionEntry> for SectionInfo {
    fn from(entry: &SectionEntry) -> Self {
        let name = entry.kind.map_or("unknown", SectionKind::name);
        Self {
            name,
            number: entry.number,
            ordinal: entry.ordinal,
            offset: entry.offset,
            stored: entry.stored,
            raw: entry.raw,
        }
    }
}

/// A section that is to be written.
pub(super) struct Draft {
    pub kind: SectionKind,
    pub ordinal: u32,
    pub raw: Vec<u8>,
}

/// The file that holds `drafts` in this order, and behind them the sections of groups of scanned frames, of which `groups` tells length and
/// checksum: those are to be appended.
pub(super) fn assemble(drafts: Vec<Draft>, groups: impl Iterator<Item = (u64, u32)>) -> (Vec<u8>, Header) {
    let minor = drafts.iter().map(|draft| draft.kind.since()).max().unwrap_or(0);
    let mut header = Header { major: VERSION_MAJOR, minor, total: 0, sections: Vec::new() };
    let mut contents = Vec::new();
    for draft in drafts {
        let raw = draft.raw.len() as u64;
        let (codec, stored) = compress(draft.kind, draft.raw);
        header.sections.push(SectionEntry {
            kind: Some(draft.kind),
            number: draft.kind.number(),
            codec,
            ordinal: draft.ordinal,
            offset: 0,
            stored: stored.len() as u64,
            raw,
            checksum: checksum(&[&stored]),
        });
        contents.push(stored);
    }
    let group = |(ordinal, (length, checksum))| SectionEntry {
        kind: Some(SectionKind::ScannedGroup),
        number: SectionKind::ScannedGroup.number(),
        codec: Codec::Stored,
        ordinal,
        offset: 0,
        stored: length,
        raw: length,
        checksum,
    };
    header.sections.extend((0..).zip(groups).map(group));
    let mut end = header.byte_length() as u64;
    for section in &mut header.sections {
        section.offset = end;
        end += section.stored;
    }
    header.total = end;
    let mut bytes = header.to_bytes();
    for content in contents {
        bytes.extend_from_slice(&content);
    }
    (bytes, header)
}

/// Only names and numbers profit from deflate: everything else is entropy coded already.
fn compress(kind: SectionKind, raw: Vec<u8>) -> (Codec, Vec<u8>) {
    if kind != SectionKind::Meta {
        return (Codec::Stored, raw);
    }
    let deflated = compress_to_vec(&raw, 9);
    if deflated.len() < raw.len() { (Codec::Deflate, deflated) } else { (Codec::Stored, raw) }
}

/// Whether `stored` are the bytes that `entry` tells of.
pub(super) fn check(entry: &SectionEntry, stored: &[u8]) -> Result<(), BundleError> {
    let found = checksum(&[stored]);
    if found == entry.checksum && stored.len() as u64 == entry.stored {
        return Ok(());
    }
    Err(BundleError::Damaged { kind: entry.kind, ordinal: entry.ordinal, expected: entry.checksum, found })
}

/// The raw bytes of a section whose stored bytes have all arrived.
pub(super) fn open(entry: &SectionEntry, stored: Vec<u8>) -> Result<Vec<u8>, BundleError> {
    check(entry, &stored)?;
    let wrong =
        |reason: &str| BundleError::Inconsistent { kind: entry.kind, ordinal: entry.ordinal, reason: reason.into() };
    let raw = match entry.codec {
        Codec::Stored => stored,
        Codec::Deflate => decompress_to_vec_with_limit(&stored, entry.raw as usize)
            .map_err(|_| wrong("cannot be decompressed to its declared size"))?,
    };
    if raw.len() as u64 == entry.raw { Ok(raw) } else { Err(wrong("has another size than declared")) }
}
