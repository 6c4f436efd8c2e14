//! Wavefront OBJ: `v` (with colours), `vt`, `vn`, `f`, `usemtl` and `mtllib`; the rest is skipped.

use std::collections::HashMap;
use std::path::Path;

use glam::DVec3;

use super::colour;
use super::error::ImportError;
use super::mesh::MeshFile;
use super::text::{Continues, for_each_line, keyword_and_rest, number, shorten, syntax, without_comment};
use super::warning::Note;

/// Reads the OBJ file `bytes`; `path` is for messages.
///
/// Texture coordinates are turned to v downwards. Faces keep their polygons. Face corners without a texture
/// coordinate in a file that has some get (0, 0).
pub(super) fn parse(bytes: &[u8], path: &Path) -> Result<MeshFile, ImportError> {
    let mut reader = Reader::new(path);
    for_each_line(bytes, continues, |line, text| reader.line(line, text))?;
    reader.finish()
}

/// Whether a statement that ends in a backslash goes on.
fn continues(keyword: &str) -> Continues {
    match keyword {
        "v" | "vt" | "vn" | "f" | "fo" => Continues::Always,
        "usemtl" | "mtllib" => Continues::WhereApart,
        // What is skipped may be carried on by lines that begin with a number, and are skipped, too.
        _ => Continues::Never,
    }
}

struct Reader<'a> {
    path: &'a Path,
    frame: MeshFile,
    uvs: Vec<[f32; 2]>,
    /// Index into `uvs` of each face corner, from 1; 0 for none.
    uv_of_corner: Vec<u32>,
    normals: Vec<[f32; 3]>,
    /// Index into `normals` of each face corner, from 1; 0 for none that can be read.
    normal_of_corner: Vec<u32>,
    /// Colours of the vertices as written; not a number where a vertex has none. Empty where no vertex has.
    colours: Vec<[f32; 4]>,
    material: Option<u32>,
    material_by_name: HashMap<String, u32>,
    /// Largest indices seen, from 1, and their lines.
    last_vertex: (u32, usize),
    last_uv: (u32, usize),
    odd: Odd,
}

/// What is unusual about the file's statements.
#[derive(Default)]
struct Odd {
    /// First line of a vertex with numbers that mean nothing here, and how many it has.
    numbers: Option<(usize, usize)>,
    /// First line of a vertex of seven numbers, and whether the fourth of all of them is 1.
    seven: Option<(usize, bool)>,
    /// First line of a free-form curve or surface.
    surface: Option<usize>,
}

impl<'a> Reader<'a> {
    fn new(path: &'a Path) -> Self {
        Self {
            path,
            frame: MeshFile::default(),
            uvs: Vec::new(),
            uv_of_corner: Vec::new(),
            normals: Vec::new(),
            normal_of_corner: Vec::new(),
            colours: Vec::new(),
            material: None,
            material_by_name: HashMap::new(),
            last_vertex: (0, 0),
            last_uv: (0, 0),
            odd: Odd::default(),
        }
    }

    fn line(&mut self, line: usize, text: &str) -> Result<(), ImportError> {
        let (keyword, rest) = keyword_and_rest(text);
        match keyword {
            "v" => self.vertex(line, without_comment(rest)),
            "vt" => self.texture_coordinate(line, without_comment(rest)),
            "vn" => {
                self.normals.push(normal(without_comment(rest)));
                Ok(())
            }
            // "fo" is what old files write.
            "f" | "fo" => self.face(line, without_comment(rest)),
            // A name may hold a "#": whether it is a comment shows when the name is looked for.
            "usemtl" => {
                self.use_material(rest);
                Ok(())
            }
            "mtllib" => {
                self.frame.libraries.push(rest.to_owned());
                Ok(())
            }
            "curv" | "curv2" | "surf" => {
                self.odd.surface.get_or_insert(line);
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn vertex(&mut self, line: usize, rest: &str) -> Result<(), ImportError> {
        let mut values = [0.0; 7];
        let mut count = 0;
        for word in rest.split_ascii_whitespace() {
            if let Some(value) = values.get_mut(count) {
                *value = number(self.path, line, word)?;
            }
            count += 1;
        }
        let [x, y, z, w, ..] = values;
        // x y z [w], x y z r g b, or x y z r g b a.
        let colour = match count {
            0..=2 => return Err(syntax(self.path, line, "a vertex needs three coordinates")),
            6 => Some([values[3], values[4], values[5], 1.0]),
            7 => Some([values[3], values[4], values[5], values[6]]),
            _ => None,
        };
        if count == 7 {
            let (_, all_one) = self.odd.seven.get_or_insert((line, true));
            *all_one &= w == 1.0;
        }
        if count == 5 || count > 7 || (count == 4 && w != 1.0) {
            self.odd.numbers.get_or_insert((line, count));
        }
        if let Some(colour) = colour {
            if colour.iter().any(|component| !component.is_finite()) {
                return Err(syntax(self.path, line, "a colour is not finite"));
            }
            self.colours.resize(self.frame.positions.len(), [f32::NAN; 4]);
            self.colours.push(colour.map(|component| component as f32));
        }
        self.frame.positions.push(DVec3::new(x, y, z));
        Ok(())
    }

    fn texture_coordinate(&mut self, line: usize, rest: &str) -> Result<(), ImportError> {
        let mut words = rest.split_ascii_whitespace();
        let u = words.next().ok_or_else(|| syntax(self.path, line, "a texture coordinate needs u and v"))?;
        let u = number(self.path, line, u)? as f32;
        let v = words.next().map_or(Ok(0.0), |word| number(self.path, line, word))? as f32;
        if !(u.is_finite() && v.is_finite()) {
            return Err(syntax(self.path, line, "a texture coordinate is not finite"));
        }
        self.uvs.push([u, 1.0 - v]);
        Ok(())
    }

    fn face(&mut self, line: usize, rest: &str) -> Result<(), ImportError> {
        let mut size = 0_u32;
        for word in rest.split_ascii_whitespace() {
            let mut parts = word.split('/');
            let vertex = self.index(line, word, parts.next(), self.frame.positions.len(), "vertex")?;
            let vertex = vertex.ok_or_else(|| syntax(self.path, line, "a face corner names no vertex"))?;
            let uv = self.index(line, word, parts.next(), self.uvs.len(), "texture coordinate")?;
            self.frame.faces.vertices.push(vertex - 1);
            self.uv_of_corner.push(uv.unwrap_or(0));
            self.normal_of_corner.push(self.normal_index(parts.next()));
            if vertex > self.last_vertex.0 {
                self.last_vertex = (vertex, line);
            }
            if uv.is_some_and(|uv| uv > self.last_uv.0) {
                self.last_uv = (uv.unwrap_or(0), line);
            }
            size += 1;
        }
        if size < 3 {
            return Err(syntax(self.path, line, format!("a face needs three corners, not {size}")));
        }
        self.frame.faces.sizes.push(size);
        let material = match self.material {
            Some(material) => material,
            None => self.use_material(""),
        };
        self.frame.material_of_face.push(material);
        Ok(())
    }

    /// An index from 1; negative ones count back from the `count` elements read so far.
    fn index(
        &self,
        line: usize,
        word: &str,
        part: Option<&str>,
        count: usize,
        what: &str,
    ) -> Result<Option<u32>, ImportError> {
        let Some(text) = part.filter(|text| !text.is_empty()) else { return Ok(None) };
        let index: i64 =
            text.parse().map_err(|_| syntax(self.path, line, format!("\"{}\" is not a face corner", shorten(word))))?;
        let absolute = if index < 0 { count as i64 + 1 + index } else { index };
        match u32::try_from(absolute) {
            Ok(absolute) if absolute > 0 => Ok(Some(absolute)),
            _ => Err(ImportError::IndexRange {
                path: self.path.to_owned(),
                place: format!("line {line}, {what}"),
                index,
                count,
            }),
        }
    }

    /// An index of a normal from 1; 0 where there is none. Nothing that is drawn depends on normals, so nothing is refused.
    fn normal_index(&self, part: Option<&str>) -> u32 {
        let index = part.and_then(|text| text.parse::<i64>().ok()).unwrap_or(0);
        let absolute = if index < 0 { self.normals.len() as i64 + 1 + index } else { index };
        u32::try_from(absolute).unwrap_or(0)
    }

    fn use_material(&mut self, name: &str) -> u32 {
        let next = self.frame.material_names.len() as u32;
        let material = *self.material_by_name.entry(name.to_owned()).or_insert(next);
        if material == next {
            self.frame.material_names.push(name.to_owned());
        }
        self.material = Some(material);
        material
    }

    fn finish(mut self) -> Result<MeshFile, ImportError> {
        // Indices may point forwards, so they are checked here.
        let checks = [
            (self.last_vertex, self.frame.positions.len(), "vertex"),
            (self.last_uv, self.uvs.len(), "texture coordinate"),
        ];
        for ((index, line), count, what) in checks {
            if index as usize > count {
                let place = format!("line {line}, {what}");
                return Err(ImportError::IndexRange { path: self.path.to_owned(), place, index: index.into(), count });
            }
        }
        if !self.colours.is_empty() {
            self.colours.resize(self.frame.positions.len(), [f32::NAN; 4]);
            let (colours, note) = colour::bytes(&self.colours);
            self.frame.colours = colours;
            self.frame.notes.extend(note);
        }
        if self.uv_of_corner.iter().any(|&uv| uv > 0) {
            let uv = |&index: &u32| self.uvs.get((index as usize).wrapping_sub(1)).copied().unwrap_or([0.0, 0.0]);
            self.frame.uvs = self.uv_of_corner.iter().map(uv).collect();
            self.frame.bare_corners = self.bare_corners();
        }
        let normal = |&index: &u32| self.normals.get((index as usize).wrapping_sub(1)).copied();
        // Normals of some corners only are those of no program.
        let normals: Option<Vec<[f32; 3]>> = self.normal_of_corner.iter().map(normal).collect();
        self.frame.normals = normals.unwrap_or_default();
        self.frame.notes.extend(self.odd.notes());
        Ok(self.frame)
    }

    /// How many face corners of each material have no texture coordinate.
    fn bare_corners(&self) -> Vec<usize> {
        let mut bare = vec![0; self.frame.material_names.len()];
        let mut corners = self.uv_of_corner.iter();
        for (&size, &material) in self.frame.faces.sizes.iter().zip(&self.frame.material_of_face) {
            bare[material as usize] += corners.by_ref().take(size as usize).filter(|&&uv| uv == 0).count();
        }
        bare
    }
}

/// Three numbers; zero where they are none.
fn normal(data: &str) -> [f32; 3] {
    let mut words = data.split_ascii_whitespace().map(|word| word.parse().unwrap_or(0.0));
    [0, 1, 2].map(|_| words.next().unwrap_or(0.0))
}

impl Odd {
    fn notes(&self) -> Vec<Note> {
        let mut notes = Vec::new();
        if let Some((line, count)) = self.numbers {
            let read = if count == 4 { "the fourth is" } else { "those after the third are" };
            let message = format!("line {line}: a vertex of {count} numbers, of which {read} left aside");
            notes.push(Note::new("W_VERTEX_NUMBERS", message));
        }
        if let Some((line, true)) = self.seven {
            let message = format!(
                "line {line}: vertices of seven numbers are read as x y z, red, green, blue, opacity, and all have a red \
                 of 1: if 1 is a weight and the colour comes after it, leave the weight out"
            );
            notes.push(Note::new("W_VERTEX_NUMBERS", message));
        }
        if let Some(line) = self.surface {
            let message = format!("line {line}: free-form curves and surfaces are left out; export them as faces");
            notes.push(Note::new("W_OBJ_SURFACE", message));
        }
        notes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<MeshFile, ImportError> {
        parse(text.as_bytes(), Path::new("t.obj"))
    }

    #[test]
    fn reads_polygons_negative_indices_colours_and_continued_lines() {
        let text = "# c\nmtllib a b.mtl\nv 0 0 0 1 0 0\nv 1 0 0\nv 1 1 0 0 0 1\r\nv 0 1 \\\n 0\nvt 0.25 0.25\n\
                    usemtl red\nf -4/1 -3 3//7 4/-1/2\nusemtl\nf 1 2 3\n";
        let frame = read(text).unwrap();
        assert_eq!(frame.positions[3], DVec3::Y);
        assert_eq!(frame.faces.sizes, [4, 3]);
        assert_eq!(frame.faces.vertices, [0, 1, 2, 3, 0, 1, 2]);
        assert_eq!(frame.uvs[0], [0.25, 0.75]);
        assert_eq!(frame.uvs[1], [0.0, 0.0]);
        assert_eq!(frame.uvs[3], [0.25, 0.75]);
        assert_eq!(frame.colours, [[255, 0, 0, 255], [255; 4], [0, 0, 255, 255], [255; 4]]);
        assert_eq!(frame.material_names, ["red", ""]);
        assert_eq!(frame.material_of_face, [0, 1]);
        assert_eq!(frame.libraries, ["a b.mtl"]);
    }

    #[test]
    fn errors_name_the_line() {
        let code = |text: &str| {
            let error = read(text).unwrap_err();
            (error.code(), error.to_string())
        };
        let (kind, message) = code("v 0 0 0\nf 1 2 3\n");
        assert_eq!(kind, "E_INDEX_RANGE");
        assert!(message.contains("line 2") && message.contains("index 3"), "{message}");
        assert_eq!(code("v 0 0 0\nf 1 -2 1").0, "E_INDEX_RANGE");
        assert_eq!(code("v 0 0 0\nf 1 0 1").0, "E_INDEX_RANGE");
        assert_eq!(code("v 0 0 0\nf 1/1 1/1 1/1").0, "E_INDEX_RANGE");
        assert_eq!(code("v 0 0\n").0, "E_SYNTAX");
        assert_eq!(code("\nv 0 zero 0\n").1, "t.obj, line 2: \"zero\" is not a number");
        assert_eq!(code("v 0 0 0\nf 1 1\n").0, "E_SYNTAX");
        assert_eq!(code("v 0 0 0\nf 1 a 1\n").0, "E_SYNTAX");
        assert_eq!(code("vt nan 0\n").0, "E_SYNTAX");
    }

    #[test]
    fn comments_stand_behind_data_but_not_in_names() {
        assert_eq!(read("v 0 0 1.#QNAN\n").unwrap_err().to_string(), "t.obj, line 1: \"1.#QNAN\" is not a number");
        let text = "v 0 0 0 # a\nv 1 0 0#b\nv 0 1 0 # D:\\c\\\nvt 0 0 # d\nusemtl Material #25\nf 1/1 2/1 3/1 # e\n";
        let frame = read(text).unwrap();
        assert_eq!((frame.positions.len(), frame.faces.vertices), (3, vec![0, 1, 2]));
        assert_eq!(frame.material_names, ["Material #25"]);
    }

    #[test]
    fn colours_may_have_opacity_or_go_to_255() {
        let of = |rest: &str| {
            let frame = read(&format!("v 0 0 0 {rest}\nv 1 0 0\n")).unwrap();
            (frame.colours, frame.notes.iter().map(|note| note.code).collect::<Vec<_>>())
        };
        assert_eq!(of("0.2 0.4 0 0.5"), (vec![[51, 102, 0, 128], [255; 4]], vec![]));
        // A weight of 1 before the colour cannot be told from a red of 1.
        assert_eq!(of("1 0 0 0.5"), (vec![[255, 0, 0, 128], [255; 4]], vec!["W_VERTEX_NUMBERS"]));
        assert_eq!(of("120 60 30"), (vec![[120, 60, 30, 255], [255; 4]], vec!["W_COLOUR_RANGE"]));
        assert_eq!(of("1.0"), (vec![], vec![]));
        assert_eq!(of("0.5"), (vec![], vec!["W_VERTEX_NUMBERS"]));
        assert_eq!(of("0.5 0.5"), (vec![], vec!["W_VERTEX_NUMBERS"]));
        assert_eq!(read("v 0 0 0 nan 0 0").unwrap_err().code(), "E_SYNTAX");
    }

    #[test]
    fn coordinates_keep_their_decimals_far_from_the_origin() {
        let frame = read("v 432187.364045 12.688889 5839219.759444\n").unwrap();
        assert_eq!(frame.positions, [DVec3::new(432187.364045, 12.688889, 5839219.759444)]);
    }

    #[test]
    fn what_is_not_read_is_said() {
        let frame = read("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\nusemtl b\nfo 1 3 2\nsurf 0 1\n");
        let frame = frame.unwrap();
        assert_eq!((frame.faces.sizes.len(), frame.bare_corners), (2, vec![0, 3]));
        assert_eq!(frame.notes[0].code, "W_OBJ_SURFACE");
    }
}
