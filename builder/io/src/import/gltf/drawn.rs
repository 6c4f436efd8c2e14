//! What the nodes draw: the triangles of their primitives with all that is on them, before anything moves.

use std::collections::BTreeMap;

use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;
use kernels::srgb::srgb_from_linear;

use super::document::Document;
use super::material::Materials;
use super::primitive::PrimitiveData;
use super::shape::{Joints, Shape};
use crate::import::error::ImportError;
use crate::import::mesh::byte;
use crate::import::warning::Warning;

/// Vertices and triangles of a small file. A large one may draw more, but each vertex of a mesh of its own takes six bytes
/// at least, and each triangle three: what goes beyond is one mesh drawn over and over.
const MAX_VERTICES: usize = 1 << 24;
const MAX_TRIANGLES: usize = 1 << 25;

/// The triangles of a primitive.
pub(super) struct Piece {
    pub shape: Shape,
    /// Over the shape's vertices.
    pub triangles: Vec<[u32; 3]>,
    /// Texture coordinates of each triangle's corners, v downwards; empty where there are none.
    pub uvs: Vec<[[f32; 2]; 3]>,
    /// Normals of the vertices; empty where there are none.
    pub normals: Vec<[f32; 3]>,
    /// sRGB colours of the vertices; empty where there are none.
    pub colours: Vec<[u8; 4]>,
    /// Index into the file's loaded materials.
    pub material: u32,
}

/// What one node draws.
pub(super) struct Drawn {
    pub node: usize,
    pub skin: Option<usize>,
    /// Morph weights that no animation changes.
    pub weights: Vec<f32>,
    pub pieces: Vec<Piece>,
}

/// Reads what nodes draw.
pub(super) struct Reader<'a> {
    document: &'a Document,
    skins: &'a [Joints],
    pub materials: Materials,
    vertex_count: usize,
    triangle_count: usize,
    /// For each material, triangles that cross the border of a texture that does not repeat.
    crossing: BTreeMap<u32, usize>,
}

impl Piece {
    /// Turns a triangle inside out.
    pub fn turn(&mut self, triangle: usize) {
        self.triangles[triangle].swap(1, 2);
        if let Some(uvs) = self.uvs.get_mut(triangle) {
            uvs.swap(1, 2);
        }
    }
}

impl<'a> Reader<'a> {
    pub fn new(document: &'a Document, skins: &'a [Joints]) -> Self {
        let crossing = BTreeMap::new();
        Self { document, skins, materials: Materials::default(), vertex_count: 0, triangle_count: 0, crossing }
    }

    /// What node `index` draws; `None` where it draws nothing.
    pub fn read(&mut self, index: usize, warnings: &mut Vec<Warning>) -> Result<Option<Drawn>, ImportError> {
        let document = self.document;
        let Some(node) = document.root().nodes.get(index) else { return Ok(None) };
        let Some(mesh_index) = node.mesh else { return Ok(None) };
        let user = format!("node {index}");
        let mesh = document.get(mesh_index, "mesh", &user)?;
        let skin = node.skin.map(|skin| document.get(skin, "skin", &user).map(|_| skin.value())).transpose()?;
        let weights = node.weights.clone().or_else(|| mesh.weights.clone()).unwrap_or_default();
        let mut pieces = Vec::new();
        for (k, primitive) in mesh.primitives.iter().enumerate() {
            let user = format!("mesh {mesh_index}, primitive {k}");
            if !matches!(primitive.mode, Checked::Valid(Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) {
                warnings.push(Warning::new(
                    "W_GLTF_PRIMITIVE",
                    format!("{}: {user} is no triangles and is left out", document.path().display()),
                ));
                continue;
            }
            pieces.push(self.piece(primitive, skin, &user, warnings)?);
        }
        Ok((!pieces.is_empty()).then_some(Drawn { node: index, skin, weights, pieces }))
    }

    fn piece(
        &mut self,
        primitive: &Primitive,
        skin: Option<usize>,
        user: &str,
        warnings: &mut Vec<Warning>,
    ) -> Result<Piece, ImportError> {
        let data = PrimitiveData::read(self.document, primitive, user)?;
        let joints = skin.and_then(|skin| self.skins.get(skin));
        let targets = primitive.targets.as_deref().unwrap_or_default();
        let shape = Shape::read(self.document, &data, targets, joints)?;
        let triangles = data.triangles(shape.len())?;
        self.count(shape.len(), triangles.len())?;
        let material = self.materials.load(self.document, primitive.material, user, warnings)?;
        let uvs = self.texture_coordinates(&data, material, &triangles, shape.len(), warnings)?;
        let colours = data.colours(&Semantic::Colors(0))?.unwrap_or_default();
        if !colours.is_empty() && colours.len() != shape.len() {
            return Err(self.document.wrong(format!("{user}: the colours do not match the vertices")));
        }
        // The format's colours are in linear light.
        let srgb = |linear| byte(srgb_from_linear(f32::clamp(linear, 0.0, 1.0)));
        let colours = colours.into_iter().map(|[r, g, b, a]| [srgb(r), srgb(g), srgb(b), byte(a)]).collect();
        // Nothing that is drawn depends on normals, so damaged ones are none.
        let normals = data.floats::<3>(&Semantic::Normals).ok().flatten().unwrap_or_default();
        let normals = if normals.len() == shape.len() { normals } else { Vec::new() };
        Ok(Piece { shape, triangles, uvs, normals, colours, material })
    }

    /// Counts what is drawn, and refuses too much of it.
    fn count(&mut self, vertices: usize, triangles: usize) -> Result<(), ImportError> {
        self.vertex_count += vertices;
        self.triangle_count += triangles;
        let bytes = self.document.buffer_bytes();
        if self.vertex_count > MAX_VERTICES.max(bytes / 6) || self.triangle_count > MAX_TRIANGLES.max(bytes / 3) {
            let reason =
                format!("it draws more than {} vertices or {} triangles", self.vertex_count, self.triangle_count);
            return Err(ImportError::TooLarge { path: self.document.path().to_owned(), reason });
        }
        Ok(())
    }

    fn texture_coordinates(
        &mut self,
        data: &PrimitiveData<'_>,
        material: u32,
        triangles: &[[u32; 3]],
        vertex_count: usize,
        warnings: &mut Vec<Warning>,
    ) -> Result<Vec<[[f32; 2]; 3]>, ImportError> {
        let (user, document) = (data.user, self.document);
        let transform = self.materials.uv(material);
        let Some(uvs) = data.floats::<2>(&Semantic::TexCoords(transform.set))? else {
            if self.materials.get(material).is_some_and(|material| material.image.is_some()) {
                warnings.push(Warning::new(
                    "W_NO_UV",
                    format!(
                        "{}: {user} has a texture but no texture coordinates {}: it is drawn in one colour of the texture",
                        document.path().display(),
                        transform.set
                    ),
                ));
            }
            return Ok(Vec::new());
        };
        if uvs.len() != vertex_count {
            return Err(document.wrong(format!("{user}: the texture coordinates do not match the vertices")));
        }
        let uvs: Vec<[f32; 2]> = uvs.into_iter().map(|uv| transform.apply(uv)).collect();
        if let Some(v) = uvs.iter().position(|uv| !(uv[0].is_finite() && uv[1].is_finite())) {
            return Err(document.wrong(format!("{user}: the texture coordinate of vertex {v} is not finite")));
        }
        let mut of_corners = Vec::with_capacity(triangles.len());
        for triangle in triangles {
            let mut corners = triangle.map(|v| uvs.get(v as usize).copied().unwrap_or_default());
            if !transform.wrap(&mut corners) {
                *self.crossing.entry(material).or_default() += 1;
            }
            of_corners.push(corners);
        }
        Ok(of_corners)
    }

    /// The materials, and sentences about what could not be written into texture coordinates.
    pub fn finish(self, warnings: &mut Vec<Warning>) -> Materials {
        for (&material, &count) in &self.crossing {
            let name = self.materials.get(material).map_or("", |material| &material.name);
            warnings.push(Warning::new(
                "W_GLTF_WRAP",
                format!(
                    "{}: {count} triangles of the material \"{name}\" cross the border of a texture that is clamped or \
                     mirrored there: they are drawn with a texture that repeats, which looks different at that border",
                    self.document.path().display()
                ),
            ));
        }
        self.materials
    }
}
