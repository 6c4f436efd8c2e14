//! The sections for appearance: what all frames share (`appearance`), then the mean and the modes one by one
//! (`appearance-mode`), coarse first.

pub(super) mod decode;
pub(super) mod encode;
mod mixed;
mod texels;
mod waves;

use std::rc::Rc;

use serde::{Deserialize, Serialize};

pub use decode::ModeDecoder;
pub use encode::{AppearanceInput, AppearanceQuality, AppearanceReport};

use super::error::EncodeError;
use super::kind::SectionKind;
use texture::basis::{Block, Layer, Mode};
use texture::dealign::{Aligned, Field};
use texture::mask::{ACTIVE, Mask};
use texture::transform::SIDE;

/// Which textures a bundle's models are of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Textures {
    /// Aligned ones, which warps move back.
    #[default]
    Aligned,
    /// Textures as they were captured, to compare with: there is nothing to move.
    Naive,
}

impl Textures {
    /// Those that a section of `kind` is about.
    pub(super) fn of(kind: SectionKind) -> Self {
        let naive =
            [SectionKind::EarlierNaive, SectionKind::EarlierNaiveMode, SectionKind::Naive, SectionKind::NaiveMode];
        if naive.contains(&kind) { Self::Naive } else { Self::Aligned }
    }

    /// The kind of section that holds what they share.
    pub(super) fn kind(self) -> SectionKind {
        [SectionKind::Appearance, SectionKind::Naive][self as usize]
    }

    /// The kind of section that holds one of their modes.
    pub(super) fn modes_kind(self) -> SectionKind {
        [SectionKind::AppearanceMode, SectionKind::NaiveMode][self as usize]
    }
}

/// How modes are coded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Coding {
    /// Each by itself, until 1.2.
    Alone,
    /// With those before as context.
    #[default]
    Mixed,
}

impl Coding {
    /// That of a section of `kind`, which holds what modes share, and the kind of its modes.
    pub(super) fn of(kind: SectionKind) -> (Self, SectionKind) {
        match kind {
            SectionKind::EarlierAppearance => (Self::Alone, SectionKind::EarlierMode),
            SectionKind::EarlierNaive => (Self::Alone, SectionKind::EarlierNaiveMode),
            SectionKind::Naive => (Self::Mixed, SectionKind::NaiveMode),
            _ => (Self::Mixed, SectionKind::AppearanceMode),
        }
    }
}

/// What all frames' textures share, and each frame's coefficients. The modes arrive later.
#[derive(Clone, Debug)]
pub struct Appearance {
    /// Index of the material that it paints.
    pub material: u32,
    /// Width and height of the textures, in texels.
    pub size: [u32; 2],
    /// Which texels are active.
    pub mask: Rc<Mask>,
    /// Colours, then warps.
    pub layers: [Layer; 2],
    pub(super) coding: Coding,
}

impl StoredAppearance {
    /// The texture of a frame as the player rebuilds it, by `cycles` multigrid cycles: three values per active texel.
    #[must_use]
    pub fn texture(&self, frame: u32, cycles: usize) -> Vec<f32> {
        self.between([frame; 2], 0.0, cycles)
    }

    /// The texture `lambda` of the way from the first frame to the second: their coefficients are interpolated.
    #[must_use]
    pub fn between(&self, [from, to]: [u32; 2], lambda: f32, cycles: usize) -> Vec<f32> {
        let Self { mask, layers, .. } = self;
        let field = |layer: usize| {
            let own: &Layer = &layers[layer];
            own.rebuild(mask, &self.modes[layer], &own.weights(from, to, lambda), SIDE)
        };
        let cell = (1 << layers[1].level) as f32;
        let aligned = Aligned { texture: field(0), warp: field(1), texel: 1.0, cell, fill: [0.5; 3] };
        let shown = aligned.dealign(mask, cycles);
        let active = shown.iter().zip(&mask.full().flags).filter(|(_, flags)| **flags & ACTIVE != 0);
        active.flat_map(|(colour, _)| *colour).collect()
    }

    /// The warp of a picture `lambda` of the way from frame `from` to frame `to` as the player reads it: two values per
    /// active texel, in texels.
    #[must_use]
    pub fn warp(&self, from: u32, to: u32, lambda: f32) -> Vec<f32> {
        let Self { mask, layers: [_, warps], modes, .. } = self;
        let warp = warps.rebuild(mask, &modes[1], &warps.weights(from, to, lambda), SIDE);
        let full = mask.full();
        let texture = Field { width: full.width, height: full.height, texels: Vec::new() };
        let aligned = Aligned { texture, warp, texel: 1.0, cell: (1 << warps.level) as f32, fill: [0.0; 3] };
        let active = aligned.warps().into_iter().zip(&full.flags).filter(|(_, flags)| **flags & ACTIVE != 0);
        active.flat_map(|(warp, _)| warp).collect()
    }
}

impl Appearance {
    /// The layer, 0 for colours and 1 for warps, and the mode in it (0 for the mean) that section `ordinal` holds.
    ///
    /// The mean texture comes first, then the mean warp, then the modes by decreasing variance, textures and warps taking
    /// turns so that both end together.
    #[must_use]
    pub fn place(&self, ordinal: u32) -> Option<(usize, usize)> {
        place([self.layers[0].mode_count(), self.layers[1].mode_count()], ordinal as usize)
    }

    /// Sections that hold a mean or a mode.
    #[must_use]
    pub fn section_count(&self) -> u32 {
        (self.layers[0].steps.len() + self.layers[1].steps.len()) as u32
    }
}

/// Models as a reader gets them back from a bundle, to measure what storing costs.
#[derive(Clone, Debug)]
pub struct StoredAppearance {
    /// Which texels are active.
    pub mask: Mask,
    /// Colours, then warps.
    pub layers: [Layer; 2],
    /// Modes of colours, then of warps; the mean first.
    pub modes: [Vec<Mode>; 2],
    /// What they weigh.
    pub report: AppearanceReport,
}

/// Codes the models of `input` for a capture of `frame_count` frames as a bundle does, and reads them again.
///
/// # Errors
/// Models that do not fit the capture.
pub fn store_appearance(
    input: &AppearanceInput,
    frame_count: u32,
    material_count: usize,
) -> Result<StoredAppearance, EncodeError> {
    let wrong = |reason: &str| EncodeError::Inconsistent(format!("the appearance that was just written {reason}"));
    let sections = encode::encode(input, frame_count, material_count)?;
    let appearance = decode::head(&sections.head, Coding::Mixed, frame_count, material_count).map_err(wrong)?;
    let mut modes = [Vec::new(), Vec::new()];
    let mut decoder = ModeDecoder::default();
    for (ordinal, bytes) in (0..).zip(&sections.modes) {
        let (layer, _) = appearance.place(ordinal).ok_or_else(|| wrong("has too many modes"))?;
        let mode = decoder.advance(bytes, &appearance, layer, usize::MAX).map_err(wrong)?;
        modes[layer].push(mode.ok_or_else(|| wrong("ends too early"))?);
    }
    let Appearance { mask, layers, .. } = appearance;
    Ok(StoredAppearance { mask: Rc::unwrap_or_clone(mask), layers, modes, report: sections.report })
}

fn place(counts: [usize; 2], ordinal: usize) -> Option<(usize, usize)> {
    let total = counts[0] + counts[1];
    match ordinal {
        0 | 1 => Some((ordinal, 0)),
        _ if ordinal >= total + 2 => None,
        _ => {
            // As many warps are done as their share of the modes before says, rounded down.
            let warps = |modes: usize| (modes * counts[1]) / total;
            let index = ordinal - 2;
            let (before, after) = (warps(index), warps(index + 1));
            Some(if after > before { (1, after) } else { (0, index + 1 - after) })
        }
    }
}

/// Least and greatest class of a block's steps.
const COARSENESS: (i32, i32) = (-16, 24);

/// How much larger the steps of a block of this class are: four classes an octave.
fn scale(class: i32) -> f32 {
    const QUARTERS: [f32; 4] = [1.0, 1.189_207_1, std::f32::consts::SQRT_2, 1.681_792_9];
    QUARTERS[class.rem_euclid(4) as usize] * 2.0_f32.powi(class.div_euclid(4))
}

/// The class that the stored blocks to the left and above let expect, among those that are known.
fn expected(classes: &[i32], block: &Block) -> i32 {
    let [left, above] = [block.left, block.above].map(|other| classes.get(other? as usize).copied());
    left.or(above).unwrap_or(0).midpoint(above.or(left).unwrap_or(0))
}

/// What postcard stores in front of what is entropy coded.
#[derive(Serialize, Deserialize)]
struct Head {
    material: u32,
    size: [u32; 2],
    warp_level: u32,
    steps: [Vec<f32>; 2],
    /// Coefficients are multiples of this.
    coefficient_steps: [f32; 2],
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_mode_has_its_place_and_order() {
        for counts in [[0, 0], [3, 0], [0, 2], [34, 16], [5, 5], [1, 9]] {
            let places: Vec<_> = (0..).map_while(|ordinal| place(counts, ordinal)).collect();
            assert_eq!(places.len(), counts[0] + counts[1] + 2);
            for layer in 0..2 {
                let modes: Vec<usize> = places.iter().filter(|place| place.0 == layer).map(|place| place.1).collect();
                assert_eq!(modes, (0..=counts[layer]).collect::<Vec<_>>());
            }
        }
    }
}
