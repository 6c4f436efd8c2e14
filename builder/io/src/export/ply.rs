//! A walk as numbered binary PLY files, with the textures beside them.

use glam::{DVec3, Vec3};

use super::error::ExportError;
use super::frame_textures::write_frame_textures;
use super::materials::write_textures;
use super::mesh::FileMesh;
use super::output::{FramePattern, write_whole};
use super::play::Played;
use super::{Actor, ExportOptions};
use job::Job;
use kernels::srgb::srgb_from_linear;

/// Writes all frames: the files' vertices and faces, in their order and at their place. PLY knows textures, but no materials:
/// where the faces of several have textures, `texnumber` says which; the colours of materials are written into the vertices.
pub(super) fn write(
    actor: &Actor,
    played: &mut Played,
    pattern: &FramePattern,
    options: &ExportOptions,
    job: &Job,
) -> Result<u32, ExportError> {
    pattern.make_folder()?;
    let changing = actor.textures.as_ref().map(|textures| textures.material);
    let mut textures = write_textures(&actor.surface, pattern, changing)?;
    let colours = colours(actor);
    let mut kinds = Vec::new();
    // Which of the textures each material has does not change, only what it is called.
    if let Some(texture) = changing.and_then(|material| textures.get_mut(material as usize)) {
        *texture = Some(String::new());
    }
    let faces = Faces::new(actor, &textures);
    let frames = played.each(options.every, ("frames", job), |shown| {
        if let Some(material) = changing {
            kinds.push(shown.kind);
            if let Some(texture) = textures.get_mut(material as usize) {
                *texture = Some(pattern.companion(shown.number, "_texture.png"));
            }
        }
        let mut bytes = header(actor, &textures, &colours, &faces).into_bytes();
        bytes.reserve(actor.mesh.vertices.len() * 40 + faces.bytes.len());
        vertices(actor, shown.pose, &colours, &mut bytes);
        bytes.extend_from_slice(&faces.bytes);
        write_whole(&pattern.file(shown.number), &bytes)
    })?;
    write_frame_textures(actor, pattern, &kinds, job)?;
    Ok(frames)
}

fn header(actor: &Actor, textures: &[Option<String>], colours: &[[u8; 4]], faces: &Faces) -> String {
    let mesh = &actor.mesh;
    let mut text = "ply\nformat binary_little_endian 1.0\n".to_owned();
    for &material in &faces.textured {
        let name = textures[material].as_deref().unwrap_or_default();
        text.push_str(&format!("comment TextureFile {name}\n"));
    }
    text.push_str(&format!("element vertex {}\n", mesh.vertices.len()));
    // 32 bits do not hold a place on a map.
    let kind = if actor.place.is_plain() { "float" } else { "double" };
    ["x", "y", "z"].iter().for_each(|axis| text.push_str(&format!("property {kind} {axis}\n")));
    if mesh.normal_count > 0 {
        ["nx", "ny", "nz"].iter().for_each(|axis| text.push_str(&format!("property float {axis}\n")));
    }
    if !colours.is_empty() {
        ["red", "green", "blue", "alpha"].iter().for_each(|part| text.push_str(&format!("property uchar {part}\n")));
    }
    let count = if faces.large { "int" } else { "uchar" };
    text.push_str(&format!("element face {}\nproperty list {count} int vertex_indices\n", mesh.faces.len()));
    if mesh.has_uvs {
        text.push_str(&format!("property list {count} float texcoord\n"));
    }
    if faces.textured.len() > 1 {
        text.push_str("property int texnumber\n");
    }
    text.push_str("end_header\n");
    text
}

fn vertices(actor: &Actor, pose: &[Vec3], colours: &[[u8; 4]], bytes: &mut Vec<u8>) {
    let (mesh, place) = (&actor.mesh, &actor.place);
    let normals = normals(mesh, pose);
    for (vertex, &welded) in mesh.vertices.iter().enumerate() {
        let position = pose[welded as usize];
        if place.is_plain() {
            bytes.extend(position.to_array().into_iter().flat_map(f32::to_le_bytes));
        } else {
            bytes.extend(place.position(position).to_array().into_iter().flat_map(f64::to_le_bytes));
        }
        if let Some(&normal) = normals.get(vertex) {
            let normal = place.direction(normal).as_vec3();
            bytes.extend(normal.to_array().into_iter().flat_map(f32::to_le_bytes));
        }
        bytes.extend(colours.get(vertex).into_iter().flatten());
    }
}

/// Normals of the files' vertices: a vertex with several has their mean.
fn normals(mesh: &FileMesh, pose: &[Vec3]) -> Vec<Vec3> {
    if mesh.normal_count == 0 {
        return Vec::new();
    }
    let of_corners = mesh.normals(pose);
    let mut sums = vec![DVec3::ZERO; mesh.vertices.len()];
    for corner in mesh.triangles.iter().flatten() {
        sums[corner.vertex as usize] += of_corners[corner.normal as usize].as_dvec3();
    }
    sums.iter().map(|sum| sum.normalize_or(DVec3::Y).as_vec3()).collect()
}

/// Colours of the files' vertices times those of their materials; none where all are white. A texture hides neither.
fn colours(actor: &Actor) -> Vec<[u8; 4]> {
    let (surface, mesh) = (&actor.surface, &actor.mesh);
    if mesh.colours.is_empty() && surface.materials.iter().all(|material| material.base_colour == [1.0; 4]) {
        return Vec::new();
    }
    let mut colours = mesh.colours.clone();
    colours.resize(mesh.vertices.len(), [255; 4]);
    let mut tinted = vec![false; mesh.vertices.len()];
    for face in &mesh.faces {
        let [r, g, b, a] = surface.materials[face.material as usize].base_colour;
        let [r, g, b] = [r, g, b].map(|light| srgb_from_linear(light.clamp(0.0, 1.0)));
        let tint = [r, g, b, a.clamp(0.0, 1.0)];
        for corner in &face.corners {
            let vertex = corner.vertex as usize;
            // A vertex between two materials has the colour of the first.
            if !std::mem::replace(&mut tinted[vertex], true) {
                let own = colours[vertex];
                colours[vertex] = [0, 1, 2, 3].map(|k| (f32::from(own[k]) * tint[k]).round() as u8);
            }
        }
    }
    colours
}

/// All that comes after the vertices: the same for all frames.
struct Faces {
    /// Materials with a texture, in the order of their numbers.
    textured: Vec<usize>,
    /// Whether a list is longer than a byte says.
    large: bool,
    bytes: Vec<u8>,
}

impl Faces {
    fn new(actor: &Actor, textures: &[Option<String>]) -> Self {
        let (surface, mesh) = (&actor.surface, &actor.mesh);
        let textured: Vec<usize> = (0..textures.len()).filter(|&material| textures[material].is_some()).collect();
        let large = mesh.faces.iter().any(|face| 2 * face.corners.len() > usize::from(u8::MAX));
        let mut bytes = Vec::with_capacity(mesh.faces.len() * 42);
        let count = |bytes: &mut Vec<u8>, count: usize| {
            if large { bytes.extend((count as u32).to_le_bytes()) } else { bytes.push(count as u8) }
        };
        for face in &mesh.faces {
            count(&mut bytes, face.corners.len());
            bytes.extend(face.corners.iter().flat_map(|corner| corner.vertex.to_le_bytes()));
            if mesh.has_uvs {
                count(&mut bytes, 2 * face.corners.len());
                let uvs = face.corners.iter().map(|corner| surface.corners[corner.corner as usize].uv);
                // PLY counts v upwards.
                bytes.extend(uvs.flat_map(|[u, v]| [u, 1.0 - v]).flat_map(f32::to_le_bytes));
            }
            if textured.len() > 1 {
                let number = textured.iter().position(|&material| material == face.material as usize).unwrap_or(0);
                bytes.extend((number as u32).to_le_bytes());
            }
        }
        Self { textured, large, bytes }
    }
}
