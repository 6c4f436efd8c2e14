//! A walk as numbered OBJ files, with MTL libraries and textures beside them: one of each for all frames, or for each frame
//! where its texture is its own.

use std::fmt::Write;

use actor::files::FilePlace;
use glam::Vec3;

use super::error::ExportError;
use super::frame_textures::write_frame_textures;
use super::materials::{library, names, write_textures};
use super::output::{FramePattern, write_whole};
use super::play::Played;
use super::{Actor, ExportOptions};
use job::Job;

const MATERIALS: &str = "materials.mtl";

/// Writes all frames: the files' vertices and faces, in their order and at their place.
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
    let names = names(&actor.surface);
    if changing.is_none() {
        let text = library(&actor.surface, &names, &textures);
        write_whole(&pattern.folder.join(pattern.beside(MATERIALS)), text.as_bytes())?;
    }
    let rest = rest(actor, &names);
    let mut kinds = Vec::new();
    let frames = played.each(options.every, ("frames", job), |shown| {
        let own = match changing {
            Some(material) => {
                kinds.push(shown.kind);
                if let Some(texture) = textures.get_mut(material as usize) {
                    *texture = Some(pattern.companion(shown.number, "_texture.png"));
                }
                let own = pattern.companion(shown.number, ".mtl");
                write_whole(&pattern.folder.join(&own), library(&actor.surface, &names, &textures).as_bytes())?;
                own
            }
            None => pattern.beside(MATERIALS),
        };
        let mut text = format!("mtllib {own}\n");
        vertices(actor, shown.pose, &mut text);
        text.push_str(&rest);
        write_whole(&pattern.file(shown.number), text.as_bytes())
    })?;
    write_frame_textures(actor, pattern, &kinds, job)?;
    Ok(frames)
}

/// Vertices with their colours, and normals.
fn vertices(actor: &Actor, pose: &[Vec3], text: &mut String) {
    let (mesh, place) = (&actor.mesh, &actor.place);
    for (vertex, &welded) in mesh.vertices.iter().enumerate() {
        position(place, pose[welded as usize], text);
        if let Some(colour) = mesh.colours.get(vertex) {
            let [r, g, b, a] = colour.map(|byte| f32::from(byte) / 255.0);
            let _ = write!(text, " {r:.4} {g:.4} {b:.4}");
            if colour[3] < 255 {
                let _ = write!(text, " {a:.4}");
            }
        }
        text.push('\n');
    }
    for normal in mesh.normals(pose) {
        let normal = place.direction(normal);
        let _ = writeln!(text, "vn {:.5} {:.5} {:.5}", normal.x, normal.y, normal.z);
    }
}

/// `v` and three coordinates, with the decimals that they have.
fn position(place: &FilePlace, position: Vec3, text: &mut String) {
    let _ = if place.is_plain() {
        write!(text, "v {} {} {}", position.x, position.y, position.z)
    } else {
        let position = place.position(position);
        write!(text, "v {} {} {}", position.x, position.y, position.z)
    };
}

/// Texture coordinates and faces: the same for all frames.
fn rest(actor: &Actor, names: &[String]) -> String {
    let (surface, mesh) = (&actor.surface, &actor.mesh);
    let mut text = String::new();
    if mesh.has_uvs {
        for corner in &surface.corners {
            // OBJ counts v upwards.
            let _ = writeln!(text, "vt {} {}", corner.uv[0], 1.0 - corner.uv[1]);
        }
    }
    let mut material = None;
    for face in &mesh.faces {
        if material != Some(face.material) {
            material = Some(face.material);
            let _ = writeln!(text, "usemtl {}", names[face.material as usize]);
        }
        text.push('f');
        for corner in &face.corners {
            let (v, vt, vn) = (corner.vertex + 1, corner.corner + 1, corner.normal + 1);
            let _ = match (mesh.has_uvs, mesh.normal_count > 0) {
                (true, true) => write!(text, " {v}/{vt}/{vn}"),
                (true, false) => write!(text, " {v}/{vt}"),
                (false, true) => write!(text, " {v}//{vn}"),
                (false, false) => write!(text, " {v}"),
            };
        }
        text.push('\n');
    }
    text
}
