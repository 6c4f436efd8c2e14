//! Texture coordinates as a material wants them: its set, `KHR_texture_transform`, and how the texture goes on beyond
//! its borders. Everything that is drawn repeats its texture, so whatever else a file asks for is written into the
//! coordinates where that is possible.

use gltf::json::Value;
use gltf::json::texture::{Info, WrappingMode};

/// Which texture coordinates a material uses, and what becomes of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TextureUv {
    /// The set, as in `TEXCOORD_0`.
    pub set: u32,
    offset: [f32; 2],
    rotation: f32,
    scale: [f32; 2],
    /// How the texture goes on beyond 0 and 1, along u and v.
    wrap: [WrappingMode; 2],
    /// Width and height of the texture in pixels.
    size: [u32; 2],
}

impl TextureUv {
    /// Coordinates as they are.
    pub const PLAIN: Self = Self {
        set: 0,
        offset: [0.0; 2],
        rotation: 0.0,
        scale: [1.0; 2],
        wrap: [WrappingMode::Repeat; 2],
        size: [1; 2],
    };

    /// What `info` asks for, of a texture of `size` pixels whose sampler wraps as `wrap`.
    pub fn read(info: &Info, wrap: [WrappingMode; 2], size: [u32; 2]) -> Self {
        let mut uv = Self { set: info.tex_coord, wrap, size, ..Self::PLAIN };
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

    /// The texture coordinate that is looked up for `uv`.
    pub fn apply(&self, [u, v]: [f32; 2]) -> [f32; 2] {
        let plain = Self::PLAIN;
        if (self.offset, self.rotation, self.scale) == (plain.offset, plain.rotation, plain.scale) {
            return [u, v];
        }
        let (u, v) = (u * self.scale[0], v * self.scale[1]);
        let (sin, cos) = self.rotation.sin_cos();
        [cos * u + sin * v + self.offset[0], cos * v - sin * u + self.offset[1]]
    }

    /// Moves the corners of a triangle to where a texture that repeats shows what the file's wrapping shows there;
    /// `false` where the triangle crosses the border of the texture, and no such place exists.
    pub fn wrap(&self, triangle: &mut [[f32; 2]; 3]) -> bool {
        let mut exact = true;
        for axis in 0..2 {
            let half_pixel = 0.5 / self.size[axis].max(1) as f32;
            let values = triangle.map(|uv| uv[axis]);
            let low = values.iter().copied().fold(f32::INFINITY, f32::min);
            let high = values.iter().copied().fold(f32::NEG_INFINITY, f32::max);
            // Rounding of the writer's is no crossing.
            let rounding = 0.1 * half_pixel;
            let cell = ((low + high) / 2.0).floor();
            let in_cell = low >= cell - rounding && high <= cell + 1.0 + rounding;
            match self.wrap[axis] {
                WrappingMode::Repeat => {}
                WrappingMode::ClampToEdge => {
                    // Half a pixel from the border, where nothing of the other border shines in. A triangle that crosses
                    // is stretched.
                    exact &= (in_cell && cell == 0.0) || high <= half_pixel || low >= 1.0 - half_pixel;
                    triangle.iter_mut().for_each(|uv| uv[axis] = uv[axis].clamp(half_pixel, 1.0 - half_pixel));
                }
                WrappingMode::MirroredRepeat if in_cell && cell == 0.0 => {}
                WrappingMode::MirroredRepeat if in_cell => {
                    let odd = cell.rem_euclid(2.0) == 1.0;
                    let turned = |value: f32| if odd { cell + 1.0 - value } else { value - cell };
                    triangle.iter_mut().for_each(|uv| uv[axis] = turned(uv[axis]));
                }
                WrappingMode::MirroredRepeat => exact = false,
            }
        }
        exact
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a texture shows at `u`, as a place within it.
    fn shown(mode: WrappingMode, u: f32) -> f32 {
        match mode {
            WrappingMode::Repeat => u.rem_euclid(1.0),
            WrappingMode::ClampToEdge => u.clamp(0.005, 0.995),
            WrappingMode::MirroredRepeat => 1.0 - (u.rem_euclid(2.0) - 1.0).abs(),
        }
    }

    #[test]
    fn wrapped_triangles_show_the_same() {
        for mode in [WrappingMode::Repeat, WrappingMode::ClampToEdge, WrappingMode::MirroredRepeat] {
            let uv = TextureUv { wrap: [mode, WrappingMode::Repeat], size: [100, 100], ..TextureUv::PLAIN };
            for (low, exact) in
                [(-1.9, true), (-0.4, mode == WrappingMode::Repeat), (0.3, true), (1.2, true), (2.3, true)]
            {
                let corners = [[low, 0.0], [low + 0.6, 7.0], [low + 0.3, -7.0]];
                let mut moved = corners;
                assert_eq!(uv.wrap(&mut moved), exact, "{mode:?} {low}");
                for (before, after) in corners.iter().zip(&moved) {
                    assert_eq!(before[1], after[1]);
                    if exact {
                        let (wanted, found) = (shown(mode, before[0]), shown(WrappingMode::Repeat, after[0]));
                        assert!((wanted - found).abs() < 1e-5, "{mode:?}: {before:?} {after:?}");
                    }
                }
            }
        }
    }
}
