//! Which split into Eigen textures and Eigen warps, and which steps, reach a similarity in the fewest bytes.
//!
//! A texture mode takes several times the bytes of a warp mode, while the same number of components loses little where
//! more of them are warps. So splits with fewer and fewer textures are tried, each fitted anew and stored in the coarsest
//! steps that reach what is wanted, until one needs more bytes than the one before. Where no split reaches it even in the
//! finest steps, more components are tried.

use bundle::AppearanceQuality;
use texture::TextureModel;

use super::AppearanceError;
use super::coarsest::coarsest;
use super::model::{AppearanceSummary, Learner, MOST_COMPONENTS, split};
use super::stored::{StoredQuality, WARP_STEP, stored_quality};
use super::textures::TextureSource;
use job::Job;

/// Components in all that are tried where fewer do not reach what is wanted.
const MORE: [usize; 3] = [75, 110, MOST_COMPONENTS];
/// Tenths of the components that are textures, after the usual two thirds.
const TENTHS: [usize; 3] = [5, 4, 3];

/// Eigen textures and Eigen warps.
type Split = (usize, usize);
/// A model, and what it comes to when stored.
type Attempt = (TextureModel, AppearanceSummary);

/// The model of so many components, or of more where they do not do and `any` number will, whose similarity after storing
/// is at least `wanted` in the fewest bytes of all splits that were tried; the most similar one where none is.
///
/// # Errors
/// A texture or a scratch file that cannot be read.
pub(super) fn reach<S: TextureSource + ?Sized>(
    learner: &Learner<S>,
    wanted: f64,
    (components, any): (usize, bool),
    job: &Job,
) -> Result<Attempt, AppearanceError> {
    let [usual, fewer @ ..] = splits(components, learner);
    job.tell("splits of components", 0, 1 + fewer.len() as u64)?;
    let best = attempt(learner, wanted, usual, None)?;
    let mut search = Search { learner, wanted, job, tried: vec![usual], best };
    search.descend(&fewer, Some(search.best.1.stored))?;
    for more in MORE.into_iter().filter(|&more| any && more > components) {
        if search.best.1.stored.ssim >= wanted {
            break;
        }
        search.descend(&splits(more, learner), None)?;
    }
    Ok(search.best)
}

/// With fewer and fewer textures, at least one of either, and no more than the complete frames have.
fn splits<S: ?Sized>(components: usize, learner: &Learner<S>) -> [Split; 4] {
    let most = learner.aligned.complete.len().saturating_sub(1);
    let [half, fewer, least] = TENTHS.map(|tenths| (tenths * components + 5) / 10);
    [split(components).0, half, fewer, least].map(|textures| {
        let textures = textures.clamp(1, components.saturating_sub(1).max(1));
        (textures.min(most), components.saturating_sub(textures).min(most))
    })
}

/// Learns `split` and finds its steps, next to those of `rival` where there is one, which has to be beaten.
fn attempt<S: TextureSource + ?Sized>(
    learner: &Learner<S>,
    wanted: f64,
    split: Split,
    rival: Option<&AppearanceSummary>,
) -> Result<Attempt, AppearanceError> {
    let (model, mut summary) = learner.learn(split)?;
    let quality = rival.map_or_else(AppearanceQuality::default, |rival| rival.quality);
    let with = |step: f64| AppearanceQuality { texture_step: step as f32, warp_step: WARP_STEP, ..quality };
    let most_bytes = match rival {
        Some(rival) if rival.stored.ssim >= wanted => rival.stored.bytes_per_frame,
        _ => f64::INFINITY,
    };
    let found = coarsest(wanted, f64::from(quality.texture_step), most_bytes, |step| {
        stored_quality(learner.source, learner.charts, &model, with(step), learner.sample)
    })?;
    (summary.quality, summary.stored) = (with(found.step), found.stored);
    Ok((model, summary))
}

/// What has been tried, and the best of it.
struct Search<'a, S: ?Sized> {
    learner: &'a Learner<'a, S>,
    wanted: f64,
    job: &'a Job<'a>,
    tried: Vec<Split>,
    best: Attempt,
}

impl<S: TextureSource + ?Sized> Search<'_, S> {
    /// Tries `splits` that are new, in turn, until one is worse than the one before.
    fn descend(&mut self, splits: &[Split], mut before: Option<StoredQuality>) -> Result<(), AppearanceError> {
        for (&split, left) in splits.iter().zip((1..=splits.len() as u64).rev()) {
            let done = self.tried.len() as u64;
            self.job.tell("splits of components", done, done + left)?;
            if self.tried.contains(&split) {
                continue;
            }
            self.tried.push(split);
            let new = attempt(self.learner, self.wanted, split, Some(&self.best.1))?;
            let stored = new.1.stored;
            if self.better(&stored, &self.best.1.stored) {
                self.best = new;
            }
            if before.is_some_and(|before| !self.better(&stored, &before)) {
                break;
            }
            before = Some(stored);
        }
        Ok(())
    }

    /// Fewer bytes among those that are similar enough, which go before those that are not; else more similar.
    fn better(&self, new: &StoredQuality, old: &StoredQuality) -> bool {
        match (new.ssim >= self.wanted, old.ssim >= self.wanted) {
            (true, true) => new.bytes_per_frame < old.bytes_per_frame,
            (false, false) => new.ssim > old.ssim,
            (reached, _) => reached,
        }
    }
}
