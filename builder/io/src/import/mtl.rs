//! Wavefront material libraries: colours, opacity and the texture of each material; the rest is skipped.

use std::path::Path;

use actor::surface::Material;
use kernels::srgb::linear_from_srgb;

use super::colour;
use super::error::ImportError;
use super::mesh::plain_material;
use super::text::{Continues, for_each_line, keyword_and_rest, number, without_comment};
use super::warning::Note;
use super::worn::UvTransform;

/// A material and the texture file that it names.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LibraryMaterial {
    /// Name, colour and opacity.
    pub material: Material,
    /// File name of the diffuse texture as it is written.
    pub texture: Option<String>,
    /// How texture coordinates are moved before the texture is looked up.
    pub uv: UvTransform,
}

/// A library, and what is unusual about it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Library {
    pub materials: Vec<LibraryMaterial>,
    pub notes: Vec<Note>,
}

/// A texture statement: options, then a file name, which may hold spaces.
#[derive(Clone, Debug, Default, PartialEq)]
struct Map {
    name: String,
    uv: UvTransform,
    clamped: bool,
}

/// A material as its statements say.
#[derive(Default)]
struct Draft {
    name: String,
    /// `Kd` and `Ke`, sRGB as written.
    diffuse: Option<[f32; 3]>,
    glow: Option<[f32; 3]>,
    /// `d` and 1 - `Tr`.
    opacity: Option<f32>,
    from_transparency: Option<f32>,
    /// `map_Kd`, `map_Ke`, `map_Ka` and `map_d`.
    maps: [Option<Map>; 4],
}

/// Keywords of `Draft::maps`, in order of preference, and of the one that is opacity.
const MAPS: [&str; 4] = ["map_kd", "map_ke", "map_ka", "map_d"];

/// Reads the material library `bytes`; `path` is for messages.
///
/// `Kd` counts as sRGB, as programs have always shown it; beside a texture it is left out, for exporters write an
/// arbitrary grey there. A material that is black but glows (`Ke`) has the colour of its glow, and one without a diffuse
/// texture wears that of its glow or of its ambient light. `d` wins over `Tr`, which programs write in both senses.
pub(super) fn parse(bytes: &[u8], path: &Path) -> Result<Library, ImportError> {
    let mut drafts: Vec<Draft> = Vec::new();
    for_each_line(bytes, continues, |line, text| {
        let (keyword, rest) = keyword_and_rest(text);
        if keyword == "newmtl" {
            drafts.push(Draft { name: rest.to_owned(), ..Draft::default() });
            return Ok(());
        }
        let Some(current) = drafts.last_mut() else { return Ok(()) };
        let data = without_comment(rest);
        match keyword {
            "Kd" => current.diffuse = components(path, line, data)?.or(current.diffuse),
            "Ke" => current.glow = components(path, line, data)?.or(current.glow),
            "d" => {
                let word = data.rsplit(' ').next().unwrap_or(data);
                current.opacity = Some(number(path, line, word)? as f32);
            }
            "Tr" => current.from_transparency = Some(1.0 - number(path, line, data)? as f32),
            _ => {
                let keyword = keyword.to_ascii_lowercase();
                if let Some(which) = MAPS.iter().position(|map| *map == keyword) {
                    current.maps[which] = Some(map(rest)).filter(|map| !map.name.is_empty());
                }
            }
        }
        Ok(())
    })?;
    let mut library = Library::default();
    for draft in drafts {
        let material = draft.finish(&mut library.notes);
        library.materials.push(material);
    }
    Ok(library)
}

fn continues(keyword: &str) -> Continues {
    match keyword {
        "Kd" | "Ke" | "d" | "Tr" => Continues::Always,
        keyword if keyword == "newmtl" || keyword.starts_with("map_") => Continues::WhereApart,
        _ => Continues::Never,
    }
}

/// Three colour components, of which the first stands for the others where they are missing; `None` for a spectrum, which
/// is never written in practice.
fn components(path: &Path, line: usize, data: &str) -> Result<Option<[f32; 3]>, ImportError> {
    if data.is_empty() || data.starts_with("spectral") || data.starts_with("xyz") {
        return Ok(None);
    }
    let mut colour = [None; 3];
    for (slot, word) in colour.iter_mut().zip(data.split_ascii_whitespace()) {
        *slot = Some(number(path, line, word)? as f32).filter(|component| component.is_finite());
    }
    let first = colour[0].unwrap_or(1.0);
    Ok(Some(colour.map(|component| component.unwrap_or(first))))
}

impl Draft {
    fn finish(self, notes: &mut Vec<Note>) -> LibraryMaterial {
        let name = self.name;
        let mut material = plain_material(&name);
        let is_black = self.diffuse.is_none_or(|colour| colour == [0.0; 3]);
        let glow = self.glow.filter(|colour| is_black && *colour != [0.0; 3]);
        let [diffuse, glowing, ambient, transparent] = self.maps;
        let map = diffuse.or(glowing).or(ambient);
        if let (Some(colour), None) = (glow.or(self.diffuse), &map) {
            let colour::Range { full, note } = colour::range(colour.into_iter());
            notes.extend(note.map(|note| Note { message: format!("material \"{name}\": {}", note.message), ..note }));
            for (slot, component) in material.base_colour.iter_mut().zip(colour) {
                *slot = linear_from_srgb((component / full).clamp(0.0, 1.0));
            }
        }
        let opacity = self.opacity.or(self.from_transparency).filter(|opacity| !opacity.is_nan()).unwrap_or(1.0);
        material.base_colour[3] = opacity.clamp(0.0, 1.0);
        if opacity <= 0.0 {
            let message = format!("material \"{name}\" is wholly transparent: if it should not be, write \"d 1\"");
            notes.push(Note::new("W_TRANSPARENT", message));
        }
        if transparent.is_some_and(|other| map.as_ref().is_none_or(|map| map.name != other.name)) {
            let message =
                format!("material \"{name}\": the texture of its opacity is left aside; put it into the alpha channel");
            notes.push(Note::new("W_OPACITY_MAP", message));
        }
        let (texture, uv) = match map {
            Some(map) => {
                if map.clamped {
                    let message = format!(
                        "material \"{name}\": its texture is not to repeat (-clamp), but repeats outside 0 to 1"
                    );
                    notes.push(Note::new("W_TEXTURE_CLAMP", message));
                }
                (Some(map.name), map.uv)
            }
            None => (None, UvTransform::default()),
        };
        LibraryMaterial { material, texture, uv }
    }
}

/// Reads what follows the keyword of a texture statement.
fn map(statement: &str) -> Map {
    let mut found = Map::default();
    let mut rest = statement;
    while let Some((option, after)) = first_word(rest).filter(|(word, _)| word.starts_with('-')) {
        let most = match option {
            "-o" | "-s" | "-t" => 3,
            "-mm" => 2,
            _ => 1,
        };
        rest = after;
        let mut values = Vec::new();
        while let Some((word, after)) = first_word(rest).filter(|_| values.len() < most) {
            // Only the first value of -o, -s and -t must be there.
            if !values.is_empty() && word.parse::<f32>().is_err() {
                break;
            }
            values.push(word);
            rest = after;
        }
        let value = |k: usize| values.get(k).and_then(|word| word.parse::<f32>().ok()).filter(|x| x.is_finite());
        match option {
            // Where only one is given, it is that of u.
            "-s" => found.uv.scale = [value(0).unwrap_or(1.0), value(1).unwrap_or(1.0)],
            "-o" => found.uv.offset = [value(0).unwrap_or(0.0), value(1).unwrap_or(0.0)],
            "-clamp" => found.clamped = values == ["on"],
            _ => {}
        }
    }
    found.name = rest.trim().to_owned();
    found
}

/// The first word of `text`, and what follows it.
fn first_word(text: &str) -> Option<(&str, &str)> {
    let text = text.trim_start();
    let end = text.find(|c: char| c.is_ascii_whitespace()).unwrap_or(text.len());
    (!text.is_empty()).then(|| text.split_at(end))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Library {
        parse(text.as_bytes(), Path::new("m.mtl")).unwrap()
    }

    fn codes(library: &Library) -> Vec<&str> {
        library.notes.iter().map(|note| note.code).collect()
    }

    #[test]
    fn reads_colours_and_texture_names() {
        let text = "Kd 1 1 1\nnewmtl skin tone\nKd 0.5 0 1 # pink\nd 0.25\nnewmtl cloth\nKd 0.1 0.1 0.1\n\
                    map_Kd -s 1 1 1 -blendu on tex\\my  cloth.png\nTr 0.25\n";
        let found = read(text).materials;
        assert_eq!(found.len(), 2);
        assert_eq!(found[0].material.name, "skin tone");
        assert!((found[0].material.base_colour[0] - 0.2140).abs() < 1e-3);
        assert_eq!(found[0].material.base_colour[3], 0.25);
        assert_eq!(found[0].texture, None);
        assert_eq!(found[1].material.base_colour, [1.0, 1.0, 1.0, 0.75]);
        assert_eq!(found[1].texture.as_deref(), Some("tex\\my  cloth.png"));
    }

    #[test]
    fn colours_in_other_ranges_and_of_one_number() {
        let found = read("newmtl a\nKd 255 0 0\nnewmtl b\nKd 0.5\n");
        assert_eq!(found.materials[0].material.base_colour, [1.0, 0.0, 0.0, 1.0]);
        let [r, g, b, _] = found.materials[1].material.base_colour;
        assert!(r == g && g == b && (r - 0.2140).abs() < 1e-3);
        assert_eq!(codes(&found), ["W_COLOUR_RANGE"]);
    }

    #[test]
    fn what_glows_shows_its_glow() {
        let found =
            read("newmtl a\nKd 0 0 0\nKe 0 1 0\nnewmtl b\nmap_Ke glow.png\nnewmtl c\nmap_Ka a.png\nMAP_KD d.png\n");
        assert_eq!(found.materials[0].material.base_colour, [0.0, 1.0, 0.0, 1.0]);
        let textures: Vec<_> = found.materials.iter().map(|m| m.texture.as_deref()).collect();
        assert_eq!(textures, [None, Some("glow.png"), Some("d.png")]);
    }

    #[test]
    fn opacity_is_what_d_says_and_nothing_vanishes_silently() {
        let found = read(
            "newmtl a\nTr 1\nd 1\nnewmtl b\nTr 1\nnewmtl c\nmap_d x.png\nmap_Kd y.png\nnewmtl d\nmap_Kd -clamp on z.png\n",
        );
        let opacities: Vec<f32> = found.materials.iter().map(|m| m.material.base_colour[3]).collect();
        assert_eq!(opacities, [1.0, 0.0, 1.0, 1.0]);
        assert_eq!(codes(&found), ["W_TRANSPARENT", "W_OPACITY_MAP", "W_TEXTURE_CLAMP"]);
    }

    #[test]
    fn textures_are_scaled_and_shifted() {
        let uv = read("newmtl a\nmap_Kd -o 0.25 0.5 -s 2 4 t.png\n").materials[0].uv;
        assert_eq!(uv.apply([0.5, 0.75]), [1.25, -0.5]);
        let uv = read("newmtl a\nmap_Kd -s 2 t.png\n").materials[0].uv;
        assert_eq!(uv.scale, [2.0, 1.0]);
    }
}
