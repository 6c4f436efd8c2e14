//! Materials: the colour and the texture that stand for each, and where its texture coordinates come from.

use std::collections::HashMap;

use actor::surface::Material;
use gltf::json::material::AlphaMode;
use gltf::json::texture::Info;
use gltf::json::validation::Checked;
use gltf::json::{self, Index, Value};

use super::document::Document;
use super::texture::{Textures, wrapping};
use super::uv::TextureUv;
use crate::import::error::ImportError;
use crate::import::mesh::plain_material;
use crate::import::warning::Warning;

const SPECULAR_GLOSSINESS: &str = "KHR_materials_pbrSpecularGlossiness";

/// Materials in the order of their first use, and their images.
#[derive(Default)]
pub(super) struct Materials {
    pub materials: Vec<Material>,
    pub textures: Textures,
    uvs: Vec<TextureUv>,
    index_of_material: HashMap<Option<usize>, u32>,
}

/// What a material shows: a colour (linear, with alpha), and a texture that it is multiplied with.
struct Colour {
    factor: [f32; 4],
    texture: Option<Info>,
}

impl Materials {
    /// The material `index` of the file; `None` is the format's default material.
    pub fn load(
        &mut self,
        document: &Document,
        index: Option<Index<json::Material>>,
        user: &str,
        warnings: &mut Vec<Warning>,
    ) -> Result<u32, ImportError> {
        let key = index.map(|index| index.value());
        if let Some(&known) = self.index_of_material.get(&key) {
            return Ok(known);
        }
        let mut material = Material { double_sided: false, ..plain_material("") };
        let mut uv = TextureUv::PLAIN;
        if let Some(index) = index {
            let source = document.get(index, "material", user)?;
            let user = match &source.name {
                Some(name) if !name.is_empty() => format!("material \"{name}\""),
                _ => format!("material {index}"),
            };
            let colour = colour(document, source, &user, warnings)?;
            material.name = source.name.clone().unwrap_or_default();
            material.double_sided = source.double_sided;
            material.base_colour = colour.factor;
            if let Some(info) = &colour.texture {
                material.image = self.textures.image(document, info.index, &user, warnings)?;
                if let Some(image) = material.image {
                    uv = TextureUv::read(info, wrapping(document, info.index), self.textures.size(image));
                }
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

    /// The loaded material `number`.
    pub fn get(&self, number: u32) -> Option<&Material> {
        self.materials.get(number as usize)
    }
}

/// What stands for `material`: its base colour, the diffuse colour of the older extension, or, of a material that only
/// glows, that glow.
fn colour(
    document: &Document,
    material: &json::Material,
    user: &str,
    warnings: &mut Vec<Warning>,
) -> Result<Colour, ImportError> {
    let mut warn = |code, what: &str| {
        warnings.push(Warning::new(code, format!("{}: {user} {what}", document.path().display())));
    };
    if material.alpha_mode != Checked::Valid(AlphaMode::Opaque) {
        warn("W_GLTF_ALPHA", "asks for transparency (alphaMode): it is drawn opaque");
    }
    let surface = &material.pbr_metallic_roughness;
    let mut base = Colour { factor: surface.base_color_factor.0, texture: surface.base_color_texture.clone() };
    let extensions = material.extensions.as_ref().map(|e| &e.others);
    if let Some(older) = extensions.and_then(|e| e.get(SPECULAR_GLOSSINESS)) {
        let older = diffuse(older).map_err(|reason| document.wrong(format!("{user}: {reason}")))?;
        // A file may have both, for readers of either; then the one with a texture says more.
        if older.texture.is_some() || base.texture.is_none() {
            base = older;
        }
    }
    let strength = extensions.and_then(|e| e.get("KHR_materials_emissive_strength")?.get("emissiveStrength")?.as_f64());
    let glow = material.emissive_factor.0.map(|c| c * strength.unwrap_or(1.0) as f32);
    let brightest = glow.iter().copied().fold(0.0, f32::max);
    if brightest <= 0.0 {
        return Ok(base);
    }
    let black = base.factor[..3].iter().all(|&c| c == 0.0);
    if black || (base.texture.is_none() && material.emissive_texture.is_some()) {
        if !black {
            warn("W_GLTF_GLOW", "has a texture only where it glows: that is drawn in place of its plain colour");
        }
        let [r, g, b] = glow.map(|c| c / brightest.max(1.0));
        return Ok(Colour { factor: [r, g, b, base.factor[3]], texture: material.emissive_texture.clone() });
    }
    warn("W_GLTF_GLOW", "also glows: it is drawn without that");
    Ok(base)
}

/// The diffuse colour and texture of `KHR_materials_pbrSpecularGlossiness`.
fn diffuse(extension: &Value) -> Result<Colour, String> {
    let mut factor = [1.0; 4];
    if let Some(values) = extension.get("diffuseFactor") {
        for (k, slot) in factor.iter_mut().enumerate() {
            let value = values.get(k).and_then(Value::as_f64);
            *slot = value.ok_or("diffuseFactor does not hold four numbers")? as f32;
        }
    }
    let texture = extension.get("diffuseTexture").cloned().map(json::deserialize::from_value).transpose();
    let texture = texture.map_err(|e| format!("diffuseTexture cannot be read: {e}"))?;
    Ok(Colour { factor, texture })
}
