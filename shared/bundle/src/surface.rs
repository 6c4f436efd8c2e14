//! The surface section: triangles, corners, alignment weights, parts, materials, and what the images are.

use serde::{Deserialize, Serialize};

use super::entropy::binary::{Bit, Decoder, Encoder, MOST_DECISIONS_PER_BYTE};
use super::entropy::numbers::Number;
use super::error::BundleError;
use super::kind::SectionKind;
use super::limits::{MAX_IMAGES, MAX_MATERIALS};
use super::meta::Meta;
use super::triangles;
use actor::surface::{Corner, Image, ImageFormat, Material, Part, Surface};
use kernels::topology::Topology;

/// Texture coordinates and weights are rounded to this many steps of their range.
const STEPS: f64 = 65535.0;

/// What postcard stores of the surface, in front of what is entropy coded.
#[derive(Serialize, Deserialize)]
struct Head {
    parts: Vec<Part>,
    materials: Vec<Material>,
    images: Vec<ImageHead>,
    /// Least texture coordinate and extent, of u and of v.
    uv_range: [(f32, f32); 2],
    has_colours: bool,
}

#[derive(Serialize, Deserialize)]
struct ImageHead {
    format: ImageFormat,
    width: u32,
    height: u32,
}

#[derive(Default)]
struct Models {
    vertex: Number,
    uv: [Number; 2],
    same_colour: Bit,
    colour: [Number; 4],
    weight: Number,
}

/// The section's bytes.
pub(super) fn encode(surface: &Surface, topology: &Topology) -> Result<Vec<u8>, postcard::Error> {
    let uv_range = [0, 1].map(|axis| range(surface.corners.iter().map(|corner| corner.uv[axis])));
    let images = surface.images.iter();
    let head = Head {
        parts: surface.parts.clone(),
        materials: surface.materials.clone(),
        images: images.map(|i| ImageHead { format: i.format, width: i.width, height: i.height }).collect(),
        uv_range,
        has_colours: surface.corners.iter().any(|corner| corner.colour != [255; 4]),
    };
    let mut bytes = postcard::to_stdvec(&head)?;
    let mut encoder = Encoder::default();
    triangles::encode(&mut encoder, &surface.triangles);
    let mut models = Models::default();
    encode_corners(&mut encoder, &mut models, surface, &head);
    encode_weights(&mut encoder, &mut models, topology.weights());
    bytes.extend(encoder.finish());
    Ok(bytes)
}

/// Reads the section; the surface's images have no bytes yet.
pub(super) fn decode(bytes: &[u8], meta: &Meta) -> Result<(Topology, Surface), BundleError> {
    let wrong = |reason: String| BundleError::section(SectionKind::Surface, reason);
    let (head, coded) = postcard::take_from_bytes::<Head>(bytes).map_err(|_| wrong("cannot be read".into()))?;
    check_head(&head, meta).map_err(|reason| wrong(reason.into()))?;
    let most = coded.len().saturating_mul(MOST_DECISIONS_PER_BYTE);
    let elements = u64::from(meta.triangle_count) + u64::from(meta.corner_count) + u64::from(meta.vertex_count);
    if elements > most as u64 {
        return Err(wrong("cannot hold as many elements as the meta section declares".into()));
    }
    let mut decoder = Decoder::new(coded);
    let triangles = triangles::decode(&mut decoder, meta.triangle_count, meta.corner_count)
        .map_err(|reason| wrong(reason.into()))?;
    let mut models = Models::default();
    let corners =
        decode_corners(&mut decoder, &mut models, &triangles, &head, meta).map_err(|reason| wrong(reason.into()))?;
    let weights = decode_weights(&mut decoder, &mut models, meta.vertex_count);
    if decoder.exhausted() || !decoder.at_end() {
        return Err(wrong("ends too early or has bytes left over".into()));
    }
    let welded = triangles.iter().map(|triangle| triangle.map(|corner| corners[corner as usize].vertex)).collect();
    let topology = Topology::new(meta.vertex_count, welded, weights).map_err(|error| wrong(error.to_string()))?;
    let images = head.images.into_iter();
    let images = images.map(|i| Image { format: i.format, width: i.width, height: i.height, bytes: Vec::new() });
    let surface =
        Surface { corners, triangles, parts: head.parts, materials: head.materials, images: images.collect() };
    Ok((topology, surface))
}

/// Parts must cover all triangles in order and name materials, materials must name images.
fn check_head(head: &Head, meta: &Meta) -> Result<(), &'static str> {
    check_parts(&head.parts, &head.materials, head.images.len(), meta.triangle_count)?;
    if head.images.len() != meta.image_count as usize || meta.image_count > MAX_IMAGES {
        return Err("has another number of images than the meta section declares");
    }
    if head.materials.len() > MAX_MATERIALS as usize || head.parts.len() > MAX_MATERIALS as usize {
        return Err("has too many materials or parts");
    }
    let numbers = head.uv_range.iter().flat_map(|&(low, extent)| [low, extent, low + extent]);
    let factors = head.materials.iter().flat_map(|material| material.base_colour);
    if !numbers.chain(factors).all(f32::is_finite) {
        return Err("has a number that is not finite");
    }
    Ok(())
}

/// What holds of the parts and materials of every surface; the reason where it does not.
pub(super) fn check_parts(
    parts: &[Part],
    materials: &[Material],
    image_count: usize,
    triangle_count: u32,
) -> Result<(), &'static str> {
    let mut next = 0_u32;
    for part in parts {
        if part.first_triangle != next || part.material as usize >= materials.len() {
            return Err("has a part out of order or without a material");
        }
        next = next.checked_add(part.triangle_count).ok_or("has parts that do not cover the triangles")?;
    }
    if next != triangle_count || materials.is_empty() {
        return Err("has parts that do not cover the triangles");
    }
    let mut images = materials.iter().filter_map(|material| material.image);
    if images.any(|image| image as usize >= image_count) {
        return Err("has a material with an image that does not exist");
    }
    Ok(())
}

fn range(values: impl Iterator<Item = f32>) -> (f32, f32) {
    let (low, high) = values.fold((f32::MAX, f32::MIN), |(low, high), value| (low.min(value), high.max(value)));
    if low <= high { (low, high - low) } else { (0.0, 0.0) }
}

fn quantise_uv(uv: f32, (low, extent): (f32, f32)) -> i32 {
    if extent > 0.0 { ((f64::from(uv) - f64::from(low)) / f64::from(extent) * STEPS).round() as i32 } else { 0 }
}

fn restore_uv(value: i32, (low, extent): (f32, f32)) -> f32 {
    (f64::from(low) + f64::from(extent) * f64::from(value) / STEPS) as f32
}

/// Corners in the order in which triangles first use them, each predicted by the corner coded before it in its
/// triangle (or the last one of all), so that texture coordinates change little from one to the next.
fn corners_in_use(triangles: &[[u32; 3]], corner_count: usize) -> Vec<(u32, Option<u32>)> {
    let mut seen = vec![false; corner_count];
    let mut order = Vec::with_capacity(corner_count);
    let mut last = None;
    for triangle in triangles {
        let known = triangle.iter().copied().find(|&corner| seen[corner as usize]);
        last = known.or(last);
        for &corner in triangle {
            if !std::mem::replace(&mut seen[corner as usize], true) {
                order.push((corner, last));
                last = Some(corner);
            }
        }
    }
    order
}

fn encode_corners(encoder: &mut Encoder, models: &mut Models, surface: &Surface, head: &Head) {
    let corners = &surface.corners;
    let mut before = -1;
    for corner in corners {
        models.vertex.encode_signed(encoder, corner.vertex as i32 - before - 1);
        before = corner.vertex as i32;
    }
    let uv = |corner: u32, axis: usize| quantise_uv(corners[corner as usize].uv[axis], head.uv_range[axis]);
    for (corner, reference) in corners_in_use(&surface.triangles, corners.len()) {
        for axis in 0..2 {
            let expected = reference.map_or(0, |reference| uv(reference, axis));
            models.uv[axis].encode_signed(encoder, uv(corner, axis) - expected);
        }
        if head.has_colours {
            let expected = reference.map_or([255; 4], |reference| corners[reference as usize].colour);
            let colour = corners[corner as usize].colour;
            encoder.bit(&mut models.same_colour, colour == expected);
            if colour != expected {
                for channel in 0..4 {
                    let difference = i32::from(colour[channel]) - i32::from(expected[channel]);
                    models.colour[channel].encode_signed(encoder, difference);
                }
            }
        }
    }
}

fn decode_corners(
    decoder: &mut Decoder,
    models: &mut Models,
    triangles: &[[u32; 3]],
    head: &Head,
    meta: &Meta,
) -> Result<Vec<Corner>, &'static str> {
    let mut corners = Vec::new();
    let mut before = -1_i32;
    for _ in 0..meta.corner_count {
        before = before.wrapping_add(1).wrapping_add(models.vertex.decode_signed(decoder));
        if decoder.exhausted() || before < 0 || before as u32 >= meta.vertex_count {
            return Err("has a corner without a vertex");
        }
        corners.push(Corner { vertex: before as u32, uv: [0.0; 2], colour: [255; 4] });
    }
    let order = corners_in_use(triangles, corners.len());
    if order.len() != corners.len() {
        return Err("has a corner that no triangle uses");
    }
    let mut quantised = vec![[0_i32; 2]; corners.len()];
    for (corner, reference) in order {
        let corner = corner as usize;
        for axis in 0..2 {
            let expected = reference.map_or(0, |reference| quantised[reference as usize][axis]);
            let value = expected.wrapping_add(models.uv[axis].decode_signed(decoder));
            if !(0..=STEPS as i32).contains(&value) {
                return Err("has a texture coordinate out of its range");
            }
            quantised[corner][axis] = value;
            corners[corner].uv[axis] = restore_uv(value, head.uv_range[axis]);
        }
        if head.has_colours {
            let mut colour = reference.map_or([255; 4], |reference| corners[reference as usize].colour);
            if !decoder.bit(&mut models.same_colour) {
                for channel in 0..4 {
                    let difference = models.colour[channel].decode_signed(decoder);
                    colour[channel] = i32::from(colour[channel]).wrapping_add(difference) as u8;
                }
            }
            corners[corner].colour = colour;
        }
    }
    Ok(corners)
}

fn encode_weights(encoder: &mut Encoder, models: &mut Models, weights: &[f32]) {
    let largest = weights.iter().copied().fold(f32::MIN_POSITIVE, f32::max);
    let mut before = 0;
    for &weight in weights {
        let value = (f64::from(weight) / f64::from(largest) * STEPS).round() as i32;
        models.weight.encode_signed(encoder, value - before);
        before = value;
    }
}

fn decode_weights(decoder: &mut Decoder, models: &mut Models, vertex_count: u32) -> Vec<f32> {
    let (mut weights, mut before) = (Vec::new(), 0_i32);
    for _ in 0..vertex_count {
        if decoder.exhausted() {
            break;
        }
        before = before.wrapping_add(models.weight.decode_signed(decoder));
        weights.push(before as f32);
    }
    weights
}
