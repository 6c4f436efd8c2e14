//! Eigenvalues and eigenvectors of a symmetric matrix, in a fixed order of operations.
//!
//! Householder's reduction to three diagonals, then QL with implicit shifts: the procedures tred2 and tql2 of Bowdler,
//! Martin, Reinsch, Wilkinson, *Handbook for Automatic Computation*, 1971. A library's version picks its operations by the
//! processor; a bundle's bytes must not depend on that.

/// Eigenvalues in decreasing order, and their eigenvectors: `vectors[k]` of length 1 belongs to `values[k]`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Eigen {
    /// Eigenvalues.
    pub values: Vec<f64>,
    /// Eigenvectors.
    pub vectors: Vec<Vec<f64>>,
}

/// The eigen-decomposition of the symmetric `size` x `size` matrix `matrix`, row-major. O(size^3).
#[must_use]
pub fn eigen(matrix: &[f64], size: usize) -> Eigen {
    if size == 0 {
        return Eigen::default();
    }
    // Rows of `v` are what the procedures call columns: all inner loops run along rows.
    let mut v: Vec<Vec<f64>> = (0..size).map(|row| matrix[row * size..(row + 1) * size].to_vec()).collect();
    let (mut diagonal, mut beside) = (vec![0.0; size], vec![0.0; size]);
    tridiagonalise(&mut v, &mut diagonal, &mut beside);
    iterate(&mut v, &mut diagonal, &mut beside);
    let mut order: Vec<usize> = (0..size).collect();
    order.sort_by(|&a, &b| diagonal[b].total_cmp(&diagonal[a]));
    let values = order.iter().map(|&k| diagonal[k]).collect();
    let vectors = order.iter().map(|&k| std::mem::take(&mut v[k])).collect();
    Eigen { values, vectors }
}

/// Householder's reduction; on return `v[k]` is column k of the transformation.
fn tridiagonalise(v: &mut [Vec<f64>], d: &mut [f64], e: &mut [f64]) {
    let n = d.len();
    for j in 0..n {
        d[j] = v[j][n - 1];
    }
    for i in (1..n).rev() {
        let scale: f64 = d[..i].iter().map(|x| x.abs()).sum();
        let mut h = 0.0;
        if scale == 0.0 {
            e[i] = d[i - 1];
            for j in 0..i {
                d[j] = v[j][i - 1];
                v[j][i] = 0.0;
                v[i][j] = 0.0;
            }
        } else {
            for x in &mut d[..i] {
                *x /= scale;
                h += *x * *x;
            }
            let f = d[i - 1];
            let g = if f > 0.0 { -h.sqrt() } else { h.sqrt() };
            e[i] = scale * g;
            h -= f * g;
            d[i - 1] = f - g;
            e[..i].fill(0.0);
            for j in 0..i {
                let f = d[j];
                v[i][j] = f;
                let mut g = e[j] + v[j][j] * f;
                for k in j + 1..i {
                    g += v[j][k] * d[k];
                    e[k] += v[j][k] * f;
                }
                e[j] = g;
            }
            let mut f = 0.0;
            for j in 0..i {
                e[j] /= h;
                f += e[j] * d[j];
            }
            let hh = f / (h + h);
            for j in 0..i {
                e[j] -= hh * d[j];
            }
            for j in 0..i {
                let (f, g) = (d[j], e[j]);
                for k in j..i {
                    v[j][k] -= f * e[k] + g * d[k];
                }
                d[j] = v[j][i - 1];
                v[j][i] = 0.0;
            }
        }
        d[i] = h;
    }
    for i in 0..n - 1 {
        v[i][n - 1] = v[i][i];
        v[i][i] = 1.0;
        let h = d[i + 1];
        if h != 0.0 {
            for k in 0..=i {
                d[k] = v[i + 1][k] / h;
            }
            for j in 0..=i {
                let g: f64 = (0..=i).map(|k| v[i + 1][k] * v[j][k]).sum();
                for k in 0..=i {
                    v[j][k] -= g * d[k];
                }
            }
        }
        v[i + 1][..=i].fill(0.0);
    }
    for j in 0..n {
        d[j] = v[j][n - 1];
        v[j][n - 1] = 0.0;
    }
    v[n - 1][n - 1] = 1.0;
    e[0] = 0.0;
}

/// QL with implicit shifts on the three diagonals.
fn iterate(v: &mut [Vec<f64>], d: &mut [f64], e: &mut [f64]) {
    let n = d.len();
    e.rotate_left(1);
    e[n - 1] = 0.0;
    let (mut f, mut largest) = (0.0, 0.0_f64);
    for l in 0..n {
        largest = largest.max(d[l].abs() + e[l].abs());
        let m = (l..n).find(|&m| e[m].abs() <= f64::EPSILON * largest).unwrap_or(n - 1);
        // QL converges in two or three rounds; the bound only keeps what is not finite from turning for ever.
        for _ in 0..if m > l { 100 } else { 0 } {
            let mut g = d[l];
            let mut p = (d[l + 1] - g) / (2.0 * e[l]);
            let r = if p < 0.0 { -p.hypot(1.0) } else { p.hypot(1.0) };
            d[l] = e[l] / (p + r);
            d[l + 1] = e[l] * (p + r);
            let next = d[l + 1];
            let h = g - d[l];
            for x in &mut d[l + 2..] {
                *x -= h;
            }
            f += h;
            p = d[m];
            let (mut c, mut c2, mut c3) = (1.0, 1.0, 1.0);
            let second = e[l + 1];
            let (mut s, mut s2) = (0.0, 0.0);
            for i in (l..m).rev() {
                c3 = c2;
                c2 = c;
                s2 = s;
                g = c * e[i];
                let h = c * p;
                let r = p.hypot(e[i]);
                e[i + 1] = s * r;
                s = e[i] / r;
                c = p / r;
                p = c * d[i] - s * g;
                d[i + 1] = h + s * (c * g + s * d[i]);
                let (left, right) = v.split_at_mut(i + 1);
                for (a, b) in left[i].iter_mut().zip(&mut right[0]) {
                    (*a, *b) = (c * *a - s * *b, s * *a + c * *b);
                }
            }
            p = -s * s2 * c3 * second * e[l] / next;
            e[l] = s * p;
            d[l] = c * p;
            // Written so that NaN ends it.
            if e[l].is_nan() || e[l].abs() <= f64::EPSILON * largest {
                break;
            }
        }
        d[l] += f;
        e[l] = 0.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_matrix_comes_back() {
        for size in [1, 2, 3, 17, 60] {
            let noise = |k: usize| {
                let hash = (k as u32 + 1).wrapping_mul(0x9E37_79B9).rotate_left(15).wrapping_mul(0x85EB_CA6B);
                f64::from(hash) / f64::from(u32::MAX) - 0.5
            };
            let mut matrix = vec![0.0; size * size];
            for i in 0..size {
                for j in 0..=i {
                    (matrix[i * size + j], matrix[j * size + i]) = (noise(i * size + j), noise(i * size + j));
                }
            }
            let Eigen { values, vectors } = eigen(&matrix, size);
            assert!(values.windows(2).all(|pair| pair[0] >= pair[1]));
            for i in 0..size {
                for j in 0..size {
                    let entry: f64 = (0..size).map(|k| values[k] * vectors[k][i] * vectors[k][j]).sum();
                    assert!((entry - matrix[i * size + j]).abs() < 1e-12, "{size}: {i} {j}");
                    let product: f64 = (0..size).map(|k| vectors[i][k] * vectors[j][k]).sum();
                    assert!((product - f64::from(u8::from(i == j))).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn a_matrix_of_low_rank_is_no_trouble() {
        let size = 20;
        let matrix: Vec<f64> = (0..size * size).map(|k| ((k / size) * (k % size)) as f64).collect();
        let values = eigen(&matrix, size).values;
        assert!((values[0] - 2470.0).abs() < 1e-9 && values[1..].iter().all(|v| v.abs() < 1e-9));
        assert!(eigen(&vec![0.0; size * size], size).values.iter().all(|v| *v == 0.0));
    }
}
