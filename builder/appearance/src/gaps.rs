//! Texels that no camera saw, frame by frame: given by a mask or by alpha, or black where the capture is not usually black.

use super::AppearanceError;
use super::charts::Charts;
use super::textures::{Texture, TextureSource};
use rayon::prelude::*;

/// Fewer black texels than this are no gap but dark colour.
const LEAST_TEXELS: usize = 24;
/// Frames read at once.
const BATCH: usize = 16;

/// Which active texels of which frames were not seen.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Gaps {
    /// For each frame a value per texel of the texture, row-major; none where all active texels were seen.
    hidden: Vec<Option<Vec<bool>>>,
    /// Frames with gaps that only their blackness shows.
    pub black_frames: Vec<usize>,
}

impl Gaps {
    /// Looks through all textures of `source`.
    ///
    /// A texel counts as not seen where the frame's mask or alpha says so, or where it lies in a patch of pure black
    /// while it is not black in most other frames.
    ///
    /// # Errors
    /// A texture that cannot be read.
    pub fn find(source: &(impl TextureSource + ?Sized), charts: &Charts) -> Result<Self, AppearanceError> {
        let frames: Vec<usize> = (0..source.frame_count()).collect();
        let mut counts = vec![0_u32; charts.labels.len()];
        let mut black: Vec<Option<Vec<u32>>> = Vec::new();
        let mut hidden: Vec<Option<Vec<bool>>> = Vec::new();
        for batch in frames.chunks(BATCH) {
            let read: Vec<Result<_, AppearanceError>> = batch
                .par_iter()
                .map(|&frame| source.read(frame).map(|texture| (black_texels(&texture, charts), texture.hidden)))
                .collect();
            for one in read {
                let (texels, mask) = one?;
                texels.iter().for_each(|&texel| counts[texel as usize] += 1);
                black.push((texels.len() >= LEAST_TEXELS).then_some(texels));
                hidden.push(mask);
            }
        }
        let mut black_frames = Vec::new();
        for (frame, (hidden, black)) in hidden.iter_mut().zip(black).enumerate() {
            let rare = |&texel: &u32| 2 * counts[texel as usize] as usize <= frames.len();
            let unusual: Vec<u32> = black.unwrap_or_default().into_iter().filter(rare).collect();
            if let Some(patches) = patches(&unusual, charts) {
                let known = hidden.get_or_insert_with(|| vec![false; charts.labels.len()]);
                let new = patches.iter().zip(&*known).any(|(black, known)| *black && !known);
                if new {
                    black_frames.push(frame);
                    known.iter_mut().zip(&patches).for_each(|(known, black)| *known |= black);
                }
            }
            let matters = |hidden: &Vec<bool>| hidden.iter().zip(&charts.labels).any(|(&h, &label)| h && label != 0);
            if !hidden.as_ref().is_some_and(matters) {
                *hidden = None;
            }
        }
        Ok(Self { hidden, black_frames })
    }

    /// What was not seen in a frame, a value per texel; none where all was seen.
    #[must_use]
    pub fn of(&self, frame: usize) -> Option<&Vec<bool>> {
        self.hidden.get(frame).and_then(Option::as_ref)
    }

    /// The frames of which all was seen.
    #[must_use]
    pub fn complete(&self) -> Vec<usize> {
        (0..self.hidden.len()).filter(|&frame| self.hidden[frame].is_none()).collect()
    }
}

fn black_texels(texture: &Texture, charts: &Charts) -> Vec<u32> {
    let texels = texture.colours.iter().zip(&charts.labels).enumerate();
    texels.filter(|(_, (colour, label))| **label != 0 && **colour == [0; 3]).map(|(texel, _)| texel as u32).collect()
}

/// Patches of `black` that are at least three texels wide, grown by two; none where they are too small.
fn patches(black: &[u32], charts: &Charts) -> Option<Vec<bool>> {
    if black.len() < LEAST_TEXELS {
        return None;
    }
    let (width, height) = (charts.width, charts.height);
    let mut is_black = vec![false; width * height];
    black.iter().for_each(|&texel| is_black[texel as usize] = true);
    let around = |texel: u32, reach: usize| {
        let (x, y) = (texel as usize % width, texel as usize / width);
        let columns = x.saturating_sub(reach)..(x + reach + 1).min(width);
        (y.saturating_sub(reach)..(y + reach + 1).min(height))
            .flat_map(move |y| columns.clone().map(move |x| y * width + x))
    };
    // What is not active does not keep a patch at a chart's border from being one.
    let solid = |texel: &&u32| around(**texel, 1).all(|near| is_black[near] || charts.labels[near] == 0);
    let mut patches = vec![false; width * height];
    let mut found = 0;
    for &texel in black.iter().filter(solid) {
        found += 1;
        around(texel, 2).for_each(|near| patches[near] = true);
    }
    (found >= LEAST_TEXELS / 3).then_some(patches)
}
