//! Eigen textures and Eigen warps from aligned textures, and what they rebuild (thesis 4.4.2, 4.4.3, 4.6.2).

use bundle::{AppearanceQuality, StoredAppearance};
use rayon::prelude::*;
use texture::AppearanceModel;
use texture::quality::Similarity;

use super::AppearanceError;
use super::align::{AlignOptions, Aligned, Incomplete, align, colours};
use super::charts::Charts;
use super::completion;
use super::fit::{self, fit};
use super::pca::{Components, components};
use super::reach::reach;
use super::stored::{self, StoredQuality};
use super::textures::TextureSource;
use super::warp::{Warper, Warping};
use job::progress::{Progress, Report};

/// Components where nothing is said: "virtually no error" in thesis 4.5.1.
pub const DEFAULT_COMPONENTS: usize = 50;
/// More are never kept, whatever quality is asked for.
pub const MOST_COMPONENTS: usize = 150;
/// Frames on which a quality is measured.
const SAMPLED_FRAMES: usize = 16;

/// How an appearance is built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AppearanceOptions {
    /// Components in all: Eigen textures and Eigen warps.
    pub components: usize,
    /// The split of them and the steps of colours that reach this structural similarity after storing in the fewest bytes,
    /// instead of two thirds textures and steps that keep to a number of bytes.
    pub ssim: Option<f64>,
    /// Whether it may be reached with another number of components than `components`, up to [`MOST_COMPONENTS`].
    pub any_components: bool,
    /// How textures are aligned.
    pub align: AlignOptions,
    /// As many components of textures that are not aligned go into the bundle, so that the page can compare.
    pub compare: bool,
}

impl Default for AppearanceOptions {
    fn default() -> Self {
        Self {
            components: DEFAULT_COMPONENTS,
            ssim: None,
            any_components: true,
            align: AlignOptions::default(),
            compare: false,
        }
    }
}

/// What came out.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct AppearanceSummary {
    /// Eigen textures.
    pub textures: usize,
    /// Eigen warps.
    pub warps: usize,
    /// The frame that the others were aligned to.
    pub reference: usize,
    /// Frames with texels that were not seen, completed from the others.
    pub completed_frames: Vec<usize>,
    /// Share of the aligned textures' variance that is kept.
    pub texture_variance: f64,
    /// Share of the warps' variance that is kept.
    pub warp_variance: f64,
    /// Structural similarity of rebuilt textures, over a sample of complete frames, before quantisation.
    pub ssim: f64,
    /// Mean square error of the same.
    pub mean_square_error: f64,
    /// How finely the models are to be stored.
    pub quality: AppearanceQuality,
    /// The same after storing, as the player shows it.
    pub stored: StoredQuality,
}

/// Eigen textures and Eigen warps of a number of components in all: two in three are textures.
#[must_use]
pub fn split(components: usize) -> (usize, usize) {
    let warps = components / 3;
    (components - warps, warps)
}

/// Builds the appearance of a capture from the textures of its frames.
///
/// # Errors
/// Textures that cannot be read, or no room for scratch files.
pub fn build(
    source: &(impl TextureSource + ?Sized),
    charts: &Charts,
    options: &AppearanceOptions,
    report: Report,
) -> Result<(AppearanceModel, AppearanceSummary), AppearanceError> {
    let aligned = align(source, charts, &options.align, report)?;
    let sample = sampled(&aligned.complete);
    let learner = Learner { source, charts, aligned: &aligned, sample: &sample };
    if let Some(wanted) = options.ssim {
        return reach(&learner, wanted, (options.components, options.any_components), report);
    }
    report(Progress { what: "eigen textures", done: 0, total: 0 });
    let (model, mut summary) = learner.learn(split(options.components))?;
    report(Progress { what: "appearance after storing", done: 0, total: 0 });
    (summary.quality, summary.stored) = stored::choose(source, charts, &model, summary.ssim, &sample)?;
    Ok((model, summary))
}

/// What appearances of a capture are learnt from and measured on.
pub(super) struct Learner<'a, S: ?Sized> {
    pub source: &'a S,
    pub charts: &'a Charts,
    pub aligned: &'a Aligned,
    /// The frames that qualities are measured on.
    pub sample: &'a [usize],
}

impl<S: TextureSource + ?Sized> Learner<'_, S> {
    /// A model of so many Eigen textures and Eigen warps, and what is known of it before it is stored.
    pub fn learn(&self, split: (usize, usize)) -> Result<(AppearanceModel, AppearanceSummary), AppearanceError> {
        let Self { source, aligned, .. } = *self;
        let basis = Basis::new(source, aligned, &aligned.complete, split.0, split.1)?;
        let (textures, warps) = (basis.textures.modes.len(), basis.warps.modes.len());
        let (ssim, mean_square_error) = basis.quality(source, aligned, self.sample, textures, warps)?;
        let share = |components: &Components| match components.total_variance {
            0.0 => 1.0,
            total => components.variances.iter().sum::<f64>() / total,
        };
        let summary = AppearanceSummary {
            textures,
            warps,
            reference: aligned.reference,
            completed_frames: aligned.incomplete.iter().map(|incomplete| incomplete.frame).collect(),
            texture_variance: share(&basis.textures),
            warp_variance: share(&basis.warps),
            ssim,
            mean_square_error,
            quality: AppearanceQuality::default(),
            stored: StoredQuality::default(),
        };
        Ok((basis.into_model(self.charts), summary))
    }
}

/// Evenly spread frames that stand for all.
fn sampled(frames: &[usize]) -> Vec<usize> {
    frames.iter().copied().step_by(frames.len().div_ceil(SAMPLED_FRAMES).max(1)).collect()
}

/// Both linear models of an aligned capture, with coefficients of all its frames.
#[derive(Clone, Debug)]
pub struct Basis {
    /// Of aligned textures.
    pub textures: Components,
    /// Of backward warps.
    pub warps: Components,
    /// The warps as they will be stored, which the textures are fitted to.
    shown: StoredAppearance,
}

impl Basis {
    /// Learns from the frames `training`; all frames get coefficients, incomplete ones from what was seen.
    ///
    /// # Errors
    /// A texture or a scratch file that cannot be read.
    pub fn new(
        source: &(impl TextureSource + ?Sized),
        aligned: &Aligned,
        training: &[usize],
        textures: usize,
        warps: usize,
    ) -> Result<Self, AppearanceError> {
        Self::fitted(source, aligned, training, (textures, warps), fit::STEPS)
    }

    /// The same with so many `steps` of the fit.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn fitted(
        source: &(impl TextureSource + ?Sized),
        aligned: &Aligned,
        training: &[usize],
        (textures, warps): (usize, usize),
        steps: usize,
    ) -> Result<Self, AppearanceError> {
        let mut warps = components(&aligned.warps, training, warps)?;
        for Incomplete { frame, unseen, .. } in &aligned.incomplete {
            completion::complete(&mut warps, &aligned.warps, *frame, unseen, 2)?;
        }
        let shown = stored::warps(&warps, &aligned.charts, source.frame_count())?;
        let warp = |frame: usize| shown.warp(frame as u32, frame as u32, 0.0);
        let textures = fit(source, aligned, &warp, training, textures, steps)?;
        Ok(Self { textures, warps, shown })
    }

    /// The texture of a frame, rebuilt from the first modes: three values per active texel.
    #[must_use]
    pub fn rebuild(&self, warper: &Warper, frame: usize, textures: usize, warps: usize, how: Warping) -> Vec<f32> {
        let texture = combine(&self.textures, frame, textures);
        let warp = match warps < self.warps.modes.len() {
            true => combine(&self.warps, frame, warps),
            false => self.shown_warp([frame; 2], 0.0),
        };
        warper.warp(&texture, 3, &warp, how)
    }

    /// The warp that the player shows `lambda` of the way between two frames: two values per active texel.
    #[must_use]
    pub fn shown_warp(&self, [from, to]: [usize; 2], lambda: f32) -> Vec<f32> {
        self.shown.warp(from as u32, to as u32, lambda)
    }

    /// Mean structural similarity and mean square error of rebuilt textures against those of `source`.
    ///
    /// # Errors
    /// A texture that cannot be read.
    pub fn quality(
        &self,
        source: &(impl TextureSource + ?Sized),
        aligned: &Aligned,
        frames: &[usize],
        textures: usize,
        warps: usize,
    ) -> Result<(f64, f64), AppearanceError> {
        let similarity = Similarity::new(aligned.charts.width as u32, &aligned.charts.active());
        let of = |&frame: &usize| -> Result<_, AppearanceError> {
            let original = colours(&source.read(frame)?, &aligned.charts);
            let rebuilt = self.rebuild(&aligned.warper, frame, textures, warps, Warping::Poisson);
            Ok(compared(&similarity, &original, rebuilt))
        };
        let found: Vec<Result<(f64, f64), AppearanceError>> = frames.par_iter().map(of).collect();
        means(found)
    }

    /// The model as it is stored: everything that rebuilds the frames that it was learnt from.
    #[must_use]
    pub fn into_model(self, charts: &Charts) -> AppearanceModel {
        AppearanceModel {
            width: charts.width as u32,
            height: charts.height as u32,
            active: charts.active(),
            mean_texture: self.textures.mean,
            textures: self.textures.modes,
            mean_warp: self.warps.mean,
            warps: self.warps.modes,
            texture_coefficients: self.textures.coefficients,
            warp_coefficients: self.warps.coefficients,
        }
    }
}

/// Structural similarity and mean square error of what a screen would show of `rebuilt`.
pub fn compared(similarity: &Similarity, original: &[f32], mut rebuilt: Vec<f32>) -> (f64, f64) {
    rebuilt.iter_mut().for_each(|value| *value = value.clamp(0.0, 1.0));
    let error = texture::quality::mean_square_error(original, &rebuilt);
    (similarity.of(original, &rebuilt), error)
}

/// Means of pairs.
pub fn means<E>(pairs: Vec<Result<(f64, f64), E>>) -> Result<(f64, f64), E> {
    let count = pairs.len().max(1) as f64;
    let mut sums = (0.0, 0.0);
    for pair in pairs {
        let (a, b) = pair?;
        sums = (sums.0 + a / count, sums.1 + b / count);
    }
    Ok(sums)
}

/// The mean and the first `count` modes, each times the frame's coefficient.
#[must_use]
pub fn combine(components: &Components, frame: usize, count: usize) -> Vec<f32> {
    let all = components.modes.len();
    let mut sum = components.mean.clone();
    for (mode, &factor) in components.modes.iter().zip(&components.coefficients[frame * all..]).take(count.min(all)) {
        sum.iter_mut().zip(mode).for_each(|(sum, value)| *sum += factor * value);
    }
    sum
}
