//! The sections for appearance: what all frames share (`appearance`), then the mean and the modes one by one
//! (`appearance-mode`), coarse first.

pub(super) mod decode;
pub(super) mod encode;
mod texels;
mod waves;

use std::rc::Rc;

use serde::{Deserialize, Serialize};

pub use decode::ModeDecoder;
pub use encode::{AppearanceInput, AppearanceQuality, AppearanceReport};

use crate::appearance::basis::Layer;
use crate::appearance::mask::Mask;

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
