//! How good an appearance is against the number of its components: the curves of thesis figures 4.6 and 4.9 to 4.12, TVCG
//! figure 22, and how transitions look between two recorded frames.
//!
//! Measured in texture space over active texels, and in pictures of the actor, against the textures as captured. *Naive* is
//! PCA of the textures as they are, with as many components in all.

use std::ops::Range;

use rayon::prelude::*;
use serde::Serialize;
use texture::quality::Similarity;

use super::ghosting::{AgainstTruth, Crossings, Scene, against_truth};
use super::quality::{Quality, evenly};
use super::seams::{Moment, changes, worn};
use super::views::Views;
use crate::EvaluateError;
use appearance::AppearanceError;
use appearance::align::{AlignOptions, Aligned, align, colours};
use appearance::basis::Basis;
use appearance::charts::Charts;
use appearance::model::split;
use appearance::naive::captured;
use appearance::rebuilt::{combine, compared, means};
use appearance::stored;
use appearance::textures::TextureSource;
use appearance::warp::WarpMethod;
use job::Job;
use learn::pca::{PrincipalComponents, components};
use learn::store::Store;

/// Numbers of components on the curves.
const COUNTS: [usize; 9] = [2, 3, 6, 12, 20, 30, 40, 50, 80];
/// Components of the model whose interpolation and generalisation are measured.
const USUAL: usize = 50;
/// Frames of which pictures are compared.
const VIEWS: usize = 6;
/// Shares of the frames that are learnt from, in percent. What the largest leaves is rebuilt in all of them.
const SHARES: [usize; 4] = [10, 25, 50, 75];
/// Frames between the two that are interpolated.
const DISTANCES: [usize; 3] = [4, 8, 16];
/// Frames, or pairs of frames, on which each point of a curve is measured.
const SAMPLE: usize = 24;

/// One number of components.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Reconstruction {
    /// Components in all.
    pub components: usize,
    /// Eigen textures and Eigen warps, fitted for this number, moved by Poisson reconstruction.
    pub ours: Quality,
    /// The same, moved directly.
    pub direct: Quality,
    /// The same after storing, as the player shows it.
    pub stored: Quality,
    /// Bytes of what is stored, a frame of the whole capture.
    pub stored_bytes: f64,
    /// Naive PCA.
    pub naive: Quality,
    /// Pictures of the actor in our textures.
    pub ours_seen: Quality,
    /// Pictures of the actor in those of naive PCA.
    pub naive_seen: Quality,
}

/// One share of training frames; frames that no share holds are rebuilt.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Generalisation {
    /// Share of the complete frames that is learnt from, in percent.
    pub percent: usize,
    /// Their number.
    pub training: usize,
    /// Components in all.
    pub components: usize,
    /// Frames not learnt from, rebuilt by ours.
    pub ours: Quality,
    /// The same by naive PCA.
    pub naive: Quality,
}

/// Halves of two frames, with some components, against the same with all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Interpolation {
    /// Components in all.
    pub components: usize,
    /// Similarity to the interpolation with all.
    pub quality: Quality,
}

/// The frame in the middle of two recorded ones, made from these two.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Ghosting {
    /// Frames from one to the other.
    pub distance: usize,
    /// Pairs.
    pub pairs: usize,
    /// Coefficients interpolated, 50 components in all.
    pub ours: Quality,
    /// The two textures cross-faded.
    pub blend: Quality,
    /// Mean gradient of both over that of the recorded frame: below 1 is blur.
    pub sharpness: [f64; 2],
}

/// All curves of a capture.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Curves {
    /// Against the number of components.
    pub reconstruction: Vec<Reconstruction>,
    /// Against the share of training frames.
    pub generalisation: Vec<Generalisation>,
    /// Against the number of Eigen textures.
    pub interpolation: Vec<Interpolation>,
    /// Against the distance of frames.
    pub ghosting: Vec<Ghosting>,
    /// Transitions against the truth, where it is known.
    pub against_truth: Option<AgainstTruth>,
    /// Root mean square changes of colours from each recorded frame to the next.
    pub own_changes: Vec<f64>,
    /// The same from a recorded frame to a synthetic one and back.
    pub seam_changes: Vec<f64>,
}

/// What is measured.
pub struct Subject<'a, S: TextureSource + ?Sized> {
    /// Textures of all frames.
    pub source: &'a S,
    /// The atlas.
    pub charts: &'a Charts,
    /// Frames of each sequence.
    pub sequences: &'a [Range<usize>],
    /// Seams of transitions: the moments before and after each.
    pub seams: &'a [[Moment; 2]],
    /// Transitions, and the truth about them where it is known.
    pub crossings: Option<Crossings<'a>>,
    /// The actor that wears them.
    pub views: Views<'a>,
}

/// Measures a capture's appearance.
///
/// # Errors
/// Textures that cannot be read, or no room for scratch files.
pub fn curves(
    subject: &Subject<'_, impl TextureSource + ?Sized>,
    options: &AlignOptions,
    job: &Job,
) -> Result<Curves, EvaluateError> {
    let Subject { source, charts, sequences, seams, crossings, views } = subject;
    let aligned = align(*source, charts, options, job)?;
    let raw = captured(*source, charts)?;
    let all = aligned.complete.clone();
    let similarity = Similarity::new(charts.width as u32, &charts.active());
    let bench = Bench { source: *source, aligned, raw, similarity, views };
    let progress = |done: usize| job.tell("appearance curves", done as u64, 11);
    progress(0)?;
    let full = bench.learn(&all, USUAL)?;
    let ghosting = bench.ghosting(&full, sequences)?;
    let halves = bench.halves(&full, &all);
    let steps: Vec<[Moment; 2]> = sequences
        .iter()
        .flat_map(|sequence| sequence.clone().zip(sequence.clone().skip(1)))
        .map(|(before, after)| [before, after].map(Moment::recorded))
        .collect();
    let own_changes = changes(&bench.aligned, &full, &steps);
    let seam_changes = changes(&bench.aligned, &full, seams);
    let scene = Scene { source: *source, aligned: &bench.aligned, basis: &full, similarity: &bench.similarity };
    let against_truth = crossings.as_ref().map(|crossings| against_truth(&scene, crossings)).transpose()?;
    drop(full);
    let naive = components(&bench.raw, &all, COUNTS[COUNTS.len() - 1]).map_err(AppearanceError::from)?;
    let (mut reconstruction, mut interpolation) = (Vec::new(), Vec::new());
    for (done, &count) in COUNTS.iter().filter(|&&count| count < all.len()).enumerate() {
        progress(1 + done)?;
        let basis = bench.learn(&all, count)?;
        reconstruction.push(bench.reconstruction(count, &basis, &naive, &all)?);
        if count < USUAL {
            interpolation.push(Interpolation { components: count, quality: bench.interpolation(&basis, &halves)? });
        }
    }
    drop(naive);
    progress(10)?;
    Ok(Curves {
        reconstruction,
        generalisation: bench.generalisation(&all)?,
        interpolation,
        ghosting,
        against_truth,
        own_changes,
        seam_changes,
    })
}

struct Bench<'a, S: TextureSource + ?Sized> {
    source: &'a S,
    aligned: Aligned,
    raw: Store,
    similarity: Similarity,
    views: &'a Views<'a>,
}

impl<S: TextureSource + ?Sized> Bench<'_, S> {
    fn learn(&self, training: &[usize], count: usize) -> Result<Basis, AppearanceError> {
        let (textures, warps) = split(count);
        Basis::new(self.source, &self.aligned, training, (textures, warps), &Job::silent())
    }

    fn original(&self, frame: usize) -> Result<Vec<f32>, AppearanceError> {
        Ok(colours(&self.source.read(frame)?, &self.aligned.charts))
    }

    /// The mean quality over `frames` of what `rebuild` makes of them.
    fn over(&self, frames: &[usize], rebuild: impl Fn(usize) -> Vec<f32> + Sync) -> Result<Quality, AppearanceError> {
        let found = frames
            .par_iter()
            .map(|&frame| Ok(compared(&self.similarity, &self.original(frame)?, rebuild(frame))))
            .collect();
        means(found).map(|(ssim, mse)| Quality { ssim, mse })
    }

    fn reconstruction(
        &self,
        count: usize,
        basis: &Basis,
        naive: &PrincipalComponents,
        frames: &[usize],
    ) -> Result<Reconstruction, EvaluateError> {
        let frames = evenly(frames, SAMPLE);
        let (textures, warps) = split(count);
        let ours = |frame, how| basis.rebuild(&self.aligned.warper, frame, textures, warps, how);
        let before = self.over(&frames, |frame| ours(frame, WarpMethod::Poisson))?;
        let (model, charts) = (basis.clone().into_model(&self.aligned.charts), &self.aligned.charts);
        let (_, stored) = stored::choose(self.source, charts, &model, before.ssim, &frames)?;
        Ok(Reconstruction {
            components: count,
            ours: before,
            stored: Quality { ssim: stored.ssim, mse: stored.mean_square_error },
            stored_bytes: stored.bytes_per_frame,
            direct: self.over(&frames, |frame| ours(frame, WarpMethod::Direct))?,
            naive: self.over(&frames, |frame| combine(naive, frame, count))?,
            ours_seen: self.seen(&frames, |frame| ours(frame, WarpMethod::Poisson))?,
            naive_seen: self.seen(&frames, |frame| combine(naive, frame, count))?,
        })
    }

    /// The mean quality of pictures of the actor in what `rebuild` makes.
    fn seen(&self, frames: &[usize], rebuild: impl Fn(usize) -> Vec<f32> + Sync) -> Result<Quality, EvaluateError> {
        let found = evenly(frames, VIEWS)
            .par_iter()
            .map(|&frame| Ok(self.views.compare(frame, &self.original(frame)?, &rebuild(frame))?))
            .collect();
        means(found).map(|(ssim, mse)| Quality { ssim, mse })
    }

    fn generalisation(&self, frames: &[usize]) -> Result<Vec<Generalisation>, AppearanceError> {
        let order = shuffled(frames);
        let share = |percent: usize| (order.len() * percent / 100).max(2).min(order.len().saturating_sub(1));
        let unknown = evenly(&order[share(SHARES[SHARES.len() - 1])..], SAMPLE);
        SHARES
            .into_iter()
            .map(|percent| {
                let training = share(percent);
                let mut known = order[..training].to_vec();
                known.sort_unstable();
                let count = USUAL.min(training);
                let (textures, warps) = split(count);
                let (basis, naive) = (self.learn(&known, count)?, components(&self.raw, &known, count)?);
                let warper = &self.aligned.warper;
                let ours =
                    self.over(&unknown, |frame| basis.rebuild(warper, frame, textures, warps, WarpMethod::Poisson))?;
                let naive = self.over(&unknown, |frame| combine(&naive, frame, count))?;
                Ok(Generalisation { percent, training, components: count, ours, naive })
            })
            .collect()
    }

    /// Pairs of frames drawn at random, and what lies half way between them, as a screen shows it.
    fn halves(&self, basis: &Basis, frames: &[usize]) -> Vec<([usize; 2], Vec<f32>)> {
        let order = shuffled(frames);
        let pairs: Vec<[usize; 2]> = order.chunks_exact(2).take(SAMPLE).map(|pair| [pair[0], pair[1]]).collect();
        let half = |&pair: &[usize; 2]| {
            (pair, self.between(basis, pair).into_iter().map(|value| value.clamp(0.0, 1.0)).collect())
        };
        pairs.par_iter().map(half).collect()
    }

    fn interpolation(&self, basis: &Basis, halves: &[([usize; 2], Vec<f32>)]) -> Result<Quality, AppearanceError> {
        let found = halves
            .par_iter()
            .map(|(pair, wanted)| Ok(compared(&self.similarity, wanted, self.between(basis, *pair))))
            .collect();
        means(found).map(|(ssim, mse)| Quality { ssim, mse })
    }

    /// Half way between two frames: means of coefficients are means of textures and of warps.
    fn between(&self, basis: &Basis, pair: [usize; 2]) -> Vec<f32> {
        worn(&self.aligned, basis, Moment { frames: pair, lambda: 0.5 })
    }

    fn ghosting(&self, basis: &Basis, sequences: &[Range<usize>]) -> Result<Vec<Ghosting>, AppearanceError> {
        let complete = &self.aligned.complete;
        DISTANCES
            .into_iter()
            .map(|distance| {
                let fits = |middle: &usize| {
                    let Some(before) = middle.checked_sub(distance / 2) else { return false };
                    let ends = [before, *middle, middle + distance / 2];
                    let together = sequences.iter().any(|s| ends.iter().all(|frame| s.contains(frame)));
                    together && ends.iter().all(|frame| complete.binary_search(frame).is_ok())
                };
                let middles: Vec<usize> = complete.iter().copied().filter(fits).collect();
                let middles = evenly(&middles, SAMPLE);
                let ends = |middle: usize| [middle - distance / 2, middle + distance / 2];
                let ours = |middle| self.between(basis, ends(middle));
                let blend = |middle| -> Vec<f32> {
                    let [a, b] = ends(middle).map(|frame| self.raw.row(frame).unwrap_or_default());
                    a.iter().zip(&b).map(|(a, b)| 0.5 * (a + b)).collect()
                };
                let sharpness = [self.sharpness(&middles, ours)?, self.sharpness(&middles, blend)?];
                Ok(Ghosting {
                    distance,
                    pairs: middles.len(),
                    ours: self.over(&middles, ours)?,
                    blend: self.over(&middles, blend)?,
                    sharpness,
                })
            })
            .collect()
    }

    /// Mean length of gradients of what `make` makes over that of the recorded frames.
    fn sharpness(&self, frames: &[usize], make: impl Fn(usize) -> Vec<f32> + Sync) -> Result<f64, AppearanceError> {
        let texels = self.aligned.charts.texels();
        let steepness = |values: &[f32]| -> f64 {
            let pairs = texels.windows(2).enumerate().filter(|(_, pair)| pair[1] == pair[0] + 1);
            pairs
                .map(|(k, _)| (0..3).map(|c| f64::from((values[3 * k + 3 + c] - values[3 * k + c]).abs())).sum::<f64>())
                .sum()
        };
        let found =
            frames.par_iter().map(|&frame| Ok((steepness(&make(frame)), steepness(&self.original(frame)?)))).collect();
        means(found).map(|(made, recorded)| made / recorded.max(1e-12))
    }
}

/// `frames` in an order that looks random but is always the same.
fn shuffled(frames: &[usize]) -> Vec<usize> {
    let mut order = frames.to_vec();
    order.sort_by_key(|&frame| {
        let mixed = (frame as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        (mixed ^ (mixed >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9) >> 7
    });
    order
}
