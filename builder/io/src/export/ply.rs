//! A walk as numbered binary PLY files, with the texture beside them.

use super::error::ExportError;
use super::output::{FramePattern, write_textures, write_whole};
use super::play::Played;
use super::{Actor, ExportOptions};
use job::Job;

/// Writes all frames. A PLY names one texture: that of the first material which has one.
pub(super) fn write(
    actor: &Actor,
    played: &mut Played,
    pattern: &FramePattern,
    options: &ExportOptions,
    job: &Job,
) -> Result<u32, ExportError> {
    pattern.make_folder()?;
    let textures = write_textures(&actor.surface, &pattern.folder)?;
    let surface = &actor.surface;
    let texture = surface.materials.iter().find_map(|material| textures.get(material.image? as usize));
    let texture = texture.map_or(String::new(), |name| format!("comment TextureFile {name}\n"));
    let faces = faces(actor);
    played.each(options.every, ("frames", job), |frame, pose| {
        let header = format!(
            "ply\nformat binary_little_endian 1.0\n{texture}element vertex {}\nproperty float x\nproperty float y\n\
             property float z\nelement face {}\nproperty list uchar int vertex_indices\n\
             property list uchar float texcoord\nend_header\n",
            pose.len(),
            surface.triangles.len()
        );
        let mut bytes = header.into_bytes();
        bytes.reserve(pose.len() * 12 + faces.len());
        for position in pose {
            bytes.extend(position.to_array().into_iter().flat_map(f32::to_le_bytes));
        }
        bytes.extend_from_slice(&faces);
        write_whole(&pattern.file(frame), &bytes)
    })
}

/// All that comes after the vertices: the same for all frames.
fn faces(actor: &Actor) -> Vec<u8> {
    let surface = &actor.surface;
    let mut bytes = Vec::with_capacity(surface.triangles.len() * 38);
    for triangle in &surface.triangles {
        let corners = triangle.map(|corner| &surface.corners[corner as usize]);
        bytes.push(3);
        bytes.extend(corners.iter().flat_map(|corner| corner.vertex.to_le_bytes()));
        bytes.push(6);
        // PLY counts v upwards.
        bytes.extend(corners.iter().flat_map(|corner| [corner.uv[0], 1.0 - corner.uv[1]]).flat_map(f32::to_le_bytes));
    }
    bytes
}
