//! Names of materials, MTL libraries, and textures as files.

use std::collections::HashSet;
use std::fmt::Write;
use std::path::Path;

use actor::surface::{Image, ImageFormat, Surface};
use image::RgbaImage;
use kernels::srgb::srgb_from_linear;

use super::error::ExportError;
use super::output::{FramePattern, write_whole};

/// Names for the materials that OBJ files can say: those that they came with, made different from each other.
pub(super) fn names(surface: &Surface) -> Vec<String> {
    let mut taken = HashSet::new();
    let mut named = Vec::with_capacity(surface.materials.len());
    for (index, material) in surface.materials.iter().enumerate() {
        // A name ends with its line, what follows a "#" is a comment to some, and a backslash carries lines on.
        let plain = |c: char| if c.is_control() || c == '#' || c == '\\' { '_' } else { c };
        let wanted: String = material.name.trim().chars().map(plain).collect();
        let wanted = if wanted.is_empty() { format!("material_{index}") } else { wanted };
        let mut name = wanted.clone();
        for again in 2.. {
            if taken.insert(name.clone()) {
                break;
            }
            name = format!("{wanted}_{again}");
        }
        named.push(name);
    }
    named
}

/// An MTL library; `textures` has the file of each material's texture.
pub(super) fn library(surface: &Surface, names: &[String], textures: &[Option<String>]) -> String {
    let mut text = String::new();
    for ((material, name), texture) in surface.materials.iter().zip(names).zip(textures) {
        // MTL says nothing of colour spaces; programs take colours as sRGB.
        let [r, g, b, a] = material.base_colour;
        let rounded = |component: f32| (1e6 * srgb_from_linear(component.clamp(0.0, 1.0))).round() / 1e6;
        let [r, g, b] = [r, g, b].map(rounded);
        let _ = writeln!(text, "newmtl {name}\nKd {r} {g} {b}\nd {a}");
        if let Some(texture) = texture {
            let _ = writeln!(text, "map_Kd {texture}");
        }
    }
    text
}

/// Writes the static textures beside frames, but for that of the material `changing` where it is of no other; the file of
/// each material's texture.
pub(super) fn write_textures(
    surface: &Surface,
    pattern: &FramePattern,
    changing: Option<u32>,
) -> Result<Vec<Option<String>>, ExportError> {
    let is_static = |material: usize| changing != Some(material as u32);
    let image_of = |material: usize| {
        let image = surface.materials[material].image?;
        surface.images.get(image as usize).map(|own| (image, own)).filter(|_| is_static(material))
    };
    let mut written = HashSet::new();
    let mut names = Vec::with_capacity(surface.materials.len());
    for material in 0..surface.materials.len() {
        let Some((index, image)) = image_of(material) else {
            names.push(None);
            continue;
        };
        let name = pattern.beside(&format!("texture_{index}.{}", extension(image)));
        if written.insert(index) {
            write_whole(&pattern.folder.join(&name), &image.bytes)?;
        }
        names.push(Some(name));
    }
    Ok(names)
}

/// `image` as the bytes of a PNG file; `file` is for messages.
pub(super) fn png(image: &RgbaImage, file: &Path) -> Result<Vec<u8>, ExportError> {
    let failed = |cause| ExportError::Picture { file: file.to_owned(), cause };
    crate::png::encode_lean(image).map_err(failed)
}

fn extension(image: &Image) -> &'static str {
    match image.format {
        ImageFormat::Png => "png",
        ImageFormat::Jpeg => "jpg",
        ImageFormat::WebP => "webp",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use actor::surface::Material;

    #[test]
    fn names_can_be_written_and_told_apart() {
        let material =
            |name: &str| Material { name: name.into(), base_colour: [1.0; 4], image: None, double_sided: true };
        let materials = ["skin tone", "", "skin tone", "a#b\n\\", "skin tone_2"].map(material).to_vec();
        let surface = Surface { materials, ..Surface::default() };
        assert_eq!(names(&surface), ["skin tone", "material_1", "skin tone_2", "a_b__", "skin tone_2_2"]);
    }
}
