//! The textures of a capture's frames, one at a time: from their files, or from memory.

use std::path::PathBuf;

use image::{DynamicImage, ImageReader};
use job::work::Key;

use super::AppearanceError;

/// Alpha below this means that the texel was not seen.
const SEEN_ALPHA: u8 = 128;
/// A mask's value from which on a texel was not seen.
const HIDDEN: u8 = 128;

/// The texture of a frame.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Texture {
    /// Width in texels.
    pub width: u32,
    /// Height in texels.
    pub height: u32,
    /// sRGB-encoded red, green and blue of each texel, row-major.
    pub colours: Vec<[u8; 3]>,
    /// Texels that no camera saw; none where nothing is known of any.
    pub hidden: Option<Vec<bool>>,
}

impl Texture {
    /// Whether a camera saw texel `texel`.
    #[must_use]
    pub fn seen(&self, texel: usize) -> bool {
        self.hidden.as_ref().is_none_or(|hidden| !hidden[texel])
    }
}

/// Where the textures of a capture's frames come from; read again and again, never all held.
pub trait TextureSource: Sync {
    /// Number of frames.
    fn frame_count(&self) -> usize;

    /// Width and height of every frame's texture.
    fn size(&self) -> (u32, u32);

    /// The texture of a frame.
    ///
    /// # Errors
    /// A file that cannot be read as a texture of this size.
    fn read(&self, frame: usize) -> Result<Texture, AppearanceError>;

    /// `key`, made from all textures too: what is kept of them is theirs alone.
    ///
    /// # Errors
    /// A file that cannot be read.
    fn named(&self, key: Key) -> Result<Key, AppearanceError>;
}

impl TextureSource for [Texture] {
    fn frame_count(&self) -> usize {
        self.len()
    }

    fn size(&self) -> (u32, u32) {
        self.first().map_or((0, 0), |texture| (texture.width, texture.height))
    }

    fn read(&self, frame: usize) -> Result<Texture, AppearanceError> {
        self.get(frame).cloned().ok_or(AppearanceError::NoFrames)
    }

    fn named(&self, key: Key) -> Result<Key, AppearanceError> {
        let one = |key: Key, texture: &Texture| {
            key.told(&(texture.width, texture.height, &texture.hidden)).of(bytemuck::cast_slice(&texture.colours))
        };
        Ok(self.iter().fold(key, one))
    }
}

/// Texture files, one a frame, with masks of what was not seen beside some of them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TextureFiles {
    /// The files.
    pub paths: Vec<PathBuf>,
    /// Masks: bright where nothing was seen. As many as files, or none at all.
    pub masks: Vec<Option<PathBuf>>,
    width: u32,
    height: u32,
}

impl TextureFiles {
    /// The textures `paths`, whose size is that of the first.
    ///
    /// # Errors
    /// Where the first cannot be read.
    pub fn new(paths: Vec<PathBuf>, masks: Vec<Option<PathBuf>>) -> Result<Self, AppearanceError> {
        let first = paths.first().ok_or(AppearanceError::NoFrames)?;
        let (width, height) = ImageReader::open(first)
            .and_then(ImageReader::with_guessed_format)
            .map_err(|error| error.to_string())
            .and_then(|reader| reader.into_dimensions().map_err(|error| error.to_string()))
            .map_err(|reason| AppearanceError::Image { path: first.clone(), frame: 0, reason })?;
        Ok(Self { paths, masks, width, height })
    }

    fn decode(&self, path: &PathBuf, frame: usize) -> Result<DynamicImage, AppearanceError> {
        let image = ImageReader::open(path)
            .and_then(ImageReader::with_guessed_format)
            .map_err(|error| error.to_string())
            .and_then(|reader| reader.decode().map_err(|error| error.to_string()))
            .map_err(|reason| AppearanceError::Image { path: path.clone(), frame, reason })?;
        if (image.width(), image.height()) != (self.width, self.height) {
            return Err(AppearanceError::Size {
                path: path.clone(),
                frame,
                found: (image.width(), image.height()),
                expected: (self.width, self.height),
            });
        }
        Ok(image)
    }
}

impl TextureSource for TextureFiles {
    fn frame_count(&self) -> usize {
        self.paths.len()
    }

    fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    fn read(&self, frame: usize) -> Result<Texture, AppearanceError> {
        let path = self.paths.get(frame).ok_or(AppearanceError::NoFrames)?;
        let image = self.decode(path, frame)?;
        // Grey becomes three equal channels, 16 bits become 8.
        let mut hidden: Option<Vec<bool>> = None;
        let colours = if image.color().has_alpha() {
            let texels = image.into_rgba8();
            let unseen: Vec<bool> = texels.pixels().map(|texel| texel.0[3] < SEEN_ALPHA).collect();
            hidden = unseen.contains(&true).then_some(unseen);
            texels.pixels().map(|texel| [texel.0[0], texel.0[1], texel.0[2]]).collect()
        } else {
            image.into_rgb8().pixels().map(|texel| texel.0).collect()
        };
        if let Some(Some(path)) = self.masks.get(frame) {
            let mask = self.decode(path, frame)?.into_luma8();
            let hidden = hidden.get_or_insert_with(|| vec![false; mask.len()]);
            hidden.iter_mut().zip(mask.pixels()).for_each(|(hidden, mask)| *hidden |= mask.0[0] >= HIDDEN);
        }
        Ok(Texture { width: self.width, height: self.height, colours, hidden })
    }

    fn named(&self, mut key: Key) -> Result<Key, AppearanceError> {
        let masks = self.masks.iter().map(Option::as_ref).chain(std::iter::repeat(None));
        for (frame, (path, mask)) in self.paths.iter().zip(masks).enumerate() {
            for path in [Some(path), mask] {
                let bytes = path.map_or(Ok(Vec::new()), std::fs::read).map_err(|error| {
                    let path = path.cloned().unwrap_or_default();
                    AppearanceError::Image { path, frame, reason: error.to_string() }
                })?;
                key = key.of(&bytes);
            }
        }
        Ok(key)
    }
}
