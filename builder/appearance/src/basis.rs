//! Eigen textures and Eigen warps from aligned textures, and what they rebuild (thesis sections 4.4.2, 4.4.3, 4.6.2).

use bundle::StoredAppearance;
use job::Job;
use rayon::prelude::*;
use texture::TextureModel;
use texture::quality::Similarity;

use super::AppearanceError;
use super::align::{Aligned, Incomplete, colours};
use super::charts::Charts;
use super::completion;
use super::fit::{self, Fitting, fit};
use super::rebuilt::{combine, compared, means};
use super::stored;
use super::textures::TextureSource;
use super::warp::{TextureWarper, WarpMethod};
use learn::pca::{PrincipalComponents, components};

/// Both linear models of an aligned capture, with coefficients of all its frames.
#[derive(Clone, Debug)]
pub struct Basis {
    /// Of aligned textures.
    pub textures: PrincipalComponents,
    /// Of backward warps.
    pub warps: PrincipalComponents,
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
        (textures, warps): (usize, usize),
        job: &Job,
    ) -> Result<Self, AppearanceError> {
        Self::fitted(source, aligned, &Fitting { training, textures, warps, steps: fit::STEPS }, job)
    }

    /// The same, fitted otherwise.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn fitted(
        source: &(impl TextureSource + ?Sized),
        aligned: &Aligned,
        fitting: &Fitting,
        job: &Job,
    ) -> Result<Self, AppearanceError> {
        let mut warps = components(&aligned.warps, fitting.training, fitting.warps)?;
        for Incomplete { frame, unseen, .. } in &aligned.incomplete {
            completion::complete(&mut warps, &aligned.warps, *frame, unseen, 2)?;
        }
        let shown = stored::warps(&warps, &aligned.charts, source.frame_count())?;
        let warp = |frame: usize| shown.warp(frame as u32, frame as u32, 0.0);
        let textures = fit(source, aligned, &warp, fitting, job)?;
        Ok(Self { textures, warps, shown })
    }

    /// The texture of a frame, rebuilt from the first modes: three values per active texel.
    #[must_use]
    pub fn rebuild(
        &self,
        warper: &TextureWarper,
        frame: usize,
        textures: usize,
        warps: usize,
        how: WarpMethod,
    ) -> Vec<f32> {
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
            let rebuilt = self.rebuild(&aligned.warper, frame, textures, warps, WarpMethod::Poisson);
            Ok(compared(&similarity, &original, rebuilt))
        };
        let found: Vec<Result<(f64, f64), AppearanceError>> = frames.par_iter().map(of).collect();
        means(found)
    }

    /// The model as it is stored: everything that rebuilds the frames that it was learnt from.
    #[must_use]
    pub fn into_model(self, charts: &Charts) -> TextureModel {
        TextureModel {
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
