//! Small pictures of a pose in clay, coloured vertex by vertex, for reports.

use glam::{Quat, Vec3, Vec3Swizzles};
use image::{ImageError, ImageFormat, RgbaImage};

use geometry::raster::Canvas;

/// How a pose is looked at: from afar, along a direction in the ground plane, slightly from above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Width and height of the picture in pixels.
    pub size: [u32; 2],
    /// Where the camera is, as an angle about +Y from +Z in radians.
    pub heading: f32,
    /// The point in the middle of the picture, in metres.
    pub target: Vec3,
    /// Height of the picture in metres.
    pub height: f32,
}

/// Samples along each side of a pixel.
const SAMPLES: usize = 2;
/// How far the camera looks down, in radians.
pub const DOWN: f32 = 0.18;

impl Camera {
    /// A camera that frames `pose` from `heading`.
    #[must_use]
    pub fn framing(pose: &[Vec3], size: [u32; 2], heading: f32) -> Self {
        let low = pose.iter().copied().fold(Vec3::INFINITY, Vec3::min);
        let high = pose.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
        let aspect = size[0] as f32 / size[1].max(1) as f32;
        let wide = (high - low).x.hypot((high - low).z);
        Self { size, heading, target: (low + high) / 2.0, height: (high.y - low.y).max(wide / aspect) * 1.12 }
    }
}

/// The pose as a picture with a transparent ground; `colours` are linear, one per vertex.
#[must_use]
pub fn draw(pose: &[Vec3], triangles: &[[u32; 3]], colours: &[Vec3], camera: &Camera) -> RgbaImage {
    let [width, height] = camera.size.map(|side| side as usize * SAMPLES);
    let view = Quat::from_rotation_x(DOWN) * Quat::from_rotation_y(-camera.heading);
    let scale = height as f32 / camera.height;
    // x to the right and y down in samples, z towards the camera in metres.
    let seen: Vec<Vec3> = pose
        .iter()
        .map(|point| {
            let p = view * (*point - camera.target);
            Vec3::new(width as f32 / 2.0 + p.x * scale, height as f32 / 2.0 - p.y * scale, p.z)
        })
        .collect();
    let normals = normals(pose, triangles);
    let light = (view.conjugate() * Vec3::new(-0.4, 0.7, 0.8)).normalize();
    let lit: Vec<Vec3> = normals
        .iter()
        .zip(colours)
        .map(|(normal, colour)| *colour * (0.30 + 0.70 * normal.dot(light).max(0.0) + 0.08 * normal.y))
        .collect();
    let mut canvas = Canvas::new((width, height), |_, _| Vec3::ZERO);
    for corners in triangles {
        let at = corners.map(|vertex| seen[vertex as usize]);
        let [a, b, c] = corners.map(|vertex| lit[vertex as usize]);
        canvas.fill(at.map(Vec3::xy), at.map(|p| p.z), |weights, _| a * weights.x + b * weights.y + c * weights.z);
    }
    RgbaImage::from_fn(camera.size[0], camera.size[1], |x, y| resolve(canvas.pixel(x, y, SAMPLES)))
}

/// The bytes of a picture as a PNG file.
///
/// # Errors
/// A picture without pixels.
pub fn png(picture: &RgbaImage) -> Result<Vec<u8>, ImageError> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut bytes, ImageFormat::Png)?;
    Ok(bytes.into_inner())
}

/// Unit normals of the vertices, weighted by area.
fn normals(pose: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let mut normals = vec![Vec3::ZERO; pose.len()];
    for corners in triangles {
        let [a, b, c] = corners.map(|vertex| pose[vertex as usize]);
        let normal = (b - a).cross(c - a);
        corners.iter().for_each(|&vertex| normals[vertex as usize] += normal);
    }
    normals.into_iter().map(Vec3::normalize_or_zero).collect()
}

/// The mean of a pixel's covered samples, in sRGB, and how much of it is covered.
fn resolve(samples: impl Iterator<Item = (Vec3, bool)>) -> image::Rgba<u8> {
    let (mut sum, mut covered) = (Vec3::ZERO, 0.0);
    for (colour, _) in samples.filter(|&(_, covered)| covered) {
        sum += colour;
        covered += 1.0;
    }
    let mean = sum / f32::max(covered, 1.0);
    let encode = |linear: f32| (linear.clamp(0.0, 1.0).powf(1.0 / 2.2) * 255.0).round() as u8;
    let alpha = (covered / (SAMPLES * SAMPLES) as f32 * 255.0).round() as u8;
    image::Rgba([encode(mean.x), encode(mean.y), encode(mean.z), alpha])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearer_triangle_covers() {
        let square =
            |z: f32, s: f32| [Vec3::new(-s, -s, z), Vec3::new(s, -s, z), Vec3::new(s, s, z), Vec3::new(-s, s, z)];
        let pose: Vec<Vec3> = square(0.0, 1.0).into_iter().chain(square(0.5, 0.4)).collect();
        let triangles = [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]];
        let colours = [[Vec3::X; 4], [Vec3::Y; 4]].concat();
        let camera = Camera { size: [64, 64], heading: 0.0, target: Vec3::ZERO, height: 4.0 };
        let picture = draw(&pose, &triangles, &colours, &camera);
        let [middle, side, corner] = [(32, 32), (20, 32), (1, 1)].map(|(x, y)| picture.get_pixel(x, y).0);
        assert!(middle[1] > 100 && middle[0] == 0, "{middle:?}");
        assert!(side[0] > 100 && side[1] == 0, "{side:?}");
        assert_eq!(corner[3], 0);
        // From behind, the farther one is in front.
        let behind = draw(&pose, &triangles, &colours, &Camera { heading: std::f32::consts::PI, ..camera });
        assert!(behind.get_pixel(32, 32).0[0] > 0 && behind.get_pixel(32, 32).0[1] == 0);
        assert!(png(&picture).unwrap().starts_with(b"\x89PNG"));
    }
}
