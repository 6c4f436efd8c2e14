//! A mesh as files give it, before welding: file vertices, faces, attributes of face corners.

use actor::surface::{Image, Material};
use glam::{DVec3, Vec3};

use super::polygon::triangulate;
use super::warning::Note;
use super::worn::{NamedTexture, UvTransform};

/// Faces over file vertices, flattened; the same in every frame of a capture.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct FaceList {
    /// Number of corners of each face, at least 3.
    pub sizes: Vec<u32>,
    /// File vertices of the corners, face after face.
    pub vertices: Vec<u32>,
}

impl FaceList {
    /// The first face in which two lists differ.
    pub fn first_difference(&self, other: &Self) -> Option<usize> {
        if self == other {
            return None;
        }
        let same = self.iter().zip(other.iter()).take_while(|(a, b)| a == b).count();
        Some(same)
    }

    /// The faces, as slices of file vertices.
    pub fn iter(&self) -> impl Iterator<Item = &[u32]> {
        let mut rest = self.vertices.as_slice();
        self.sizes.iter().map_while(move |&size| {
            let (face, tail) = rest.split_at_checked(size as usize)?;
            rest = tail;
            Some(face)
        })
    }
}

/// What one OBJ or PLY file holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct MeshFile {
    /// Vertex positions in the file's units and axes; 64 bits, for they may be far from the origin.
    pub positions: Vec<DVec3>,
    /// Whether the file holds them with 32 bits.
    pub narrow: bool,
    /// The faces.
    pub faces: FaceList,
    /// Texture coordinates of the face corners, v downwards; empty where the file has none.
    pub uvs: Vec<[f32; 2]>,
    /// Normals of the face corners, in the file's axes; empty where not all have one.
    pub normals: Vec<[f32; 3]>,
    /// sRGB colours of the vertices; empty where the file has none.
    pub colours: Vec<[u8; 4]>,
    /// Index into `material_names` of each face; empty where the file names no material.
    pub material_of_face: Vec<u32>,
    /// Materials in the order of their first use.
    pub material_names: Vec<String>,
    /// Material libraries (OBJ).
    pub libraries: Vec<String>,
    /// Texture file of each material (PLY).
    pub material_textures: Vec<String>,
    /// How many corners of each material have no texture coordinate while others do; empty where all or none have.
    pub bare_corners: Vec<usize>,
    /// What is unusual about the file.
    pub notes: Vec<Note>,
}

/// What all frames of a capture share: faces over file vertices and how they look.
#[derive(Clone, Debug, Default)]
pub(super) struct FileMesh {
    /// Number of file vertices.
    pub vertex_count: usize,
    /// The faces.
    pub faces: FaceList,
    /// Texture coordinates of the face corners, v downwards; empty where there are none.
    pub uvs: Vec<[f32; 2]>,
    /// Normals of the face corners in the first frame, by which it is known which share one; empty where there are none.
    pub normals: Vec<[f32; 3]>,
    /// sRGB colours of the file vertices; empty where there are none.
    pub colours: Vec<[u8; 4]>,
    /// Index into `materials` of each face; empty where all have material 0.
    pub material_of_face: Vec<u32>,
    /// At least one.
    pub materials: Vec<Material>,
    /// Static textures.
    pub images: Vec<Image>,
    /// The texture that mesh files name for each material, which is not among `images` yet; empty for glTF.
    pub textures: Vec<Option<NamedTexture>>,
    /// How each material's texture moves the texture coordinates; empty where none does.
    pub uv_transforms: Vec<UvTransform>,
    /// How many corners of each material have no texture coordinate while others do; empty where all or none have.
    pub bare_corners: Vec<usize>,
    /// Whether an OBJ file names materials, but no library that describes them.
    pub names_no_library: bool,
}

/// A triangle over corners of [`FaceList::vertices`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FileTriangle {
    /// Indices into [`FaceList::vertices`] and the attributes beside it.
    pub corners: [usize; 3],
    /// Its material.
    pub material: u32,
    /// The face that it is a piece of.
    pub face: u32,
}

impl FileMesh {
    /// The faces as triangles, sorted by material and otherwise in the file's order; `pose` has the file's vertices.
    pub fn triangles(&self, pose: &[Vec3]) -> Vec<FileTriangle> {
        let mut triangles = Vec::with_capacity(self.faces.vertices.len());
        let mut first = 0;
        let mut points = Vec::new();
        for (face, vertices) in self.faces.iter().enumerate() {
            let material = self.material_of_face.get(face).copied().unwrap_or(0);
            points.clear();
            points.extend(vertices.iter().map(|&v| pose.get(v as usize).copied().unwrap_or_default()));
            let split = triangulate(&points);
            triangles.extend(split.iter().map(|t| FileTriangle {
                corners: t.map(|k| first + k),
                material,
                face: face as u32,
            }));
            first += vertices.len();
        }
        triangles.sort_by_key(|t| t.material);
        triangles
    }
}

/// A white material without a texture.
pub(super) fn plain_material(name: &str) -> Material {
    Material { name: name.to_owned(), base_colour: [1.0; 4], image: None, double_sided: true }
}

/// A component between 0 and 1 as a byte.
pub(super) fn byte(component: f32) -> u8 {
    (component.clamp(0.0, 1.0) * 255.0).round() as u8
}
