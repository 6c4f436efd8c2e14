//! The quantised basis: mean and modes as whole numbers of waves, block by block, and their sum.
//!
//! Sums are made of waves, before the inverse transform: what is zero in a mode, and most of it is, costs nothing.

use super::dealign::{Field, PADDING};
use super::mask::{ACTIVE, Level, Mask};
use super::transform::{AREA, OPPONENT, SIDE, cosines, inverse};

/// Sums of waves are whole multiples of one in this many: the same whatever the order of summation.
pub const ONE: f32 = (1 << 20) as f32;
/// Texels around active ones that are stored too, so that smaller levels do not bleed.
pub const MARGIN: usize = 2;
/// Differences of colours are stored this much coarser than their sum.
pub const CHROMA: f32 = 2.0;

/// A block that is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Block {
    /// Column of blocks.
    pub x: u16,
    /// Row of blocks.
    pub y: u16,
    /// Index of the stored block to the left, if any.
    pub left: Option<u32>,
    /// Index of the stored block above, if any.
    pub above: Option<u32>,
}

/// What the textures have in common, or the warps.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// 3 colours, or 2 of a warp.
    pub channels: usize,
    /// Index of its size among the mask's levels: a texel here is 2^level texels wide.
    pub level: usize,
    /// Stored blocks, row by row.
    pub blocks: Vec<Block>,
    /// Step of the mean's waves, then of each mode's.
    pub steps: Vec<f32>,
    /// How much larger the steps of each stored block are.
    pub scales: Vec<f32>,
    /// Coefficients, frame by frame, one per mode.
    pub coefficients: Vec<f32>,
}

/// The waves of the mean or of a mode that are not zero.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Mode {
    /// Where each block's entries begin; one more than there are blocks.
    pub offsets: Vec<u32>,
    /// Channel × 256 + row × 16 + column of the wave in the low 16 bits, its number of steps (signed) in the high ones.
    pub entries: Vec<u32>,
}

impl Layer {
    /// Stored blocks of a layer as large as `mask`: those with an active texel inside, or within [`MARGIN`].
    #[must_use]
    pub fn blocks_of(mask: &Level) -> Vec<Block> {
        let (wide, high) = (mask.width.div_ceil(SIDE), mask.height.div_ceil(SIDE));
        let mut stored = vec![false; wide * high];
        for at in (0..mask.flags.len()).filter(|&at| mask.flags[at] & ACTIVE != 0) {
            let (x, y) = (at % mask.width, at / mask.width);
            for y in [y.saturating_sub(MARGIN), (y + MARGIN).min(mask.height - 1)] {
                for x in [x.saturating_sub(MARGIN), (x + MARGIN).min(mask.width - 1)] {
                    stored[y / SIDE * wide + x / SIDE] = true;
                }
            }
        }
        let mut index = vec![None; wide * high];
        let mut blocks = Vec::new();
        for at in (0..stored.len()).filter(|&at| stored[at]) {
            index[at] = Some(blocks.len() as u32);
            let (x, y) = (at % wide, at / wide);
            let left = if x > 0 { index[at - 1] } else { None };
            let above = if y > 0 { index[at - wide] } else { None };
            blocks.push(Block { x: x as u16, y: y as u16, left, above });
        }
        blocks
    }

    /// Modes besides the mean.
    #[must_use]
    pub fn mode_count(&self) -> usize {
        self.steps.len().saturating_sub(1)
    }

    /// Weights of the mean's and the modes' steps in a picture `lambda` of the way from frame `from` to frame `to`.
    #[must_use]
    pub fn weights(&self, from: u32, to: u32, lambda: f32) -> Vec<f32> {
        let count = self.mode_count();
        let of = |frame: u32| self.coefficients.get(frame as usize * count..).unwrap_or_default();
        let (from, to) = (of(from), of(to));
        let mixed = from.iter().zip(to).take(count).map(|(a, b)| a + (b - a) * lambda);
        std::iter::once(1.0).chain(mixed).zip(&self.steps).map(|(coefficient, step)| coefficient * step).collect()
    }

    /// The sum of the mean and the modes, as many as there are, weighted; `side` is 16, or 8 for half the size.
    ///
    /// The twin of the pass `appearance_basis`.
    #[must_use]
    pub fn rebuild(&self, mask: &Mask, modes: &[Mode], weights: &[f32], side: usize) -> Field {
        let level = &mask.levels[self.level + usize::from(side < SIDE)];
        let table = cosines(side);
        let mut texels = vec![[0.0; 4]; level.width * level.height];
        for (index, block) in self.blocks.iter().enumerate() {
            let waves = self.block_sum(index, modes, weights);
            let mut channels = [[0.0; AREA]; 3];
            for (channel, waves) in channels.iter_mut().zip(&waves).take(self.channels) {
                *channel = inverse(&table, waves);
            }
            for at in 0..AREA {
                let (x, y) = (usize::from(block.x) * side + at % SIDE, usize::from(block.y) * side + at / SIDE);
                if at % SIDE >= side || at / SIDE >= side || x >= level.width || y >= level.height {
                    continue;
                }
                let [r, g, b] = self.colour([channels[0][at], channels[1][at], channels[2][at]]);
                let known = if level.flags[y * level.width + x] & ACTIVE != 0 { 1.0 } else { PADDING };
                texels[y * level.width + x] = [r, g, b, known];
            }
        }
        Field { width: level.width, height: level.height, texels }
    }

    fn block_sum(&self, block: usize, modes: &[Mode], weights: &[f32]) -> [[f32; AREA]; 3] {
        let mut sum = [[0_i32; AREA]; 3];
        for (mode, weight) in modes.iter().zip(weights) {
            for entry in &mode.entries[mode.offsets[block] as usize..mode.offsets[block + 1] as usize] {
                let (at, value) = ((entry & 0xffff) as usize, *entry as i32 >> 16);
                let wave = &mut sum[at / AREA][at % AREA];
                *wave = wave.wrapping_add((value as f32 * (weight * ONE)).round_ties_even() as i32);
            }
        }
        let own = self.scales.get(block).copied().unwrap_or(1.0) / ONE;
        let scale = |channel: usize| if channel > 0 && self.channels == 3 { CHROMA * own } else { own };
        std::array::from_fn(|channel| sum[channel].map(|wave| wave as f32 * scale(channel)))
    }

    fn colour(&self, channels: [f32; 3]) -> [f32; 3] {
        if self.channels < 3 {
            return channels;
        }
        std::array::from_fn(|colour| (0..3).map(|row| OPPONENT[row][colour] * channels[row]).sum())
    }
}
