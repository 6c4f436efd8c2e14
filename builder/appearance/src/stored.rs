//! What is left of a model's quality once it has been stored: quantised, entropy coded, read again, and rebuilt as the
//! player rebuilds it (the processor's twin of its passes, one multigrid cycle).

use bundle::{AppearanceInput, AppearanceQuality, StoredAppearance, store_appearance};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use texture::TextureModel;
use texture::quality::{Similarity, psnr};

use super::AppearanceError;
use super::align::colours;
use super::charts::Charts;
use super::rebuilt::compared;
use super::textures::TextureSource;
use learn::pca::PrincipalComponents;

/// Multigrid cycles of the player.
pub const CYCLES: usize = 1;
/// Step of warps, in texels: they weigh little, and an error of theirs moves edges.
pub(super) const WARP_STEP: f32 = 0.08;
/// Bytes of the appearance, a frame of the whole capture, that are never exceeded.
const MOST_BYTES: u64 = 8192;
/// Structural similarity that is enough, and what storing may cost of it where the model has less.
const ENOUGH: f64 = 0.98;
const LOSS: f64 = 0.003;
/// Times that steps are made finer.
const ATTEMPTS: usize = 4;
/// How much finer.
const FINER: f32 = 0.7;
/// Part of the bytes that is as good as all.
const ALL_BUT_FULL: f32 = 0.95;

/// The warps as they will be stored.
///
/// # Errors
/// Warps that do not fit their frames.
pub fn warps(
    warps: &PrincipalComponents,
    charts: &Charts,
    frame_count: usize,
) -> Result<StoredAppearance, AppearanceError> {
    let model = TextureModel {
        width: charts.width as u32,
        height: charts.height as u32,
        active: charts.active(),
        mean_texture: vec![0.0; 3 * charts.texels().len()],
        mean_warp: warps.mean.clone(),
        warps: warps.modes.clone(),
        warp_coefficients: warps.coefficients.clone(),
        ..TextureModel::default()
    };
    let quality = AppearanceQuality { warp_step: WARP_STEP, ..AppearanceQuality::default() };
    Ok(store_appearance(&AppearanceInput { model: &model, material: 0, quality }, frame_count as u32, 1)?)
}

/// How alike textures are that were rebuilt from what is stored, over a sample of complete frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StoredQuality {
    /// Mean structural similarity in texture space.
    pub ssim: f64,
    /// That of the frame that comes out worst.
    pub least_ssim: f64,
    /// Mean square error of colours from 0 to 1.
    pub mean_square_error: f64,
    /// Peak signal-to-noise ratio of that, in decibels.
    pub psnr: f64,
    /// Frames that were compared.
    pub frames: usize,
    /// Bytes of the appearance, a frame of the whole capture.
    pub bytes_per_frame: f64,
}

/// Stores `model` with `quality` and compares the textures of `frames` with those of `source`.
///
/// # Errors
/// A model that does not fit its frames, or a texture that cannot be read.
pub fn stored_quality(
    source: &(impl TextureSource + ?Sized),
    charts: &Charts,
    model: &TextureModel,
    quality: AppearanceQuality,
    frames: &[usize],
) -> Result<StoredQuality, AppearanceError> {
    let input = AppearanceInput { model, material: 0, quality };
    let stored = store_appearance(&input, source.frame_count() as u32, 1)?;
    compare(source, charts, &stored, frames)
}

/// The coarsest quality of those tried that is `ENOUGH` or costs no more than `LOSS` of the similarity `before`, or the
/// finest that keeps to `MOST_BYTES`; with what it comes to.
///
/// # Errors
/// As [`stored_quality`].
pub fn choose(
    source: &(impl TextureSource + ?Sized),
    charts: &Charts,
    model: &TextureModel,
    before: f64,
    frames: &[usize],
) -> Result<(AppearanceQuality, StoredQuality), AppearanceError> {
    let most_bytes = Some(MOST_BYTES * source.frame_count() as u64);
    let mut quality = AppearanceQuality { warp_step: WARP_STEP, most_bytes, ..AppearanceQuality::default() };
    let mut found = stored_quality(source, charts, model, quality, frames)?;
    for _ in 0..ATTEMPTS {
        // Finer steps need no more than as many more bytes as they are finer.
        let full = (found.bytes_per_frame / MOST_BYTES as f64) as f32;
        if found.ssim >= ENOUGH.min(before - LOSS) || full > ALL_BUT_FULL {
            break;
        }
        quality.texture_step *= FINER.max(full);
        found = stored_quality(source, charts, model, quality, frames)?;
    }
    Ok((quality, found))
}

fn compare(
    source: &(impl TextureSource + ?Sized),
    charts: &Charts,
    stored: &StoredAppearance,
    frames: &[usize],
) -> Result<StoredQuality, AppearanceError> {
    let similarity = Similarity::new(charts.width as u32, &charts.active());
    let of = |&frame: &usize| -> Result<(f64, f64), AppearanceError> {
        let original = colours(&source.read(frame)?, charts);
        Ok(compared(&similarity, &original, stored.texture(frame as u32, CYCLES)))
    };
    let found: Result<Vec<(f64, f64)>, AppearanceError> = frames.par_iter().map(of).collect();
    let found = found?;
    let count = found.len().max(1) as f64;
    let mean_square_error = found.iter().map(|(_, error)| error / count).sum();
    Ok(StoredQuality {
        ssim: found.iter().map(|(ssim, _)| ssim / count).sum(),
        least_ssim: found.iter().map(|(ssim, _)| *ssim).fold(1.0, f64::min),
        mean_square_error,
        psnr: psnr(mean_square_error),
        frames: frames.len(),
        bytes_per_frame: stored.report.bytes_per_frame,
    })
}
