//! Made-up models of textures: smooth waves over two charts, with edges and noise in the mean.
#![allow(dead_code, reason = "each test uses some of them")]

use texture::TextureModel;

/// A number between 0 and 1 that looks random.
pub fn noise(seed: u32) -> f32 {
    let mixed = (seed ^ seed >> 15).wrapping_mul(2_246_822_519);
    let mixed = (mixed ^ mixed >> 13).wrapping_mul(3_266_489_917);
    ((mixed ^ mixed >> 16) >> 8) as f32 / (1 << 24) as f32
}

/// Models of `textures` and `warps` modes for `frames` frames, over two charts of a `width` × `height` texture.
pub fn model([width, height]: [usize; 2], [textures, warps]: [usize; 2], frames: usize) -> TextureModel {
    let inside = |x: f32, y: f32, cx: f32, r: f32| (x / width as f32 - cx).hypot(y / height as f32 - 0.5) < r;
    let active: Vec<bool> = (0..width * height)
        .map(|at| ((at % width) as f32, (at / width) as f32))
        .map(|(x, y)| inside(x, y, 0.26, 0.23) || inside(x, y, 0.75, 0.2))
        .collect();
    let texels: Vec<usize> = (0..active.len()).filter(|&at| active[at]).collect();
    let wave = |seed: usize, at: usize| {
        let (x, y) = ((at % width) as f32 / width as f32, (at / width) as f32 / height as f32);
        let phase = 6.0 * noise(seed as u32);
        ((4.0 + seed as f32 % 7.0) * x + (3.0 + seed as f32 % 5.0) * y + phase).sin()
    };
    let modes = |count: usize, channels: usize, first: usize| -> Vec<Vec<f32>> {
        (0..count)
            .map(|mode| {
                let value = |at: usize, channel: usize| {
                    wave(first + 3 * mode + channel, at) + 0.1 * noise((at * 31 + mode * 7 + channel) as u32)
                };
                let values: Vec<f32> =
                    texels.iter().flat_map(|&at| (0..channels).map(move |channel| value(at, channel))).collect();
                let length = values.iter().map(|value| value * value).sum::<f32>().sqrt().max(1e-9);
                values.iter().map(|value| value / length).collect()
            })
            .collect()
    };
    let coefficients = |count: usize, channels: usize, scale: f32| -> Vec<f32> {
        let length = ((texels.len() * channels) as f32).sqrt() * scale;
        let of = |frame: usize, mode: usize| {
            (0.3 * frame as f32 * (1.0 + mode as f32 / 3.0)).cos() * length / (1.0 + mode as f32).powi(2)
        };
        (0..frames).flat_map(|frame| (0..count).map(move |mode| of(frame, mode))).collect()
    };
    let mean = |at: usize| {
        let edge = if wave(5, at) > 0.3 { 0.2 } else { 0.0 };
        [0.4 + edge + 0.05 * noise(at as u32), 0.5 - edge, 0.3 + 0.1 * wave(2, at)]
    };
    TextureModel {
        width: width as u32,
        height: height as u32,
        mean_texture: texels.iter().flat_map(|&at| mean(at)).collect(),
        textures: modes(textures, 3, 0),
        mean_warp: texels.iter().flat_map(|&at| [wave(11, at), wave(12, at)]).collect(),
        warps: modes(warps, 2, 20),
        texture_coefficients: coefficients(textures, 3, 0.1),
        warp_coefficients: coefficients(warps, 2, 1.5),
        active,
    }
}

/// A frame's aligned texture (3 values a texel) and warp (2), by definition.
pub fn plain(model: &TextureModel, frame: usize) -> [Vec<f32>; 2] {
    let sum = |mean: &[f32], modes: &[Vec<f32>], coefficients: &[f32]| {
        let mut sum = mean.to_vec();
        for (mode, coefficient) in modes.iter().zip(&coefficients[frame * modes.len()..]) {
            sum.iter_mut().zip(mode).for_each(|(sum, value)| *sum += coefficient * value);
        }
        sum
    };
    [
        sum(&model.mean_texture, &model.textures, &model.texture_coefficients),
        sum(&model.mean_warp, &model.warps, &model.warp_coefficients),
    ]
}
