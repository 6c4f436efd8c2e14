//! The deformation of a block of triangles between two poses.
//!
//! Boukhayma and Boyer, TVCG, equation 2; thesis equation 2.14. For the triangle's edges P_i = [a_i b_i; 0 c_i] and
//! frame q_i in pose i, likewise in j, the in-plane part of the deformation is
//!
//! ```text
//! A = P_j P_i^-1 = [alpha beta; 0 gamma]   alpha = a_j / a_i, gamma = c_j / c_i, beta = (b_j - alpha b_i) / c_i
//! ```
//!
//! It is a stretch of singular values s1 >= s2, then a turn by phi about the normal. With c = alpha + gamma > 0 and
//! s = -beta, phi = atan2(s, c) and s1 + s2 = r = hypot(c, s); the half angle of phi lies along (r + c, s), which is
//! never degenerate. s1 - s2 = hypot(alpha - gamma, beta) and s1 s2 = alpha gamma. So neither a trigonometric function
//! nor a decomposition is needed: the rotation is q_j turn(phi) conj(q_i), and its angle is an arc tangent.

use kernels::lanes::lane_sum;
use kernels::scalar::fused::{ln, quarter_atan2};

use super::triangles::{BLOCK, TriangleBlock};

/// A pair's settings: j is first turned about +Y by twice the angle of (`cos`, `sin`).
#[derive(Clone, Copy)]
pub(super) struct Pair {
    pub(super) cos: f32,
    pub(super) sin: f32,
    /// w of TVCG equation 2: the weight of the stretch.
    pub(super) stretch_weight: f32,
}

/// The sum of `weights[m] (angle(R_m) + w ||log S_m||)` over a block of triangles, or of `angle(R_m) + w ||S_m - I||`
/// (thesis equation 2.13) where not `LOG`.
#[inline(always)]
pub(super) fn deformation<const LOG: bool>(
    i: &TriangleBlock,
    j: &TriangleBlock,
    weights: &[f32; BLOCK],
    pair: Pair,
) -> f64 {
    let mut values = [0.0; BLOCK];
    for m in 0..BLOCK {
        // p = conj(q_i) yaw q_j.
        let (jw, jx, jy, jz) = (j.w[m], j.x[m], j.y[m], j.z[m]);
        let tw = pair.cos.mul_add(jw, -(pair.sin * jy));
        let tx = pair.cos.mul_add(jx, pair.sin * jz);
        let ty = pair.cos.mul_add(jy, pair.sin * jw);
        let tz = pair.cos.mul_add(jz, -(pair.sin * jx));
        let (iw, ix, iy, iz) = (i.w[m], i.x[m], i.y[m], i.z[m]);
        let pw = iw.mul_add(tw, ix.mul_add(tx, iy.mul_add(ty, iz * tz)));
        let px = iw.mul_add(tx, iz.mul_add(ty, -ix.mul_add(tw, iy * tz)));
        let py = iw.mul_add(ty, ix.mul_add(tz, -iy.mul_add(tw, iz * tx)));
        let pz = iw.mul_add(tz, iy.mul_add(tx, -iz.mul_add(tw, ix * ty)));

        // The in-plane deformation A.
        let alpha = j.a[m] * i.inverse_a[m];
        let gamma = j.c[m] * i.inverse_c[m];
        let beta = (-alpha).mul_add(i.b[m], j.b[m]) * i.inverse_c[m];
        let c = alpha + gamma;
        let difference = alpha - gamma;
        let beta2 = beta * beta;
        let r = c.mul_add(c, beta2).sqrt();
        let d = difference.mul_add(difference, beta2).sqrt();

        // The rotation: p times the half turn (hc, hs) about the normal, a quaternion of length hypot(hc, hs).
        let (hc, hs) = (r + c, -beta);
        let w = pw.mul_add(hc, -(pz * hs));
        let z = pw.mul_add(hs, pz * hc);
        let xy2 = px.mul_add(px, py * py) * hc.mul_add(hc, hs * hs);
        let half = quarter_atan2(z.mul_add(z, xy2).sqrt(), w.abs());

        let stretch = if LOG {
            // ||log S||^2 = ln^2 s1 + ln^2 s2.
            let log_product = j.log_det[m] - i.log_det[m];
            let log_ratio = 2.0_f32.mul_add(ln(r + d) - std::f32::consts::LN_2, -log_product);
            (0.5 * log_product.mul_add(log_product, log_ratio * log_ratio)).sqrt()
        } else {
            // With s1, s2 = (r + d) / 2, (r - d) / 2: (s1 - 1)^2 + (s2 - 1)^2 = ((r - 2)^2 + d^2) / 2.
            (0.5 * (r - 2.0).mul_add(r - 2.0, d * d)).sqrt()
        };

        values[m] = weights[m] * pair.stretch_weight.mul_add(stretch, half + half);
    }
    lane_sum(&values)
}
