//! Textures: which image stands behind one, and how it wraps.

use std::collections::HashMap;

use gltf::json::texture::{Texture, WrappingMode};
use gltf::json::validation::Checked;
use gltf::json::{Index, Value};

use super::document::Document;
use crate::import::error::ImportError;
use crate::import::images::{ImageStore, from_bytes};
use crate::import::ktx2::decode_ktx2;
use crate::import::warning::Warning;
use crate::png::encode_lean;

/// The images of a file, each once.
#[derive(Default)]
pub(super) struct Textures {
    pub images: ImageStore,
    index_of_image: HashMap<usize, u32>,
}

impl Textures {
    /// The image behind `texture` as an index into [`Textures::images`]; `None`, with a sentence, where the texture has
    /// none that is read.
    pub fn image(
        &mut self,
        document: &Document,
        texture: Index<Texture>,
        user: &str,
        warnings: &mut Vec<Warning>,
    ) -> Result<Option<u32>, ImportError> {
        let Some(source) = source(document.get(texture, "texture", user)?) else {
            warnings.push(Warning::new(
                "W_GLTF_TEXTURE",
                format!(
                    "{}: texture {texture}, which {user} names, has no image that is read: it is left out",
                    document.path().display()
                ),
            ));
            return Ok(None);
        };
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
                path = document.beside(uri);
                document.fetch(uri, &user)?
            }
            (None, Some(view)) => document.view(view, &user)?.to_vec(),
            (None, None) => return Err(document.wrong(format!("{user} has neither a URI nor a buffer view"))),
        };
        let bytes = if bytes.starts_with(b"\xABKTX") { unpacked(&bytes, &path)? } else { bytes };
        let number = self.images.push(from_bytes(bytes, &path)?);
        self.index_of_image.insert(source, number);
        Ok(Some(number))
    }

    /// Width and height of a loaded image.
    pub fn size(&self, image: u32) -> [u32; 2] {
        self.images.images.get(image as usize).map_or([1; 2], |image| [image.width, image.height])
    }
}

/// The index of the image that a texture shows.
fn source(texture: &Texture) -> Option<usize> {
    let others = texture.extensions.as_ref().map(|e| &e.others);
    let of_extension = |name: &str| {
        let source = others.and_then(|others| others.get(name)?.get("source")).and_then(Value::as_u64);
        source.and_then(|source| usize::try_from(source).ok())
    };
    // The crate's word for no image.
    let plain = Some(texture.source.value()).filter(|&source| source != u32::MAX as usize);
    // A WebP image is what the file is about, a plain one beside it is for readers without the extension. A KTX2 image
    // has lost something in its packing already: a plain one is preferred.
    of_extension("EXT_texture_webp").or(plain).or_else(|| of_extension("KHR_texture_basisu"))
}

/// How a texture goes on beyond its borders, along u and v.
pub(super) fn wrapping(document: &Document, texture: Index<Texture>) -> [WrappingMode; 2] {
    let sampler = document.root().get(texture).and_then(|texture| document.root().get(texture.sampler?));
    let mode = |mode: Checked<WrappingMode>| match mode {
        Checked::Valid(mode) => mode,
        Checked::Invalid => WrappingMode::Repeat,
    };
    sampler.map_or([WrappingMode::Repeat; 2], |sampler| [mode(sampler.wrap_s), mode(sampler.wrap_t)])
}

/// A KTX2 image as PNG, for bundles hold what every browser shows.
fn unpacked(bytes: &[u8], path: &std::path::Path) -> Result<Vec<u8>, ImportError> {
    let wrong = |reason: String| ImportError::Image { path: path.to_owned(), reason };
    let image = decode_ktx2(bytes).map_err(|error| wrong(error.to_string()))?;
    encode_lean(&image).map_err(|error| wrong(error.to_string()))
}
