//! Texture images: copied as they are, decoded once to be sure that a browser can.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

use actor::surface::{Image, ImageFormat};
use image::ImageReader;

use super::error::ImportError;
use super::formats::unread_image;

/// Endings of image files.
const ENDINGS: [&str; 4] = ["png", "jpg", "jpeg", "webp"];

/// Whether `path` ends like an image file.
pub(super) fn is_image(path: &Path) -> bool {
    let ending = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    ending.is_some_and(|ending| ENDINGS.contains(&ending.as_str()))
}

/// Images of a capture, each file once.
#[derive(Debug, Default)]
pub(super) struct ImageStore {
    /// The images.
    pub images: Vec<Image>,
    index_of_path: HashMap<PathBuf, u32>,
}

impl ImageStore {
    /// Index of the image file `path`, which is read unless it is there already.
    pub fn load(&mut self, path: &Path) -> Result<u32, ImportError> {
        if let Some(&index) = self.index_of_path.get(path) {
            return Ok(index);
        }
        let bytes = read_file(path)?;
        let index = self.push(from_bytes(bytes, path)?);
        self.index_of_path.insert(path.to_owned(), index);
        Ok(index)
    }

    /// Appends an image; its index.
    pub fn push(&mut self, image: Image) -> u32 {
        self.images.push(image);
        self.images.len() as u32 - 1
    }
}

/// An image from the bytes of its file; `path` is for messages.
pub(super) fn from_bytes(bytes: Vec<u8>, path: &Path) -> Result<Image, ImportError> {
    let wrong = |reason: String| image_error(path, reason);
    let guessed = image::guess_format(&bytes).map_err(|_| wrong("unknown format".into()))?;
    let format = match guessed {
        image::ImageFormat::Png => ImageFormat::Png,
        image::ImageFormat::Jpeg => ImageFormat::Jpeg,
        image::ImageFormat::WebP => ImageFormat::WebP,
        other => return Err(wrong(format!("it is {other:?}"))),
    };
    // The decoder's default limits bound the memory that a header can ask for.
    let decoded = image::load_from_memory_with_format(&bytes, guessed).map_err(|e| wrong(e.to_string()))?;
    let (width, height) = (decoded.width(), decoded.height());
    drop(decoded);
    Ok(Image { format, width, height, bytes })
}

/// The error for an image: what it is where its ending says so, or what the decoder says.
fn image_error(path: &Path, reason: String) -> ImportError {
    match unread_image(path) {
        Some(told) => ImportError::UnknownFormat { path: path.to_owned(), told },
        None => ImportError::Image { path: path.to_owned(), reason },
    }
}

/// Width and height of an image file, from its header.
pub(super) fn size_of(path: &Path) -> Result<(u32, u32), ImportError> {
    let wrong = |reason: String| image_error(path, reason);
    let reader = ImageReader::open(path).map_err(|source| read_error(path, source))?;
    let reader = reader.with_guessed_format().map_err(|e| wrong(e.to_string()))?;
    reader.into_dimensions().map_err(|e| wrong(e.to_string()))
}

/// All bytes of a file.
pub(super) fn read_file(path: &Path) -> Result<Vec<u8>, ImportError> {
    fs::read(path).map_err(|source| read_error(path, source))
}

fn read_error(path: &Path, source: std::io::Error) -> ImportError {
    let path = path.to_owned();
    if source.kind() == std::io::ErrorKind::NotFound {
        ImportError::NotFound { path }
    } else {
        ImportError::Io { path, source }
    }
}
