//! Textures rebuilt from modes, and how alike they are to those that were captured.

use texture::quality::Similarity;

use kernels::simd::{Kernel, Level as Instructions};
use learn::pca::PrincipalComponents;

/// Values that are summed together.
const PIECE: usize = 2048;

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
pub fn combine(components: &PrincipalComponents, frame: usize, count: usize) -> Vec<f32> {
    combine_all(components, &[frame], count).pop().unwrap_or_default()
}

/// The same for several frames: modes are read from memory once for all of them, which is what costs.
#[must_use]
pub fn combine_all(components: &PrincipalComponents, frames: &[usize], count: usize) -> Vec<Vec<f32>> {
    Instructions::best().run(Combine { components, frames, count: count.min(components.modes.len()) })
}

struct Combine<'a> {
    components: &'a PrincipalComponents,
    frames: &'a [usize],
    count: usize,
}

impl Kernel for Combine<'_> {
    type Output = Vec<Vec<f32>>;

    #[inline(always)]
    fn run(self) -> Vec<Vec<f32>> {
        let Self { components, frames, count } = self;
        let (all, length) = (components.modes.len(), components.mean.len());
        let mut sums = vec![components.mean.clone(); frames.len()];
        // A piece of all modes at a time: the sums stay in the processor's nearest memory.
        for start in (0..length).step_by(PIECE) {
            let end = (start + PIECE).min(length);
            for mode in 0..count {
                let values = &components.modes[mode][start..end];
                for k in 0..frames.len() {
                    let factor = components.coefficients[frames[k] * all + mode];
                    let sum = &mut sums[k][start..end];
                    for at in 0..values.len() {
                        sum[at] += factor * values[at];
                    }
                }
            }
        }
        sums
    }
}
