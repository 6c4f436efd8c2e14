//! Draco meshes: standalone `.drc` files, and what `KHR_draco_mesh_compression` embeds in glTF.

use draco_core::{
    DataType, DecodeLimits, DecoderBuffer, ErrorKind, GeometryAttributeType, Mesh, MeshDecoder, PointAttribute,
    PointIndex,
};
use thiserror::Error;

/// No mesh has more points or faces; a stream of a kilobyte can ask for millions of them.
const MAX_POINTS: u64 = 1 << 24;
const MAX_FACES: u64 = 1 << 25;
/// Bytes of all decoded attributes of a mesh.
const MAX_BYTES: u64 = 1 << 30;

/// A decoded mesh. A point is a corner's combination of attributes: a vertex on a seam of the texture is several points.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct DracoMesh {
    /// Number of points.
    pub point_count: usize,
    /// Points of each triangle, all below `point_count`.
    pub faces: Vec<[u32; 3]>,
    /// What the points have.
    pub attributes: Vec<DracoAttribute>,
}

/// One attribute of all points.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct DracoAttribute {
    /// The number by which glTF names it.
    pub id: u32,
    /// What it says.
    pub kind: DracoKind,
    /// Numbers of a point.
    pub width: usize,
    /// `width` numbers a point. Integers are as they are stored, not brought to 0..1.
    pub values: Vec<f32>,
    /// Whether the numbers are stored as integers.
    pub whole: bool,
    /// The largest integer of their kind, which stands for 1 where they are colours; 1 for others.
    pub most: f32,
}

/// What an attribute says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DracoKind {
    /// Positions, three numbers each.
    Position,
    /// Normals.
    Normal,
    /// Colours.
    Colour,
    /// Texture coordinates, v as the writer has it.
    TextureCoordinate,
    /// Anything else.
    Other,
}

/// Why bytes are no Draco mesh.
#[derive(Debug, Error, PartialEq, Eq)]
pub(super) enum DracoError {
    /// The first bytes are not Draco's.
    #[error("it does not begin like a Draco file")]
    NotDraco,
    /// Points without faces.
    #[error("it holds a point cloud, not a mesh")]
    PointCloud,
    /// More than is read.
    #[error("it holds more than {MAX_POINTS} points or {MAX_FACES} triangles")]
    TooLarge,
    /// Damaged, cut short, or of a version that is not read.
    #[error("Draco: {0}")]
    Damaged(String),
}

impl DracoMesh {
    /// The attribute that glTF names `id`.
    pub fn by_id(&self, id: u32) -> Option<&DracoAttribute> {
        self.attributes.iter().find(|attribute| attribute.id == id)
    }
}

/// Decodes a Draco file of version 1.2 to 2.2: edgebreaker or sequential, quantised or not.
///
/// # Errors
/// See [`DracoError`]. Never more than a gigabyte of attributes is decoded, whatever the bytes say.
pub(super) fn decode_draco(bytes: &[u8]) -> Result<DracoMesh, DracoError> {
    // The header: "DRACO", version, and what follows (0 points, 1 a mesh).
    match bytes.get(..5).zip(bytes.get(7)) {
        Some((b"DRACO", 0)) => return Err(DracoError::PointCloud),
        Some((b"DRACO", _)) => {}
        _ => return Err(DracoError::NotDraco),
    }
    let limits = DecodeLimits::default();
    let limits = limits.with_max_points(MAX_POINTS).with_max_faces(MAX_FACES).with_max_decoded_bytes(MAX_BYTES);
    let mut mesh = Mesh::new();
    MeshDecoder::new().decode(&mut DecoderBuffer::new(bytes).with_limits(limits), &mut mesh).map_err(|error| {
        match error.kind() {
            ErrorKind::LimitExceeded => DracoError::TooLarge,
            _ => DracoError::Damaged(error.message().to_owned()),
        }
    })?;
    let point_count = mesh.num_points();
    if point_count as u64 > MAX_POINTS {
        return Err(DracoError::TooLarge);
    }
    let faces: Vec<[u32; 3]> = mesh.faces().iter().map(|face| face.map(|point| point.0)).collect();
    if let Some(point) = faces.iter().flatten().find(|&&point| point as usize >= point_count) {
        return Err(DracoError::Damaged(format!("a triangle names point {point}, of {point_count}")));
    }
    let mut attributes = Vec::new();
    for index in 0..mesh.num_attributes() {
        let attribute = mesh.try_attribute(index).map_err(|error| DracoError::Damaged(error.message().to_owned()))?;
        attributes.push(read(attribute, point_count)?);
    }
    Ok(DracoMesh { point_count, faces, attributes })
}

fn read(attribute: &PointAttribute, point_count: usize) -> Result<DracoAttribute, DracoError> {
    // The crate reads zeros for what a damaged file does not hold.
    let missing = |point: usize| attribute.mapped_index(PointIndex(point as u32)).0 as usize >= attribute.size();
    let bytes = usize::try_from(attribute.byte_stride()).ok().and_then(|stride| stride.checked_mul(attribute.size()));
    if (0..point_count).any(missing) || bytes.is_none_or(|bytes| bytes > attribute.buffer().data().len()) {
        return Err(DracoError::Damaged("an attribute has fewer values than the mesh has points".into()));
    }
    let width = usize::from(attribute.num_components());
    Ok(DracoAttribute {
        id: attribute.unique_id(),
        kind: match attribute.attribute_type() {
            GeometryAttributeType::Position => DracoKind::Position,
            GeometryAttributeType::Normal => DracoKind::Normal,
            GeometryAttributeType::Color => DracoKind::Colour,
            GeometryAttributeType::TexCoord => DracoKind::TextureCoordinate,
            _ => DracoKind::Other,
        },
        width,
        values: attribute.read_f32s(point_count, width),
        whole: !matches!(attribute.data_type(), DataType::Float32 | DataType::Float64),
        most: match attribute.data_type() {
            DataType::Uint8 => 255.0,
            DataType::Int8 => 127.0,
            DataType::Uint16 => 65535.0,
            DataType::Int16 => 32767.0,
            _ => 1.0,
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Files made by the encoder of the format's authors, with what their own decoder makes of them: `README.md` beside.
    macro_rules! sample {
        ($name:literal) => {{
            let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/draco/");
            let read = |ending: &str| std::fs::read(format!("{folder}{}.{ending}", $name)).unwrap();
            let words = |bytes: Vec<u8>| bytes.chunks_exact(4).map(|b| b.try_into().unwrap()).collect::<Vec<[u8; 4]>>();
            let positions = words(read("positions")).into_iter().map(f32::from_le_bytes).collect::<Vec<_>>();
            let faces = words(read("faces")).into_iter().map(u32::from_le_bytes).collect::<Vec<_>>();
            (read("drc"), positions, faces)
        }};
    }

    #[test]
    fn decodes_as_the_authors_decoder_does() {
        for (drc, positions, faces) in
            [sample!("edgebreaker"), sample!("valence"), sample!("sequential"), sample!("unquantised")]
        {
            let mesh = decode_draco(&drc).unwrap();
            assert_eq!(mesh.faces.as_flattened(), faces);
            let found = mesh.attributes.iter().find(|a| a.kind == DracoKind::Position).unwrap();
            assert_eq!((found.width, found.whole), (3, false));
            assert_eq!(found.values, positions);
            let uvs = mesh.attributes.iter().find(|a| a.kind == DracoKind::TextureCoordinate).unwrap();
            assert!(uvs.width == 2 && uvs.values.len() == 2 * mesh.point_count);
            assert!(uvs.values.iter().all(|&c| (-0.001..=1.001).contains(&c)));
        }
    }

    #[test]
    fn damage_is_refused_or_decodes_to_a_mesh() {
        let (drc, ..) = sample!("valence");
        for length in 0..drc.len() {
            assert!(decode_draco(&drc[..length]).is_err(), "{length} of {} bytes", drc.len());
        }
        let mut damaged = drc.clone();
        for at in 0..drc.len() {
            for flip in [1, 0x10, 0x80, 0xff] {
                damaged[at] ^= flip;
                if let Ok(mesh) = decode_draco(&damaged) {
                    assert!(mesh.faces.iter().flatten().all(|&p| (p as usize) < mesh.point_count));
                    assert!(mesh.attributes.iter().all(|a| a.values.len() == a.width * mesh.point_count));
                }
                damaged[at] = drc[at];
            }
        }
        assert_eq!(decode_draco(b"DRACO\x02\x02\0\0\0\0"), Err(DracoError::PointCloud));
        assert_eq!(decode_draco(b"glTF"), Err(DracoError::NotDraco));
    }
}
