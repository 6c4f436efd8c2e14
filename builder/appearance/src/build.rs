//! The whole way from textures to models of them.

use std::io;

use texture::TextureModel;

use super::AppearanceError;
use super::align::{AlignOptions, Aligned, align};
use super::charts::Charts;
use super::model::{AppearanceSummary, Learner, split};
use super::reach::reach;
use super::stored;
use super::textures::TextureSource;
use super::warp::WarpMethod;

use job::Job;

/// Components where nothing is said: "virtually no error" in thesis section 4.5.1.
pub const DEFAULT_COMPONENTS: usize = 50;
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
    /// Whether it may be reached with another number of components than `components`, up to [`MOST_COMPONENTS`](super::model::MOST_COMPONENTS).
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
            align: AlignOptions { warping: WarpMethod::Direct, ..AlignOptions::default() },
            compare: false,
        }
    }
}

/// Builds the appearance of a capture from the textures of its frames.
///
/// # Errors
/// Textures that cannot be read, or no room for scratch files.
pub fn build(
    source: &(impl TextureSource + ?Sized),
    charts: &Charts,
    options: &AppearanceOptions,
    job: &Job,
) -> Result<(TextureModel, AppearanceSummary), AppearanceError> {
    let aligned = align(source, charts, &options.align, job)?;
    let key = aligned.kept.as_ref().map(|(work, key)| {
        let wanted = (options.components, options.ssim, options.any_components);
        (work, key.part("model", u64::from(MODEL_VERSION)).told(&wanted))
    });
    if let Some(known) =
        key.as_ref().and_then(|(work, key)| work.get(key)).and_then(|bytes| postcard::from_bytes(&bytes).ok())
    {
        return Ok(known);
    }
    let built = learnt(source, charts, &aligned, options, job)?;
    if let Some((work, key)) = key {
        let bytes =
            postcard::to_allocvec(&built).map_err(|error| AppearanceError::Work { source: io::Error::other(error) })?;
        work.put(&key, &bytes).map_err(|source| AppearanceError::Work { source })?;
    }
    Ok(built)
}

/// Changes whenever other models are learnt from the same aligned textures.
const MODEL_VERSION: u32 = 1;

fn learnt(
    source: &(impl TextureSource + ?Sized),
    charts: &Charts,
    aligned: &Aligned,
    options: &AppearanceOptions,
    job: &Job,
) -> Result<(TextureModel, AppearanceSummary), AppearanceError> {
    let sample = sampled(&aligned.complete);
    let learner = Learner { source, charts, aligned, sample: &sample, job };
    if let Some(wanted) = options.ssim {
        return reach(&learner, wanted, (options.components, options.any_components), job);
    }
    job.begin("eigen textures")?;
    let (model, mut summary) = learner.learn(split(options.components))?;
    job.begin("appearance after storing")?;
    (summary.quality, summary.stored) = stored::choose(source, charts, &model, summary.ssim, &sample)?;
    Ok((model, summary))
}

/// Evenly spread frames that stand for all.
fn sampled(frames: &[usize]) -> Vec<usize> {
    frames.iter().copied().step_by(frames.len().div_ceil(SAMPLED_FRAMES).max(1)).collect()
}
