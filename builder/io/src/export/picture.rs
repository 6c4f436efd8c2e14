//! Pictures of the actor, drawn in software: textured triangles with perspective, four samples a pixel, a soft shadow on the
//! ground. It runs anywhere and gives the same pictures everywhere.

use actor::surface::{Image, Surface};
use glam::{FloatExt, Vec2, Vec3};
use image::{Rgb, RgbImage, RgbaImage};

use super::error::ExportError;
use geometry::raster::Canvas;

/// Samples along each side of a pixel.
const OVER: usize = 2;
/// Nearer than this nothing is drawn, in metres.
const NEAR: f32 = 0.05;

/// Where the camera stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Picture {
    /// The eye, in metres.
    pub eye: Vec3,
    /// What it looks at.
    pub at: Vec3,
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// Distance of the image plane over its height.
    pub focal: f32,
}

/// Draws one mesh again and again.
pub struct Raster<'a> {
    surface: &'a Surface,
    textures: Vec<RgbaImage>,
}

/// A corner as the camera sees it.
#[derive(Clone, Copy, Debug)]
struct Seen {
    /// In samples, from the top left.
    place: Vec2,
    /// One over the distance along the view.
    inverse: f32,
    uv: Vec2,
    colour: Vec3,
}

impl<'a> Raster<'a> {
    /// A rasteriser of a surface, whose textures are decoded once.
    ///
    /// # Errors
    /// A texture that cannot be decoded.
    pub fn new(surface: &'a Surface) -> Result<Self, ExportError> {
        let images = surface.images.iter().enumerate();
        let textures = images.map(|(image, encoded)| decode(image, encoded)).collect::<Result<_, _>>()?;
        Ok(Self { surface, textures })
    }

    /// Draws the surface with its corners at `positions`, in metres.
    #[must_use]
    pub fn draw(&self, positions: &[Vec3], picture: &Picture) -> RgbImage {
        self.draw_in(positions, picture, None)
    }

    /// As [`Self::draw`], the material of this index in this texture instead of its own.
    pub(super) fn draw_in(
        &self,
        positions: &[Vec3],
        picture: &Picture,
        changed: Option<(u32, &RgbaImage)>,
    ) -> RgbImage {
        let (width, height) = (picture.size.0 as usize * OVER, picture.size.1 as usize * OVER);
        let view = View::new(picture, width, height);
        let shade = Shade::under(positions);
        let mut canvas = Canvas::new((width, height), |x, y| view.background(x, y, &shade));
        for part in &self.surface.parts {
            let Some(material) = self.surface.materials.get(part.material as usize) else { continue };
            let own = || material.image.and_then(|image| self.textures.get(image as usize));
            let texture = match changed {
                Some((changed, texture)) if changed == part.material => Some(texture),
                _ => own(),
            };
            let tint = Vec3::from_slice(&material.base_colour[..3]).max(Vec3::ZERO).powf(1.0 / 2.2);
            for triangle in self.surface.triangles_of(part) {
                let points = triangle.map(|corner| positions[corner as usize]);
                let normal = (points[1] - points[0]).cross(points[2] - points[0]).normalize_or_zero();
                // Captured textures hold their light; what has none gets a plain one from the front and above.
                let light = if texture.is_some() { 1.0 } else { 0.55 + 0.45 * normal.dot(view.light()).max(0.0) };
                let corners = [0, 1, 2].map(|k| {
                    let corner = self.surface.corners[triangle[k] as usize];
                    let colour = Vec3::from([0, 1, 2].map(|axis| f32::from(corner.colour[axis]) / 255.0));
                    view.see(points[k], corner.uv.into(), colour * tint * light)
                });
                if let [Some(a), Some(b), Some(c)] = corners {
                    fill(&mut canvas, [a, b, c], texture);
                }
            }
        }
        RgbImage::from_fn(picture.size.0, picture.size.1, |x, y| resolve(canvas.pixel(x, y, OVER)))
    }
}

/// An image of a bundle, decoded.
pub(super) fn decode(image: usize, encoded: &Image) -> Result<RgbaImage, ExportError> {
    let decoded = image::load_from_memory(&encoded.bytes);
    decoded.map(|decoded| decoded.to_rgba8()).map_err(|cause| ExportError::Texture { image, cause })
}

struct View {
    eye: Vec3,
    right: Vec3,
    up: Vec3,
    forward: Vec3,
    scale: f32,
    centre: Vec2,
}

impl View {
    fn new(picture: &Picture, width: usize, height: usize) -> Self {
        let forward = (picture.at - picture.eye).normalize_or(Vec3::NEG_Z);
        let right = forward.cross(Vec3::Y).normalize_or(Vec3::X);
        let up = right.cross(forward);
        let scale = picture.focal * height as f32;
        Self { eye: picture.eye, right, up, forward, scale, centre: Vec2::new(width as f32, height as f32) / 2.0 }
    }

    fn light(&self) -> Vec3 {
        (0.8 * self.up - 0.6 * self.forward + 0.3 * self.right).normalize_or(Vec3::Y)
    }

    fn see(&self, point: Vec3, uv: Vec2, colour: Vec3) -> Option<Seen> {
        let from_eye = point - self.eye;
        let distance = from_eye.dot(self.forward);
        if distance < NEAR {
            return None;
        }
        let flat = Vec2::new(from_eye.dot(self.right), -from_eye.dot(self.up));
        Some(Seen { place: self.centre + flat * (self.scale / distance), inverse: 1.0 / distance, uv, colour })
    }

    /// The ground with the actor's shadow and a metre grid, fading into a plain backdrop.
    fn background(&self, x: usize, y: usize, shade: &Shade) -> Vec3 {
        let offset = (Vec2::new(x as f32 + 0.5, y as f32 + 0.5) - self.centre) / self.scale;
        let ray = self.forward + offset.x * self.right - offset.y * self.up;
        let backdrop = 0.90;
        if ray.y > -1e-4 {
            return Vec3::splat(backdrop);
        }
        let distance = -self.eye.y / ray.y;
        let ground = self.eye + ray * distance;
        let near = (-0.08 * distance * distance).exp();
        let line = [ground.x, ground.z].map(|v| (v - v.round()).abs()).into_iter().fold(1.0, f32::min);
        let grid = if line < 0.012 { 0.05 * near } else { 0.0 };
        let value = backdrop - 0.06 * near - grid - 0.35 * shade.at(Vec2::new(ground.x, ground.z));
        Vec3::new(value, value, value + 0.01)
    }
}

/// How much of the sky the actor hides from the ground: counted in cells under it, blurred.
struct Shade {
    low: Vec2,
    side: usize,
    cells: Vec<f32>,
}

const SHADE_CELL: f32 = 0.04;

impl Shade {
    fn under(positions: &[Vec3]) -> Self {
        let flat = |p: &Vec3| Vec2::new(p.x, p.z);
        let low = positions.iter().map(flat).reduce(Vec2::min).unwrap_or_default() - 0.4;
        let high = positions.iter().map(flat).reduce(Vec2::max).unwrap_or_default() + 0.4;
        let side = (((high - low).max_element() / SHADE_CELL).ceil() as usize).clamp(1, 512);
        let mut cells = vec![0.0_f32; side * side];
        for position in positions {
            let cell = (flat(position) - low) / SHADE_CELL;
            let (x, z) = (cell.x.max(0.0) as usize, cell.y.max(0.0) as usize);
            if x < side && z < side {
                // What is near the ground darkens it most.
                let dark = (-2.5 * position.y.max(0.0)).exp();
                cells[z * side + x] = cells[z * side + x].max(dark);
            }
        }
        let mut shade = Self { low, side, cells };
        (0..2).for_each(|_| shade.blur());
        shade
    }

    fn blur(&mut self) {
        for (step, rows) in [(1, self.side), (self.side, 1)] {
            let before = self.cells.clone();
            for line in 0..self.side {
                for k in 0..self.side {
                    let from = k.saturating_sub(3);
                    let to = (k + 4).min(self.side);
                    let sum: f32 = (from..to).map(|j| before[line * rows + j * step]).sum();
                    self.cells[line * rows + k * step] = sum / 7.0;
                }
            }
        }
    }

    fn at(&self, ground: Vec2) -> f32 {
        let cell = (ground - self.low) / SHADE_CELL;
        if cell.x < 0.0 || cell.y < 0.0 {
            return 0.0;
        }
        let cell = (cell - 0.5).max(Vec2::ZERO);
        let (x, z, share) = (cell.x as usize, cell.y as usize, cell.fract());
        if x + 1 >= self.side || z + 1 >= self.side {
            return 0.0;
        }
        let row = |z: usize| self.cells[z * self.side + x].lerp(self.cells[z * self.side + x + 1], share.x);
        row(z).lerp(row(z + 1), share.y)
    }
}

/// Draws both sides of a triangle. What is linear on it is linear in the picture once divided by the distance.
fn fill(canvas: &mut Canvas, [a, b, c]: [Seen; 3], texture: Option<&RgbaImage>) {
    let inverses = [a.inverse, b.inverse, c.inverse];
    canvas.fill([a.place, b.place, c.place], inverses, |weights, inverse| {
        let share = Vec3::from(inverses) * weights / inverse;
        let shown = a.colour * share.x + b.colour * share.y + c.colour * share.z;
        texture.map_or(shown, |texture| shown * texel(texture, a.uv * share.x + b.uv * share.y + c.uv * share.z))
    });
}

/// The mean of a pixel's samples.
fn resolve(samples: impl Iterator<Item = (Vec3, bool)>) -> Rgb<u8> {
    let sum: Vec3 = samples.map(|(colour, _)| colour).sum();
    Rgb(sum.to_array().map(|value| (value / (OVER * OVER) as f32 * 255.0 + 0.5).clamp(0.0, 255.0) as u8))
}

/// A texture's colour between its four nearest texels, repeated beyond its edges.
fn texel(texture: &RgbaImage, uv: Vec2) -> Vec3 {
    let (width, height) = (texture.width(), texture.height());
    let place = uv * Vec2::new(width as f32, height as f32) - 0.5;
    let floor = place.floor();
    let share = place - floor;
    let at = |dx: i64, dy: i64| {
        let x = (floor.x as i64 + dx).rem_euclid(i64::from(width)) as u32;
        let y = (floor.y as i64 + dy).rem_euclid(i64::from(height)) as u32;
        let [r, g, b, _] = texture.get_pixel(x, y).0;
        Vec3::new(f32::from(r), f32::from(g), f32::from(b)) / 255.0
    };
    at(0, 0).lerp(at(1, 0), share.x).lerp(at(0, 1).lerp(at(1, 1), share.x), share.y)
}
