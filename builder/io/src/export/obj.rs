//! A walk as numbered OBJ files, with one MTL and the textures beside them.

use std::fmt::Write;

use super::error::ExportError;
use super::output::{FramePattern, write_textures, write_whole};
use super::play::Played;
use super::{Actor, ExportOptions};
use job::Job;

const MATERIALS: &str = "materials.mtl";

/// Writes all frames. Vertices are the welded ones; texture coordinates belong to corners.
pub(super) fn write(
    actor: &Actor,
    played: &mut Played,
    pattern: &FramePattern,
    options: &ExportOptions,
    job: &Job,
) -> Result<u32, ExportError> {
    pattern.make_folder()?;
    let textures = write_textures(&actor.surface, &pattern.folder)?;
    write_whole(&pattern.folder.join(MATERIALS), materials(actor, &textures).as_bytes())?;
    let rest = faces(actor);
    played.each(options.every, ("frames", job), |frame, pose| {
        let mut text = format!("mtllib {MATERIALS}\n");
        for position in pose {
            let _ = writeln!(text, "v {} {} {}", position.x, position.y, position.z);
        }
        text.push_str(&rest);
        write_whole(&pattern.file(frame), text.as_bytes())
    })
}

fn materials(actor: &Actor, textures: &[String]) -> String {
    let mut text = String::new();
    for (index, material) in actor.surface.materials.iter().enumerate() {
        // MTL says nothing of colour spaces; programs take colours as sRGB.
        let [r, g, b, a] = material.base_colour;
        let [r, g, b] = [r, g, b].map(|linear| linear.clamp(0.0, 1.0).powf(1.0 / 2.2));
        let _ = writeln!(text, "newmtl material_{index}\nKd {r} {g} {b}\nd {a}");
        if let Some(name) = material.image.and_then(|image| textures.get(image as usize)) {
            let _ = writeln!(text, "map_Kd {name}");
        }
    }
    text
}

/// Texture coordinates and faces: the same for all frames.
fn faces(actor: &Actor) -> String {
    let surface = &actor.surface;
    let mut text = String::new();
    for corner in &surface.corners {
        // OBJ counts v upwards.
        let _ = writeln!(text, "vt {} {}", corner.uv[0], 1.0 - corner.uv[1]);
    }
    for part in &surface.parts {
        let _ = writeln!(text, "usemtl material_{}", part.material);
        for triangle in surface.triangles_of(part) {
            let corner = |k: usize| (surface.corners[triangle[k] as usize].vertex + 1, triangle[k] + 1);
            let [(a, s), (b, t), (c, u)] = [corner(0), corner(1), corner(2)];
            let _ = writeln!(text, "f {a}/{s} {b}/{t} {c}/{u}");
        }
    }
    text
}
