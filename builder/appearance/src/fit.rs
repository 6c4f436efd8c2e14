//! Fitting Eigen textures to what is made of them: to the textures as captured, after de-alignment.
//!
//! A texture that is moved to the reference and back has been interpolated twice, and loses detail of a texel's size each
//! time; and the warp that moves it back is not its own but what a few Eigen warps leave of it. Both losses are far larger
//! than what the Eigen textures leave out. So aligned textures are not taken as they were moved, but are those from which
//! the *player's* way back gives the captured textures: with S_k the de-alignment by the Eigen warps of frame k, the
//! modes T and coefficients c minimise
//!
//! ```text
//! sum over frames of | I_k - S_k (mean + sum_j c_kj T_j) |^2
//! ```
//!
//! by projected gradients: what is missing of each captured texture is moved to the reference (the inverse warp stands for
//! the transpose of S_k, as in the iterative back-projection of Irani, Peleg, *Improving resolution by image
//! registration*, 1991), added to what the model has, and principal components of that are the next model. The warps are
//! those that a bundle stores, smaller and in steps, so that what this does to them is made good as well.

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use super::AppearanceError;
use super::align::{Aligned, Incomplete, WARP_RANGE, colours};
use super::completion;
use super::rebuilt::combine_all;
use super::textures::TextureSource;
use super::warp::WarpMethod;
use job::Job;
use learn::pca::{PrincipalComponents, components};
use learn::store::Store;

/// Times that what is missing is added. More come closer before storing (SSIM 0.9944 after four, 0.9933 after two, 0.9907 after
/// one, at 1024 x 1024), but what they add is fine detail that costs more bytes than it is worth (docs/appearance.md).
pub const STEPS: usize = 2;
/// Frames whose models are put together at once by a thread.
const TOGETHER: usize = 4;
/// How much of what is missing is added: interpolation there and back weakens detail, so more than all of it.
const STEP: f32 = 1.4;

/// What is fitted.
#[derive(Clone, Copy, Debug)]
pub struct Fitting<'a> {
    /// The frames that are learnt from.
    pub training: &'a [usize],
    /// Eigen textures at most.
    pub textures: usize,
    /// Eigen warps of the way back.
    pub warps: usize,
    /// Times that what is missing is added, [`STEPS`] where nothing else is tried.
    pub steps: usize,
}

/// Eigen textures which each frame's `warp` turns into the textures of
/// `source`; all frames get coefficients, incomplete ones from what was seen.
///
/// # Errors
/// Textures that cannot be read, or no room for scratch files.
pub fn fit(
    source: &(impl TextureSource + ?Sized),
    aligned: &Aligned,
    warp: &(impl Fn(usize) -> Vec<f32> + Sync),
    fitting: &Fitting,
    job: &Job,
) -> Result<PrincipalComponents, AppearanceError> {
    let Fitting { training, textures: count, warps, steps } = *fitting;
    let mut textures = learn(aligned, &aligned.textures, training, count)?;
    if steps == 0 {
        return Ok(textures);
    }
    let part = |step: usize| {
        let (work, key) = aligned.kept.as_ref()?;
        Some((work, key.part("fit", step as u64).told(&(training, count, warps))))
    };
    let opened = |step| {
        let (place, aligned) = (part(step), &aligned.textures);
        Store::kept(place.as_ref().map(|(work, key)| (*work, key)), aligned.rows(), aligned.columns(), aligned.range())
    };
    let ways = Store::new(aligned.warps.rows(), aligned.warps.columns(), WARP_RANGE)?;
    let done = AtomicU64::new(0);
    let total = (steps * aligned.textures.rows()) as u64;
    for step in 0..steps {
        let rows = opened(step)?;
        let improve = |(frame, mut model): (usize, Vec<f32>)| -> Result<(), AppearanceError> {
            let warp = warp(frame);
            let way = if step == 0 {
                let way = aligned.warper.inverse(&warp);
                ways.write(frame, &way)?;
                way
            } else {
                // The step before was done before this program was started. Its stores are less exact than what is put there.
                if !ways.has(frame) {
                    ways.write(frame, &aligned.warper.inverse(&warp))?;
                }
                ways.row(frame)?
            };
            let mut missing = colours(&source.read(frame)?, &aligned.charts);
            let shown = aligned.warper.warp(&model, 3, &warp, WarpMethod::Direct);
            missing.iter_mut().zip(&shown).for_each(|(missing, shown)| *missing -= shown);
            for &texel in aligned.unseen(frame) {
                missing[3 * texel as usize..3 * texel as usize + 3].fill(0.0);
            }
            let missing = aligned.warper.warp(&missing, 3, &way, WarpMethod::Direct);
            model.iter_mut().zip(&missing).for_each(|(model, missing)| *model += STEP * missing);
            Ok(rows.write(frame, &model)?)
        };
        let together = |frames: &[usize]| -> Result<(), AppearanceError> {
            let missing: Vec<usize> = frames.iter().copied().filter(|&frame| !rows.has(frame)).collect();
            let done = done.fetch_add(frames.len() as u64, Ordering::Relaxed) + frames.len() as u64;
            job.tell("eigen textures", done, total)?;
            let models = combine_all(&textures, &missing, textures.modes.len());
            missing.into_iter().zip(models).try_for_each(improve)
        };
        let frames: Vec<usize> = (0..rows.rows()).collect();
        let improved: Result<Vec<()>, AppearanceError> = frames.par_chunks(TOGETHER).map(together).collect();
        improved?;
        textures = learn(aligned, &rows, training, count)?;
    }
    Ok(textures)
}

fn learn(
    aligned: &Aligned,
    rows: &Store,
    training: &[usize],
    count: usize,
) -> Result<PrincipalComponents, AppearanceError> {
    let mut textures = components(rows, training, count)?;
    for Incomplete { frame, unseen_aligned, .. } in &aligned.incomplete {
        completion::complete(&mut textures, rows, *frame, unseen_aligned, 3)?;
    }
    Ok(textures)
}
