//! Where the numbers of a primitive come from: accessors, or a Draco mesh (`KHR_draco_mesh_compression`).

use gltf::json::accessor::{Accessor, ComponentType, GenericComponentType};
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;
use gltf::json::{Index, Value};

use super::document::Document;
use crate::import::draco::{DracoAttribute, DracoMesh, decode_draco};
use crate::import::error::ImportError;

const DRACO: &str = "KHR_draco_mesh_compression";

/// A primitive, decoded where it has to be.
pub(super) struct PrimitiveData<'a> {
    document: &'a Document,
    primitive: &'a Primitive,
    draco: Option<Draco<'a>>,
    /// Who asks, for messages: `mesh 3, primitive 0`.
    pub user: &'a str,
}

/// A Draco mesh, and which of its attributes stands for which of the primitive's.
struct Draco<'a> {
    mesh: DracoMesh,
    ids: &'a serde_json::Map<String, Value>,
}

impl<'a> PrimitiveData<'a> {
    /// Decodes `primitive` where it is compressed and has no uncompressed twin.
    pub fn read(document: &'a Document, primitive: &'a Primitive, user: &'a str) -> Result<Self, ImportError> {
        let extension = primitive.extensions.as_ref().and_then(|e| e.others.get(DRACO));
        let draco = match extension {
            Some(extension) if !has_uncompressed_twin(document, primitive) => {
                Some(Draco::read(document, extension, user)?)
            }
            _ => None,
        };
        Ok(Self { document, primitive, draco, user })
    }

    /// `N` numbers a vertex; `None` where the primitive has no such attribute.
    pub fn floats<const N: usize>(&self, semantic: &Semantic) -> Result<Option<Vec<[f32; N]>>, ImportError> {
        let Some(index) = self.accessor(semantic) else { return Ok(None) };
        let Some(attribute) = self.decoded(semantic)? else {
            return self.document.floats::<N>(index, self.user).map(Some);
        };
        if attribute.width != N {
            return Err(self.wrong(semantic, format!("has {} numbers a vertex instead of {N}", attribute.width)));
        }
        Ok(Some(self.scaled(attribute, index)?.as_chunks::<N>().0.to_vec()))
    }

    /// Colours with or without alpha; `None` where the primitive has none.
    pub fn colours(&self, semantic: &Semantic) -> Result<Option<Vec<[f32; 4]>>, ImportError> {
        let Some(index) = self.accessor(semantic) else { return Ok(None) };
        let Some(attribute) = self.decoded(semantic)? else {
            return self.document.colours(index, self.user).map(Some);
        };
        let numbers = self.scaled(attribute, index)?;
        match attribute.width {
            3 => Ok(Some(numbers.as_chunks::<3>().0.iter().map(|&[r, g, b]| [r, g, b, 1.0]).collect())),
            4 => Ok(Some(numbers.as_chunks::<4>().0.to_vec())),
            _ => Err(self.wrong(semantic, "is no colour".into())),
        }
    }

    /// Four whole numbers a vertex; `None` where the primitive has no such attribute.
    pub fn whole_numbers(&self, semantic: &Semantic) -> Result<Option<Vec<[u32; 4]>>, ImportError> {
        let Some(index) = self.accessor(semantic) else { return Ok(None) };
        let Some(attribute) = self.decoded(semantic)? else {
            return self.document.whole_numbers::<4>(index, self.user).map(Some);
        };
        // Joints are few: 32-bit floats hold all whole numbers to 16 million.
        if attribute.width != 4 || !attribute.whole || attribute.values.iter().any(|&v| !(0.0..16e6).contains(&v)) {
            return Err(self.wrong(semantic, "does not hold four whole numbers a vertex".into()));
        }
        Ok(Some(attribute.values.as_chunks::<4>().0.iter().map(|v| v.map(|x| x as u32)).collect()))
    }

    /// The triangles, all with the same orientation.
    pub fn triangles(&self, vertex_count: usize) -> Result<Vec<[u32; 3]>, ImportError> {
        if let Some(draco) = &self.draco {
            return Ok(draco.mesh.faces.clone());
        }
        let indices = match self.primitive.indices {
            Some(index) => self.document.whole_numbers::<1>(index, self.user)?.concat(),
            None => (0..vertex_count as u32).collect(),
        };
        if let Some(at) = indices.iter().position(|&v| v as usize >= vertex_count) {
            let place = format!("{}, index {at}", self.user);
            let (path, index) = (self.document.path().to_owned(), indices[at].into());
            return Err(ImportError::IndexRange { path, place, index, count: vertex_count });
        }
        Ok(triangles(&indices, self.primitive.mode))
    }

    fn accessor(&self, semantic: &Semantic) -> Option<Index<Accessor>> {
        self.primitive.attributes.get(&Checked::Valid(semantic.clone())).copied()
    }

    /// The Draco attribute that stands for `semantic`; `None` where its accessor holds the numbers itself.
    fn decoded(&self, semantic: &Semantic) -> Result<Option<&DracoAttribute>, ImportError> {
        let Some(draco) = &self.draco else { return Ok(None) };
        let Some(id) = draco.ids.get(&semantic.to_string()) else { return Ok(None) };
        let attribute = id.as_u64().and_then(|id| draco.mesh.by_id(u32::try_from(id).ok()?));
        attribute
            .map(Some)
            .ok_or_else(|| self.wrong(semantic, format!("names the Draco attribute {id}, which is not there")))
    }

    /// The attribute's numbers as its accessor wants them: integers brought to 0..1 where they are normalised.
    fn scaled(&self, attribute: &DracoAttribute, index: Index<Accessor>) -> Result<Vec<f32>, ImportError> {
        let accessor = self.document.get(index, "accessor", self.user)?;
        let largest = match accessor.component_type {
            Checked::Valid(GenericComponentType(ComponentType::U8)) => 255.0,
            Checked::Valid(GenericComponentType(ComponentType::I8)) => 127.0,
            Checked::Valid(GenericComponentType(ComponentType::U16)) => 65535.0,
            Checked::Valid(GenericComponentType(ComponentType::I16)) => 32767.0,
            _ => 1.0,
        };
        let scale = if accessor.normalized && attribute.whole { 1.0 / largest } else { 1.0 };
        Ok(attribute.values.iter().map(|&value| if scale == 1.0 { value } else { (value * scale).max(-1.0) }).collect())
    }

    fn wrong(&self, semantic: &Semantic, reason: String) -> ImportError {
        self.document.wrong(format!("{}: {} {reason}", self.user, semantic.to_string()))
    }
}

impl<'a> Draco<'a> {
    fn read(document: &Document, extension: &'a Value, user: &str) -> Result<Self, ImportError> {
        let view = extension.get("bufferView").and_then(Value::as_u64).and_then(|view| u32::try_from(view).ok());
        let ids = extension.get("attributes").and_then(Value::as_object);
        let Some((view, ids)) = view.zip(ids) else {
            return Err(document.wrong(format!("{user}: {DRACO} names no buffer view or no attributes")));
        };
        let mesh = decode_draco(document.view(Index::new(view), user)?);
        Ok(Self { mesh: mesh.map_err(|error| document.wrong(format!("{user}: {error}")))?, ids })
    }
}

/// Whether a compressed primitive has its uncompressed numbers beside it, for readers without a decoder.
fn has_uncompressed_twin(document: &Document, primitive: &Primitive) -> bool {
    let filled = |index: Index<Accessor>| {
        let accessor = document.root().accessors.get(index.value());
        accessor.is_some_and(|accessor| accessor.buffer_view.is_some())
    };
    primitive.attributes.values().copied().chain(primitive.indices).all(filled)
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
