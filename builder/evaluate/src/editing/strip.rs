//! Pictures of poses beside each other, as the paper's figures are.

use glam::{Vec3, Vec3Swizzles};
use image::{Rgba, RgbaImage, imageops};
use kernels::align::centre_of_mass;

use super::shape::tall;
use crate::EvaluateError;
use crate::clay::{self, Camera, DOWN};
use crate::document::Picture;

/// The size of one pose in pixels.
const SIZE: [u32; 2] = [150, 200];

/// Clay; what was recorded is blue and what was edited green, as in the paper.
pub const CLAY: Vec3 = Vec3::new(0.55, 0.55, 0.55);
pub const RECORDED: Vec3 = Vec3::new(0.25, 0.40, 0.75);
pub const EDITED: Vec3 = Vec3::new(0.30, 0.62, 0.30);

/// The faces of a block by its corners, of which the first four are below, all round, and the others above them.
const FACES: [[u32; 3]; 12] = [
    [0, 1, 5],
    [0, 5, 4],
    [1, 2, 6],
    [1, 6, 5],
    [2, 3, 7],
    [2, 7, 6],
    [3, 0, 4],
    [3, 4, 7],
    [4, 5, 6],
    [4, 6, 7],
    [0, 2, 1],
    [0, 3, 2],
];

/// A pose and the colours of its vertices.
#[derive(Clone)]
pub struct Shown {
    pub pose: Vec<Vec3>,
    pub colours: Vec<Vec3>,
    /// By how much more it is turned than the others, about +Y in radians.
    pub turned: f32,
    /// Corners of a block that stands beside it, in the order of [`FACES`].
    pub block: Option<[Vec3; 8]>,
}

impl Shown {
    pub fn plain(pose: &[Vec3], colour: Vec3) -> Self {
        Self { pose: pose.to_vec(), colours: vec![colour; pose.len()], turned: 0.0, block: None }
    }

    /// From clay where it is as `from` to red where it is `most` metres away.
    pub fn heat(pose: &[Vec3], from: &[Vec3], most: f32) -> Self {
        let red = Vec3::new(0.85, 0.10, 0.05);
        let colours = pose.iter().zip(from).map(|(a, b)| CLAY.lerp(red, (a.distance(*b) / most).min(1.0))).collect();
        Self { pose: pose.to_vec(), colours, turned: 0.0, block: None }
    }

    /// Draws it as `camera` sees it.
    fn draw(&self, triangles: &[[u32; 3]], camera: &Camera) -> RgbaImage {
        let Some(block) = &self.block else { return clay::draw(&self.pose, triangles, &self.colours, camera) };
        // Each face has corners of its own: smooth edges are none.
        let first = self.pose.len() as u32;
        let corners = FACES.iter().flatten().map(|&corner| block[corner as usize]);
        let pose: Vec<Vec3> = self.pose.iter().copied().chain(corners).collect();
        let faces = (0..FACES.len() as u32).map(|face| [0, 1, 2].map(|k| first + 3 * face + k));
        let triangles: Vec<[u32; 3]> = triangles.iter().copied().chain(faces).collect();
        let mut colours = self.colours.clone();
        colours.resize(pose.len(), CLAY);
        clay::draw(&pose, &triangles, &colours, camera)
    }
}

/// Rows of poses, each seen from `heading` (about +Y, from +Z) about its own place over the ground; `floor` is how high that is.
pub fn strip(
    triangles: &[[u32; 3]],
    weights: &[f32],
    rows: &[Vec<Shown>],
    (heading, floor): (f32, f32),
    caption: String,
) -> Result<Picture, EvaluateError> {
    let [width, height] = SIZE;
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0).max(1) as u32;
    let size = [width * columns, height * rows.len().max(1) as u32];
    let mut picture = RgbaImage::from_pixel(size[0], size[1], Rgba([255, 255, 255, 255]));
    let body = rows.iter().flatten().map(|shown| tall(&shown.pose)).fold(0.5, f32::max);
    for (row, shown) in rows.iter().enumerate() {
        for (column, shown) in shown.iter().enumerate() {
            let middle = centre_of_mass(&shown.pose, weights).xz();
            let target = Vec3::new(middle.x, floor + 0.55 * body, middle.y);
            let camera = Camera { size: SIZE, heading: heading + shown.turned, target, height: 1.35 * body };
            let (left, top) = (width * column as u32, height * row as u32);
            let ground = height as f32 / 2.0 + 0.55 * body * height as f32 / camera.height * DOWN.cos();
            (0..width).for_each(|x| picture.put_pixel(left + x, top + ground as u32, Rgba([170, 200, 170, 255])));
            let drawn = shown.draw(triangles, &camera);
            imageops::overlay(&mut picture, &drawn, i64::from(left), i64::from(top));
        }
    }
    let png = clay::png(&picture).map_err(EvaluateError::Picture)?;
    Ok(Picture { png, size, caption })
}
