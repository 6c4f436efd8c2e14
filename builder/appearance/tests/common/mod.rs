//! Textures made in code, of which all is known: what becomes of them is tested here and where they are evaluated.
#![allow(dead_code, clippy::unwrap_used, reason = "each test uses its part, and fails loudly")]

use appearance::Charts;
use appearance::align::{AlignOptions, Aligned, align};
use appearance::textures::Texture;
use job::Job;

pub const SIZE: usize = 96;
pub const FRAMES: usize = 14;

/// Spots and stripes that slide, brighter from frame to frame.
pub fn texture(frame: usize) -> Texture {
    between(frame, frame, 0.0)
}

pub fn slide(frame: usize) -> f32 {
    2.5 * (0.45 * frame as f32).sin()
}

/// What lies `lambda` of the way from frame `a` to frame `b`: slides and light are interpolated, not colours.
pub fn between(a: usize, b: usize, lambda: f32) -> Texture {
    let mixed = |a: f32, b: f32| a + lambda * (b - a);
    let slide = mixed(slide(a), slide(b));
    let light = |frame: usize, x: f32| 0.8 + 0.01 * frame as f32 + 0.1 * (0.02 * x + 0.1 * frame as f32).sin();
    let colours = (0..SIZE * SIZE).map(|k| {
        let (x, y) = ((k % SIZE) as f32, (k / SIZE) as f32);
        let (u, v) = (x + slide * (0.03 * y).cos(), y + slide * (0.04 * x).sin());
        let spots = ((0.5 * u).sin() * (0.43 * v).cos() * 6.0).tanh();
        let light = mixed(light(a, x), light(b, x));
        [0.5 + 0.35 * spots, 0.5 - 0.2 * spots, 0.4 + 0.1 * (0.3 * u).sin()].map(|c| (c * light * 255.0).round() as u8)
    });
    Texture { width: SIZE as u32, height: SIZE as u32, colours: colours.collect(), hidden: None }
}

/// As above; some frames have a gap.
pub fn capture() -> Vec<Texture> {
    let mut textures: Vec<Texture> = (0..FRAMES).map(texture).collect();
    for frame in [3, 9] {
        let hidden: Vec<bool> =
            (0..SIZE * SIZE).map(|k| (20..45).contains(&(k % SIZE)) && (30..50).contains(&(k / SIZE))).collect();
        for (colour, hidden) in textures[frame].colours.iter_mut().zip(&hidden) {
            if *hidden {
                *colour = [0; 3];
            }
        }
        textures[frame].hidden = Some(hidden);
    }
    textures
}

pub fn charts() -> Charts {
    let label = |x: usize, y: usize| match (x, y) {
        (4..46, 4..92) => 1,
        (50..92, 4..92) => 2,
        _ => 0,
    };
    Charts { width: SIZE, height: SIZE, labels: (0..SIZE * SIZE).map(|k| label(k % SIZE, k / SIZE)).collect() }
}

pub fn aligned(textures: &[Texture]) -> Aligned {
    align(textures, &charts(), &AlignOptions::default(), &Job::silent()).unwrap()
}
