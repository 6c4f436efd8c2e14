//! A walk as one animated GLB.
//!
//! The base mesh is the first frame; each further frame is a morph target (differences of positions), and one animation
//! blends from target to target, so that any glTF viewer plays exactly the frames that were made. The weights are a matrix
//! of keyframes by targets with a single 1 a row: as a sparse accessor it takes a few bytes a frame instead of growing with
//! their square. The positions are 12 bytes a vertex and frame, 24 with normals; `--every 2` halves them, and viewers
//! interpolate. A basis of fewer targets would be smaller still, but then the file would hold approximations of the frames.
//!
//! A texture of a morphed mesh cannot change without extensions that few viewers read. So where the actor's texture changes,
//! and all textures together fit a viewer's memory, every frame is a mesh of its own with its own material, and steps of
//! scale between 0 and 1 show one after the other: glTF says that what has no size need not be drawn. Where they do not fit,
//! the first frame's texture is on all, and a warning says so.
//!
//! Vertices are the files', in their order; where the files have several texture coordinates or normals at a vertex, further
//! ones follow them. Textures hold the light that they were captured in: materials are marked unlit
//! (`KHR_materials_unlit`). The file has metres and +Y up, and a node moves it to where it was recorded.

use std::borrow::Cow;
use std::collections::HashMap;
use std::path::Path;

use actor::surface::Material;
use glam::{DVec3, Vec3};
use kernels::srgb::linear_from_srgb;
use rayon::prelude::*;
use serde_json::{Value, json};
use synthesis::FrameKind;

use super::error::ExportError;
use super::frame_textures::AT_ONCE;
use super::glb_file::File;
use super::materials::png;
use super::mesh::FaceCorner;
use super::output::write_whole;
use super::play::Played;
use super::textures::FrameTextures;
use super::{Actor, ExportOptions, Written};
use crate::import::Warning;
use job::Job;

/// The largest file in bytes: viewers hold all of it in memory.
const MOST_BYTES: u64 = 2 << 30;
/// The largest number of frames: viewers spread out the sparse weights, which grow with its square.
const MOST_FRAMES: u32 = 6000;

/// Writes all frames.
pub(super) fn write(
    actor: &Actor,
    played: &mut Played,
    path: &Path,
    options: &ExportOptions,
    job: &Job,
) -> Result<Written, ExportError> {
    let vertices = Vertices::of(actor);
    let (total, count) = (played.written(options.every), vertices.corners.len());
    let bytes_of_vertex = if actor.mesh.normal_count > 0 { 24 } else { 12 };
    let bytes = u64::from(total) * count as u64 * bytes_of_vertex;
    if bytes > MOST_BYTES || total > MOST_FRAMES {
        let most = (MOST_BYTES.min(u64::from(MOST_FRAMES) * count as u64 * bytes_of_vertex)) >> 20;
        return Err(ExportError::TooLarge { frames: total, corners: count, megabytes: bytes >> 20, most });
    }
    let in_turn =
        actor.textures.as_ref().is_some_and(|textures| decoded(textures, total) <= options.most_texture_bytes);
    let mut file = File::default();
    let (mut frames, mut kinds) = (Frames { base: None, others: Vec::new() }, Vec::new());
    let written = played.each(options.every, ("frames", job), |shown| {
        let (positions, normals) = vertices.posed(actor, shown.pose);
        kinds.push(shown.kind);
        match &frames.base {
            Some((base, base_normals)) if !in_turn => {
                let moved: Vec<Vec3> = positions.iter().zip(base).map(|(now, base)| *now - *base).collect();
                let turned: Vec<Vec3> = normals.iter().zip(base_normals).map(|(now, base)| *now - *base).collect();
                frames.others.push(attributes(&mut file, &moved, &turned));
            }
            Some(_) => frames.others.push(attributes(&mut file, &positions, &normals)),
            None => frames.base = Some((positions, normals)),
        }
        Ok(())
    })?;
    let (images, materials) = images(actor, &kinds, in_turn, path, job)?;
    let rate = actor.fps / options.every.max(1) as f32;
    let json = if in_turn {
        pages(actor, &mut file, &vertices, &frames, rate)
    } else {
        morphed(actor, &mut file, &vertices, &frames, rate)
    };
    let json = with_images(json, &mut file, &images, materials, actor.place.offset);
    write_whole(path, &file.assemble(&json))?;
    let stays = actor.textures.as_ref().filter(|_| !in_turn && total > 1);
    Ok(Written {
        frames: written,
        warnings: stays
            .map(|textures| static_texture(textures, total, options.most_texture_bytes))
            .into_iter()
            .collect(),
    })
}

/// Bytes of the textures of `frames` frames once they are decoded.
fn decoded(textures: &FrameTextures, frames: u32) -> u64 {
    let (width, height) = textures.size();
    u64::from(frames) * u64::from(width) * u64::from(height) * 16 / 3
}

fn static_texture(textures: &FrameTextures, frames: u32, most_bytes: u64) -> Warning {
    let (width, height) = textures.size();
    let most = most_bytes / decoded(textures, 1).max(1);
    Warning::new(
        "W_TEXTURE_STATIC",
        format!(
            "the texture changes from frame to frame, but {frames} of {width} x {height} are too many for a viewer: all frames \
             of the GLB wear that of the first; write at most {most} frames (--every, or a shorter walk), allow more \
             (--glb-textures), or write OBJ or PLY files, which have a texture each"
        ),
    )
}

/// The frames so far: positions and normals of the first, accessors of the others.
struct Frames {
    base: Option<(Vec<Vec3>, Vec<Vec3>)>,
    others: Vec<Value>,
}

/// Attributes of a frame, or their differences.
fn attributes(file: &mut File, positions: &[Vec3], normals: &[Vec3]) -> Value {
    let mut attributes = json!({"POSITION": file.positions(positions)});
    if !normals.is_empty() {
        attributes["NORMAL"] = json!(file.positions(normals));
    }
    attributes
}

/// The file's vertices: the files' own first.
struct Vertices {
    /// What each shows; `corner` and `normal` mean nothing where no face uses it.
    corners: Vec<FaceCorner>,
    /// The triangles over them, in the surface's order.
    triangles: Vec<[u32; 3]>,
}

impl Vertices {
    fn of(actor: &Actor) -> Self {
        let mesh = &actor.mesh;
        let mut corners: Vec<FaceCorner> =
            (0..mesh.vertices.len() as u32).map(|vertex| FaceCorner { vertex, corner: 0, normal: 0 }).collect();
        let mut used = vec![false; corners.len()];
        let mut index_of: HashMap<FaceCorner, u32> = HashMap::new();
        let mut index = |corner: &FaceCorner| {
            *index_of.entry(*corner).or_insert_with(|| {
                let own = corner.vertex as usize;
                if !std::mem::replace(&mut used[own], true) {
                    corners[own] = *corner;
                    return own as u32;
                }
                corners.push(*corner);
                corners.len() as u32 - 1
            })
        };
        let triangles = mesh.triangles.iter().map(|triangle| triangle.each_ref().map(&mut index)).collect();
        Self { corners, triangles }
    }

    /// Positions and normals in a pose over welded vertices.
    fn posed(&self, actor: &Actor, pose: &[Vec3]) -> (Vec<Vec3>, Vec<Vec3>) {
        let mesh = &actor.mesh;
        let position = |corner: &FaceCorner| pose[mesh.vertices[corner.vertex as usize] as usize];
        let normals = mesh.normals(pose);
        let of_corners = |corner: &FaceCorner| normals.get(corner.normal as usize).copied();
        (self.corners.iter().map(position).collect(), self.corners.iter().filter_map(of_corners).collect())
    }

    /// The primitives of a mesh, without the attributes that move.
    fn primitives(&self, actor: &Actor, file: &mut File) -> Vec<Value> {
        let surface = &actor.surface;
        let mut attributes = json!({});
        if actor.mesh.has_uvs {
            let uvs: Vec<f32> =
                self.corners.iter().flat_map(|corner| surface.corners[corner.corner as usize].uv).collect();
            attributes["TEXCOORD_0"] = json!(file.floats(&uvs, "VEC2", false));
        }
        if !actor.mesh.colours.is_empty() {
            let colours = self.corners.iter().map(|corner| actor.mesh.colours[corner.vertex as usize]);
            let colours: Vec<f32> = colours.flat_map(linear).collect();
            attributes["COLOR_0"] = json!(file.floats(&colours, "VEC4", false));
        }
        let mut primitives = Vec::with_capacity(surface.parts.len());
        for part in &surface.parts {
            let first = part.first_triangle as usize;
            let own = self.triangles.get(first..first + part.triangle_count as usize).unwrap_or_default();
            let indices = file.indices(own.iter().flatten().copied());
            primitives.push(json!({"attributes": attributes, "indices": indices, "material": part.material}));
        }
        primitives
    }
}

/// A colour in linear light, as glTF wants it.
fn linear(colour: [u8; 4]) -> [f32; 4] {
    let component = |byte: u8| linear_from_srgb(f32::from(byte) / 255.0);
    [component(colour[0]), component(colour[1]), component(colour[2]), f32::from(colour[3]) / 255.0]
}

/// One mesh whose targets are the frames.
fn morphed(actor: &Actor, file: &mut File, vertices: &Vertices, frames: &Frames, rate: f32) -> Value {
    let mut primitives = vertices.primitives(actor, file);
    if let Some((positions, normals)) = &frames.base {
        let base = attributes(file, positions, normals);
        primitives.iter_mut().for_each(|primitive| merge(&mut primitive["attributes"], &base));
    }
    let mut mesh = json!({"name": actor.name, "primitives": primitives});
    let mut document = json!({"nodes": [{"name": actor.name, "mesh": 0}]});
    let targets = frames.others.len();
    if targets > 0 {
        for primitive in mesh["primitives"].as_array_mut().into_iter().flatten() {
            primitive["targets"] = json!(frames.others);
        }
        mesh["weights"] = json!(vec![0; targets]);
        let times: Vec<f32> = (0..=targets).map(|frame| frame as f32 / rate).collect();
        let (input, output) = (file.floats(&times, "SCALAR", true), file.weights(targets));
        document["animations"] = json!([{
            "name": "walk",
            "channels": [{"sampler": 0, "target": {"node": 0, "path": "weights"}}],
            "samplers": [{"input": input, "output": output, "interpolation": "LINEAR"}],
        }]);
    }
    document["meshes"] = json!([mesh]);
    document
}

/// A mesh for each frame, shown in turn by steps of scale.
fn pages(actor: &Actor, file: &mut File, vertices: &Vertices, frames: &Frames, rate: f32) -> Value {
    let shared = vertices.primitives(actor, file);
    let first = frames.base.iter().map(|(positions, normals)| attributes(file, positions, normals));
    let all: Vec<Value> = first.collect::<Vec<_>>().into_iter().chain(frames.others.iter().cloned()).collect();
    let changing = actor.textures.as_ref().map_or(0, |textures| textures.material);
    // The first frame's is in its own place, those of the others come last.
    let of_others = actor.surface.materials.len();
    let (mut meshes, mut nodes) = (Vec::new(), vec![json!({"name": actor.name})]);
    let (mut channels, mut samplers) = (Vec::new(), Vec::new());
    for (frame, own) in all.iter().enumerate() {
        let mut primitives = shared.clone();
        for primitive in &mut primitives {
            merge(&mut primitive["attributes"], own);
            if frame > 0 && primitive["material"] == json!(changing) {
                primitive["material"] = json!(of_others + frame - 1);
            }
        }
        meshes.push(json!({"name": format!("{} {frame}", actor.name), "primitives": primitives}));
        let scale = if frame == 0 { 1.0 } else { 0.0 };
        nodes.push(json!({"mesh": frame, "scale": [scale, scale, scale]}));
        if all.len() > 1 {
            let keys = [(0, frame == 0), (frame, true), (frame + 1, false)];
            let keys = || keys.iter().skip(usize::from(frame == 0)).filter(|(key, _)| *key < all.len());
            let times: Vec<f32> = keys().map(|(key, _)| *key as f32 / rate).collect();
            let scales: Vec<f32> = keys().flat_map(|(_, shown)| [f32::from(u8::from(*shown)); 3]).collect();
            let (input, output) = (file.floats(&times, "SCALAR", true), file.floats(&scales, "VEC3", false));
            samplers.push(json!({"input": input, "output": output, "interpolation": "STEP"}));
            channels.push(json!({"sampler": frame, "target": {"node": frame + 1, "path": "scale"}}));
        }
    }
    nodes[0]["children"] = json!((1..nodes.len()).collect::<Vec<_>>());
    let mut document = json!({"nodes": nodes, "meshes": meshes});
    if all.len() > 1 {
        document["animations"] = json!([{"name": "walk", "channels": channels, "samplers": samplers}]);
    }
    document
}

/// Adds the fields of `more` to `value`.
fn merge(value: &mut Value, more: &Value) {
    for (name, field) in more.as_object().into_iter().flatten() {
        value[name] = field.clone();
    }
}

/// An encoded image, and its media type.
type Encoded<'a> = (Cow<'a, [u8]>, &'static str);

/// Images of the materials, and the materials. A texture that changes is that of the first frame; those of the further
/// frames, where meshes are shown in turn, come last, with a material each.
fn images<'a>(
    actor: &'a Actor,
    kinds: &[FrameKind],
    in_turn: bool,
    path: &Path,
    job: &Job,
) -> Result<(Vec<Encoded<'a>>, Vec<Value>), ExportError> {
    let surface = &actor.surface;
    let changing = actor.textures.as_ref().map(|textures| textures.material);
    let mut images: Vec<Encoded> = Vec::new();
    let mut index_of = vec![None; surface.images.len()];
    for (index, image) in (0..).zip(&surface.images) {
        let worn = |(material, own): (u32, &Material)| changing != Some(material) && own.image == Some(index);
        if changing.is_none() || (0..).zip(&surface.materials).any(worn) {
            index_of[index as usize] = Some(images.len());
            images.push((image.bytes.as_slice().into(), image.format.media_type()));
        }
    }
    let static_of = |own: &Material| index_of.get(own.image? as usize).copied().flatten();
    let mut materials: Vec<Value> = surface.materials.iter().map(|own| material(own, static_of(own))).collect();
    let Some(textures) = &actor.textures else { return Ok((images, materials)) };
    let Some(changing) = surface.materials.get(textures.material as usize) else { return Ok((images, materials)) };
    let wanted = if in_turn { kinds } else { &kinds[..kinds.len().min(1)] };
    for (batch, wanted) in wanted.chunks(AT_ONCE).enumerate() {
        job.tell("textures", (batch * AT_ONCE) as u64, wanted.len() as u64)?;
        let rebuilt: Vec<_> = wanted.par_iter().map(|&kind| png(&textures.of_frame(kind), path)).collect();
        for (k, bytes) in rebuilt.into_iter().enumerate() {
            let painted = material(changing, Some(images.len()));
            images.push((bytes?.into(), "image/png"));
            match batch * AT_ONCE + k {
                0 => materials[textures.material as usize] = painted,
                _ => materials.push(painted),
            }
        }
    }
    Ok((images, materials))
}

fn material(material: &Material, image: Option<usize>) -> Value {
    let mut colour = json!({"baseColorFactor": material.base_colour, "metallicFactor": 0.0, "roughnessFactor": 1.0});
    if let Some(image) = image {
        colour["baseColorTexture"] = json!({"index": image});
    }
    json!({
        "name": material.name, "doubleSided": material.double_sided, "pbrMetallicRoughness": colour,
        "extensions": {"KHR_materials_unlit": {}},
    })
}

/// The whole document: what is drawn, at its place, with its images.
fn with_images(
    mut document: Value,
    file: &mut File,
    images: &[Encoded],
    materials: Vec<Value>,
    offset: DVec3,
) -> Value {
    if offset != DVec3::ZERO {
        document["nodes"][0]["translation"] = json!(offset.to_array());
    }
    document["asset"] = json!({"version": "2.0", "generator": concat!("Reprise builder ", env!("CARGO_PKG_VERSION"))});
    document["extensionsUsed"] = json!(["KHR_materials_unlit"]);
    document["scene"] = json!(0);
    document["scenes"] = json!([{"nodes": [0]}]);
    document["materials"] = Value::Array(materials);
    if !images.is_empty() {
        let views: Vec<Value> = images
            .iter()
            .map(|(bytes, kind)| json!({"bufferView": file.view(bytes.iter().copied()), "mimeType": kind}))
            .collect();
        document["textures"] = (0..images.len()).map(|image| json!({"source": image})).collect();
        document["images"] = Value::Array(views);
    }
    document
}
