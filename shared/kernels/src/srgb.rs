//! The curve between light and the bytes of pictures (IEC 61966-2-1).

/// Linear light of a component in sRGB, both 0 to 1.
#[must_use]
pub fn linear_from_srgb(srgb: f32) -> f32 {
    if srgb <= 0.04045 { srgb / 12.92 } else { ((srgb + 0.055) / 1.055).powf(2.4) }
}

/// The component in sRGB of linear light, both 0 to 1.
#[must_use]
pub fn srgb_from_linear(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}
