//! Textures rebuilt from modes, and how alike they are to those that were captured.

use texture::quality::Similarity;

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
    let all = components.modes.len();
    let mut sum = components.mean.clone();
    // A piece of all modes at a time: the sum stays in the processor's nearest memory.
    for (piece, sum) in sum.chunks_mut(PIECE).enumerate() {
        let factors = &components.coefficients[frame * all..];
        for (mode, &factor) in components.modes.iter().zip(factors).take(count.min(all)) {
            let mode = &mode[piece * PIECE..];
            sum.iter_mut().zip(mode).for_each(|(sum, value)| *sum += factor * value);
        }
    }
    sum
}
