//! How much a texture changes where recorded and synthetic frames meet, against its own change from frame to frame.

use rayon::prelude::*;

use appearance::align::Aligned;
use appearance::basis::Basis;
use appearance::rebuilt::combine;
use appearance::warp::WarpMethod;

/// What the actor wears at one frame of a walk: the coefficients of two recorded frames, blended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Both frames; the same one twice where it was recorded.
    pub frames: [usize; 2],
    /// Weight of the second.
    pub lambda: f32,
}

impl Moment {
    /// A recorded frame.
    #[must_use]
    pub fn recorded(frame: usize) -> Self {
        Self { frames: [frame; 2], lambda: 0.0 }
    }
}

/// The root mean square change of colours, from 0 to 1, over the active texels from the first to the second of each pair of
/// moments; pairs with a frame that is not complete are left out.
pub(super) fn changes(aligned: &Aligned, basis: &Basis, pairs: &[[Moment; 2]]) -> Vec<f64> {
    let complete = |moment: &Moment| moment.frames.iter().all(|frame| aligned.complete.binary_search(frame).is_ok());
    let whole: Vec<&[Moment; 2]> = pairs.iter().filter(|pair| pair.iter().all(complete)).collect();
    whole.into_par_iter().map(|pair| root_mean_square(&pair.map(|moment| worn(aligned, basis, moment)))).collect()
}

/// The texture at a moment, as the player rebuilds it.
pub(super) fn worn(aligned: &Aligned, basis: &Basis, moment: Moment) -> Vec<f32> {
    let [a, b] = moment.frames.map(|frame| combine(&basis.textures, frame, basis.textures.modes.len()));
    let textures: Vec<f32> = a.iter().zip(&b).map(|(a, b)| a + moment.lambda * (b - a)).collect();
    // Textures are fitted to the warps as they are stored.
    aligned.warper.warp(&textures, 3, &basis.shown_warp(moment.frames, moment.lambda), WarpMethod::Poisson)
}

fn root_mean_square([a, b]: &[Vec<f32>; 2]) -> f64 {
    let shown = |value: f32| f64::from(value.clamp(0.0, 1.0));
    let sum: f64 = a.iter().zip(b).map(|(&a, &b)| (shown(b) - shown(a)).powi(2)).sum();
    (sum / a.len().max(1) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::root_mean_square;

    #[test]
    fn changes_are_seen_as_a_screen_shows_them() {
        let change = root_mean_square(&[vec![0.0, 0.5, 1.5], vec![0.3, 0.5, 1.0]]);
        assert!((change - 0.3 / 3.0_f64.sqrt()).abs() < 1e-6);
        assert!(root_mean_square(&[vec![], vec![]]).abs() < 1e-12);
    }
}
