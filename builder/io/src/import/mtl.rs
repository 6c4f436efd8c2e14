//! Wavefront material libraries: `newmtl`, `Kd`, `d`, `Tr` and `map_Kd`; the rest is skipped.

use std::path::Path;

use actor::surface::Material;

use super::error::ImportError;
use super::mesh::{linear_from_srgb, plain_material};
use super::text::{for_each_line, number};

/// A material and the texture file that it names.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LibraryMaterial {
    /// Name, colour and opacity.
    pub material: Material,
    /// File name of the diffuse texture, relative to the library.
    pub texture: Option<String>,
}

/// Reads the material library `bytes`; `path` is for messages.
///
/// `Kd` counts as sRGB, as programs have always shown it; beside a texture it is left out, for exporters write an
/// arbitrary grey there.
pub(super) fn parse(bytes: &[u8], path: &Path) -> Result<Vec<LibraryMaterial>, ImportError> {
    let mut materials: Vec<LibraryMaterial> = Vec::new();
    for_each_line(bytes, |line, text| {
        let (keyword, rest) = text.split_once(|c: char| c.is_ascii_whitespace()).unwrap_or((text, ""));
        let rest = rest.trim();
        if keyword == "newmtl" {
            materials.push(LibraryMaterial { material: plain_material(rest), texture: None });
            return Ok(());
        }
        let Some(current) = materials.last_mut() else { return Ok(()) };
        match keyword {
            // "Kd spectral ..." and "Kd xyz ..." are never written in practice.
            "Kd" if !rest.starts_with(|c: char| c.is_ascii_alphabetic()) => {
                for (slot, word) in current.material.base_colour.iter_mut().zip(rest.split_ascii_whitespace()).take(3) {
                    *slot = linear_from_srgb(number(path, line, word)?);
                }
            }
            "d" => {
                let word = rest.rsplit(' ').next().unwrap_or(rest);
                current.material.base_colour[3] = number(path, line, word)?.clamp(0.0, 1.0);
            }
            "Tr" => current.material.base_colour[3] = (1.0 - number(path, line, rest)?).clamp(0.0, 1.0),
            "map_Kd" => current.texture = Some(texture_name(rest)).filter(|name| !name.is_empty()),
            _ => {}
        }
        Ok(())
    })?;
    for LibraryMaterial { material, texture } in &mut materials {
        if texture.is_some() {
            material.base_colour[..3].fill(1.0);
        }
        if material.base_colour.iter().any(|c| !c.is_finite()) {
            material.base_colour = [1.0; 4];
        }
    }
    Ok(materials)
}

/// The file name of a texture statement, without its options; it may hold spaces.
fn texture_name(statement: &str) -> String {
    let mut words = statement.split_ascii_whitespace().peekable();
    while let Some(option) = words.next_if(|word| word.starts_with('-')) {
        let numbers = match option {
            "-o" | "-s" | "-t" => 3,
            "-mm" => 2,
            _ => 1,
        };
        for taken in 0..numbers {
            // Only the first value of -o, -s and -t must be there.
            let is_value = |word: &&str| taken == 0 || word.parse::<f32>().is_ok();
            if words.next_if(is_value).is_none() {
                break;
            }
        }
    }
    // Collapsing runs of spaces would change names with two spaces in them; nobody writes those.
    words.collect::<Vec<_>>().join(" ").replace('\\', "/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_colours_and_texture_names() {
        let text = "Kd 1 1 1\nnewmtl skin tone\nKd 0.5 0 1\nd 0.25\nnewmtl cloth\nKd 0.1 0.1 0.1\n\
                    map_Kd -s 1 1 1 -clamp on tex\\my cloth.png\nTr 0.25\n";
        let found = parse(text.as_bytes(), Path::new("m.mtl")).unwrap();
        assert_eq!(found.len(), 2);
        assert_eq!(found[0].material.name, "skin tone");
        assert!((found[0].material.base_colour[0] - 0.2140).abs() < 1e-3);
        assert_eq!(found[0].material.base_colour[3], 0.25);
        assert_eq!(found[0].texture, None);
        assert_eq!(found[1].material.base_colour, [1.0, 1.0, 1.0, 0.75]);
        assert_eq!(found[1].texture.as_deref(), Some("tex/my cloth.png"));
    }
}
