//! The appearance of a whole capture as two small linear models.
//!
//! This work is based on: A. Boukhayma, *Surface Motion Capture Animation*, thesis 2017, chapter 4; A. Boukhayma,
//! E. Boyer, *Surface Motion Capture Animation Synthesis*, section 5.
//!
//! Colours are sRGB-encoded, 0 to 1, not linear light. The papers' textures, and what SSIM is measured on, are encoded
//! values; the encoding spreads quantisation and least-squares errors evenly over what the eye tells apart, where linear
//! light would spend the modes on highlights and let shadows band. What a warp moves is the same in both, and a GPU
//! decodes to linear light on sampling once the texture has been rebuilt.

use serde::{Deserialize, Serialize};

/// Eigen textures and Eigen warps of a capture (thesis section 4.4.2, equations 4.4 to 4.11). Texel order: row-major,
/// only active texels, `active` a bitmask of width*height.
///
/// Everything is indexed by active texel, in row-major order: colours as red, green, blue of one texel after the other,
/// warps as dx, dy (x to the right, y down, in texels). A frame's textures are rebuilt in two steps: the aligned texture
/// is `mean_texture + sum c_k textures[k]`, the backward warp `mean_warp + sum b_k warps[k]`, and the texture that is
/// drawn is the aligned one moved by the warp.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TextureModel {
    /// Width of the texture in texels.
    pub width: u32,
    /// Height of the texture in texels.
    pub height: u32,
    /// Active texels: row-major bit mask, one bool per texel.
    pub active: Vec<bool>,
    /// Mean aligned texture: 3 values per active texel, sRGB-encoded, 0 to 1.
    pub mean_texture: Vec<f32>,
    /// Eigen textures, decreasing variance, each 3 * active, unit norm, sign fixed (largest absolute entry positive).
    pub textures: Vec<Vec<f32>>,
    /// Mean backward warp in texels (dx, dy): 2 per active texel: where texel x of the input is found in the aligned
    /// texture (A(x) = aligned(x + w(x))).
    pub mean_warp: Vec<f32>,
    /// Eigen warps, decreasing variance, each 2 * active, unit norm, sign fixed as for `textures`.
    pub warps: Vec<Vec<f32>>,
    /// Coefficients per capture frame, frame-major: textures.len() each.
    pub texture_coefficients: Vec<f32>,
    /// Coefficients per capture frame: warps.len() each.
    pub warp_coefficients: Vec<f32>,
}

impl TextureModel {
    /// Number of active texels.
    #[must_use]
    pub fn active_count(&self) -> usize {
        self.active.iter().filter(|&&active| active).count()
    }

    /// Number of frames that the coefficients are for; 0 where there is no mode at all.
    #[must_use]
    pub fn frame_count(&self) -> usize {
        let of_textures = self.texture_coefficients.len().checked_div(self.textures.len());
        let of_warps = self.warp_coefficients.len().checked_div(self.warps.len());
        of_textures.or(of_warps).unwrap_or(0)
    }
}
