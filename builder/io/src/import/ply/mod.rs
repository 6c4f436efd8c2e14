//! PLY: ascii and binary of both byte orders, vertex colours, texture coordinates per vertex or per face corner.
//!
//! Elements and properties that mean nothing here are skipped.

mod body;
mod header;

use std::path::Path;

use glam::Vec3;

use self::body::Body;
use self::header::{Element, Header, Kind, Property};
use super::error::ImportError;
use super::mesh::{Frame, byte};

/// Reads the PLY file `bytes`; `path` is for messages. Texture coordinates are turned to v downwards.
pub(super) fn parse(bytes: &[u8], path: &Path) -> Result<Frame, ImportError> {
    let header = Header::parse(bytes, path)?;
    header.check_size(bytes.len(), path)?;
    let mut body = Body::new(bytes, &header, path);
    let mut frame = Frame { material_textures: header.textures.clone(), ..Frame::default() };
    let mut vertex_uvs = Vec::new();
    let mut found = false;
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => read_vertices(&mut body, element, &mut frame, &mut vertex_uvs, path)?,
            "face" => {
                found = true;
                read_faces(&mut body, element, &mut frame, &vertex_uvs, path)?;
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
    let textures = frame.material_textures.len().max(1);
    frame.material_names = (0..textures).map(|k| format!("texture {k}")).collect();
    Ok(frame)
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
    Colour(usize, f32),
    Uv(usize),
    Nothing,
}

fn slot(property: &Property) -> Slot {
    // Whole numbers hold 0 to 255 (or 0 to 65535), others 0 to 1.
    let colour = |k: usize| match property.kind {
        Kind::U8 | Kind::I8 => Slot::Colour(k, 1.0 / 255.0),
        Kind::U16 | Kind::I16 => Slot::Colour(k, 1.0 / 65535.0),
        Kind::U32 | Kind::I32 => Slot::Colour(k, 1.0 / 255.0),
        Kind::F32 | Kind::F64 => Slot::Colour(k, 1.0),
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
        _ => Slot::Nothing,
    }
}

fn read_vertices(
    body: &mut Body<'_>,
    element: &Element,
    frame: &mut Frame,
    uvs: &mut Vec<[f32; 2]>,
    path: &Path,
) -> Result<(), ImportError> {
    let slots: Vec<Slot> = element.properties.iter().map(slot).collect();
    for axis in 0..3 {
        if !slots.iter().any(|s| matches!(s, Slot::Position(k) if *k == axis)) {
            let reason = "the vertices have no x, y and z".into();
            return Err(ImportError::Syntax { path: path.to_owned(), line: element.line, reason });
        }
    }
    let coloured = slots.iter().any(|s| matches!(s, Slot::Colour(0..=2, _)));
    let textured = slots.iter().any(|s| matches!(s, Slot::Uv(_)));
    for vertex in 0..element.count {
        let (mut position, mut colour, mut uv) = ([0.0_f32; 3], [1.0_f32; 4], [0.0_f32; 2]);
        for (property, slot) in element.properties.iter().zip(&slots) {
            body.property(property, &mut |_, value| match *slot {
                Slot::Position(k) => position[k] = value as f32,
                Slot::Colour(k, scale) => colour[k] = value as f32 * scale,
                Slot::Uv(k) => uv[k] = value as f32,
                Slot::Nothing => {}
            })?;
        }
        frame.positions.push(Vec3::from_array(position));
        if coloured {
            frame.colours.push(colour.map(byte));
        }
        if textured {
            uvs.push(texture_coordinate(uv, || format!("vertex {vertex}"), path)?);
        }
    }
    Ok(())
}

fn read_faces(
    body: &mut Body<'_>,
    element: &Element,
    frame: &mut Frame,
    vertex_uvs: &[[f32; 2]],
    path: &Path,
) -> Result<(), ImportError> {
    let is_list = |p: &Property, names: &[&str]| p.list_count.is_some() && names.contains(&p.name.as_str());
    let indices_at = element.properties.iter().position(|p| is_list(p, &["vertex_indices", "vertex_index"]));
    let uvs_at = element.properties.iter().position(|p| is_list(p, &["texcoord", "texcoords"]));
    let material_at = element.properties.iter().position(|p| p.list_count.is_none() && p.name == "texnumber");
    if indices_at.is_none() {
        let reason = "the faces have no list vertex_indices".into();
        return Err(ImportError::Syntax { path: path.to_owned(), line: element.line, reason });
    }
    let vertex_count = frame.positions.len();
    let mut uvs: Vec<f32> = Vec::new();
    for face in 0..element.count {
        let first = frame.faces.vertices.len();
        let (mut bad, mut material) = (None, 0);
        uvs.clear();
        for (at, property) in element.properties.iter().enumerate() {
            body.property(property, &mut |_, value| {
                if Some(at) == indices_at {
                    if !(value >= 0.0 && value < vertex_count as f64) {
                        bad = Some(value as i64);
                    }
                    frame.faces.vertices.push(value as u32);
                } else if Some(at) == uvs_at {
                    uvs.push(value as f32);
                } else if Some(at) == material_at {
                    material = value as u32;
                }
            })?;
        }
        if let Some(index) = bad {
            let place = format!("face {face}, vertex");
            return Err(ImportError::IndexRange { path: path.to_owned(), place, index, count: vertex_count });
        }
        let size = frame.faces.vertices.len() - first;
        if size < 3 {
            return Err(body.wrong(format!("face {face} has {size} corners and needs three")));
        }
        frame.faces.sizes.push(size as u32);
        if material_at.is_some() {
            frame.material_of_face.push(material.min(frame.material_textures.len().saturating_sub(1) as u32));
        }
        if uvs_at.is_some() {
            let pairs = uvs.chunks_exact(2).map(|uv| [uv[0], uv[1]]);
            if uvs.is_empty() {
                frame.uvs.resize(frame.uvs.len() + size, [0.0, 0.0]);
            } else if uvs.len() == 2 * size {
                for uv in pairs {
                    frame.uvs.push(texture_coordinate(uv, || format!("face {face}"), path)?);
                }
            } else {
                return Err(body.wrong(format!("face {face} has {size} corners but {} texcoord numbers", uvs.len())));
            }
        }
    }
    if uvs_at.is_none() && !vertex_uvs.is_empty() {
        let corners = frame.faces.vertices.iter();
        frame.uvs = corners.map(|&v| vertex_uvs.get(v as usize).copied().unwrap_or_default()).collect();
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

    fn read(text: &str) -> Result<Frame, ImportError> {
        parse(text.as_bytes(), Path::new("t.ply"))
    }

    #[test]
    fn reads_colours_quads_and_corner_texture_coordinates() {
        let body = "0 0 0 255 0 0\n1 0 0 0 255 0\n1 1 0 0 0 255\n0 1 0 9 9 9\n4 0 1 2 3 8 0 0 1 0 1 1 0 1\n1 5\n0\n";
        let frame = read(&format!("{HEAD}{body}")).unwrap();
        assert_eq!(frame.positions[2], Vec3::new(1.0, 1.0, 0.0));
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
}
