//! The arrays of a frame, and the mesh that they are.

use glam::DVec3;

use super::super::mesh::{FaceList, MeshFile};
use super::file::Frame;
use super::header::Header;

/// From so many vertices on indices have 32 bits.
const WIDE: usize = 65_535;

/// The arrays of a frame as bytes.
pub(super) struct Arrays<'a> {
    vertices: &'a [u8],
    normals: &'a [u8],
    indices: &'a [u8],
    uvs: &'a [u8],
    #[cfg_attr(not(feature = "gltf"), allow(dead_code, reason = "textures are read by what reads glTF's"))]
    pub texture: Option<&'a [u8]>,
}

/// Finds the arrays of `frame`.
pub(super) fn arrays<'a>(frame: &'a Frame, header: &Header) -> Result<Arrays<'a>, String> {
    let mut rest = frame.bytes.as_slice();
    let mut next = |there: bool, what: &str| -> Result<&'a [u8], String> {
        if !there {
            return Ok(&[]);
        }
        let cut = || format!("its {what} are cut short");
        let (length, tail) = rest.split_first_chunk::<4>().ok_or_else(cut)?;
        let (array, tail) = tail.split_at_checked(u32::from_le_bytes(*length) as usize).ok_or_else(cut)?;
        rest = tail;
        Ok(array)
    };
    let textured = header.textured && header.version >= 11;
    Ok(Arrays {
        vertices: next(true, "vertices")?,
        normals: next(header.normals && header.version >= 11, "normals")?,
        indices: next(frame.key, "indices")?,
        uvs: next(frame.key, "texture coordinates")?,
        texture: if textured { Some(next(true, "textures")?) } else { None },
    })
}

/// The mesh of `frame`, whose vertices are joined as `key` says.
///
/// The format's x runs to the left and its triangles run clockwise: both are turned round.
pub(super) fn parse(frame: &Frame, key: &Frame, header: &Header) -> Result<MeshFile, String> {
    let (of, joined) = (arrays(frame, header)?, arrays(key, header)?);
    let positions: Vec<[f32; 3]> = numbers(of.vertices, "vertices")?;
    let uvs: Vec<[f32; 2]> = numbers(joined.uvs, "texture coordinates")?;
    if !uvs.is_empty() && uvs.len() != positions.len() {
        return Err(format!("it has {} vertices, and {} texture coordinates for them", positions.len(), uvs.len()));
    }
    if let Some(k) = uvs.iter().position(|uv| !(uv[0].is_finite() && uv[1].is_finite())) {
        return Err(format!("the texture coordinate of vertex {k} is not finite"));
    }
    let corners = corners(joined.indices, positions.len())?;
    // A texture's first row is its highest, and v runs upwards.
    let uv = |&v: &u32| uvs.get(v as usize).map_or([0.0; 2], |&[u, v]| [u, 1.0 - v]);
    let normals: Vec<[f32; 3]> = numbers(of.normals, "normals").unwrap_or_default();
    let normal = |&v: &u32| normals.get(v as usize).map_or([0.0; 3], |&[x, y, z]| [-x, y, z]);
    let has_normals = normals.len() == positions.len();
    Ok(MeshFile {
        positions: positions.iter().map(|&[x, y, z]| DVec3::new((-x).into(), y.into(), z.into())).collect(),
        narrow: true,
        uvs: if uvs.is_empty() { Vec::new() } else { corners.iter().map(uv).collect() },
        normals: if has_normals { corners.iter().map(normal).collect() } else { Vec::new() },
        faces: FaceList { sizes: vec![3; corners.len() / 3], vertices: corners },
        ..MeshFile::default()
    })
}

/// The vertices of all triangles' corners.
fn corners(indices: &[u8], vertices: usize) -> Result<Vec<u32>, String> {
    let wide = |bytes: &[u8; 4]| u32::from_le_bytes(*bytes);
    let narrow = |bytes: &[u8; 2]| u32::from(u16::from_le_bytes(*bytes));
    let (mut corners, left): (Vec<u32>, usize) = if vertices >= WIDE {
        let (all, left) = indices.as_chunks::<4>();
        (all.iter().map(wide).collect(), left.len())
    } else {
        let (all, left) = indices.as_chunks::<2>();
        (all.iter().map(narrow).collect(), left.len())
    };
    if left > 0 || !corners.len().is_multiple_of(3) {
        return Err(format!("its indices have {} bytes, which are no whole triangles", indices.len()));
    }
    if let Some(k) = corners.iter().position(|&corner| corner as usize >= vertices) {
        return Err(format!("triangle {} names vertex {}, of {vertices}", k / 3, corners[k]));
    }
    for triangle in corners.as_chunks_mut::<3>().0 {
        triangle.swap(0, 2);
    }
    Ok(corners)
}

/// `N` numbers each.
fn numbers<const N: usize>(bytes: &[u8], what: &str) -> Result<Vec<[f32; N]>, String> {
    let (all, left) = bytes.as_chunks::<4>();
    if !left.is_empty() || !all.len().is_multiple_of(N) {
        return Err(format!("its {what} have {} bytes, which is no multiple of {}", bytes.len(), 4 * N));
    }
    let number = |bytes: &[u8; 4]| f32::from_le_bytes(*bytes);
    Ok(all.as_chunks::<N>().0.iter().map(|one| std::array::from_fn(|k| number(&one[k]))).collect())
}
