//! The texture of a scanned frame: one picture, or those of several materials side by side.

use std::path::{Path, PathBuf};

use actor::surface::{Image, ImageFormat};
use glam::Vec2;
use image::codecs::jpeg::JpegEncoder;
use image::imageops::{FilterType, replace, resize};
use image::{DynamicImage, Rgb, RgbImage};

use super::error::ImportError;
use super::images::{from_bytes, read_file};
use super::layers::TextureLayer;

/// Width and height of a cell of one colour where no picture is larger.
const PLAIN: u32 = 8;
/// Widest sheet: cells become narrower beyond it.
const WIDEST: u32 = 16_384;

/// Widest still that a page shows.
const WIDEST_STILL: u32 = 4096;
/// Quality of the JPEG files of stills, of 100.
const STILL_QUALITY: u8 = 92;

/// A texture that is not decoded yet.
#[derive(Clone, Debug)]
pub struct ScannedTexture {
    /// At least one, from left to right, of equal width.
    cells: Vec<Cell>,
}

/// What a material looks like.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Cell {
    /// None where it is of one colour.
    pub picture: Option<Picture>,
    /// What the picture is multiplied by in linear light, or the colour.
    pub tint: [f32; 3],
}

/// A picture that is not decoded yet.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Picture {
    /// The file that it is from.
    pub path: PathBuf,
    /// Its bytes.
    pub bytes: Vec<u8>,
    /// Which picture of the file, where it holds several.
    pub layer: Option<TextureLayer>,
}

impl Picture {
    pub fn read(path: &Path) -> Result<Self, ImportError> {
        Ok(Self { path: path.to_owned(), bytes: read_file(path)?, layer: None })
    }

    fn decoded(&self) -> Result<RgbImage, ImportError> {
        let image = match &self.layer {
            Some(layer) => DynamicImage::from(layer.decoded(&self.bytes)?),
            // The decoder's default limits bound the memory that a header can ask for.
            None => image::load_from_memory(&self.bytes)
                .map_err(|cause| ImportError::Image { path: self.path.clone(), reason: cause.to_string() })?,
        };
        Ok(image.into_rgb8())
    }
}

impl From<Picture> for ScannedTexture {
    fn from(picture: Picture) -> Self {
        Self { cells: vec![Cell { picture: Some(picture), tint: [1.0; 3] }] }
    }
}

impl ScannedTexture {
    /// The texture as a still that a page can show: a JPEG or WebP file as it is, where it is one and not too large, else a JPEG.
    ///
    /// # Errors
    /// A file that is no image that is read.
    pub fn still(&self) -> Result<Image, ImportError> {
        if let [Cell { picture: Some(Picture { path, bytes, layer: None }), tint: [1.0, 1.0, 1.0] }] =
            self.cells.as_slice()
            && matches!(image::guess_format(bytes), Ok(image::ImageFormat::Jpeg | image::ImageFormat::WebP))
        {
            let image = from_bytes(bytes.clone(), path)?;
            if image.width.max(image.height) <= WIDEST_STILL {
                return Ok(image);
            }
        }
        let path =
            || self.cells.iter().find_map(|cell| cell.picture.as_ref()).map_or_else(PathBuf::new, |p| p.path.clone());
        jpeg(self.decoded()?).map_err(|reason| ImportError::Image { path: path(), reason })
    }

    /// Width, height and texels in sRGB, row by row from the top.
    ///
    /// # Errors
    /// A file that is no image that is read.
    pub fn decoded(&self) -> Result<Texels, ImportError> {
        let mut pictures = Vec::with_capacity(self.cells.len());
        for cell in &self.cells {
            let picture = cell.picture.as_ref().map(Picture::decoded).transpose()?;
            pictures.push(match picture {
                Some(mut picture) => {
                    tint(&mut picture, cell.tint);
                    picture
                }
                None => RgbImage::from_pixel(PLAIN, PLAIN, Rgb(cell.tint.map(byte_of))),
            });
        }
        let sheet = side_by_side(pictures);
        let texels = sheet.pixels().map(|pixel| pixel.0).collect();
        Ok((sheet.width() as usize, sheet.height() as usize, texels))
    }
}

/// Texels of an image, row by row from the top.
type Texels = (usize, usize, Vec<[u8; 3]>);

/// A JPEG of `texels`; the reason where there is none.
fn jpeg((width, height, texels): Texels) -> Result<Image, String> {
    let mut sheet = RgbImage::from_fn(width as u32, height as u32, |x, y| Rgb(texels[y as usize * width + x as usize]));
    let most = width.max(height) as u32;
    if most > WIDEST_STILL {
        let side = |side: usize| ((side as u64 * u64::from(WIDEST_STILL) / u64::from(most)) as u32).max(1);
        sheet = resize(&sheet, side(width), side(height), FilterType::Triangle);
    }
    let mut bytes = Vec::new();
    let encoded = JpegEncoder::new_with_quality(&mut bytes, STILL_QUALITY).encode_image(&sheet);
    encoded.map_err(|cause| cause.to_string())?;
    Ok(Image { format: ImageFormat::Jpeg, width: sheet.width(), height: sheet.height(), bytes })
}

/// All pictures in cells of one size, that of the largest.
fn side_by_side(pictures: Vec<RgbImage>) -> RgbImage {
    let count = pictures.len() as u32;
    let width = pictures.iter().map(RgbImage::width).max().unwrap_or(1).clamp(1, WIDEST / count.clamp(1, WIDEST));
    let height = pictures.iter().map(RgbImage::height).max().unwrap_or(1).max(1);
    let mut sheet = RgbImage::new(width * count, height);
    for (cell, picture) in (0..).zip(pictures) {
        if count == 1 && picture.width() == width {
            return picture;
        }
        let fits = picture.dimensions() == (width, height);
        let picture = if fits { picture } else { resize(&picture, width, height, FilterType::Triangle) };
        replace(&mut sheet, &picture, i64::from(cell * width), 0);
    }
    sheet
}

/// Which cell each material's triangles lie in.
pub(super) struct Sheet {
    pub texture: ScannedTexture,
    /// By material.
    cells: Vec<u32>,
}

impl Sheet {
    /// A sheet of what materials look like, those that look the same in one cell; `None` where none has a picture.
    pub fn of(looks: Vec<Cell>) -> Option<Self> {
        if looks.iter().all(|look| look.picture.is_none()) {
            return None;
        }
        let mut kept: Vec<Cell> = Vec::new();
        let mut cells = Vec::with_capacity(looks.len());
        for look in looks {
            let cell = kept.iter().position(|cell| *cell == look).unwrap_or_else(|| {
                kept.push(look);
                kept.len() - 1
            });
            cells.push(cell as u32);
        }
        Some(Self { texture: ScannedTexture { cells: kept }, cells })
    }

    /// Texture coordinates of a triangle of `material` on the sheet. In a picture that repeats itself the triangle is moved to
    /// where its middle is in the first one.
    pub fn place(&self, material: u32, corners: [Vec2; 3]) -> [Vec2; 3] {
        let count = self.texture.cells.len() as f32;
        let Some(&cell) = self.cells.get(material as usize).filter(|_| count > 1.0) else { return corners };
        let first = ((corners[0] + corners[1] + corners[2]) / 3.0).floor();
        corners.map(|corner| {
            let inside = (corner - first).clamp(Vec2::ZERO, Vec2::ONE);
            Vec2::new((cell as f32 + inside.x) / count, inside.y)
        })
    }
}

/// Multiplies a picture in linear light.
fn tint(picture: &mut RgbImage, tint: [f32; 3]) {
    if tint == [1.0; 3] {
        return;
    }
    let tables = tint.map(|tint| std::array::from_fn::<u8, 256, _>(|value| byte_of(linear_of(value as u8) * tint)));
    for pixel in picture.pixels_mut() {
        for (channel, table) in pixel.0.iter_mut().zip(&tables) {
            *channel = table[usize::from(*channel)];
        }
    }
}

/// Linear light of an sRGB value (IEC 61966-2-1).
fn linear_of(value: u8) -> f32 {
    let value = f32::from(value) / 255.0;
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// The sRGB value of linear light.
fn byte_of(light: f32) -> u8 {
    let light = light.clamp(0.0, 1.0);
    let value = if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 };
    (255.0 * value + 0.5) as u8
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

    use super::*;

    fn picture(size: u32, colour: [u8; 3]) -> Cell {
        let mut bytes = Vec::new();
        let image = DynamicImage::from(RgbImage::from_pixel(size, size, Rgb(colour)));
        image.write_to(&mut std::io::Cursor::new(&mut bytes), image::ImageFormat::Png).unwrap();
        Cell { picture: Some(Picture { path: PathBuf::new(), bytes, layer: None }), tint: [1.0; 3] }
    }

    #[test]
    fn materials_lie_side_by_side() {
        let looks = vec![
            picture(4, [200, 0, 0]),
            Cell { picture: None, tint: [0.0, 1.0, 0.0] },
            picture(4, [200, 0, 0]),
            picture(8, [0, 0, 90]),
        ];
        let sheet = Sheet::of(looks).unwrap();
        let (width, height, texels) = sheet.texture.decoded().unwrap();
        assert_eq!((width, height), (24, 8));
        let corners = [Vec2::new(0.1, 0.2), Vec2::new(0.9, 0.2), Vec2::new(0.5, 0.9)];
        for (material, colour) in [[200, 0, 0], [0, 255, 0], [200, 0, 0], [0, 0, 90]].into_iter().enumerate() {
            for shift in [0.0, 3.0, -2.0] {
                let placed = sheet.place(material as u32, corners.map(|corner| corner + shift));
                for corner in placed {
                    let (x, y) = ((corner.x * width as f32) as usize, (corner.y * height as f32) as usize);
                    assert_eq!(texels[y * width + x], colour, "material {material}, {corner}");
                }
            }
        }
    }

    #[test]
    fn one_picture_stays_as_it_is_and_colours_alone_are_none() {
        let sheet = Sheet::of(vec![picture(4, [1, 2, 3]); 2]).unwrap();
        let corners = [Vec2::new(-3.0, 0.2), Vec2::new(0.9, 7.0), Vec2::new(0.5, 0.9)];
        assert_eq!(sheet.place(1, corners), corners);
        assert_eq!(sheet.texture.decoded().unwrap().2, vec![[1, 2, 3]; 16]);
        assert!(Sheet::of(vec![Cell { picture: None, tint: [0.5; 3] }]).is_none());
    }

    #[test]
    fn stills_are_kept_as_they_are_or_become_jpeg() {
        let png = ScannedTexture { cells: vec![picture(4, [200, 30, 60])] };
        let still = png.still().unwrap();
        assert_eq!((still.format, still.width, still.height), (ImageFormat::Jpeg, 4, 4));
        let read = image::load_from_memory(&still.bytes).unwrap().into_rgb8();
        assert!(
            read.pixels().all(|pixel| pixel
                .0
                .iter()
                .zip([200, 30, 60])
                .all(|(&a, b): (&u8, i32)| (i32::from(a) - b).abs() < 6))
        );
        let bytes = still.bytes.clone();
        let of = |tint| {
            let picture = Picture { path: PathBuf::new(), bytes: bytes.clone(), layer: None };
            ScannedTexture { cells: vec![Cell { picture: Some(picture), tint }] }.still().unwrap()
        };
        assert_eq!(of([1.0; 3]).bytes, bytes, "a JPEG stays as it is");
        assert_ne!(of([0.5, 1.0, 1.0]).bytes, bytes);
    }

    #[test]
    fn tints_are_in_linear_light() {
        let mut cell = picture(1, [255, 188, 0]);
        cell.tint = [0.5, 1.0, 1.0];
        let sheet = Sheet::of(vec![cell]).unwrap();
        assert_eq!(sheet.texture.decoded().unwrap().2, [[188, 188, 0]]);
        assert!((0..=255).all(|value| byte_of(linear_of(value)) == value));
    }
}
