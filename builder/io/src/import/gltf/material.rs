//! Materials: base colour, base colour texture, and where its texture coordinates come from.

use std::collections::HashMap;

use actor::surface::Material;
use gltf::json::texture::Info;
use gltf::json::{Index, Texture, Value};

use super::document::Document;
use crate::import::error::ImportError;
use crate::import::images::{ImageStore, from_bytes};
use crate::import::mesh::plain_material;

/// Materials in the order of their first use, and their images.
#[derive(Default)]
pub(super) struct Materials {
    pub materials: Vec<Material>,
    pub images: ImageStore,
    uvs: Vec<TextureUv>,
    index_of_material: HashMap<Option<usize>, u32>,
    index_of_image: HashMap<usize, u32>,
}

/// Which texture coordinates a material uses, and how it moves them (`KHR_texture_transform`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TextureUv {
    /// The set, as in `TEXCOORD_0`.
    pub set: u32,
    offset: [f32; 2],
    rotation: f32,
    scale: [f32; 2],
}

impl TextureUv {
    const PLAIN: Self = Self { set: 0, offset: [0.0; 2], rotation: 0.0, scale: [1.0; 2] };

    /// The texture coordinate that is looked up for `uv`.
    pub fn apply(&self, [u, v]: [f32; 2]) -> [f32; 2] {
        if *self == (Self { set: self.set, ..Self::PLAIN }) {
            return [u, v];
        }
        let (u, v) = (u * self.scale[0], v * self.scale[1]);
        let (sin, cos) = self.rotation.sin_cos();
        [cos * u + sin * v + self.offset[0], cos * v - sin * u + self.offset[1]]
    }
}

impl Materials {
    /// The material `index` of the file; `None` is the format's default material.
    pub fn load(
        &mut self,
        document: &Document,
        index: Option<Index<gltf::json::Material>>,
        user: &str,
    ) -> Result<u32, ImportError> {
        let key = index.map(|index| index.value());
        if let Some(&known) = self.index_of_material.get(&key) {
            return Ok(known);
        }
        let mut material = Material { double_sided: false, ..plain_material("") };
        let mut uv = TextureUv::PLAIN;
        if let Some(index) = index {
            let source = document.get(index, "material", user)?;
            let surface = &source.pbr_metallic_roughness;
            material.name = source.name.clone().unwrap_or_default();
            material.double_sided = source.double_sided;
            material.base_colour = surface.base_color_factor.0;
            if let Some(info) = &surface.base_color_texture {
                material.image = self.image(document, info.index, &format!("material {index}"))?;
                uv = texture_uv(info);
            }
        }
        let number = self.materials.len() as u32;
        self.materials.push(material);
        self.uvs.push(uv);
        self.index_of_material.insert(key, number);
        Ok(number)
    }

    /// The texture coordinates that the loaded material `number` wants.
    pub fn uv(&self, number: u32) -> TextureUv {
        self.uvs.get(number as usize).copied().unwrap_or(TextureUv::PLAIN)
    }

    fn image(&mut self, document: &Document, texture: Index<Texture>, user: &str) -> Result<Option<u32>, ImportError> {
        let texture = document.get(texture, "texture", user)?;
        let webp = texture.extensions.as_ref().and_then(|e| e.others.get("EXT_texture_webp"));
        let webp = webp.and_then(|e| e.get("source")).and_then(Value::as_u64);
        let plain = Some(texture.source.value()).filter(|&source| source != u32::MAX as usize);
        let Some(source) = webp.and_then(|source| usize::try_from(source).ok()).or(plain) else { return Ok(None) };
        if let Some(&known) = self.index_of_image.get(&source) {
            return Ok(Some(known));
        }
        let image = document.root().images.get(source);
        let image =
            image.ok_or_else(|| document.wrong(format!("{user} names image {source}, which does not exist")))?;
        let user = format!("image {source}");
        let mut path = document.path().to_owned();
        let bytes = match (&image.uri, image.buffer_view) {
            (Some(uri), _) => {
                if !uri.starts_with("data:") {
                    path = document.beside(uri);
                }
                document.fetch(uri, &user)?
            }
            (None, Some(view)) => document.view(view, &user)?.to_vec(),
            (None, None) => return Err(document.wrong(format!("{user} has neither a URI nor a buffer view"))),
        };
        let number = self.images.push(from_bytes(bytes, &path)?);
        self.index_of_image.insert(source, number);
        Ok(Some(number))
    }
}

fn texture_uv(info: &Info) -> TextureUv {
    let mut uv = TextureUv { set: info.tex_coord, ..TextureUv::PLAIN };
    let Some(transform) = info.extensions.as_ref().and_then(|e| e.others.get("KHR_texture_transform")) else {
        return uv;
    };
    let number = |value: &Value| value.as_f64().map(|n| n as f32).filter(|n| n.is_finite());
    let pair = |key: &str, default: [f32; 2]| {
        let values = transform.get(key);
        let get = |k: usize| values.and_then(|v| v.get(k)).and_then(number).unwrap_or(default[k]);
        [get(0), get(1)]
    };
    uv.offset = pair("offset", uv.offset);
    uv.scale = pair("scale", uv.scale);
    uv.rotation = transform.get("rotation").and_then(number).unwrap_or(0.0);
    if let Some(set) = transform.get("texCoord").and_then(Value::as_u64) {
        uv.set = u32::try_from(set).unwrap_or(uv.set);
    }
    uv
}
