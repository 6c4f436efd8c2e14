//! What stands in for `layers` where this crate is built without the feature `gltf`: there are no such textures.

use std::path::Path;

use image::RgbaImage;

use super::error::ImportError;
use super::scratch::Scratch;
use super::worn::NamedTexture;

/// A picture of a KTX2 file, of which there is none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum TextureLayer {}

impl TextureLayer {
    pub fn path(&self) -> &Path {
        match *self {}
    }

    pub fn bytes(&self) -> Result<Vec<u8>, ImportError> {
        match *self {}
    }

    pub fn decoded(&self, _bytes: &[u8]) -> Result<RgbaImage, ImportError> {
        match *self {}
    }
}

/// # Errors
/// Never.
pub(super) fn unpacked(
    _layers: &[TextureLayer],
    _sequence: usize,
    _scratch: &mut Option<Scratch>,
) -> Result<Vec<Option<NamedTexture>>, ImportError> {
    Ok(Vec::new())
}
