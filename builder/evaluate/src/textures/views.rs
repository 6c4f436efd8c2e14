//! What a texture looks like on the actor: pictures of frames with one texture and with another, compared.

use std::io::Cursor;

use actor::surface::{self, Surface};
use glam::Vec3;
use image::{ImageFormat, RgbImage};
use texture::quality::Similarity;

use appearance::charts::Charts;
use appearance::rebuilt::compared;
use capture_io::export::{ExportError, Picture, Raster};

/// Width and height of a picture in pixels.
const SIZE: u32 = 512;
/// Distance of the image plane over its height.
const FOCAL: f32 = 1.6;
/// Distance of the eye, over the actor's height.
const AWAY: f32 = 1.9;

/// Frames of a capture from the front, in any texture.
pub struct Views<'a> {
    surface: &'a Surface,
    poses: &'a [Vec<Vec3>],
    charts: &'a Charts,
}

impl<'a> Views<'a> {
    /// Of the poses `poses` over the vertices that `surface` draws.
    #[must_use]
    pub fn new(surface: &'a Surface, poses: &'a [Vec<Vec3>], charts: &'a Charts) -> Self {
        Self { surface, poses, charts }
    }

    /// Structural similarity and mean square error of two pictures of a frame, in the textures `original` and `rebuilt`
    /// (three values per active texel), over the pixels that the actor covers in part at least.
    ///
    /// # Errors
    /// A surface whose images cannot be drawn.
    pub fn compare(&self, frame: usize, original: &[f32], rebuilt: &[f32]) -> Result<(f64, f64), ExportError> {
        let [black, white] = [0.0, 1.0].map(|value| vec![value; original.len()]);
        let (black, white) = (self.draw(frame, &black)?, self.draw(frame, &white)?);
        let active: Vec<bool> = black.pixels().zip(white.pixels()).map(|(a, b)| a != b).collect();
        let seen = |image: &RgbImage| -> Vec<f32> {
            let pixels = image.pixels().zip(&active).filter(|(_, active)| **active);
            pixels.flat_map(|(pixel, _)| pixel.0.map(|value| f32::from(value) / 255.0)).collect()
        };
        let (original, rebuilt) = (seen(&self.draw(frame, original)?), seen(&self.draw(frame, rebuilt)?));
        Ok(compared(&Similarity::new(SIZE, &active), &original, rebuilt))
    }

    fn draw(&self, frame: usize, colours: &[f32]) -> Result<RgbImage, ExportError> {
        let (width, height) = (self.charts.width as u32, self.charts.height as u32);
        let mut texture = RgbImage::from_pixel(width, height, image::Rgb([128; 3]));
        for (&texel, colour) in self.charts.texels().iter().zip(colours.chunks_exact(3)) {
            let bytes = [0, 1, 2].map(|channel| (colour[channel].clamp(0.0, 1.0) * 255.0).round() as u8);
            texture.put_pixel(texel % width, texel / width, image::Rgb(bytes));
        }
        let mut bytes = Cursor::new(Vec::new());
        texture.write_to(&mut bytes, ImageFormat::Png).map_err(|cause| ExportError::Texture { image: 0, cause })?;
        let image = surface::Image { format: surface::ImageFormat::Png, width, height, bytes: bytes.into_inner() };
        let mut surface = self.surface.clone();
        surface.images.iter_mut().for_each(|slot| *slot = image.clone());
        let pose = &self.poses[frame];
        let corners: Vec<Vec3> = surface.corners.iter().map(|corner| pose[corner.vertex as usize]).collect();
        let (low, high) = pose.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(l, h), p| (l.min(*p), h.max(*p)));
        let (middle, tall) = (0.5 * (low + high), (high.y - low.y).max(0.1));
        let eye = middle + Vec3::new(0.35, 0.1, 0.93) * AWAY * tall;
        let picture = Picture { eye, at: middle, size: (SIZE, SIZE), focal: FOCAL };
        Ok(Raster::new(&surface)?.draw(&corners, &picture))
    }
}
