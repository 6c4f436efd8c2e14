//! Learning models of some size, and what is known of them.

use bundle::AppearanceQuality;
use job::Job;
use texture::TextureModel;

use super::AppearanceError;
use super::align::Aligned;
use super::basis::Basis;
use super::charts::Charts;
use super::stored::StoredQuality;
use super::textures::TextureSource;
use learn::pca::PrincipalComponents;

/// More are never kept, whatever quality is asked for.
pub const MOST_COMPONENTS: usize = 150;

/// What came out.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
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

/// What appearances of a capture are learnt from and measured on.
pub(super) struct Learner<'a, S: ?Sized> {
    pub source: &'a S,
    pub charts: &'a Charts,
    pub aligned: &'a Aligned,
    /// The frames that qualities are measured on.
    pub sample: &'a [usize],
    pub job: &'a Job<'a>,
}

impl<S: TextureSource + ?Sized> Learner<'_, S> {
    /// A model of so many Eigen textures and Eigen warps, and what is known of it before it is stored.
    pub fn learn(&self, split: (usize, usize)) -> Result<(TextureModel, AppearanceSummary), AppearanceError> {
        let Self { source, aligned, .. } = *self;
        let basis = Basis::new(source, aligned, &aligned.complete, split, self.job)?;
        let (textures, warps) = (basis.textures.modes.len(), basis.warps.modes.len());
        let (ssim, mean_square_error) = basis.quality(source, aligned, self.sample, textures, warps)?;
        let share = |components: &PrincipalComponents| match components.total_variance {
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
