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

use super::lanes::lane_sum;
use super::triangles::{BLOCK, TriangleBlock};

/// A pair's settings: j is first turned about +Y by twice the angle of (`cos`, `sin`).
#[derive(Clone, Copy)]
pub(super) struct Pair {
    pub(super) cos: f32,
    pub(super) sin: f32,
    /// w of the equation: the weight of the stretch.
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
        let half = half_angle(z.mul_add(z, xy2).sqrt(), w.abs());

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

/// `atan2(sin, cos)` for `sin`, `cos` >= 0, not both zero; relative error below 4e-7.
#[inline(always)]
fn half_angle(sin: f32, cos: f32) -> f32 {
    let steep = sin > cos;
    let (low, high) = if steep { (cos, sin) } else { (sin, cos) };
    let t = low / high;
    let u = t * t;
    // Least greatest relative error on [0, 1]: 9e-8.
    let mut p = -0.004_780_457_f32;
    p = p.mul_add(u, 0.024_557_13);
    p = p.mul_add(u, -0.059_904_72);
    p = p.mul_add(u, 0.099_427_595);
    p = p.mul_add(u, -0.140_294_2);
    p = p.mul_add(u, 0.199_713_75);
    p = p.mul_add(u, -0.333_320_94);
    p = p.mul_add(u, 0.999_999_9);
    let angle = t * p;
    if steep { std::f32::consts::FRAC_PI_2 - angle } else { angle }
}

/// Natural logarithm of a positive normal number; absolute error below 1e-7, plus rounding.
#[inline(always)]
fn ln(x: f32) -> f32 {
    /// Bits of the square root of a half: the mantissa is taken in [sqrt(1/2), sqrt(2)).
    const ROOT_HALF: i32 = 0x3f35_04f3;
    let bits = x.to_bits() as i32;
    let exponent = (bits - ROOT_HALF) >> 23;
    let f = f32::from_bits((bits - (exponent << 23)) as u32) - 1.0;
    // Least greatest error of f p(f) on that interval: 3.4e-8.
    let mut p = -0.101_031_52_f32;
    p = p.mul_add(f, 0.164_194_47);
    p = p.mul_add(f, -0.173_329_2);
    p = p.mul_add(f, 0.198_731_21);
    p = p.mul_add(f, -0.249_594_07);
    p = p.mul_add(f, 0.333_361_77);
    p = p.mul_add(f, -0.500_006_7);
    p = p.mul_add(f, 0.999_999_8);
    (exponent as f32).mul_add(std::f32::consts::LN_2, f * p)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_are_accurate() {
        for step in 0..10_000 {
            let angle = f64::from(step) * std::f64::consts::FRAC_PI_2 / 9_999.0;
            let (sin, cos) = (3.0 * angle.sin() as f32, 3.0 * angle.cos().abs() as f32);
            let want = f64::from(sin).atan2(f64::from(cos));
            assert!((f64::from(half_angle(sin, cos)) - want).abs() <= 4e-7 * want, "{angle}");
            let x = (f64::from(step - 5_000) * 0.005).exp() as f32;
            let want = f64::from(x).ln();
            assert!((f64::from(ln(x)) - want).abs() <= 1.5e-7 * (1.0 + want.abs()), "ln {x}");
        }
        assert_eq!(half_angle(0.0, 1.0), 0.0);
        assert_eq!(ln(1.0), 0.0);
        assert_eq!(ln(2.0), std::f32::consts::LN_2);
    }
}
