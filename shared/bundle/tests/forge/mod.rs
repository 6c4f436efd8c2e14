//! Takes bundles apart and puts them together again, with checksums that fit whatever was changed.
#![allow(dead_code, reason = "each test uses some of it")]

use bundle::{Header, Meta, SectionKind};

/// A section as it is once decompressed.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    pub number: u16,
    pub may_be_skipped: bool,
    pub ordinal: u32,
    pub raw: Vec<u8>,
}

pub fn raw_sections(bytes: &[u8]) -> Vec<Section> {
    let header = Header::parse(bytes).unwrap().unwrap();
    let sections = header.sections.iter().map(|entry| {
        let stored = &bytes[entry.offset as usize..][..entry.stored as usize];
        let raw = if entry.stored == entry.raw {
            stored.to_vec()
        } else {
            miniz_oxide::inflate::decompress_to_vec(stored).unwrap()
        };
        Section { number: entry.number, may_be_skipped: false, ordinal: entry.ordinal, raw }
    });
    sections.collect()
}

pub fn meta_of(sections: &[Section]) -> Meta {
    assert_eq!(sections[0].number, SectionKind::Meta.number());
    postcard::from_bytes(&sections[0].raw).unwrap()
}

/// Written by hand from `docs/bundle-format.md`, not by the library's own writer.
pub fn assembled(sections: &[Section]) -> Vec<u8> {
    let header_length = 48 + 40 * sections.len() as u32;
    let total = u64::from(header_length) + sections.iter().map(|section| section.raw.len() as u64).sum::<u64>();
    let mut bytes = vec![0x89, b'R', b'E', b'P', b'R', b'\r', b'\n', 0x1a, 1, 0, 0, 0];
    bytes.extend(header_length.to_le_bytes());
    bytes.extend((sections.len() as u32).to_le_bytes());
    bytes.extend(total.to_le_bytes());
    bytes.extend([0; 20]);
    let mut offset = u64::from(header_length);
    for section in sections {
        let length = section.raw.len() as u64;
        bytes.extend(section.number.to_le_bytes());
        bytes.extend([u8::from(section.may_be_skipped), 0]);
        bytes.extend(section.ordinal.to_le_bytes());
        bytes.extend(offset.to_le_bytes());
        bytes.extend(length.to_le_bytes());
        bytes.extend(length.to_le_bytes());
        bytes.extend(crc32fast::hash(&section.raw).to_le_bytes());
        bytes.extend([0; 4]);
        offset += length;
    }
    let checksum = crc32fast::hash(&bytes);
    bytes[28..32].copy_from_slice(&checksum.to_le_bytes());
    for section in sections {
        bytes.extend_from_slice(&section.raw);
    }
    bytes
}
