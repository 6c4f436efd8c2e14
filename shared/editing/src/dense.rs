//! Small dense systems.

/// Solves `(A + damping diag(A)) x = b` by Cholesky; `None` where that is not positive definite. Of `matrix`, row after row, the
/// lower half is read.
pub(crate) fn solve_dense(matrix: &[f64], right: &[f64], damping: f64) -> Option<Vec<f64>> {
    let n = right.len();
    let mut lower = matrix.to_vec();
    let mut x = right.to_vec();
    for j in 0..n {
        lower[j * n + j] += damping * lower[j * n + j] + 1e-9;
        for k in 0..j {
            lower[j * n + j] -= lower[j * n + k] * lower[j * n + k];
        }
        let pivot = lower[j * n + j];
        if pivot.is_nan() || pivot <= 0.0 {
            return None;
        }
        let root = pivot.sqrt();
        lower[j * n + j] = root;
        for i in j + 1..n {
            let dot: f64 = (0..j).map(|k| lower[i * n + k] * lower[j * n + k]).sum();
            lower[i * n + j] = (lower[i * n + j] - dot) / root;
        }
    }
    for i in 0..n {
        let dot: f64 = (0..i).map(|k| lower[i * n + k] * x[k]).sum();
        x[i] = (x[i] - dot) / lower[i * n + i];
    }
    for i in (0..n).rev() {
        let dot: f64 = (i + 1..n).map(|k| lower[k * n + i] * x[k]).sum();
        x[i] = (x[i] - dot) / lower[i * n + i];
    }
    x.iter().all(|x| x.is_finite()).then_some(x)
}
