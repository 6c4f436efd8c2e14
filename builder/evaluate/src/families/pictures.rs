//! Samples frame by frame, to be looked at.

use family::{Recorded, Sample};
use glam::Vec3;
use image::{Rgba, RgbaImage, imageops};

use crate::EvaluateError;
use crate::clay::{self, Camera, DOWN};
use crate::document::Picture;

/// Frames of a strip, and the size of one in pixels.
const FRAMES: usize = 12;
const SIZE: [u32; 2] = [130, 180];

/// A strip a sample, seen from the side at the same phases.
pub fn strips(recorded: &Recorded, samples: &[Sample], caption: String) -> Result<Picture, EvaluateError> {
    let [width, height] = SIZE;
    let mut picture =
        RgbaImage::from_pixel(width * FRAMES as u32, height * samples.len() as u32, Rgba([255, 255, 255, 255]));
    for (row, sample) in samples.iter().enumerate() {
        let count = sample.poses.len();
        let (first, last) = (recorded.centre(&sample.poses[0]), recorded.centre(&sample.poses[count - 1]));
        let way = last - first;
        let heading = way.x.atan2(way.y) + std::f32::consts::FRAC_PI_2;
        // Recorded is grey, and the more of both there is, the more it is red.
        let mixed = 4.0 * sample.lambda * (1.0 - sample.lambda);
        let colour = Vec3::splat(0.55).lerp(Vec3::new(0.8, 0.3, 0.2), mixed);
        for column in 0..FRAMES {
            let frame = if sample.cyclic { column * count / FRAMES } else { column * (count - 1) / (FRAMES - 1) };
            let pose = &sample.poses[frame];
            let middle = recorded.centre(pose);
            let tall = recorded.body();
            let target = Vec3::new(middle.x, sample.floor + 0.6 * tall, middle.y);
            let camera = Camera { size: SIZE, heading, target, height: 1.5 * tall };
            let (left, top) = (width * column as u32, height * row as u32);
            let ground = height as f32 / 2.0 + 0.6 * tall * height as f32 / camera.height * DOWN.cos();
            (0..width).for_each(|x| picture.put_pixel(left + x, top + ground as u32, Rgba([170, 200, 170, 255])));
            let drawn = clay::draw(pose, recorded.topology.triangles(), &vec![colour; pose.len()], &camera);
            imageops::overlay(&mut picture, &drawn, i64::from(left), i64::from(top));
        }
    }
    let png = clay::png(&picture).map_err(EvaluateError::Picture)?;
    Ok(Picture { png, size: [picture.width(), picture.height()], caption })
}
