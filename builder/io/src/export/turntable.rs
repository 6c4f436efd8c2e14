//! A walk as pictures, from a camera that follows the actor and turns about it.

use std::f32::consts::TAU;

use glam::Vec3;
use image::ExtendedColorType;
use rayon::prelude::*;
use synthesis::FrameKind;

use super::error::ExportError;
use super::frame_textures::AT_ONCE;
use super::output::{FramePattern, write_whole};
use super::picture::{Picture, Raster};
use super::play::Played;
use super::{Actor, ExportOptions, bounds};
use crate::png;
use job::Job;

/// How much of the way to the actor the camera goes in a second, on a logarithmic scale: it does not shake with its steps.
const FOLLOW: f32 = 3.0;
/// Share of the picture's height that the actor fills.
const FILL: f32 = 0.72;
/// Distance of the image plane over its height: a long lens.
const FOCAL: f32 = 1.6;

/// A picture that is still to be drawn.
struct Due {
    number: u32,
    kind: FrameKind,
    positions: Vec<Vec3>,
    picture: Picture,
}

/// Writes all pictures.
pub(super) fn write(
    actor: &Actor,
    played: &mut Played,
    pattern: &FramePattern,
    options: &ExportOptions,
    job: &Job,
) -> Result<u32, ExportError> {
    pattern.make_folder()?;
    let raster = Raster::new(&actor.surface)?;
    let seconds = options.every.max(1) as f32 / actor.fps;
    let mut follow: Option<(Vec3, f32)> = None;
    let mut due: Vec<Due> = Vec::new();
    let frames = played.each(options.every, ("pictures", job), |shown| {
        let positions = actor.corners(shown.pose);
        let (middle, height) = extent(&positions);
        let (at, tall) = follow.map_or((middle, height), |(at, tall)| {
            let share = 1.0 - (-FOLLOW * seconds).exp();
            (at.lerp(middle, share), tall.max(height))
        });
        follow = Some((at, tall));
        let angle = 0.6 + TAU * shown.number as f32 * seconds / options.turn_seconds;
        let distance = tall.max(0.01) / FILL * FOCAL;
        let eye = at + distance * Vec3::new(angle.sin(), 0.18, angle.cos());
        let picture = Picture { eye, at, size: options.size, focal: FOCAL };
        due.push(Due { number: shown.number, kind: shown.kind, positions, picture });
        if due.len() < AT_ONCE { Ok(()) } else { draw(actor, &raster, pattern, std::mem::take(&mut due)) }
    })?;
    draw(actor, &raster, pattern, due)?;
    Ok(frames)
}

/// Draws and writes pictures, in parallel.
fn draw(actor: &Actor, raster: &Raster, pattern: &FramePattern, due: Vec<Due>) -> Result<(), ExportError> {
    let one = |due: &Due| {
        let texture = actor.textures.as_ref().map(|textures| (textures.material, textures.of_frame(due.kind)));
        let changed = texture.as_ref().map(|(material, texture)| (*material, texture));
        let image = raster.draw_in(&due.positions, &due.picture, changed);
        let file = pattern.file(due.number);
        let encoded = png::encode(&image, [image.width(), image.height()], ExtendedColorType::Rgb8);
        write_whole(&file, &encoded.map_err(|cause| ExportError::Picture { file: file.clone(), cause })?)
    };
    due.par_iter().map(one).collect()
}

/// Middle of the box that the actor fills, and how tall or wide it is.
fn extent(positions: &[Vec3]) -> (Vec3, f32) {
    let (low, high) = bounds(positions);
    let size = high - low;
    ((low + high) / 2.0, size.y.max(0.8 * size.x.max(size.z)))
}
