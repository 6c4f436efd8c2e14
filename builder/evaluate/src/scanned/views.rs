//! A registered frame in its texture beside the scan's own frame: pictures of both, unlit, and how much they differ.

use capture_io::import::{ImportError, ScannedFrame};
use geometry::raster::Canvas;
use glam::{Quat, Vec2, Vec3, Vec3Swizzles};
use image::{Rgba, RgbaImage};
use registration::projection::Texture;
use texture::quality::{Similarity, mean_square_error, psnr};

use crate::clay::{Camera, DOWN};

/// Headings of the camera, radians: from the front of what stands along +Z, from both sides and from behind, all askew.
pub const HEADINGS: [f32; 4] = [0.3, 1.9, 3.5, 5.1];
/// Pixels of a picture.
pub const SIZE: [u32; 2] = [256, 384];
/// Samples along each side of a pixel.
const SAMPLES: usize = 2;

/// What is drawn: a mesh and where its colours come from.
pub struct Worn<'a> {
    frame: &'a ScannedFrame,
    texture: Option<Texture>,
}

/// A picture: a colour and how much of it is covered, 0 to 1, for every pixel, row by row.
pub struct Drawn {
    colours: Vec<Vec3>,
    covers: Vec<f32>,
}

/// How much two pictures differ where both are covered in full.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Mean square error of colours, 0 to 1.
    pub error: f64,
    /// Structural similarity.
    pub similarity: f64,
    /// Pixels that one alone covers, over those that either does.
    pub outline: f64,
}

impl Difference {
    /// Of what is drawn of `a` and of `b`.
    #[must_use]
    pub fn of(a: &Drawn, b: &Drawn) -> Self {
        let pairs = || a.covers.iter().zip(&b.covers);
        let active: Vec<bool> = pairs().map(|(a, b)| a.min(*b) >= 1.0).collect();
        let either = pairs().filter(|(a, b)| a.max(**b) > 0.5).count();
        let one = pairs().filter(|(a, b)| (**a > 0.5) != (**b > 0.5)).count();
        let seen = |drawn: &Drawn| -> Vec<f32> {
            let colours = drawn.colours.iter().zip(&active).filter(|(_, active)| **active);
            colours.flat_map(|(colour, _)| colour.to_array()).collect()
        };
        let (own, others) = (seen(a), seen(b));
        let similarity = Similarity::new(SIZE[0], &active).of(&own, &others);
        Self { error: mean_square_error(&own, &others), similarity, outline: one as f64 / either.max(1) as f64 }
    }

    /// The mean over several views, and the peak signal-to-noise ratio of the mean error, decibels.
    #[must_use]
    pub fn mean(all: &[Self]) -> (Self, f64) {
        let mean = |of: fn(&Self) -> f64| all.iter().map(of).sum::<f64>() / all.len().max(1) as f64;
        let error = mean(|d| d.error);
        (Self { error, similarity: mean(|d| d.similarity), outline: mean(|d| d.outline) }, psnr(error.max(1e-10)))
    }
}

impl<'a> Worn<'a> {
    /// `frame` in its own texture or colours.
    ///
    /// # Errors
    /// A texture that cannot be decoded.
    pub fn own(frame: &'a ScannedFrame) -> Result<Self, ImportError> {
        Self::in_texture_of(frame, frame)
    }

    /// `frame` in the texture of `other`, which has the same atlas.
    ///
    /// # Errors
    /// A texture that cannot be decoded.
    pub fn in_texture_of(frame: &'a ScannedFrame, other: &ScannedFrame) -> Result<Self, ImportError> {
        let texture = other.texture.as_ref().filter(|_| !frame.uvs.is_empty()).map(|texture| {
            let (width, height, texels) = texture.decoded()?;
            Ok::<_, ImportError>(Texture { width, height, texels })
        });
        Ok(Self { frame, texture: texture.transpose()? })
    }

    /// Whether it has colours at all.
    #[must_use]
    pub fn is_coloured(&self) -> bool {
        self.texture.is_some() || !self.frame.colours.is_empty()
    }

    /// Draws it without any light.
    #[must_use]
    pub fn draw(&self, camera: &Camera) -> Drawn {
        let [width, height] = camera.size.map(|side| side as usize * SAMPLES);
        let view = Quat::from_rotation_x(DOWN) * Quat::from_rotation_y(-camera.heading);
        let scale = height as f32 / camera.height;
        let seen = |point: &Vec3| {
            let p = view * (*point - camera.target);
            Vec3::new(width as f32 / 2.0 + p.x * scale, height as f32 / 2.0 - p.y * scale, p.z)
        };
        let places: Vec<Vec3> = self.frame.positions.iter().map(seen).collect();
        let mut canvas = Canvas::new((width, height), |_, _| Vec3::ZERO);
        for (k, corners) in self.frame.triangles.iter().enumerate() {
            let at = corners.map(|vertex| places[vertex as usize]);
            canvas.fill(at.map(Vec3::xy), at.map(|p| p.z), |weights, _| self.colour(k, weights));
        }
        let pixels = (0..camera.size[1]).flat_map(|y| (0..camera.size[0]).map(move |x| (x, y)));
        let of = |(x, y)| {
            let covered = canvas.pixel(x, y, SAMPLES).filter(|&(_, covered)| covered);
            let (sum, count) = covered.fold((Vec3::ZERO, 0.0_f32), |(sum, n), (colour, _)| (sum + colour, n + 1.0));
            (sum / count.max(1.0), count / (SAMPLES * SAMPLES) as f32)
        };
        let (colours, covers) = pixels.map(of).unzip();
        Drawn { colours, covers }
    }

    fn colour(&self, triangle: usize, weights: Vec3) -> Vec3 {
        if let (Some(texture), Some([a, b, c])) = (&self.texture, self.frame.uvs.get(triangle)) {
            let uv: Vec2 = *a * weights.x + *b * weights.y + *c * weights.z;
            return texture.at(uv) / 255.0;
        }
        let colour = |vertex: u32| -> Vec3 {
            let colour = self.frame.colours.get(vertex as usize).copied().unwrap_or([128; 4]);
            Vec3::new(f32::from(colour[0]), f32::from(colour[1]), f32::from(colour[2])) / 255.0
        };
        let [a, b, c] = self.frame.triangles[triangle].map(colour);
        a * weights.x + b * weights.y + c * weights.z
    }
}

impl Drawn {
    /// As a picture on white.
    #[must_use]
    pub fn picture(&self) -> RgbaImage {
        RgbaImage::from_fn(SIZE[0], SIZE[1], |x, y| {
            let k = (y * SIZE[0] + x) as usize;
            let colour = Vec3::ONE.lerp(self.colours[k], self.covers[k]);
            let [r, g, b] = colour.to_array().map(|c| (c.clamp(0.0, 1.0) * 255.0).round() as u8);
            Rgba([r, g, b, 255])
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square whose left side is of one colour and its right side of another.
    fn square(left: [u8; 4], right: [u8; 4]) -> ScannedFrame {
        let positions = [(-0.5, 0.0), (0.5, 0.0), (0.5, 1.5), (-0.5, 1.5)].map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec();
        let colours = vec![left, right, right, left];
        ScannedFrame { positions, triangles: vec![[0, 1, 2], [0, 2, 3]], colours, ..ScannedFrame::default() }
    }

    #[test]
    fn what_is_the_same_differs_in_nothing_and_what_is_not_does() {
        let (grey, red) = ([90, 90, 90, 255], [200, 90, 90, 255]);
        let plain = square(grey, grey);
        let camera = Camera::framing(&plain.positions, SIZE, 0.0);
        let drawn = |frame: &ScannedFrame| Worn::own(frame).unwrap().draw(&camera);
        let same = Difference::of(&drawn(&plain), &drawn(&plain));
        assert_eq!((same.error, same.outline), (0.0, 0.0));
        assert!((same.similarity - 1.0).abs() < 1e-6);
        // One channel of three is off by 110 of 255 at one side and by nothing at the other.
        let other = Difference::of(&drawn(&plain), &drawn(&square(grey, red)));
        let wanted = (110.0_f64 / 255.0).powi(2) / 3.0 / 3.0;
        assert!((other.error / wanted - 1.0).abs() < 0.02, "{} for {wanted}", other.error);
        assert!(other.similarity < 0.999);
        // Half as wide: half of what the wider one covers is covered by it alone.
        let mut narrow = square(grey, grey);
        narrow.positions.iter_mut().for_each(|p| p.x *= 0.5);
        let outline = Difference::of(&drawn(&plain), &drawn(&narrow)).outline;
        assert!((outline - 0.5).abs() < 0.01, "{outline}");
    }
}
