//! The texture of each frame, rebuilt from the bundle's models as the player's GPU does: `texture::basis` and
//! `texture::dealign` are the twins of its passes.

use actor::surface::Surface;
use bundle::{BundleReader, ModeDecoder};
use image::{Rgba, RgbaImage};
use synthesis::FrameKind;
use texture::basis::{Layer, Mode};
use texture::dealign::Aligned;
use texture::mask::{ACTIVE, Mask};
use texture::transform::SIDE;

use super::error::ExportError;

/// Multigrid cycles of a rebuild: as many as the player's.
const CYCLES: usize = 1;
/// Colour where neither the models nor a static texture know any.
const UNKNOWN: Rgba<u8> = Rgba([128, 128, 128, 255]);

/// Rebuilds textures.
pub(super) struct FrameTextures {
    /// Index of the material that they are on.
    pub material: u32,
    mask: Mask,
    layers: [Layer; 2],
    modes: [Vec<Mode>; 2],
    /// What is around the texels that show the actor: of the static texture.
    around: RgbaImage,
    /// The recorded frame whose texture all frames wear, whatever their numbers.
    pub worn: Option<u32>,
}

impl FrameTextures {
    /// Those of a whole bundle; `None` where its textures do not change.
    ///
    /// # Errors
    /// Modes that cannot be read, or a static texture that cannot be decoded.
    pub fn of(reader: &BundleReader, surface: &Surface) -> Result<Option<Self>, ExportError> {
        let Some(appearance) = reader.appearance() else { return Ok(None) };
        let mut modes = [Vec::new(), Vec::new()];
        let mut decoder = ModeDecoder::default();
        for ordinal in 0..appearance.section_count() {
            let (Some((layer, _)), Some(bytes)) = (appearance.place(ordinal), reader.mode_bytes(ordinal)) else {
                return Err(ExportError::NotWhole);
            };
            let mode = decoder.advance(bytes, appearance, layer, usize::MAX);
            let mode = mode.map_err(|reason| ExportError::Mode { ordinal, reason })?;
            modes[layer].push(mode.ok_or(ExportError::NotWhole)?);
        }
        let [width, height] = appearance.size;
        let image = surface.materials.get(appearance.material as usize).and_then(|material| material.image);
        let around = match image.and_then(|image| Some((image as usize, surface.images.get(image as usize)?))) {
            Some((image, encoded)) => super::picture::decode(image, encoded)?,
            None => RgbaImage::from_pixel(width, height, UNKNOWN),
        };
        let around =
            if around.dimensions() == (width, height) { around } else { RgbaImage::from_pixel(width, height, UNKNOWN) };
        let mask = Mask::clone(&appearance.mask);
        Ok(Some(Self {
            material: appearance.material,
            mask,
            layers: appearance.layers.clone(),
            modes,
            around,
            worn: None,
        }))
    }

    /// Width and height in texels.
    pub fn size(&self) -> (u32, u32) {
        self.around.dimensions()
    }

    /// The texture of a frame of a walk. Within a transition coefficients are interpolated as the shape is.
    pub fn of_frame(&self, kind: FrameKind) -> RgbaImage {
        if let Some(frame) = self.worn {
            return self.between(frame, frame, 0.0);
        }
        match kind {
            FrameKind::Recorded { frame } => self.between(frame, frame, 0.0),
            FrameKind::Synthetic { lambda, source_frame, destination_frame, .. } => {
                self.between(source_frame, destination_frame, lambda)
            }
        }
    }

    fn between(&self, from: u32, to: u32, lambda: f32) -> RgbaImage {
        let field = |layer: usize| {
            let own = &self.layers[layer];
            own.rebuild(&self.mask, &self.modes[layer], &own.weights(from, to, lambda), SIDE)
        };
        let cell = (1 << self.layers[1].level) as f32;
        let aligned = Aligned { texture: field(0), warp: field(1), texel: 1.0, cell, fill: [0.5; 3] };
        let colours = aligned.dealign(&self.mask, CYCLES);
        let mut image = self.around.clone();
        for ((pixel, colour), flags) in image.pixels_mut().zip(colours).zip(&self.mask.full().flags) {
            if flags & ACTIVE != 0 {
                let [r, g, b] = colour.map(|value| (value.clamp(0.0, 1.0) * 255.0).round() as u8);
                *pixel = Rgba([r, g, b, pixel.0[3]]);
            }
        }
        image
    }
}
