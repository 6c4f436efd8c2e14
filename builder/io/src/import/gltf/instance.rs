//! From what is drawn to one mesh, and to the list of what has to be posed for it in each frame.

use super::document::Document;
use super::drawn::{Drawn, Piece};
use super::flipbook::Shown;
use super::material::Materials;
use super::shape::Shape;
use crate::import::error::ImportError;
use crate::import::mesh::FileMesh;
use crate::import::warning::Warning;

/// Everything that is posed, in the order of the mesh's vertices.
#[derive(Default)]
pub(super) struct Instances {
    /// Primitives of the same triangles, of which a frame shows one.
    pages: Vec<Vec<Page>>,
    /// Which of `pages`, and which page of it.
    parts: Vec<(usize, Turn)>,
}

impl Instances {
    /// The pages that a frame shows; `page` says which one it is.
    pub fn shown(&self, page: impl Fn(Turn) -> usize) -> impl Iterator<Item = &Page> {
        self.parts.iter().filter_map(move |&(pages, turn)| self.pages.get(pages)?.get(page(turn)))
    }
}

/// Which page a frame shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Turn {
    /// The only one.
    Always,
    /// The one of the frame's scene.
    Scene,
    /// That at `place` among those that flip-book `book` shows.
    Book { book: usize, place: usize },
}

/// A primitive as a node draws it.
pub(super) struct Page {
    pub node: usize,
    pub skin: Option<usize>,
    /// Morph weights that no animation changes.
    pub weights: Vec<f32>,
    pub shape: Shape,
}

/// What is drawn as one mesh, with the flip-books that `shown` knows.
pub(super) fn assemble(
    document: &Document,
    drawn: Vec<Drawn>,
    shown: &Shown,
    materials: Materials,
    warnings: &mut Vec<Warning>,
) -> Result<(Instances, FileMesh), ImportError> {
    let mut drawn: Vec<Option<Drawn>> = drawn.into_iter().map(Some).collect();
    let mut assembly = Assembly::new(document, materials);
    for index in 0..drawn.len() {
        if shown.never.contains(&index) {
            continue;
        }
        let book = shown.books.iter().position(|book| book.pages.contains(&index));
        let Some(book) = book else {
            assembly.add(&[Turn::Always], drawn[index].take().into_iter().collect());
            continue;
        };
        // All of a book stands where its first page is.
        let pages: Vec<Drawn> = shown.books[book].pages.iter().filter_map(|&page| drawn[page].take()).collect();
        let places: Vec<Turn> = (0..shown.books[book].shown).map(|place| Turn::Book { book, place }).collect();
        assembly.add(&places, pages);
    }
    assembly.finish(warnings)
}

/// The scenes of a file as the frames of one mesh.
pub(super) fn assemble_scenes(
    document: &Document,
    scenes: Vec<Vec<Drawn>>,
    materials: Materials,
    warnings: &mut Vec<Warning>,
) -> Result<(Instances, FileMesh), ImportError> {
    let mut assembly = Assembly::new(document, materials);
    // Scenes may cut the same primitives into nodes in other ways, so those go side by side.
    let mut scenes: Vec<_> = scenes.into_iter().map(|scene| scene.into_iter().flat_map(single)).collect();
    while let Some(pages) = scenes.iter_mut().map(Iterator::next).collect::<Option<Vec<Drawn>>>() {
        assembly.add(&[Turn::Scene], pages);
    }
    assembly.finish(warnings)
}

/// One drawn primitive each.
fn single(drawn: Drawn) -> impl Iterator<Item = Drawn> {
    let Drawn { node, skin, weights, pieces } = drawn;
    pieces.into_iter().map(move |piece| Drawn { node, skin, weights: weights.clone(), pieces: vec![piece] })
}

/// The mesh so far.
struct Assembly<'a> {
    document: &'a Document,
    materials: Materials,
    instances: Instances,
    mesh: FileMesh,
    has_uvs: bool,
    has_normals: bool,
    has_colours: bool,
    /// Whether meshes that are shown in turn wear different things.
    pages_differ: bool,
}

impl<'a> Assembly<'a> {
    fn new(document: &'a Document, materials: Materials) -> Self {
        let mesh = FileMesh::default();
        let instances = Instances::default();
        let (has_uvs, has_normals, has_colours, pages_differ) = (false, false, false, false);
        Self { document, materials, instances, mesh, has_uvs, has_normals, has_colours, pages_differ }
    }

    /// Adds the primitives of `pages`, which all have the same triangles, once for each of `turns`; the first pages give
    /// what they wear.
    fn add(&mut self, turns: &[Turn], pages: Vec<Drawn>) {
        let base = self.instances.pages.len();
        let mut worn: Vec<Vec<Piece>> = Vec::new();
        for Drawn { node, skin, weights, pieces } in pages {
            let first = worn.first();
            let differs = |piece: &Piece, first: &Piece| {
                first.uvs != piece.uvs || first.colours != piece.colours || first.material != piece.material
            };
            self.pages_differ |= first.is_some_and(|first| pieces.iter().zip(first).any(|(a, b)| differs(a, b)));
            let mut kept = Vec::new();
            for (k, mut piece) in pieces.into_iter().enumerate() {
                let shape = std::mem::take(&mut piece.shape);
                let page = Page { node, skin, weights: weights.clone(), shape };
                match self.instances.pages.get_mut(base + k) {
                    Some(pages) => pages.push(page),
                    None => self.instances.pages.push(vec![page]),
                }
                kept.push(piece);
            }
            if worn.len() < turns.len() {
                worn.push(kept);
            }
        }
        for (&turn, pieces) in turns.iter().zip(worn) {
            for (k, piece) in pieces.into_iter().enumerate() {
                let pages = self.instances.pages.get(base + k);
                let vertex_count = pages.and_then(|pages| pages.first()).map_or(0, |page| page.shape.len());
                self.instances.parts.push((base + k, turn));
                self.wear(piece, vertex_count);
            }
        }
    }

    fn wear(&mut self, piece: Piece, vertex_count: usize) {
        let first = self.mesh.vertex_count as u32;
        self.mesh.vertex_count += vertex_count;
        self.has_uvs |= !piece.uvs.is_empty();
        self.has_normals |= !piece.normals.is_empty();
        self.has_colours |= !piece.colours.is_empty();
        for (k, triangle) in piece.triangles.iter().enumerate() {
            self.mesh.faces.sizes.push(3);
            self.mesh.faces.vertices.extend(triangle.map(|v| first + v));
            self.mesh.material_of_face.push(piece.material);
            self.mesh.uvs.extend(piece.uvs.get(k).copied().unwrap_or_default());
            let normal = |v: u32| piece.normals.get(v as usize).copied().unwrap_or_default();
            self.mesh.normals.extend(triangle.map(normal));
        }
        let colours = (0..vertex_count).map(|v| piece.colours.get(v).copied().unwrap_or([255; 4]));
        self.mesh.colours.extend(colours);
    }

    fn finish(self, warnings: &mut Vec<Warning>) -> Result<(Instances, FileMesh), ImportError> {
        let mut mesh = self.mesh;
        if mesh.faces.sizes.is_empty() {
            return Err(ImportError::NoTriangles { path: self.document.path().to_owned() });
        }
        if self.pages_differ {
            warnings.push(Warning::new(
                "W_ATTRIBUTES_DIFFER",
                format!(
                    "{}: the meshes that are shown in turn have different materials, texture coordinates or colours: those \
                     of the first are used; give textures that change with --texture",
                    self.document.path().display()
                ),
            ));
        }
        if !self.has_uvs {
            mesh.uvs.clear();
        }
        if !self.has_normals {
            mesh.normals.clear();
        }
        if !self.has_colours {
            mesh.colours.clear();
        }
        mesh.materials = self.materials.materials;
        mesh.images = self.materials.textures.images.images;
        Ok((self.instances, mesh))
    }
}
