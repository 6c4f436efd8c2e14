//! Wavefront OBJ: `v` (with colours), `vt`, `f`, `usemtl` and `mtllib`; the rest is skipped.

use std::collections::HashMap;
use std::path::Path;

use glam::Vec3;

use super::error::ImportError;
use super::mesh::{Frame, byte};
use super::text::{for_each_line, number, shorten, syntax};

/// Reads the OBJ file `bytes`; `path` is for messages.
///
/// Texture coordinates are turned to v downwards. Faces keep their polygons. Face corners without a texture
/// coordinate in a file that has some get (0, 0).
pub(super) fn parse(bytes: &[u8], path: &Path) -> Result<Frame, ImportError> {
    let mut reader = Reader::new(path);
    for_each_line(bytes, |line, text| reader.line(line, text))?;
    reader.finish()
}

struct Reader<'a> {
    path: &'a Path,
    frame: Frame,
    uvs: Vec<[f32; 2]>,
    /// Index into `uvs` of each face corner, from 1; 0 for none.
    uv_of_corner: Vec<u32>,
    material: Option<u32>,
    material_by_name: HashMap<String, u32>,
    /// Largest indices seen, from 1, and their lines.
    last_vertex: (u32, usize),
    last_uv: (u32, usize),
}

impl<'a> Reader<'a> {
    fn new(path: &'a Path) -> Self {
        Self {
            path,
            frame: Frame::default(),
            uvs: Vec::new(),
            uv_of_corner: Vec::new(),
            material: None,
            material_by_name: HashMap::new(),
            last_vertex: (0, 0),
            last_uv: (0, 0),
        }
    }

    fn line(&mut self, line: usize, text: &str) -> Result<(), ImportError> {
        let (keyword, rest) = text.split_once(|c: char| c.is_ascii_whitespace()).unwrap_or((text, ""));
        match keyword {
            "v" => self.vertex(line, rest),
            "vt" => self.texture_coordinate(line, rest),
            "f" => self.face(line, rest),
            "usemtl" => {
                self.use_material(rest.trim());
                Ok(())
            }
            "mtllib" => {
                self.frame.libraries.push(rest.trim().to_owned());
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn vertex(&mut self, line: usize, rest: &str) -> Result<(), ImportError> {
        let mut values = [0.0; 7];
        let mut count = 0;
        for word in rest.split_ascii_whitespace().take(values.len()) {
            values[count] = number(self.path, line, word)?;
            count += 1;
        }
        let [x, y, z, a, b, c, d] = values;
        // x y z [w] [r g b]: with 6 numbers there is no w.
        let colour = match count {
            0..=2 => return Err(syntax(self.path, line, "a vertex needs three coordinates")),
            6 => Some([a, b, c]),
            7 => Some([b, c, d]),
            _ => None,
        };
        if let Some([r, g, b]) = colour {
            self.frame.colours.resize(self.frame.positions.len(), [255; 4]);
            self.frame.colours.push([byte(r), byte(g), byte(b), 255]);
        }
        self.frame.positions.push(Vec3::new(x, y, z));
        Ok(())
    }

    fn texture_coordinate(&mut self, line: usize, rest: &str) -> Result<(), ImportError> {
        let mut words = rest.split_ascii_whitespace();
        let u = words.next().ok_or_else(|| syntax(self.path, line, "a texture coordinate needs u and v"))?;
        let u = number(self.path, line, u)?;
        let v = words.next().map_or(Ok(0.0), |word| number(self.path, line, word))?;
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

    fn use_material(&mut self, name: &str) -> u32 {
        let next = self.frame.material_names.len() as u32;
        let material = *self.material_by_name.entry(name.to_owned()).or_insert(next);
        if material == next {
            self.frame.material_names.push(name.to_owned());
        }
        self.material = Some(material);
        material
    }

    fn finish(mut self) -> Result<Frame, ImportError> {
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
        if !self.frame.colours.is_empty() {
            self.frame.colours.resize(self.frame.positions.len(), [255; 4]);
        }
        if self.uv_of_corner.iter().any(|&uv| uv > 0) {
            let uv = |&index: &u32| self.uvs.get((index as usize).wrapping_sub(1)).copied().unwrap_or([0.0, 0.0]);
            self.frame.uvs = self.uv_of_corner.iter().map(uv).collect();
        }
        Ok(self.frame)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Frame, ImportError> {
        parse(text.as_bytes(), Path::new("t.obj"))
    }

    #[test]
    fn reads_polygons_negative_indices_colours_and_continued_lines() {
        let text = "# c\nmtllib a b.mtl\nv 0 0 0 1 0 0\nv 1 0 0\nv 1 1 0 0 0 1\r\nv 0 1 \\\n 0\nvt 0.25 0.25\n\
                    usemtl red\nf -4/1 -3 3//7 4/-1/2\nusemtl\nf 1 2 3\n";
        let frame = read(text).unwrap();
        assert_eq!(frame.positions[3], Vec3::Y);
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
}
