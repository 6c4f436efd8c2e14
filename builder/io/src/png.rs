//! PNG files in memory.

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder, ImageResult, RgbaImage};

/// A PNG file of `texels`, of which each has the channels of `colour`, row by row from the top.
pub(crate) fn encode(texels: &[u8], [width, height]: [u32; 2], colour: ExtendedColorType) -> ImageResult<Vec<u8>> {
    let mut file = Vec::new();
    PngEncoder::new_with_quality(&mut file, CompressionType::Fast, FilterType::Adaptive)
        .write_image(texels, width, height, colour)?;
    Ok(file)
}

/// A PNG file of `image`, without an alpha channel that says nothing.
pub(crate) fn encode_lean(image: &RgbaImage) -> ImageResult<Vec<u8>> {
    let size = [image.width(), image.height()];
    if image.pixels().any(|pixel| pixel.0[3] != 255) {
        return encode(image, size, ExtendedColorType::Rgba8);
    }
    let opaque: Vec<u8> = image.pixels().flat_map(|&image::Rgba([r, g, b, _])| [r, g, b]).collect();
    encode(&opaque, size, ExtendedColorType::Rgb8)
}
