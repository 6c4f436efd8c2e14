//! glTF and GLB: every animation clip of the scene's meshes, baked to vertex positions.
//!
//! All drawn meshes of the scene together are one mesh: the file vertices are those of the nodes, depth first in the
//! file's order, and of each node's primitives in order, each with the vertices of its POSITION accessor.

mod accessor;
mod animation;
mod document;
mod material;
mod nodes;
mod shape;

use std::path::{Path, PathBuf};

use glam::{Mat4, Vec3};
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;

use self::animation::Clip;
use self::document::Document;
use self::material::Materials;
use self::nodes::Nodes;
use self::shape::{Joints, Shape, attribute};
use super::error::ImportError;
use super::inputs::stem;
use super::mesh::{FileMesh, byte, srgb_from_linear};
use super::warning::Warning;

/// No file draws more vertices.
const MAX_VERTICES: usize = 1 << 24;

/// An opened glTF file; what is needed to pose its meshes at any time.
pub(super) struct GltfFile {
    path: PathBuf,
    nodes: Nodes,
    skins: Vec<Joints>,
    instances: Vec<Instance>,
    clips: Vec<Clip>,
    mesh: FileMesh,
    warnings: Vec<Warning>,
}

/// A primitive as a node draws it.
struct Instance {
    node: usize,
    skin: Option<usize>,
    /// Morph weights that no animation changes.
    weights: Vec<f32>,
    shape: Shape,
}

impl GltfFile {
    /// Opens a file and reads all but the poses.
    pub fn open(path: &Path) -> Result<Self, ImportError> {
        let document = Document::open(path)?;
        let mut warnings = Vec::new();
        let nodes = Nodes::read(&document)?;
        let skins = document.root().skins.iter().enumerate();
        let skins = skins.map(|(k, skin)| Joints::read(&document, skin, &format!("skin {k}")));
        let skins = skins.collect::<Result<Vec<_>, _>>()?;
        let clips = animation::clips(&document, &stem(path), &mut warnings)?;
        let mut builder = Builder::new(&document, &nodes, &skins);
        for &node in &nodes.drawn {
            builder.add_node(node, &mut warnings)?;
        }
        let (instances, mesh) = builder.finish()?;
        Ok(Self { path: path.to_owned(), nodes, skins, instances, clips, mesh, warnings })
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Sentences for the user.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// Names of the clips; a file without animations has one, of one frame.
    pub fn clip_names(&self) -> Vec<String> {
        self.clips.iter().map(|clip| clip.name.clone()).collect()
    }

    /// Number of frames of a clip at `fps`.
    pub fn frame_count(&self, clip: usize, fps: f32) -> u64 {
        self.clips.get(clip).map_or(0, |clip| clip.frame_count(f64::from(fps)))
    }

    /// What all frames share.
    pub fn mesh(&self) -> &FileMesh {
        &self.mesh
    }

    /// Positions of the file vertices, in the file's units, `frame` frames after the clip's first keyframe.
    pub fn pose(&self, clip: usize, fps: f64, frame: usize) -> Vec<Vec3> {
        let mut pose = Vec::with_capacity(self.mesh.vertex_count);
        let Some(clip) = self.clips.get(clip) else { return pose };
        let time = (clip.start + frame as f64 / fps).min(clip.end);
        let animated = clip.apply(time, &self.nodes.rest);
        let world = self.nodes.world_from_nodes(&animated.transforms);
        let joints: Vec<_> = self.skins.iter().map(|skin| skin.world_from_mesh(&world)).collect();
        for instance in &self.instances {
            let driven = animated.weights.iter().rev().find(|(node, _)| *node == instance.node);
            let weights = driven.map_or(instance.weights.as_slice(), |(_, weights)| weights);
            let of_skin = instance.skin.and_then(|skin| joints.get(skin)).map_or(&[][..], Vec::as_slice);
            instance.shape.pose(weights, world[instance.node], of_skin, &mut pose);
        }
        pose
    }
}

/// Collects the drawn primitives.
struct Builder<'a> {
    document: &'a Document,
    /// World matrices of the nodes at rest.
    world_from_nodes: Vec<Mat4>,
    skins: &'a [Joints],
    instances: Vec<Instance>,
    materials: Materials,
    mesh: FileMesh,
    has_uvs: bool,
    has_colours: bool,
}

impl<'a> Builder<'a> {
    fn new(document: &'a Document, nodes: &Nodes, skins: &'a [Joints]) -> Self {
        Self {
            document,
            world_from_nodes: nodes.world_from_nodes(&nodes.rest),
            skins,
            instances: Vec::new(),
            materials: Materials::default(),
            mesh: FileMesh::default(),
            has_uvs: false,
            has_colours: false,
        }
    }

    fn add_node(&mut self, index: usize, warnings: &mut Vec<Warning>) -> Result<(), ImportError> {
        let Some(node) = self.document.root().nodes.get(index) else { return Ok(()) };
        let Some(mesh_index) = node.mesh else { return Ok(()) };
        let mesh = self.document.get(mesh_index, "mesh", &format!("node {index}"))?;
        let skin =
            node.skin.map(|skin| self.document.get(skin, "skin", &format!("node {index}")).map(|_| skin.value()));
        let skin = skin.transpose()?;
        let weights = node.weights.clone().or_else(|| mesh.weights.clone()).unwrap_or_default();
        for (k, primitive) in mesh.primitives.iter().enumerate() {
            let user = format!("mesh {mesh_index}, primitive {k}");
            if compressed(primitive) && primitive_is_empty(self.document, primitive) {
                let extension = "KHR_draco_mesh_compression".to_owned();
                return Err(ImportError::Compressed { path: self.document.path().to_owned(), extension });
            }
            if !matches!(primitive.mode, Checked::Valid(Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) {
                warnings.push(Warning::new(
                    "W_GLTF_PRIMITIVE",
                    format!("{}: {user} is no triangles and is left out", self.document.path().display()),
                ));
                continue;
            }
            let joints = skin.and_then(|skin| self.skins.get(skin));
            let shape = Shape::read(self.document, primitive, joints, &user)?;
            self.add_faces(primitive, &shape, index, skin.is_some(), &user)?;
            self.instances.push(Instance { node: index, skin, weights: weights.clone(), shape });
        }
        Ok(())
    }

    /// Appends faces and attributes of a primitive whose vertices follow those so far.
    fn add_faces(
        &mut self,
        primitive: &Primitive,
        shape: &Shape,
        node: usize,
        skinned: bool,
        user: &str,
    ) -> Result<(), ImportError> {
        let first = self.mesh.vertex_count;
        self.mesh.vertex_count += shape.len();
        if self.mesh.vertex_count > MAX_VERTICES {
            let reason = format!("more than {MAX_VERTICES} vertices");
            return Err(ImportError::TooLarge { path: self.document.path().to_owned(), reason });
        }
        let indices: Vec<u32> = match primitive.indices {
            Some(index) => self.document.whole_numbers::<1>(index, user)?.into_iter().flatten().collect(),
            None => (0..shape.len() as u32).collect(),
        };
        if let Some(at) = indices.iter().position(|&v| v as usize >= shape.len()) {
            let place = format!("{user}, index {at}");
            let (path, index) = (self.document.path().to_owned(), indices[at].into());
            return Err(ImportError::IndexRange { path, place, index, count: shape.len() });
        }
        let mut triangles = triangles(&indices, primitive.mode);
        // A mirroring node turns the triangles inside out (specification, section 3.7.4); a skin ignores its node.
        if !skinned && self.world_from_nodes[node].determinant() < 0.0 {
            triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        let material = self.materials.load(self.document, primitive.material, user)?;
        let uvs = self.texture_coordinates(primitive, material, shape.len(), user)?;
        for triangle in &triangles {
            self.mesh.faces.sizes.push(3);
            self.mesh.faces.vertices.extend(triangle.map(|v| first as u32 + v));
            self.mesh.material_of_face.push(material);
            self.mesh.uvs.extend(triangle.map(|v| uvs.get(v as usize).copied().unwrap_or([0.0, 0.0])));
        }
        let colours = match attribute(primitive, &Semantic::Colors(0)) {
            Some(index) => self.document.colours(index, user)?,
            None => Vec::new(),
        };
        self.has_colours |= !colours.is_empty();
        self.mesh.colours.extend((0..shape.len()).map(|v| match colours.get(v) {
            // The format's colours are in linear light.
            Some(&[r, g, b, a]) => {
                [byte(srgb_from_linear(r)), byte(srgb_from_linear(g)), byte(srgb_from_linear(b)), byte(a)]
            }
            None => [255; 4],
        }));
        Ok(())
    }

    fn texture_coordinates(
        &mut self,
        primitive: &Primitive,
        material: u32,
        vertex_count: usize,
        user: &str,
    ) -> Result<Vec<[f32; 2]>, ImportError> {
        let transform = self.materials.uv(material);
        let Some(index) = attribute(primitive, &Semantic::TexCoords(transform.set)) else { return Ok(Vec::new()) };
        let uvs = self.document.floats::<2>(index, user)?;
        if uvs.len() != vertex_count {
            return Err(self.document.wrong(format!("{user}: the texture coordinates do not match the vertices")));
        }
        self.has_uvs = true;
        let uvs: Vec<[f32; 2]> = uvs.into_iter().map(|uv| transform.apply(uv)).collect();
        match uvs.iter().position(|uv| !(uv[0].is_finite() && uv[1].is_finite())) {
            Some(v) => Err(self.document.wrong(format!("{user}: the texture coordinate of vertex {v} is not finite"))),
            None => Ok(uvs),
        }
    }

    fn finish(self) -> Result<(Vec<Instance>, FileMesh), ImportError> {
        let mut mesh = self.mesh;
        if mesh.faces.sizes.is_empty() {
            return Err(ImportError::NoTriangles { path: self.document.path().to_owned() });
        }
        if !self.has_uvs {
            mesh.uvs.clear();
        }
        if !self.has_colours {
            mesh.colours.clear();
        }
        mesh.materials = self.materials.materials;
        mesh.images = self.materials.images.images;
        Ok((self.instances, mesh))
    }
}

/// The triangles of a list, strip or fan of indices, all with the same orientation.
fn triangles(indices: &[u32], mode: Checked<Mode>) -> Vec<[u32; 3]> {
    match mode {
        Checked::Valid(Mode::TriangleStrip) => {
            let windows = indices.windows(3).enumerate();
            windows.map(|(k, w)| if k % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] }).collect()
        }
        Checked::Valid(Mode::TriangleFan) => {
            let Some((&apex, rest)) = indices.split_first() else { return Vec::new() };
            rest.windows(2).map(|w| [apex, w[0], w[1]]).collect()
        }
        _ => indices.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect(),
    }
}

fn compressed(primitive: &Primitive) -> bool {
    primitive.extensions.as_ref().is_some_and(|e| e.others.contains_key("KHR_draco_mesh_compression"))
}

/// Whether a compressed primitive has no uncompressed copy beside it.
fn primitive_is_empty(document: &Document, primitive: &Primitive) -> bool {
    let position = attribute(primitive, &Semantic::Positions);
    let accessor = position.and_then(|index| document.root().accessors.get(index.value()));
    accessor.is_none_or(|accessor| accessor.buffer_view.is_none())
}
