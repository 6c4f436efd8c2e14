//! Coefficients of frames that were not seen in full (thesis section 4.6.2): the modes that explain what was
//! seen.

use super::AppearanceError;
use learn::pca::PrincipalComponents;
use learn::store::Store;

/// How much a coefficient is drawn to zero, against all texels seen: keeps a mode that lies in the gap from running away.
const RIDGE: f64 = 1e-3;

/// Sets the coefficients of `frame`, a row of `store`, by least squares over all texels but `unseen`, each of `channels`
/// values.
///
/// The modes are orthonormal, so the normal matrix is the identity less the products over the gap alone.
///
/// # Errors
/// A scratch file that cannot be read.
pub fn complete(
    components: &mut PrincipalComponents,
    store: &Store,
    frame: usize,
    unseen: &[u32],
    channels: usize,
) -> Result<(), AppearanceError> {
    let count = components.modes.len();
    if count == 0 || unseen.is_empty() {
        return Ok(());
    }
    let row = store.row(frame)?;
    let gap: Vec<usize> = unseen.iter().flat_map(|&k| (0..channels).map(move |c| k as usize * channels + c)).collect();
    let own = &mut components.coefficients[frame * count..(frame + 1) * count];
    let mut right: Vec<f64> = own.iter().map(|&c| f64::from(c)).collect();
    let mut matrix = vec![0.0; count * count];
    for i in 0..count {
        let mode = &components.modes[i];
        let outside: f64 = gap.iter().map(|&at| f64::from(mode[at] * (row[at] - components.mean[at]))).sum();
        right[i] -= outside;
        for j in 0..=i {
            let other = &components.modes[j];
            let shared: f64 = gap.iter().map(|&at| f64::from(mode[at] * other[at])).sum();
            matrix[i * count + j] = -shared;
            matrix[j * count + i] = -shared;
        }
        matrix[i * count + i] += 1.0 + RIDGE;
    }
    for (own, value) in own.iter_mut().zip(solve(matrix, right)) {
        *own = value as f32;
    }
    Ok(())
}

/// Solves a positive definite system by elimination without pivots.
fn solve(mut matrix: Vec<f64>, mut right: Vec<f64>) -> Vec<f64> {
    let n = right.len();
    for i in 0..n {
        for k in i + 1..n {
            let factor = matrix[k * n + i] / matrix[i * n + i];
            for j in i..n {
                matrix[k * n + j] -= factor * matrix[i * n + j];
            }
            right[k] -= factor * right[i];
        }
    }
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|j| matrix[i * n + j] * right[j]).sum();
        right[i] = (right[i] - known) / matrix[i * n + i];
    }
    right
}
