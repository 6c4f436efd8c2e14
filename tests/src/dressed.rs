//! A bundle with made-up appearance, and what its textures should be.
//!
//! The models are smooth waves over the actor's own atlas, with edges in the mean, so that every pass has something to do.

use actor::capture::{Capture, Poses};
use actor::files::Files;
use actor::pose_source::PoseSource;
use actor::surface::Surface;
use anyhow::{Context, Result};
use bundle::{
    AppearanceInput, AppearanceQuality, BundleInput, BundleReader, EncodeReport, Extras, ModeDecoder, ScannedFrames,
    encode_with_extras,
};
use glam::Vec3;
use texture::TextureModel;
use texture::basis::Mode;
use texture::dealign::Aligned;

use crate::scanned::scanned;

/// Modes of colours and of warps.
const MODES: [usize; 2] = [8, 4];

/// Texels of a `size` × `size` texture whose centres lie in a triangle of material 0.
#[must_use]
pub fn active_texels(surface: &Surface, size: usize) -> Vec<bool> {
    let mut active = vec![false; size * size];
    for part in surface.parts.iter().filter(|part| part.material == 0) {
        let range = part.first_triangle as usize..(part.first_triangle + part.triangle_count) as usize;
        for triangle in &surface.triangles[range] {
            fill(&mut active, size, triangle.map(|corner| surface.corners[corner as usize].uv));
        }
    }
    active
}

fn fill(active: &mut [bool], size: usize, uvs: [[f32; 2]; 3]) {
    let [a, b, c] = uvs.map(|uv| uv.map(|value| value * size as f32 - 0.5));
    let side = |p: [f32; 2], q: [f32; 2], x: f32, y: f32| (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0]);
    let range = |axis: usize| {
        let low = a[axis].min(b[axis]).min(c[axis]).ceil().max(0.0) as usize;
        let high = a[axis].max(b[axis]).max(c[axis]).floor().max(-1.0);
        low..((high + 1.0) as usize).min(size)
    };
    for y in range(1) {
        for x in range(0) {
            let (fx, fy) = (x as f32, y as f32);
            let sides = [side(a, b, fx, fy), side(b, c, fx, fy), side(c, a, fx, fy)];
            if sides.iter().all(|side| *side >= 0.0) || sides.iter().all(|side| *side <= 0.0) {
                active[y * size + x] = true;
            }
        }
    }
}

/// The models for a capture of `frame_count` frames.
#[must_use]
pub fn model(active: Vec<bool>, size: usize, frame_count: usize) -> TextureModel {
    let texels: Vec<[f32; 2]> = (0..size * size)
        .filter(|&at| active[at])
        .map(|at| [(at % size) as f32 / size as f32, (at / size) as f32 / size as f32])
        .collect();
    let wave = |index: usize, [x, y]: [f32; 2]| {
        let (fx, fy) = (5.0 + ((index * 37) % 17) as f32, 3.0 + ((index * 53) % 23) as f32);
        (fx * x + fy * y + index as f32).sin()
    };
    let unit = |mut mode: Vec<f32>| {
        let length = mode.iter().map(|value| f64::from(*value).powi(2)).sum::<f64>().sqrt() as f32;
        mode.iter_mut().for_each(|value| *value /= length.max(1e-9));
        mode
    };
    let modes = |count: usize, channels: usize, first: usize| -> Vec<Vec<f32>> {
        let of = |mode: usize| {
            let values = |texel: &[f32; 2]| {
                let texel = *texel;
                (0..channels).map(move |channel| wave(first + mode * channels + channel, texel)).collect::<Vec<_>>()
            };
            unit(texels.iter().flat_map(values).collect())
        };
        (0..count).map(of).collect()
    };
    let coefficients = |count: usize, channels: usize, scale: f32| -> Vec<f32> {
        let length = ((texels.len() * channels) as f32).sqrt();
        let of = |frame: usize, mode: usize| {
            (0.11 * frame as f32 * (1.0 + 0.4 * mode as f32) + mode as f32).sin() * scale * length / (1.0 + mode as f32)
        };
        (0..frame_count).flat_map(|frame| (0..count).map(move |mode| of(frame, mode))).collect()
    };
    let check = |texel: &[f32; 2]| {
        let [x, y] = texel.map(|value| (value * 24.0) as u32 % 2);
        let base = if x == y { 0.62 } else { 0.38 };
        [base + 0.1 * texel[0], base, base - 0.1 * texel[1]]
    };
    TextureModel {
        width: size as u32,
        height: size as u32,
        mean_texture: texels.iter().flat_map(check).collect(),
        textures: modes(MODES[0], 3, 0),
        mean_warp: texels.iter().flat_map(|texel| [wave(90, *texel), wave(91, *texel)]).collect(),
        warps: modes(MODES[1], 2, 40),
        texture_coefficients: coefficients(MODES[0], 3, 0.08),
        warp_coefficients: coefficients(MODES[1], 2, size as f32 / 300.0),
        active,
    }
}

/// The bundle, read and written again with appearance of `size` × `size` texels.
///
/// # Errors
/// A bundle that is not complete.
pub fn dress(bundle: &[u8], size: usize) -> Result<(Vec<u8>, EncodeReport)> {
    written_again(bundle, |capture| {
        let active = active_texels(&capture.surface, size);
        let aligned = model(active, size, capture.timeline.frame_count() as usize);
        // To compare with: the same colours, which nothing moves.
        let naive = TextureModel {
            mean_warp: vec![0.0; aligned.mean_warp.len()],
            warps: Vec::new(),
            warp_coefficients: Vec::new(),
            ..aligned.clone()
        };
        Ok((vec![aligned, naive], None))
    })
}

/// The bundle, read and written again with frames as if they had been scanned.
///
/// # Errors
/// A bundle that is not complete.
pub fn with_scans(bundle: &[u8]) -> Result<Vec<u8>> {
    let written = written_again(bundle, |capture| {
        let (triangles, frames) = (capture.topology.triangles(), capture.timeline.frame_count());
        let scanned = scanned(triangles, frames, |frame| Ok(capture.poses.frame(frame).to_vec()))?;
        Ok((Vec::new(), Some(scanned)))
    });
    written.map(|(bytes, _)| bytes)
}

/// The bundle, read and written again with what `more` says.
fn written_again(
    bundle: &[u8],
    more: impl Fn(&Capture) -> Result<(Vec<TextureModel>, Option<ScannedFrames>)>,
) -> Result<(Vec<u8>, EncodeReport)> {
    let mut reader = BundleReader::from_bytes(bundle)?;
    let missing = "the bundle is not complete";
    let meta = reader.meta().context(missing)?.clone();
    let timeline = reader.timeline().context(missing)?.clone();
    let topology = reader.topology().context(missing)?.clone();
    let mut surface = reader.surface().context(missing)?.clone();
    for (index, image) in surface.images.iter_mut().enumerate() {
        *image = reader.image(index).context(missing)?.clone();
    }
    let mut poses = Poses::new(topology.vertex_count());
    let mut pose = vec![Vec3::ZERO; topology.vertex_count()];
    for frame in 0..timeline.frame_count() {
        reader.read(frame, &mut pose)?;
        poses.push(&pose);
    }
    let capture = Capture { name: meta.name, topology, surface, timeline, poses, vertex_of_file_vertex: Vec::new() };
    let input = BundleInput {
        capture: &capture,
        graph: reader.graph().context(missing)?,
        first_frame: meta.first_frame,
        max_error: meta.max_error,
        poisson_order: reader.order(),
        generator: meta.generator,
    };
    let (models, scanned) = more(&capture)?;
    let looks: Vec<AppearanceInput> = models
        .iter()
        .map(|model| AppearanceInput { model, material: 0, quality: AppearanceQuality::default() })
        .collect();
    let mut extras = Extras::default();
    extras.scanned = scanned.as_ref();
    Ok(encode_with_extras(&input, &looks, &Files::default(), &extras)?)
}

/// All modes of a bundle, as the player reads them.
///
/// # Errors
/// A bundle without appearance, or a damaged mode.
pub fn modes(reader: &BundleReader) -> Result<[Vec<Mode>; 2]> {
    let appearance = reader.appearance().context("the bundle has no appearance")?;
    let mut modes = [Vec::new(), Vec::new()];
    let mut decoder = ModeDecoder::default();
    for ordinal in 0..appearance.section_count() {
        let (layer, _) = appearance.place(ordinal).context("no such mode")?;
        let bytes = reader.mode_bytes(ordinal).context("a mode is missing")?;
        let mode = decoder.advance(bytes, appearance, layer, usize::MAX);
        modes[layer].push(mode.map_err(anyhow::Error::msg)?.context("a mode is not complete")?);
    }
    Ok(modes)
}

/// The texture of frame `frame`: RGBA in sRGB, alpha 0 where nothing is active; at half the size, or after so many cycles
/// of Poisson reconstruction.
///
/// # Errors
/// As [`modes`].
pub fn texture(reader: &BundleReader, frame: u32, half: bool, cycles: usize) -> Result<Vec<u8>> {
    let appearance = reader.appearance().context("the bundle has no appearance")?;
    let modes = modes(reader)?;
    let rebuild = |layer: usize, side: usize| {
        let own = &appearance.layers[layer];
        own.rebuild(&appearance.mask, &modes[layer], &own.weights(frame, frame, 0.0), side)
    };
    let aligned = Aligned {
        texture: rebuild(0, if half { 8 } else { 16 }),
        warp: rebuild(1, 16),
        texel: if half { 2.0 } else { 1.0 },
        cell: (1 << appearance.layers[1].level) as f32,
        fill: [0.5; 3],
    };
    let byte = |value: f32| (value.clamp(0.0, 1.0) * 255.0).round() as u8;
    let colours = aligned.dealign(&appearance.mask, cycles);
    let pixels = colours.iter().zip(&aligned.texture.texels).flat_map(|(&[r, g, b], texel)| {
        let alpha = if texel[3] == 1.0 { 255 } else { 0 };
        [byte(r), byte(g), byte(b), alpha]
    });
    Ok(pixels.collect())
}
