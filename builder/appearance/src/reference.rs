//! The reference texture, by iterative medoid shift (thesis section 4.4.1, algorithm 4).
//!
//! The algorithm runs at a lower resolution and over evenly spread frames: it only has to choose one of them. The medoid
//! is the frame whose aligned texture has the least sum of squared distances to all others, which is the one nearest
//! their mean.

use rayon::prelude::*;

use super::AppearanceError;
use super::charts::Charts;
use super::flow::{FlowGrid, FlowOptions};
use super::prepare::prepare;
use super::textures::{Texture, TextureSource};
use super::warp::{TextureWarper, WarpMethod};

/// Longest side of the textures that are compared.
const SIZE: usize = 256;
/// Frames that stand for all.
const MOST_FRAMES: usize = 128;
/// Rounds at most; three are usual.
const MOST_ROUNDS: usize = 8;

/// The frame of `frames` that the others align to best.
///
/// # Errors
/// A texture that cannot be read.
pub fn choose(
    source: &(impl TextureSource + ?Sized),
    charts: &Charts,
    frames: &[usize],
) -> Result<usize, AppearanceError> {
    let small = charts.at_most(SIZE);
    let step = frames.len().div_ceil(MOST_FRAMES).max(1);
    let frames: Vec<usize> = frames.iter().copied().step_by(step).collect();
    let grid = FlowGrid::new(&small, FlowOptions::default());
    let warper = TextureWarper::new(&small);
    let texels = small.texels();
    let read = |&frame: &usize| -> Result<_, AppearanceError> {
        let texture = shrunk(source.read(frame)?, charts, &small);
        let prepared = grid.prepare(&prepare(&texture, &small.labels), None);
        let colours = texels.iter().flat_map(|&texel| texture.colours[texel as usize]);
        Ok((prepared, colours.map(|c| f32::from(c) / 255.0).collect::<Vec<f32>>()))
    };
    let small_textures: Result<Vec<_>, AppearanceError> = frames.par_iter().map(read).collect();
    let textures = small_textures?;
    let mut reference = frames.len() / 2;
    let mut least = f64::INFINITY;
    for _ in 0..MOST_ROUNDS {
        let Some((template, wanted)) = textures.get(reference) else { break };
        let aligned: Vec<Vec<f32>> = textures
            .par_iter()
            .map(|(prepared, colours)| {
                let flow = grid.flow(template, prepared);
                warper.warp(colours, 3, &warper.compact(&flow), WarpMethod::Direct)
            })
            .collect();
        let error: f64 = aligned.iter().map(|texture| distance(texture, wanted)).sum();
        if error >= least {
            break;
        }
        least = error;
        let mut mean = vec![0.0; wanted.len()];
        for texture in &aligned {
            mean.iter_mut().zip(texture).for_each(|(mean, value)| *mean += value / aligned.len() as f32);
        }
        let distances: Vec<f64> = aligned.iter().map(|texture| distance(texture, &mean)).collect();
        let medoid = (0..distances.len()).min_by(|&a, &b| distances[a].total_cmp(&distances[b]));
        let Some(medoid) = medoid.filter(|&medoid| medoid != reference) else { break };
        reference = medoid;
    }
    frames.get(reference).copied().ok_or(AppearanceError::NoFrames)
}

fn distance(a: &[f32], b: &[f32]) -> f64 {
    a.iter().zip(b).map(|(a, b)| f64::from((a - b) * (a - b))).sum()
}

/// The texture at the resolution of `small`, which is some halvings of `charts`: means over texels of the same chart.
fn shrunk(texture: Texture, charts: &Charts, small: &Charts) -> Texture {
    let mut step = 1;
    while charts.width.div_ceil(step) > small.width {
        step *= 2;
    }
    let mut colours = vec![[0; 3]; small.labels.len()];
    for (index, colour) in colours.iter_mut().enumerate() {
        let (x, y) = (index % small.width * step, index / small.width * step);
        let (mut sum, mut count) = ([0_u32; 3], 0);
        for row in y..(y + step).min(charts.height) {
            for texel in row * charts.width + x..row * charts.width + (x + step).min(charts.width) {
                if charts.labels[texel] == small.labels[index] {
                    sum.iter_mut().zip(texture.colours[texel]).for_each(|(sum, c)| *sum += u32::from(c));
                    count += 1;
                }
            }
        }
        *colour = sum.map(|sum| ((sum + count / 2) / count.max(1)) as u8);
    }
    Texture { width: small.width as u32, height: small.height as u32, colours, hidden: None }
}
