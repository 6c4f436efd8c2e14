//! The bundle: everything that the player needs, in one file that can be drawn before all of it has arrived.
//!
//! `docs/bundle-format.md` describes the format. This crate is pure: bytes to types and back, no input or output.
//! [`encode`] writes a bundle; [`BundleReader`] reads one as it arrives and serves its poses; [`validate`] says what is
//! wrong with one. Nothing here trusts a length, an index or a count, before or after decompression.

pub mod entropy;
pub mod geometry;

mod alternatives;
mod appearance;
mod body_parts;
mod checksum;
mod contacts;
mod encode;
mod error;
mod families;
mod feet;
mod files;
mod found_parts;
mod graph;
mod header;
mod integers;
mod kind;
mod layout;
mod learned;
mod meta;
mod motion;
mod reader;
mod rig;
mod scanned;
mod sections;
mod surface;
mod ties;
mod triangles;
mod turns;
mod validate;

pub use alternatives::AlternativesDecoder;
pub use appearance::{
    Appearance, AppearanceInput, AppearanceQuality, AppearanceReport, ModeDecoder, StoredAppearance, Textures,
    store_appearance,
};
pub use encode::{
    BundleInput, EncodeReport, Extras, SectionSize, default_max_error, encode, encode_with_appearance,
    encode_with_extras, encode_with_files, encode_with_looks, encode_with_rig,
};
pub use error::{BundleError, EncodeError};
pub use found_parts::FoundParts;
pub use header::{Header, SectionEntry};
pub use kind::{MAGIC, SectionKind, VERSION_MAJOR, VERSION_MINOR};
pub use learned::decode as decode_learned_space;
pub use meta::{Chunk, Meta, SequenceMeta};
pub use reader::BundleReader;
pub use rig::decode as decode_rig;
pub use scanned::{
    CodedGroup, GROUP_FRAMES, OpenGroup, ScannedCorner, ScannedFrames, ScannedGroup, ScannedHead, ScannedIndex,
    code_group, ordered,
};
pub use sections::SectionInfo;
pub use validate::{Finding, Severity, validate};

/// Limits that a reader enforces before it allocates anything. A writer refuses what exceeds them.
pub mod limits {
    /// Bytes of a bundle.
    pub const MAX_BYTES: u64 = 1 << 32;
    /// Sections of a bundle.
    pub const MAX_SECTIONS: u32 = 1 << 16;
    /// Bytes of one section, stored and raw.
    pub const MAX_SECTION_BYTES: u64 = 1 << 30;
    /// Welded vertices.
    pub const MAX_VERTICES: u32 = 1 << 22;
    /// Corners of the drawn mesh.
    pub const MAX_CORNERS: u32 = 1 << 23;
    /// Triangles.
    pub const MAX_TRIANGLES: u32 = 1 << 23;
    /// Images.
    pub const MAX_IMAGES: u32 = 1 << 12;
    /// Materials, and as many parts.
    pub const MAX_MATERIALS: u32 = 1 << 16;
    /// Transitions of the graph.
    pub const MAX_TRANSITIONS: u32 = 1 << 24;
    /// Modes of colours, and as many of warps.
    pub const MAX_MODES: u32 = 255;
    /// Texels along a side of a texture that has modes.
    pub const MAX_TEXTURE_SIDE: u32 = 4096;
    /// Frames of a group of scanned frames.
    pub const MAX_SCANNED_FRAMES: u32 = 64;
    /// Pixels along a side of an image that a scanned frame wears.
    pub const MAX_SCANNED_SIDE: u32 = 8192;
    /// Frames of a chunk of geometry.
    pub const MAX_CHUNK_FRAMES: u32 = 256;
    /// Largest coordinate in steps of the quantisation.
    pub const MAX_COORDINATE: i32 = 1 << 22;
}
