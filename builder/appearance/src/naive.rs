//! Principal components of textures as they were captured, not aligned: what Eigen textures and Eigen warps are compared
//! with, in figures and on the page.

use rayon::prelude::*;
use texture::TextureModel;

use super::AppearanceError;
use super::align::colours;
use super::charts::Charts;
use super::completion::complete;
use super::gaps::Gaps;
use super::textures::TextureSource;
use learn::pca::components;
use learn::store::Store;

/// `count` components of the complete textures of `source`, with coefficients of all frames; nothing is warped.
///
/// # Errors
/// A texture that cannot be read, or no room for a scratch file.
pub fn naive(
    source: &(impl TextureSource + ?Sized),
    charts: &Charts,
    count: usize,
) -> Result<TextureModel, AppearanceError> {
    let gaps = Gaps::find(source, charts)?;
    let store = captured(source, charts)?;
    let mut found = components(&store, &gaps.complete(), count)?;
    let texels = charts.texels();
    for frame in 0..source.frame_count() {
        let Some(hidden) = gaps.of(frame) else { continue };
        let unseen: Vec<u32> = (0..texels.len() as u32).filter(|&k| hidden[texels[k as usize] as usize]).collect();
        complete(&mut found, &store, frame, &unseen, 3)?;
    }
    Ok(TextureModel {
        width: charts.width as u32,
        height: charts.height as u32,
        active: charts.active(),
        mean_texture: found.mean,
        textures: found.modes,
        mean_warp: vec![0.0; 2 * texels.len()],
        warps: Vec::new(),
        texture_coefficients: found.coefficients,
        warp_coefficients: Vec::new(),
    })
}

/// The textures as they are, a row a frame.
pub fn captured(source: &(impl TextureSource + ?Sized), charts: &Charts) -> Result<Store, AppearanceError> {
    let store = Store::new(source.frame_count(), 3 * charts.texels().len(), 2.0)?;
    let written: Result<Vec<()>, AppearanceError> = (0..source.frame_count())
        .into_par_iter()
        .map(|frame| Ok(store.write(frame, &colours(&source.read(frame)?, charts))?))
        .collect();
    written.map(|_| store)
}
