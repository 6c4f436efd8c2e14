//! PLY: ascii and binary of both byte orders, vertex colours, texture coordinates per vertex or per face corner.
//!
//! Elements and properties that mean nothing here are skipped.

mod body;
mod header;

use std::path::Path;

use glam::DVec3;

use self::body::Body;
use self::header::{Element, Header, NumberType, Property};
use super::colour;
use super::error::ImportError;
use super::mesh::MeshFile;
use super::text::utf8_without_mark;
use super::warning::Note;

/// Reads the PLY file `bytes`; `path` is for messages. Texture coordinates are turned to v downwards.
///
/// Elements may come in any order.
pub(super) fn parse(bytes: &[u8], path: &Path) -> Result<MeshFile, ImportError> {
    let bytes = &*utf8_without_mark(bytes);
    let header = Header::parse(bytes, path)?;
    header.check_size(bytes.len(), path)?;
    let mut body = Body::new(bytes, &header, path);
    let mut frame = MeshFile { material_textures: header.textures.clone(), ..MeshFile::default() };
    let mut vertices = Vertices::default();
    let mut found = false;
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => read_vertices(&mut body, element, &mut frame, &mut vertices, path)?,
            "face" => {
                found = true;
                read_faces(&mut body, element, &mut frame, header.vertex_count(), path)?;
            }
            "tristrips" => {
                let reason = "triangle strips are not read; export faces instead".into();
                return Err(ImportError::Syntax { path: path.to_owned(), line: element.line, reason });
            }
            _ => skip(&mut body, element)?,
        }
    }
    if !found {
        return Err(ImportError::NoTriangles { path: path.to_owned() });
    }
    if body.has_rest() {
        let message =
            "there is more in the file than its header announces: if vertices or faces look wrong, export it again";
        frame.notes.push(Note::new("W_PLY_REST", message));
    }
    vertices.finish(&mut frame);
    let textures = frame.material_textures.len().max(1);
    frame.material_names = (0..textures).map(|k| format!("texture {k}")).collect();
    Ok(frame)
}

/// Attributes of all vertices, until it is known what they mean.
#[derive(Default)]
struct Vertices {
    uvs: Vec<[f32; 2]>,
    normals: Vec<[f32; 3]>,
    /// Red, green, blue and opacity, 0 to 1 where the type of their numbers says so; else as written.
    colours: Vec<[f32; 4]>,
    /// Which components of colours are of 16 bits.
    wide: [bool; 4],
}

impl Vertices {
    fn finish(mut self, frame: &mut MeshFile) {
        if frame.uvs.is_empty() && !self.uvs.is_empty() {
            let corners = frame.faces.vertices.iter();
            frame.uvs = corners.map(|&v| self.uvs.get(v as usize).copied().unwrap_or_default()).collect();
        }
        if !self.normals.is_empty() {
            let corners = frame.faces.vertices.iter();
            frame.normals = corners.map(|&v| self.normals.get(v as usize).copied().unwrap_or_default()).collect();
        }
        // 16 bits that hold no more than 8 are a common mistake; read in full they would all be black.
        let wide = (0..4).filter(|&k| self.wide[k]);
        let most = self.colours.iter().flat_map(|colour| wide.clone().map(|k| colour[k])).fold(0.0, f32::max);
        if most > 0.0 && most <= 255.0 / 65535.0 {
            self.colours.iter_mut().for_each(|colour| wide.clone().for_each(|k| colour[k] *= 257.0));
            let message = "colours of 16 bits go up to 255 only: they are read as 0 to 255";
            frame.notes.push(Note::new("W_COLOUR_RANGE", message));
        }
        let (colours, note) = colour::bytes(&self.colours);
        frame.colours = colours;
        frame.notes.extend(note);
    }
}

fn skip(body: &mut Body<'_>, element: &Element) -> Result<(), ImportError> {
    if element.properties.is_empty() {
        return Ok(());
    }
    for _ in 0..element.count {
        for property in &element.properties {
            body.property(property, &mut |_, _| {})?;
        }
    }
    Ok(())
}

/// What a vertex property means.
#[derive(Clone, Copy)]
enum Slot {
    Position(usize),
    /// Which component, and the number that means 1.
    Colour(usize, f32),
    Uv(usize),
    Normal(usize),
    Nothing,
}

fn slot(property: &Property) -> Slot {
    // Whole numbers hold 0 to 255 (or 0 to 65535), others 0 to 1.
    let colour = |k: usize| match property.kind {
        NumberType::U8 | NumberType::I8 => Slot::Colour(k, 255.0),
        NumberType::U16 | NumberType::I16 => Slot::Colour(k, 65535.0),
        NumberType::U32 | NumberType::I32 => Slot::Colour(k, 255.0),
        NumberType::F32 | NumberType::F64 => Slot::Colour(k, 1.0),
    };
    if property.list_count.is_some() {
        return Slot::Nothing;
    }
    match property.name.as_str() {
        "x" => Slot::Position(0),
        "y" => Slot::Position(1),
        "z" => Slot::Position(2),
        "red" | "r" | "diffuse_red" => colour(0),
        "green" | "g" | "diffuse_green" => colour(1),
        "blue" | "b" | "diffuse_blue" => colour(2),
        "alpha" | "a" | "diffuse_alpha" => colour(3),
        "s" | "u" | "texture_u" | "texture_s" => Slot::Uv(0),
        "t" | "v" | "texture_v" | "texture_t" => Slot::Uv(1),
        "nx" => Slot::Normal(0),
        "ny" => Slot::Normal(1),
        "nz" => Slot::Normal(2),
        _ => Slot::Nothing,
    }
}

fn read_vertices(
    body: &mut Body<'_>,
    element: &Element,
    frame: &mut MeshFile,
    vertices: &mut Vertices,
    path: &Path,
) -> Result<(), ImportError> {
    let slots: Vec<Slot> = element.properties.iter().map(slot).collect();
    for axis in 0..3 {
        if !slots.iter().any(|s| matches!(s, Slot::Position(k) if *k == axis)) {
            let reason = "the vertices have no x, y and z".into();
            return Err(ImportError::Syntax { path: path.to_owned(), line: element.line, reason });
        }
    }
    let placed = element.properties.iter().zip(&slots).filter(|(_, slot)| matches!(slot, Slot::Position(_)));
    // Text has as many decimals as were written.
    frame.narrow |= !body.is_text() && placed.into_iter().any(|(property, _)| property.kind == NumberType::F32);
    let coloured = slots.iter().any(|s| matches!(s, Slot::Colour(0..=2, _)));
    let textured = slots.iter().any(|s| matches!(s, Slot::Uv(_)));
    let shaded = slots.iter().any(|s| matches!(s, Slot::Normal(_)));
    for (property, slot) in element.properties.iter().zip(&slots) {
        if let (Slot::Colour(k, _), NumberType::U16 | NumberType::I16) = (slot, property.kind) {
            vertices.wide[*k] = true;
        }
    }
    for vertex in 0..element.count {
        let (mut position, mut colour, mut uv) = ([0.0_f64; 3], [1.0_f32; 4], [0.0_f32; 2]);
        let mut normal = [0.0_f32; 3];
        for (property, slot) in element.properties.iter().zip(&slots) {
            body.property(property, &mut |_, value| match *slot {
                Slot::Position(k) => position[k] = value,
                // A signed byte is an unsigned one that was declared wrongly.
                Slot::Colour(k, full) if value < 0.0 && property.kind == NumberType::I8 => {
                    colour[k] = (value + 256.0) as f32 / full
                }
                Slot::Colour(k, full) => colour[k] = value as f32 / full,
                Slot::Uv(k) => uv[k] = value as f32,
                Slot::Normal(k) => normal[k] = value as f32,
                Slot::Nothing => {}
            })?;
        }
        frame.positions.push(DVec3::from_array(position));
        if coloured {
            if colour.iter().any(|component| !component.is_finite()) {
                return Err(body.wrong(format!("the colour of vertex {vertex} is not finite")));
            }
            vertices.colours.push(colour);
        }
        if shaded {
            vertices.normals.push(normal);
        }
        if textured {
            vertices.uvs.push(texture_coordinate(uv, || format!("vertex {vertex}"), path)?);
        }
    }
    Ok(())
}

/// Where the properties of faces that mean something are.
struct FaceProperties {
    indices: usize,
    uvs: Option<usize>,
    material: Option<usize>,
    coloured: bool,
}

impl FaceProperties {
    fn new(element: &Element, path: &Path) -> Result<Self, ImportError> {
        let properties = &element.properties;
        let list =
            |names: &[&str]| properties.iter().position(|p| p.list_count.is_some() && names.contains(&p.name.as_str()));
        let single = |name: &str| properties.iter().position(|p| p.list_count.is_none() && p.name == name);
        let indices = list(&["vertex_indices", "vertex_index", "vertex_indexes", "indices"]).ok_or_else(|| {
            let reason = "the faces have no list vertex_indices".into();
            ImportError::Syntax { path: path.to_owned(), line: element.line, reason }
        })?;
        Ok(Self {
            indices,
            uvs: list(&["texcoord", "texcoords"]),
            material: single("texnumber"),
            coloured: ["red", "green", "blue"].iter().any(|name| single(name).is_some()),
        })
    }
}

fn read_faces(
    body: &mut Body<'_>,
    element: &Element,
    frame: &mut MeshFile,
    vertex_count: u64,
    path: &Path,
) -> Result<(), ImportError> {
    let at = FaceProperties::new(element, path)?;
    let mut uvs: Vec<f32> = Vec::new();
    let mut nameless = None;
    for face in 0..element.count {
        let first = frame.faces.vertices.len();
        let (mut bad, mut material) = (None, 0.0);
        uvs.clear();
        for (k, property) in element.properties.iter().enumerate() {
            body.property(property, &mut |_, value| {
                if k == at.indices {
                    if !(value >= 0.0 && value < vertex_count as f64 && value.fract() == 0.0) {
                        bad.get_or_insert(value);
                    }
                    frame.faces.vertices.push(value as u32);
                } else if Some(k) == at.uvs {
                    uvs.push(value as f32);
                } else if Some(k) == at.material {
                    material = value;
                }
            })?;
        }
        if let Some(index) = bad {
            if index.fract() != 0.0 {
                return Err(body.wrong(format!("face {face}: the index {index} is no whole number")));
            }
            let (place, count) = (format!("face {face}, vertex"), vertex_count as usize);
            return Err(ImportError::IndexRange { path: path.to_owned(), place, index: index as i64, count });
        }
        let size = frame.faces.vertices.len() - first;
        if size < 3 {
            return Err(body.wrong(format!("face {face} has {size} corners and needs three")));
        }
        frame.faces.sizes.push(size as u32);
        if at.material.is_some() {
            let textures = frame.material_textures.len().max(1);
            if !(material >= 0.0 && material < textures as f64) {
                nameless.get_or_insert((face, material));
                material = 0.0;
            }
            frame.material_of_face.resize(frame.faces.sizes.len() - 1, 0);
            frame.material_of_face.push(material as u32);
        }
        if at.uvs.is_some() {
            frame.uvs.resize(first, [0.0, 0.0]);
            read_corner_uvs(body, face, &uvs, size, frame, path)?;
        }
    }
    if !frame.uvs.is_empty() {
        frame.uvs.resize(frame.faces.vertices.len(), [0.0, 0.0]);
    }
    if !frame.material_of_face.is_empty() {
        frame.material_of_face.resize(frame.faces.sizes.len(), 0);
    }
    if let Some((face, number)) = nameless {
        let message =
            format!("face {face} wears texture {number}, which the header does not name: it wears the first one");
        frame.notes.push(Note::new("W_TEXTURE_NUMBER", message));
    }
    if at.coloured {
        let message = "the faces have colours, which are left aside: give the vertices colours, or a texture";
        frame.notes.push(Note::new("W_FACE_COLOURS", message));
    }
    Ok(())
}

/// Appends the texture coordinates of the `size` corners of a face; none at all are zeros.
fn read_corner_uvs(
    body: &Body<'_>,
    face: u64,
    uvs: &[f32],
    size: usize,
    frame: &mut MeshFile,
    path: &Path,
) -> Result<(), ImportError> {
    if uvs.is_empty() {
        frame.uvs.resize(frame.uvs.len() + size, [0.0, 0.0]);
        frame.bare_corners.resize(1, 0);
        frame.bare_corners[0] += size;
        return Ok(());
    }
    if uvs.len() != 2 * size {
        return Err(body.wrong(format!("face {face} has {size} corners but {} texcoord numbers", uvs.len())));
    }
    for uv in uvs.chunks_exact(2) {
        frame.uvs.push(texture_coordinate([uv[0], uv[1]], || format!("face {face}"), path)?);
    }
    Ok(())
}

fn texture_coordinate([u, v]: [f32; 2], element: impl Fn() -> String, path: &Path) -> Result<[f32; 2], ImportError> {
    if u.is_finite() && v.is_finite() {
        return Ok([u, 1.0 - v]);
    }
    let reason = format!("the texture coordinate of {} is not finite", element());
    Err(ImportError::Binary { path: path.to_owned(), reason })
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "ply\nformat ascii 1.0\ncomment TextureFile a b.png\nelement vertex 4\nproperty float x\n\
        property double y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n\
        element face 1\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n\
        element other 2\nproperty list int short nothing\nend_header\n";

    fn read(text: &str) -> Result<MeshFile, ImportError> {
        parse(text.as_bytes(), Path::new("t.ply"))
    }

    #[test]
    fn reads_colours_quads_and_corner_texture_coordinates() {
        let body = "0 0 0 255 0 0\n1 0 0 0 255 0\n1 1 0 0 0 255\n0 1 0 9 9 9\n4 0 1 2 3 8 0 0 1 0 1 1 0 1\n1 5\n0\n";
        let frame = read(&format!("{HEAD}{body}")).unwrap();
        assert_eq!(frame.positions[2], DVec3::new(1.0, 1.0, 0.0));
        assert_eq!(frame.faces.sizes, [4]);
        assert_eq!(frame.uvs, [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]]);
        assert_eq!(frame.colours[1], [0, 255, 0, 255]);
        assert_eq!(frame.material_textures, ["a b.png"]);
    }

    #[test]
    fn errors_say_where() {
        let body = "0 0 0 255 0 0\n1 0 0 0 255 0\n1 1 0 0 0 255\n0 1 0 9 9 9\n";
        let error = read(&format!("{HEAD}{body}4 0 1 2 4 0\n0\n0\n")).unwrap_err();
        assert_eq!(error.code(), "E_INDEX_RANGE");
        assert!(error.to_string().contains("face 0"), "{error}");
        assert_eq!(read(&format!("{HEAD}{body}3 0 1 2\n")).unwrap_err().code(), "E_TRUNCATED");
        assert_eq!(read(&format!("{HEAD}{body}3 0 1 2 2 0 1\n0\n0\n")).unwrap_err().code(), "E_SYNTAX");
        assert_eq!(read(&format!("{HEAD}0 0 0 x")).unwrap_err().code(), "E_TRUNCATED");
        assert_eq!(read("ply\nformat ascii 1.0\nend_header\n").unwrap_err().code(), "E_NO_TRIANGLES");
    }

    #[test]
    fn a_header_cannot_ask_for_more_than_the_file_holds() {
        for count in ["4000000000", "18446744073709551615"] {
            let text = format!(
                "ply\nformat binary_little_endian 1.0\nelement vertex {count}\nproperty float x\nproperty float y\n\
                 property float z\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n"
            );
            assert_eq!(read(&text).unwrap_err().code(), "E_TRUNCATED");
        }
        let text = "ply\nformat binary_big_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
             property float z\nelement face 1\nproperty list int int vertex_indices\nend_header\n\
             aaaabbbbcccc\x7f\x7f\x7f\x7f";
        assert_eq!(read(text).unwrap_err().code(), "E_TRUNCATED");
    }

    const PLAIN: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

    #[test]
    fn lines_end_in_whatever_a_system_writes() {
        let expected = read(PLAIN).unwrap();
        for text in [PLAIN.replace('\n', "\r"), PLAIN.replace('\n', "\r\n"), format!("\u{feff}{PLAIN}")] {
            assert_eq!(read(&text).unwrap(), expected);
        }
        // A binary body may begin with the byte of a line feed.
        let head = PLAIN.split_once("end_header\n").unwrap().0.replace("ascii", "binary_little_endian");
        for end in ["\n", "\r", "\r\n"] {
            let mut bytes = format!("{head}end_header\n").replace('\n', end).into_bytes();
            bytes.extend(f32::from_bits(0x3f80_000a).to_le_bytes());
            bytes.extend([0.0_f32, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|c| c.to_le_bytes()));
            bytes.extend([3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]);
            let frame = parse(&bytes, Path::new("t.ply")).unwrap();
            assert_eq!(frame.positions[0].x, f64::from(f32::from_bits(0x3f80_000a)));
            assert_eq!((frame.faces.vertices, frame.notes), (vec![0, 1, 2], vec![]));
        }
    }

    #[test]
    fn faces_may_come_before_vertices() {
        let text = "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\nelement vertex 3\n\
            property double x\nproperty double y\nproperty double z\nproperty float s\nproperty float t\nend_header\n\
            3 2 1 0\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0.5 1\n";
        let frame = read(text).unwrap();
        assert_eq!(frame.faces.vertices, [2, 1, 0]);
        assert_eq!(frame.uvs, [[0.5, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        assert_eq!(read(&text.replace("3 2 1 0", "3 2 1 3")).unwrap_err().code(), "E_INDEX_RANGE");
    }

    #[test]
    fn numbers_that_do_not_fit_the_header_are_not_misread() {
        // A number too many in a line shifts all that follow.
        assert_eq!(read(&PLAIN.replace("3 0 1 2", "3 0 1 2 9")).unwrap().notes[0].code, "W_PLY_REST");
        assert_eq!(read(&PLAIN.replace("0 1 0\n", "0 1 0 0.5\n")).unwrap_err().code(), "E_SYNTAX");
        assert_eq!(read(&PLAIN.replace("3 0 1 2", "3 0 1 1.5")).unwrap_err().code(), "E_SYNTAX");
        assert_eq!(read(&PLAIN.replace("3 0 1 2\n", "3 0 1 2\n\0")).unwrap().notes, []);
    }

    #[test]
    fn colours_are_read_in_the_range_that_they_have() {
        let of = |kind: &str, red: &str| {
            let text = PLAIN.replace("property float z\n", &format!("property float z\nproperty {kind} red\n"));
            let frame = read(
                &text
                    .replace("1 0 0\n", &format!("1 0 0 {red}\n"))
                    .replace("0 0 0\n", "0 0 0 0\n")
                    .replace("0 1 0\n", "0 1 0 0\n"),
            );
            let frame = frame.unwrap();
            (frame.colours[1][0], frame.notes.iter().map(|note| note.code).collect::<Vec<_>>())
        };
        assert_eq!(of("uchar", "120"), (120, vec![]));
        assert_eq!(of("char", "-56"), (200, vec![]));
        assert_eq!(of("ushort", "30840"), (120, vec![]));
        assert_eq!(of("ushort", "120"), (120, vec!["W_COLOUR_RANGE"]));
        assert_eq!(of("int", "120"), (120, vec![]));
        assert_eq!(of("float", "0.2"), (51, vec![]));
        assert_eq!(of("float", "120"), (120, vec!["W_COLOUR_RANGE"]));
    }

    #[test]
    fn what_faces_say_in_vain_is_told() {
        let text = PLAIN.replace("vertex_indices\n", "vertex_indices\nproperty uchar red\nproperty int texnumber\n");
        let frame = read(&text.replace("3 0 1 2", "3 0 1 2 9 -1")).unwrap();
        let codes: Vec<_> = frame.notes.iter().map(|note| note.code).collect();
        assert_eq!((codes, frame.material_of_face), (vec!["W_TEXTURE_NUMBER", "W_FACE_COLOURS"], vec![0]));
    }
}
