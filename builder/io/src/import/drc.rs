//! Draco files (`.drc`), one a frame, as players of volumetric video load them.

use std::path::Path;

use glam::DVec3;

use super::draco::{DracoAttribute, DracoKind, DracoMesh, decode_draco};
use super::error::ImportError;
use super::mesh::{FaceList, MeshFile, byte};
use super::warning::Note;

/// Reads a file.
pub(super) fn parse(bytes: &[u8], path: &Path) -> Result<MeshFile, ImportError> {
    let wrong = |reason: String| ImportError::Binary { path: path.to_owned(), reason };
    let mesh = decode_draco(bytes).map_err(|error| wrong(error.to_string()))?;
    let of = |kind: DracoKind| mesh.attributes.iter().find(|attribute| attribute.kind == kind);
    let positions = of(DracoKind::Position).ok_or_else(|| wrong("it holds no positions".into()))?;
    if positions.width != 3 {
        return Err(wrong(format!("its positions have {} numbers instead of 3", positions.width)));
    }
    let mut file = MeshFile {
        positions: positions
            .values
            .as_chunks::<3>()
            .0
            .iter()
            .map(|&[x, y, z]| DVec3::new(x.into(), y.into(), z.into()))
            .collect(),
        narrow: true,
        faces: FaceList { sizes: vec![3; mesh.faces.len()], vertices: mesh.faces.as_flattened().to_vec() },
        ..MeshFile::default()
    };
    // Corners of a point have its attributes. Draco keeps v as OBJ has it, upwards.
    let uv = |[u, v]: [f32; 2]| [u, 1.0 - v];
    file.uvs = corners::<2>(&mesh, of(DracoKind::TextureCoordinate)).into_iter().map(uv).collect();
    if file.uvs.as_flattened().iter().any(|c| !c.is_finite()) {
        return Err(wrong("a texture coordinate is not finite".into()));
    }
    file.normals = corners::<3>(&mesh, of(DracoKind::Normal));
    file.colours = of(DracoKind::Colour).map(colours).unwrap_or_default();
    for (kind, found, told) in [
        (DracoKind::TextureCoordinate, !file.uvs.is_empty(), "texture coordinates"),
        (DracoKind::Colour, !file.colours.is_empty(), "colours"),
    ] {
        if let (Some(attribute), false) = (of(kind), found) {
            let message = format!("its {told} have {} numbers, which is not read: they are left out", attribute.width);
            file.notes.push(Note::new("W_DRACO_ATTRIBUTE", message));
        }
    }
    Ok(file)
}

/// `N` numbers for every corner; empty where the attribute is not there or has other numbers.
fn corners<const N: usize>(mesh: &DracoMesh, attribute: Option<&DracoAttribute>) -> Vec<[f32; N]> {
    let Some(attribute) = attribute.filter(|attribute| attribute.width == N) else { return Vec::new() };
    let of_points = attribute.values.as_chunks::<N>().0;
    let most = if attribute.whole { attribute.most } else { 1.0 };
    let of = |&point: &u32| of_points.get(point as usize).map_or([0.0; N], |values| values.map(|value| value / most));
    mesh.faces.as_flattened().iter().map(of).collect()
}

/// Colours of the points; empty where they are none.
fn colours(attribute: &DracoAttribute) -> Vec<[u8; 4]> {
    let most = if attribute.whole { attribute.most } else { 1.0 };
    match attribute.width {
        3 => attribute
            .values
            .as_chunks::<3>()
            .0
            .iter()
            .map(|&[r, g, b]| [r, g, b, most].map(|c| byte(c / most)))
            .collect(),
        4 => attribute.values.as_chunks::<4>().0.iter().map(|rgba| rgba.map(|c| byte(c / most))).collect(),
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_decoder_gives_is_a_mesh() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/draco/");
        for name in ["edgebreaker", "valence", "sequential", "unquantised"] {
            let bytes = std::fs::read(format!("{folder}{name}.drc")).unwrap();
            let mesh = decode_draco(&bytes).unwrap();
            let file = parse(&bytes, Path::new("x.drc")).unwrap();
            assert_eq!(
                (file.positions.len(), file.faces.vertices.as_slice()),
                (mesh.point_count, mesh.faces.as_flattened())
            );
            let of = |kind| mesh.attributes.iter().find(|a| a.kind == kind).unwrap();
            let (places, uvs) = (of(DracoKind::Position), of(DracoKind::TextureCoordinate));
            for (corner, &point) in file.faces.vertices.iter().enumerate() {
                let point = point as usize;
                let place = file.positions[point].as_vec3().to_array();
                assert_eq!(place[..], places.values[3 * point..3 * point + 3]);
                let [u, v] = file.uvs[corner];
                assert_eq!([u, v], [uvs.values[2 * point], 1.0 - uvs.values[2 * point + 1]]);
            }
        }
    }

    #[test]
    fn whole_colours_are_bytes_of_their_range() {
        let of = |width: usize, whole: bool, most: f32, values: Vec<f32>| DracoAttribute {
            id: 0,
            kind: DracoKind::Colour,
            width,
            values,
            whole,
            most,
        };
        assert_eq!(colours(&of(3, true, 255.0, vec![255.0, 0.0, 51.0])), [[255, 0, 51, 255]]);
        assert_eq!(colours(&of(4, true, 65535.0, vec![65535.0, 0.0, 0.0, 32768.0])), [[255, 0, 0, 128]]);
        assert_eq!(colours(&of(3, false, 1.0, vec![1.0, 0.5, 0.0])), [[255, 128, 0, 255]]);
        assert!(colours(&of(1, true, 255.0, vec![3.0])).is_empty());
    }

    #[test]
    fn what_is_no_draco_file_is_told() {
        let error = parse(b"DRACO\x02\x02\0\0\0\0", Path::new("x.drc")).unwrap_err();
        assert_eq!(error.code(), "E_BINARY");
        assert!(error.to_string().contains("point cloud"), "{error}");
    }
}
