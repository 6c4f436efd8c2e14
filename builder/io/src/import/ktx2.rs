//! KTX2 textures of Basis Universal (ETC1S and UASTC): standalone `.ktx2` files, and what `KHR_texture_basisu` names in
//! glTF. They are turned into plain pixels, for bundles hold images that every browser shows.
//!
//! The decoder trusts places and sizes in the header, so [`check`] holds them against the file first. What may be left
//! (it was tried with 300,000 damaged files, of which two made it add or subtract beyond a number's range) ends as an error,
//! not as the end of the program: its panics are caught.

use std::panic::{AssertUnwindSafe, catch_unwind};

use basisu::{DecodeFlags, SourceFormat, TargetFormat, Transcoder, VideoState};
use image::RgbaImage;
use thiserror::Error;

/// The first bytes of every file.
const IDENTIFIER: [u8; 12] = *b"\xABKTX 20\xBB\r\n\x1A\n";
/// Bytes of the header before the list of levels, and of a level in that list.
const HEADER: usize = 80;
const LEVEL: usize = 24;
/// No image is wider or higher; browsers show no larger ones.
const MAX_SIDE: u32 = 16_384;
/// No image has more pixels: 256 MB of them.
const MAX_PIXELS: u64 = 1 << 26;
/// Nor does a file hold more layers.
const MAX_LAYERS: u32 = 4096;

/// An opened file: `layers` images of one size, each in `levels` sizes, the first the largest.
pub(super) struct Ktx2<'a> {
    transcoder: Transcoder<'a>,
    /// Width of level 0 in pixels.
    pub width: u32,
    /// Height of level 0 in pixels.
    pub height: u32,
    /// Number of images: 1 where the file is no array.
    pub layers: u32,
    /// Number of sizes.
    pub levels: u32,
    /// Whether the first row of pixels is the lowest (`KTXorientation`).
    upside_down: bool,
}

/// Why bytes are no KTX2 texture that can be read.
#[derive(Debug, Error, PartialEq, Eq)]
pub(super) enum Ktx2Error {
    /// The first bytes are not KTX2's.
    #[error("it does not begin like a KTX2 file")]
    NotKtx2,
    /// The file ends within its header.
    #[error("the KTX2 file is cut short")]
    Short,
    /// Texels that are not coded by Basis Universal.
    #[error("the KTX2 file holds texels of the Vulkan format {0}: only Basis Universal (ETC1S, UASTC) is read")]
    Format(u32),
    /// High dynamic range.
    #[error("the KTX2 file holds colours of high dynamic range, which are not read")]
    HighRange,
    /// Not a plain picture or a list of them.
    #[error("the KTX2 file holds {0}, where a picture is wanted")]
    Shape(&'static str),
    /// More than is read.
    #[error(
        "the KTX2 file holds {0} x {1} pixels in {2} layers: at most {MAX_SIDE} a side, {MAX_PIXELS} in all, and {MAX_LAYERS} layers are read"
    )]
    TooLarge(u32, u32, u32),
    /// Damaged, or of a kind that the decoder does not know.
    #[error("the KTX2 file is damaged, or of a kind that is not read")]
    Damaged,
    /// The file has no such image.
    #[error("the KTX2 file has no layer {layer} at level {level}")]
    NoImage {
        /// Layer asked for.
        layer: u32,
        /// Level asked for.
        level: u32,
    },
}

/// The picture of a KTX2 file in full size; straight alpha, colours as they are stored, the highest row first.
///
/// # Errors
/// See [`Ktx2Error`]; also where the file holds several pictures, which [`Ktx2::images`] reads.
pub(super) fn decode_ktx2(bytes: &[u8]) -> Result<RgbaImage, Ktx2Error> {
    let ktx2 = Ktx2::open(bytes)?;
    if ktx2.layers > 1 {
        return Err(Ktx2Error::Shape("several pictures"));
    }
    ktx2.images(0)?.next().unwrap_or(Err(Ktx2Error::NoImage { layer: 0, level: 0 }))
}

/// Whether bytes begin like a `.basis` file, the format's older container.
pub(super) fn is_basis(bytes: &[u8]) -> bool {
    bytes.starts_with(b"sB")
}

/// The first picture of a `.basis` file in full size, as [`decode_ktx2`] gives it: rows as they are stored.
///
/// # Errors
/// See [`Ktx2Error`].
pub(super) fn decode_basis(bytes: &[u8]) -> Result<RgbaImage, Ktx2Error> {
    let transcoder = guarded(|| Transcoder::new(bytes))?;
    if !matches!(transcoder.source_format(), SourceFormat::Etc1s | SourceFormat::UastcLdr) {
        return Err(Ktx2Error::Damaged);
    }
    let (width, height) = transcoder.base_dimensions();
    if width > MAX_SIDE || height > MAX_SIDE || u64::from(width) * u64::from(height) > MAX_PIXELS {
        return Err(Ktx2Error::TooLarge(width, height, 1));
    }
    let (target, flags) = (TargetFormat::Rgba32, DecodeFlags::NONE);
    let pixels = guarded(|| {
        let mut state = VideoState::default();
        transcoder.transcode_video_frame(&mut state, 0, 0, target, flags)
    })?;
    RgbaImage::from_raw(width, height, pixels).ok_or(Ktx2Error::Damaged)
}

impl<'a> Ktx2<'a> {
    /// Reads the header and prepares for decoding.
    ///
    /// # Errors
    /// See [`Ktx2Error`].
    pub fn open(bytes: &'a [u8]) -> Result<Self, Ktx2Error> {
        let [width, height, layers, levels] = check(bytes)?;
        let transcoder = guarded(|| Transcoder::new(bytes))?;
        match transcoder.source_format() {
            SourceFormat::Etc1s | SourceFormat::UastcLdr => {}
            SourceFormat::AstcLdr(_) | SourceFormat::XuastcLdr(_) => return Err(Ktx2Error::Damaged),
            _ => return Err(Ktx2Error::HighRange),
        }
        let upside_down = orientation(bytes).is_some_and(|value| value.get(1) == Some(&b'u'));
        Ok(Self { transcoder, width, height, layers, levels, upside_down })
    }

    /// The picture `layer` in full size.
    ///
    /// # Errors
    /// Where there is no such layer, or it is damaged.
    pub fn image(&self, layer: u32) -> Result<RgbaImage, Ktx2Error> {
        let mut images = self.images(0)?;
        // In videos, a layer builds on those before; others are found at once.
        if !self.transcoder.is_video() {
            images.next = layer;
        }
        while images.next < layer {
            images.next().transpose()?;
        }
        images.next().unwrap_or(Err(Ktx2Error::NoImage { layer, level: 0 }))
    }

    /// Whether the file says that its first row is the lowest; images are turned over then.
    #[must_use]
    pub fn upside_down(&self) -> bool {
        self.upside_down
    }

    /// All layers at `level`, one after the other.
    ///
    /// # Errors
    /// Where there is no such level.
    pub fn images(&self, level: u32) -> Result<Images<'_, 'a>, Ktx2Error> {
        if level >= self.levels {
            return Err(Ktx2Error::NoImage { layer: 0, level });
        }
        Ok(Images { file: self, level, next: 0, state: VideoState::default() })
    }
}

/// The layers of a file in their order: in videos, a layer builds on the one before.
pub(super) struct Images<'f, 'a> {
    file: &'f Ktx2<'a>,
    level: u32,
    next: u32,
    state: VideoState,
}

impl Iterator for Images<'_, '_> {
    type Item = Result<RgbaImage, Ktx2Error>;

    fn next(&mut self) -> Option<Self::Item> {
        let (file, level, layer) = (self.file, self.level, self.next);
        if layer >= file.layers {
            return None;
        }
        self.next += 1;
        let (target, flags) = (TargetFormat::Rgba32, DecodeFlags::NONE);
        let pixels = guarded(|| {
            if file.transcoder.is_video() {
                file.transcoder.transcode_video_frame(&mut self.state, level, layer, target, flags)
            } else {
                file.transcoder.transcode_image(level, layer, 0, target, flags)
            }
        });
        let (width, height) = ((file.width >> level).max(1), (file.height >> level).max(1));
        let image = pixels.and_then(|pixels| RgbaImage::from_raw(width, height, pixels).ok_or(Ktx2Error::Damaged));
        Some(image.map(|mut image| {
            if file.upside_down {
                image::imageops::flip_vertical_in_place(&mut image);
            }
            image
        }))
    }
}

/// What the decoder says, or [`Ktx2Error::Damaged`] where it refuses or panics.
fn guarded<T>(decode: impl FnOnce() -> Result<T, basisu::Error>) -> Result<T, Ktx2Error> {
    catch_unwind(AssertUnwindSafe(decode)).ok().and_then(Result::ok).ok_or(Ktx2Error::Damaged)
}

/// Width, height, layers and levels, all within bounds.
///
/// The decoder reserves what the header asks for, so the header is held against these bounds first; so are the size to
/// which each level says it inflates, and the places of all parts of the file.
fn check(bytes: &[u8]) -> Result<[u32; 4], Ktx2Error> {
    if !bytes.starts_with(&IDENTIFIER) {
        return Err(Ktx2Error::NotKtx2);
    }
    let header = bytes.get(..HEADER).ok_or(Ktx2Error::Short)?;
    let word = |at: usize| u32::from_le_bytes([header[at], header[at + 1], header[at + 2], header[at + 3]]);
    let [format, width, height, depth, layers, faces, levels] = [12, 20, 24, 28, 32, 36, 40].map(word);
    if format != 0 {
        return Err(Ktx2Error::Format(format));
    }
    if depth > 0 || height == 0 {
        return Err(Ktx2Error::Shape("a volume or a line"));
    }
    if faces != 1 {
        return Err(Ktx2Error::Shape("a cube map"));
    }
    let too_large = width > MAX_SIDE || height > MAX_SIDE || u64::from(width) * u64::from(height) > MAX_PIXELS;
    if too_large || layers > MAX_LAYERS {
        return Err(Ktx2Error::TooLarge(width, height, layers));
    }
    if width == 0 || levels == 0 || levels > 16 {
        return Err(Ktx2Error::Damaged);
    }
    let list = bytes.get(HEADER..HEADER + levels as usize * LEVEL).ok_or(Ktx2Error::Short)?;
    let within = |offset: u64, length: u64| offset.checked_add(length).is_some_and(|end| end <= bytes.len() as u64);
    let [dfd, dfd_length, kvd, kvd_length] = [48, 52, 56, 60].map(|at| u64::from(word(at)));
    let [global, global_length] = [64, 72].map(|at| long(header, at));
    if !(within(dfd, dfd_length) && within(kvd, kvd_length) && within(global, global_length)) {
        return Err(Ktx2Error::Short);
    }
    // The decoder walks over pairs of names and values as if they were padded, as they have to be.
    if !(kvd.is_multiple_of(4) && kvd_length.is_multiple_of(4)) {
        return Err(Ktx2Error::Damaged);
    }
    for (level, entry) in list.chunks_exact(LEVEL).enumerate() {
        let [offset, length, inflated] = [0, 8, 16].map(|at| long(entry, at));
        if !within(offset, length) {
            return Err(Ktx2Error::Short);
        }
        // Blocks of 4 x 4 pixels have 16 bytes at most.
        let blocks = |side: u32| u64::from((side >> level).max(1).div_ceil(4));
        if inflated > 16 * blocks(width) * blocks(height) * u64::from(layers.max(1)) {
            return Err(Ktx2Error::Damaged);
        }
    }
    Ok([width, height, layers.max(1), levels])
}

/// What the file says of its rows and columns: `rd` where they run to the right and down.
fn orientation(bytes: &[u8]) -> Option<&[u8]> {
    let word = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at.checked_add(4)?)?.try_into().ok()?) as usize);
    let (start, length) = (word(56)?, word(60)?);
    let mut rest = bytes.get(start..start.checked_add(length)?)?;
    while let Some((size, tail)) = rest.split_at_checked(4) {
        let size = u32::from_le_bytes(size.try_into().ok()?) as usize;
        let (entry, tail) = tail.split_at_checked(size)?;
        if let Some(value) = entry.strip_prefix(b"KTXorientation\0") {
            return Some(value);
        }
        rest = tail.get(size.next_multiple_of(4) - size..)?;
    }
    None
}

/// The 64-bit number at `at`, which must lie within `bytes`.
fn long(bytes: &[u8], at: usize) -> u64 {
    bytes[at..at + 8].iter().rev().fold(0, |value, &byte| value << 8 | u64::from(byte))
}

#[cfg(test)]
mod tests {
    use super::*;

    const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/ktx2/");

    /// A file made by the encoder of the format's authors, and the pixels of their decoder: `README.md` beside them.
    fn sample(name: &str) -> (Vec<u8>, Vec<u8>) {
        let read = |ending: &str| std::fs::read(format!("{FOLDER}{name}.{ending}")).unwrap();
        (read("ktx2"), read("rgba"))
    }

    const SAMPLES: [(&str, u32, u32); 6] = [
        ("etc1s", 1, 1),
        ("etc1s-alpha-levels", 1, 6),
        ("etc1s-layers", 4, 1),
        ("etc1s-video", 5, 1),
        ("uastc", 1, 1),
        ("uastc-zstd-layers", 3, 1),
    ];

    #[test]
    fn decodes_as_the_authors_decoder_does() {
        for (name, layers, levels) in SAMPLES {
            let (bytes, mut expected) = sample(name);
            let file = Ktx2::open(&bytes).unwrap();
            assert_eq!((file.width, file.height, file.layers, file.levels), (32, 24, layers, levels), "{name}");
            for level in 0..levels {
                for (layer, image) in file.images(level).unwrap().enumerate() {
                    let image = image.unwrap();
                    let rest = expected.split_off(image.as_raw().len());
                    assert_eq!(*image.as_raw(), expected, "{name}, level {level}, layer {layer}");
                    expected = rest;
                }
            }
            assert!(expected.is_empty() && file.images(levels).is_err());
            let single = decode_ktx2(&bytes);
            assert!(if layers > 1 { single.is_err() } else { single.unwrap().dimensions() == (32, 24) });
        }
    }

    #[test]
    fn the_older_container_holds_the_same() {
        for name in ["basis-etc1s", "basis-uastc"] {
            let read = |ending: &str| std::fs::read(format!("{FOLDER}{name}.{ending}")).unwrap();
            let (mut bytes, expected) = (read("basis"), read("rgba"));
            let image = decode_basis(&bytes).unwrap();
            assert_eq!((image.dimensions(), is_basis(&bytes)), ((32, 24), true), "{name}");
            assert_eq!(*image.as_raw(), expected, "{name}");
            for length in 0..bytes.len() {
                assert!(decode_basis(&bytes[..length]).is_err() || length > 77);
            }
            for at in 0..bytes.len() {
                let whole = bytes[at];
                for flip in [1, 0x80, 0xff] {
                    bytes[at] ^= flip;
                    let _ = decode_basis(&bytes).map(|image| assert!(image.width() > 0));
                    bytes[at] = whole;
                }
            }
        }
    }

    #[test]
    fn damage_is_refused_or_decodes_to_images() {
        for (name, ..) in SAMPLES {
            let (bytes, _) = sample(name);
            let attempt = |damaged: &[u8]| {
                let Ok(file) = Ktx2::open(damaged) else { return };
                if u64::from(file.width) * u64::from(file.height) > 1 << 16 {
                    return;
                }
                for level in 0..file.levels {
                    let images = file.images(level).unwrap().take(8);
                    images.for_each(|image| assert!(image.is_err() || image.is_ok_and(|image| image.width() > 0)));
                }
            };
            for length in 0..bytes.len() {
                attempt(&bytes[..length]);
            }
            let mut damaged = bytes.clone();
            for at in 0..bytes.len() {
                for flip in [1, 0x80, 0xff] {
                    damaged[at] ^= flip;
                    attempt(&damaged);
                    damaged[at] = bytes[at];
                }
            }
        }
    }

    #[test]
    fn rows_that_run_upwards_are_turned_over() {
        let (bytes, pixels) = sample("uastc");
        let entry = b"KTXorientation\0ru\0";
        let mut with = bytes.clone();
        let start = with.len();
        with.extend((entry.len() as u32).to_le_bytes());
        with.extend(entry);
        with.resize(with.len().next_multiple_of(4), 0);
        let length = with.len() - start;
        with[56..60].copy_from_slice(&(start as u32).to_le_bytes());
        with[60..64].copy_from_slice(&(length as u32).to_le_bytes());
        let turned: Vec<u8> = pixels.chunks(4 * 32).rev().flatten().copied().collect();
        assert_eq!(decode_ktx2(&with).unwrap().into_raw(), turned);
        assert_eq!(decode_ktx2(&bytes).unwrap().into_raw(), pixels);
    }

    #[test]
    fn other_files_are_named() {
        let (bytes, _) = sample("uastc");
        let with = |at: usize, value: u32| {
            let mut changed = bytes.clone();
            changed[at..at + 4].copy_from_slice(&value.to_le_bytes());
            Ktx2::open(&changed).err().unwrap()
        };
        assert_eq!(with(0, 0), Ktx2Error::NotKtx2);
        assert_eq!(with(12, 43), Ktx2Error::Format(43));
        assert_eq!(with(20, 1 << 20), Ktx2Error::TooLarge(1 << 20, 24, 0));
        assert_eq!(with(28, 3), Ktx2Error::Shape("a volume or a line"));
        assert_eq!(with(36, 6), Ktx2Error::Shape("a cube map"));
        // A level that says it inflates to half a terabyte.
        assert_eq!(with(80 + 16 + 4, 128), Ktx2Error::Damaged);
    }
}
