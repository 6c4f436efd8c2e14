//! Pictures among many of one KTX2 file, or within the frames of a vologram: the textures of frames.

use std::path::{Path, PathBuf};

use image::RgbaImage;

use super::error::ImportError;
use super::images::read_file;
use super::ktx2::{Ktx2, Ktx2Error, decode_basis, is_basis};
use super::scratch::Scratch;
use super::vologram;
use super::worn::NamedTexture;
use crate::png::encode_lean;

/// A picture of a KTX2 file, or of a frame of a vologram.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct TextureLayer {
    pub path: PathBuf,
    pub layer: u32,
    /// Whether rows are stored as texture coordinates with v upwards find them: the lowest first.
    pub lowest_first: bool,
}

impl TextureLayer {
    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What [`Self::decoded`] decodes.
    pub fn bytes(&self) -> Result<Vec<u8>, ImportError> {
        match vologram::frame_at(&self.path) {
            Some((file, number)) => vologram::texture_bytes(file, number),
            None => read_file(&self.path),
        }
    }

    /// The picture, the highest row first.
    pub fn decoded(&self, bytes: &[u8]) -> Result<RgbaImage, ImportError> {
        let wrong = |error: Ktx2Error| image_error(&self.path, &error);
        if is_basis(bytes) {
            return decode_basis(bytes).map_err(wrong);
        }
        let file = Ktx2::open(bytes).map_err(wrong)?;
        let mut image = file.image(self.layer).map_err(wrong)?;
        // A file that says that its lowest row is the first is turned over already.
        if self.lowest_first != file.upside_down() {
            image::imageops::flip_vertical_in_place(&mut image);
        }
        Ok(image)
    }
}

/// How many pictures the KTX2 file `path` holds.
pub(super) fn layer_count(path: &Path) -> Result<u32, ImportError> {
    let bytes = read_file(path)?;
    Ktx2::open(&bytes).map(|file| file.layers).map_err(|error| image_error(path, &error))
}

/// Writes the pictures `layers`, one a frame, out as PNG files; each once. `sequence` tells those of several sequences apart.
pub(super) fn unpacked(
    layers: &[TextureLayer],
    sequence: usize,
    scratch: &mut Option<Scratch>,
) -> Result<Vec<Option<NamedTexture>>, ImportError> {
    let folder = match scratch {
        Some(scratch) => scratch.clone(),
        None => scratch.insert(Scratch::new()?).clone(),
    };
    let (mut textures, mut file) = (Vec::with_capacity(layers.len()), (PathBuf::new(), Vec::new()));
    for (frame, layer) in layers.iter().enumerate() {
        if let (Some(last), true) = (textures.last().cloned(), frame > 0 && layers[frame - 1] == *layer) {
            textures.push(last);
            continue;
        }
        if file.0 != layer.path {
            file = (layer.path.clone(), layer.bytes()?);
        }
        let wrong = |error: image::ImageError| image_error(&layer.path, &error);
        let png = encode_lean(&layer.decoded(&file.1)?).map_err(wrong)?;
        let name = format!("layers_{sequence}_{frame:06}.png");
        textures.push(Some(NamedTexture::Found(folder.write(&name, &png)?)));
    }
    Ok(textures)
}

fn image_error(path: &Path, error: &dyn std::error::Error) -> ImportError {
    ImportError::Image { path: path.to_owned(), reason: error.to_string() }
}
