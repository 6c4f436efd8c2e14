//! A walk as one animated GLB: a morph target a frame.
//!
//! The base mesh is the first frame; each further frame is a morph target (differences of positions), and one animation
//! blends from target to target, so that any glTF viewer plays exactly the frames that were made. The weights are a matrix
//! of keyframes by targets with a single 1 a row: as a sparse accessor it takes a few bytes a frame instead of growing with
//! their square. The positions are 12 bytes a vertex and frame; `--every 2` halves them, and viewers interpolate. A basis
//! of fewer targets would be smaller still, but then the file would hold approximations of the frames.
//!
//! Textures hold the light that they were captured in: materials are marked unlit (`KHR_materials_unlit`).

use std::path::Path;

use glam::Vec3;
use serde_json::{Value, json};

use super::error::ExportError;
use super::output::write_whole;
use super::play::Played;
use super::{Actor, ExportOptions, bounds};
use job::Job;

/// The largest file in bytes: viewers hold all of it in memory.
const MOST_BYTES: u64 = 2 << 30;
/// The largest number of frames: viewers spread out the sparse weights, which grow with its square.
const MOST_FRAMES: u32 = 6000;

const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;

/// Writes all frames.
pub(super) fn write(
    actor: &Actor,
    played: &mut Played,
    path: &Path,
    options: &ExportOptions,
    job: &Job,
) -> Result<u32, ExportError> {
    let (total, corners) = (played.written(options.every), actor.surface.corners.len());
    let bytes = u64::from(total) * corners as u64 * 12;
    if bytes > MOST_BYTES || total > MOST_FRAMES {
        let most = (MOST_BYTES.min(u64::from(MOST_FRAMES) * corners as u64 * 12)) >> 20;
        return Err(ExportError::TooLarge { frames: total, corners, megabytes: bytes >> 20, most });
    }
    let mut file = File::default();
    let mut base: Vec<Vec3> = Vec::new();
    let mut targets = Vec::new();
    let frames = played.each(options.every, ("frames", job), |frame, pose| {
        let positions = actor.corners(pose);
        if frame == 0 {
            base = positions;
        } else {
            let moved: Vec<Vec3> = positions.iter().zip(&base).map(|(now, base)| *now - *base).collect();
            targets.push(file.positions(&moved));
        }
        Ok(())
    })?;
    let json = document(actor, &mut file, &base, &targets, options);
    write_whole(path, &file.assemble(&json))?;
    Ok(frames)
}

/// The binary chunk with the views and accessors into it.
#[derive(Default)]
struct File {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl File {
    /// Appends bytes as a view of their own; its index.
    fn view(&mut self, bytes: impl IntoIterator<Item = u8>) -> usize {
        let offset = self.bytes.len();
        self.bytes.extend(bytes);
        self.views.push(json!({"buffer": 0, "byteOffset": offset, "byteLength": self.bytes.len() - offset}));
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.len() - 1
    }

    fn accessor(&mut self, accessor: Value) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// An accessor of positions, with the bounds that glTF demands.
    fn positions(&mut self, positions: &[Vec3]) -> usize {
        let view = self.view(positions.iter().flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes));
        let (low, high) = bounds(positions);
        self.accessor(json!({
            "bufferView": view, "componentType": FLOAT, "count": positions.len(), "type": "VEC3",
            "min": low.to_array(), "max": high.to_array(),
        }))
    }

    /// An accessor of floats.
    fn floats(&mut self, values: &[f32], kind: &str, bounds: bool) -> usize {
        let view = self.view(values.iter().copied().flat_map(f32::to_le_bytes));
        let parts = if kind == "VEC2" { 2 } else { 1 };
        let mut accessor =
            json!({"bufferView": view, "componentType": FLOAT, "count": values.len() / parts, "type": kind});
        if let (true, Some(first), Some(last)) = (bounds, values.first(), values.last()) {
            (accessor["min"], accessor["max"]) = (json!([first]), json!([last]));
        }
        self.accessor(accessor)
    }

    fn indices(&mut self, indices: impl IntoIterator<Item = u32>) -> usize {
        let indices: Vec<u32> = indices.into_iter().collect();
        let view = self.view(indices.iter().flat_map(|index| index.to_le_bytes()));
        let count = indices.len();
        self.accessor(json!({"bufferView": view, "componentType": UNSIGNED_INT, "count": count, "type": "SCALAR"}))
    }

    /// Weights of `targets` at one keyframe more: all 0, but for target k - 1 at keyframe k.
    fn weights(&mut self, targets: usize) -> usize {
        let ones = (0..targets as u32).flat_map(|k| ((k + 1) * targets as u32 + k).to_le_bytes());
        let indices = self.view(ones);
        let values = self.view((0..targets).flat_map(|_| 1.0_f32.to_le_bytes()));
        self.accessor(json!({
            "componentType": FLOAT, "count": (targets + 1) * targets, "type": "SCALAR",
            "sparse": {
                "count": targets,
                "indices": {"bufferView": indices, "componentType": UNSIGNED_INT},
                "values": {"bufferView": values},
            },
        }))
    }

    /// The GLB: header, JSON, binary chunk.
    fn assemble(mut self, json: &Value) -> Vec<u8> {
        let mut document = json.clone();
        document["bufferViews"] = Value::Array(std::mem::take(&mut self.views));
        document["accessors"] = Value::Array(std::mem::take(&mut self.accessors));
        document["buffers"] = json!([{"byteLength": self.bytes.len()}]);
        let mut text = document.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let total = 12 + 8 + text.len() + 8 + self.bytes.len();
        let mut glb = Vec::with_capacity(total);
        glb.extend(*b"glTF");
        for number in [2, total as u32, text.len() as u32] {
            glb.extend(number.to_le_bytes());
        }
        glb.extend(*b"JSON");
        glb.extend(text);
        glb.extend((self.bytes.len() as u32).to_le_bytes());
        glb.extend(*b"BIN\0");
        glb.extend(self.bytes);
        glb
    }
}

fn document(actor: &Actor, file: &mut File, base: &[Vec3], targets: &[usize], options: &ExportOptions) -> Value {
    let surface = &actor.surface;
    let position = file.positions(base);
    let uvs: Vec<f32> = surface.corners.iter().flat_map(|corner| corner.uv).collect();
    let uv = file.floats(&uvs, "VEC2", false);
    let colour = colours(actor, file);
    let morphs: Vec<Value> = targets.iter().map(|target| json!({"POSITION": target})).collect();
    let mut primitives = Vec::new();
    for part in &surface.parts {
        let indices = file.indices(surface.triangles_of(part).iter().flatten().copied());
        let mut primitive = json!({
            "attributes": {"POSITION": position, "TEXCOORD_0": uv}, "indices": indices, "material": part.material,
        });
        if let Some(colour) = colour {
            primitive["attributes"]["COLOR_0"] = json!(colour);
        }
        if !morphs.is_empty() {
            primitive["targets"] = Value::Array(morphs.clone());
        }
        primitives.push(primitive);
    }
    let mut mesh = json!({"name": actor.name, "primitives": primitives});
    let mut document = json!({
        "asset": {"version": "2.0", "generator": concat!("Reprise builder ", env!("CARGO_PKG_VERSION"))},
        "extensionsUsed": ["KHR_materials_unlit"],
        "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"name": actor.name, "mesh": 0}],
        "materials": materials(actor),
    });
    if !targets.is_empty() {
        mesh["weights"] = json!(vec![0; targets.len()]);
        let rate = actor.fps / options.every.max(1) as f32;
        let times: Vec<f32> = (0..=targets.len()).map(|frame| frame as f32 / rate).collect();
        let (input, output) = (file.floats(&times, "SCALAR", true), file.weights(targets.len()));
        document["animations"] = json!([{
            "name": "walk",
            "channels": [{"sampler": 0, "target": {"node": 0, "path": "weights"}}],
            "samplers": [{"input": input, "output": output, "interpolation": "LINEAR"}],
        }]);
    }
    document["meshes"] = json!([mesh]);
    let images: Vec<Value> = surface
        .images
        .iter()
        .map(|image| {
            let view = file.view(image.bytes.iter().copied());
            json!({"bufferView": view, "mimeType": image.format.media_type()})
        })
        .collect();
    if !images.is_empty() {
        let textures: Vec<Value> = (0..images.len()).map(|image| json!({"source": image})).collect();
        document["textures"] = Value::Array(textures);
        document["images"] = Value::Array(images);
    }
    document
}

/// Vertex colours, in linear light as glTF wants them; `None` where all are white.
fn colours(actor: &Actor, file: &mut File) -> Option<usize> {
    let corners = &actor.surface.corners;
    if corners.iter().all(|corner| corner.colour == [255; 4]) {
        return None;
    }
    let linear = |byte: u8| {
        let value = f32::from(byte) / 255.0;
        if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
    };
    let colour =
        |colour: [u8; 4]| [linear(colour[0]), linear(colour[1]), linear(colour[2]), f32::from(colour[3]) / 255.0];
    let view = file.view(corners.iter().flat_map(|corner| colour(corner.colour)).flat_map(f32::to_le_bytes));
    Some(file.accessor(json!({"bufferView": view, "componentType": FLOAT, "count": corners.len(), "type": "VEC4"})))
}

fn materials(actor: &Actor) -> Vec<Value> {
    let material = |material: &actor::surface::Material| {
        let mut colour =
            json!({"baseColorFactor": material.base_colour, "metallicFactor": 0.0, "roughnessFactor": 1.0});
        if let Some(image) = material.image {
            colour["baseColorTexture"] = json!({"index": image});
        }
        json!({
            "name": material.name, "doubleSided": material.double_sided, "pbrMetallicRoughness": colour,
            "extensions": {"KHR_materials_unlit": {}},
        })
    };
    actor.surface.materials.iter().map(material).collect()
}
