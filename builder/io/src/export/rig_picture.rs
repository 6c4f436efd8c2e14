//! A picture of a rig: the surface in its rest pose from the front and from the side, coloured by bones, joints on top.

use editing::Rig;
use geometry::raster::Canvas;
use glam::{Quat, Vec2, Vec3};
use image::ExtendedColorType;

use super::error::ExportError;
use crate::png;

/// Samples along each side of a pixel.
const OVER: usize = 2;
/// Width and height of each of the two views in pixels.
const VIEW: [usize; 2] = [600, 800];
/// Share of a view that the body fills.
const FILL: f32 = 0.9;

/// A PNG file of `rig` over `triangles`, which turns its front, the way `facing` (X, Z), to the first view.
///
/// # Errors
/// A picture that cannot be encoded.
pub fn rig_picture(rig: &Rig, triangles: &[[u32; 3]], facing: Vec2) -> Result<Vec<u8>, ExportError> {
    let size = (2 * VIEW[0] * OVER, VIEW[1] * OVER);
    let mut canvas = Canvas::new(size, |_, _| Vec3::splat(0.94));
    let to_front = Quat::from_rotation_y(-facing.x.atan2(facing.y));
    for (column, turn) in
        [to_front, Quat::from_rotation_y(-std::f32::consts::FRAC_PI_2) * to_front].into_iter().enumerate()
    {
        let view = View::new(rig, turn, column);
        view.surface(&mut canvas, rig, triangles);
        view.bones(&mut canvas, rig);
    }
    let [width, height] = [2 * VIEW[0] as u32, VIEW[1] as u32];
    let texels: Vec<u8> = (0..height)
        .flat_map(|y| (0..width).map(move |x| (x, y)))
        .flat_map(|(x, y)| {
            let sum: Vec3 = canvas.pixel(x, y, OVER).map(|(colour, _)| colour).sum();
            sum.to_array().map(|value| (value / (OVER * OVER) as f32 * 255.0 + 0.5).clamp(0.0, 255.0) as u8)
        })
        .collect();
    png::encode(&texels, [width, height], ExtendedColorType::Rgb8).map_err(ExportError::RigPicture)
}

/// One view, without perspective.
struct View {
    turn: Quat,
    middle: Vec3,
    scale: f32,
    centre: Vec2,
}

impl View {
    fn new(rig: &Rig, turn: Quat, column: usize) -> Self {
        let seen = || rig.rest().iter().map(|&point| turn * point);
        let (low, high) = (seen().reduce(Vec3::min).unwrap_or_default(), seen().reduce(Vec3::max).unwrap_or_default());
        let extent = (high - low).max(Vec3::splat(1e-6));
        let [width, height] = VIEW.map(|side| (side * OVER) as f32);
        let scale = FILL * (width / extent.x).min(height / extent.y);
        let centre = Vec2::new((column as f32 + 0.5) * width, 0.5 * height);
        Self { turn, middle: 0.5 * (low + high), scale, centre }
    }

    /// Where a point is in samples, and how near.
    fn see(&self, point: Vec3) -> (Vec2, f32) {
        let seen = self.turn * point - self.middle;
        (self.centre + Vec2::new(seen.x, -seen.y) * self.scale, seen.z)
    }

    fn surface(&self, canvas: &mut Canvas, rig: &Rig, triangles: &[[u32; 3]]) {
        let colours: Vec<Vec3> = rig
            .influences()
            .iter()
            .map(|own| own.joints.iter().zip(&own.weights).map(|(&bone, &weight)| colour(bone as usize) * weight).sum())
            .collect();
        for triangle in triangles {
            let points = triangle.map(|v| rig.rest()[v as usize]);
            let normal = self.turn * (points[1] - points[0]).cross(points[2] - points[0]).normalize_or_zero();
            let light = 0.6 + 0.4 * normal.z.abs();
            let seen = points.map(|point| self.see(point));
            let own = triangle.map(|v| colours[v as usize]);
            canvas.fill(seen.map(|(place, _)| place), seen.map(|(_, near)| near), |weights, _| {
                (own[0] * weights.x + own[1] * weights.y + own[2] * weights.z) * light
            });
        }
    }

    /// Bones as lines from joint to joint and joints as dots, in front of everything.
    fn bones(&self, canvas: &mut Canvas, rig: &Rig) {
        let front = 1e6;
        for bone in &rig.bones()[1..] {
            let ([from, to], side) = ([rig.bones()[bone.parent].joint, bone.joint].map(|p| self.see(p).0), 2.0);
            let across = (to - from).perp().normalize_or_zero() * side;
            for corners in [[from - across, from + across, to + across], [from - across, to + across, to - across]] {
                canvas.fill(corners, [front; 3], |_, _| Vec3::splat(0.15));
            }
        }
        for (index, bone) in rig.bones().iter().enumerate() {
            let place = self.see(bone.joint).0;
            for (radius, near, shown) in [(9.0, 1.0, Vec3::splat(0.1)), (6.0, 2.0, colour(index).lerp(Vec3::ONE, 0.4))]
            {
                let corner = |k: usize| place + radius * Vec2::from_angle(k as f32 * std::f32::consts::FRAC_PI_4);
                for k in 0..8 {
                    canvas.fill([place, corner(k), corner(k + 1)], [front + near; 3], |_, _| shown);
                }
            }
        }
    }
}

/// A colour for each bone, neighbours far apart.
fn colour(bone: usize) -> Vec3 {
    let hue = (bone as f32 * 0.618_034).fract() * std::f32::consts::TAU;
    let channel = |k: f32| 0.62 + 0.3 * (hue + k * std::f32::consts::TAU / 3.0).cos();
    Vec3::new(channel(0.0), channel(1.0), channel(2.0))
}
