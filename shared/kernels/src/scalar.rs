//! Functions of single numbers that give the same bits on every machine: polynomials in place of the platform's library.
//!
//! Without a fused multiply-add, so that machines without one and wasm agree; [`fused`] holds those for kernels that are
//! compiled for one anyway. All are short enough for loops over lanes to become vector instructions
//! ([`crate::lanes`]).
//!
//! The polynomials of [`exp`], [`ln`], [`quarter_atan2`] and `quarter_sin_cos` are those of Moshier's Cephes library
//! (single precision, about one unit in the last place).

use std::f64::consts::{FRAC_PI_2, PI};

use crate::number::Number;

/// A polynomial at `x`, its coefficients from the highest power down to that of 1.
#[inline(always)]
fn polynomial<N: Number, const C: usize>(coefficients: [f32; C], x: N) -> N {
    let mut sum = N::splat(coefficients[0]);
    for &coefficient in &coefficients[1..] {
        sum = sum * x + N::splat(coefficient);
    }
    sum
}

/// Exponential, for arguments between -87 and 87.
#[inline(always)]
#[must_use]
pub fn exp<N: Number>(x: N) -> N {
    // Adding and taking away 1.5 * 2^23 rounds to a whole number.
    let round = N::splat(12_582_912.0);
    let rounded = x * N::splat(std::f32::consts::LOG2_E) + round;
    let whole = rounded - round;
    let r = x - whole * N::splat(0.693_359_4) - whole * N::splat(-2.121_944_4e-4);
    let p = polynomial([1.987_569_2e-4, 1.398_2e-3, 8.333_452e-3, 4.166_579_6e-2, 1.666_666_5e-1, 0.5], r);
    (p * r * r + r + N::splat(1.0)) * rounded.power_of_two()
}

/// Natural logarithm of positive, normal numbers.
#[inline(always)]
#[must_use]
pub fn ln<N: Number>(x: N) -> N {
    let (mantissa, exponent) = x.split();
    let m = mantissa - N::splat(1.0);
    let z = m * m;
    let p = polynomial(
        [
            7.037_683_6e-2,
            -1.151_461e-1,
            1.167_699_9e-1,
            -1.242_014_1e-1,
            1.424_932_3e-1,
            -1.666_805_7e-1,
            2.000_071_5e-1,
            -2.499_999_4e-1,
            3.333_333e-1,
        ],
        m,
    );
    m + (p * m * z - exponent * N::splat(2.121_944_4e-4) - N::splat(0.5) * z) + exponent * N::splat(0.693_359_4)
}

/// Angle in [0, pi/2] whose tangent is `y / x`, both not negative and not both zero.
#[inline(always)]
#[must_use]
pub fn quarter_atan2<N: Number>(y: N, x: N) -> N {
    let (small, large) = (y.greater(x, x, y), y.greater(x, y, x));
    // Beyond tan(pi/8) the arc tangent is taken from pi/4.
    let tangent = large * N::splat(0.414_213_57);
    let far = |yes: N, no: N| small.greater(tangent, yes, no);
    let t = far(small - large, small) / far(small + large, large);
    let z = t * t;
    let p = polynomial([8.053_744_6e-2, -1.387_768_6e-1, 1.997_771_1e-1, -3.333_295e-1], z);
    let angle = p * z * t + t + far(N::splat(std::f32::consts::FRAC_PI_4), N::splat(0.0));
    y.greater(x, N::splat(std::f32::consts::FRAC_PI_2) - angle, angle)
}

/// Sine of an angle in [0, pi/2].
#[inline(always)]
#[must_use]
pub fn quarter_sin<N: Number>(x: N) -> N {
    let z = x * x;
    polynomial([-2.505_210_8e-8, 2.755_732e-6, -1.984_127e-4, 8.333_334e-3, -1.666_666_7e-1], z) * z * x + x
}

/// Cosine of an angle in [0, pi/2].
#[inline(always)]
#[must_use]
pub fn quarter_cos<N: Number>(x: N) -> N {
    let z = x * x;
    let p = polynomial([2.087_675_7e-9, -2.755_732e-7, 2.480_158_8e-5, -1.388_889e-3, 4.166_666_8e-2], z);
    p * z * z - N::splat(0.5) * z + N::splat(1.0)
}

/// Sine and cosine of any angle in radians.
#[must_use]
pub fn sin_cos(angle: f32) -> (f32, f32) {
    let quarters = (f64::from(angle) / FRAC_PI_2).round();
    let x = f64::from(angle) - quarters * FRAC_PI_2;
    let square = x * x;
    let series = |first: f64, terms: [f64; 4]| terms.iter().rev().fold(0.0, |sum, term| (sum + term) * square) + first;
    let sin = x * series(1.0, [-1.0 / 6.0, 1.0 / 120.0, -1.0 / 5040.0, 1.0 / 362_880.0]);
    let cos = series(1.0, [-0.5, 1.0 / 24.0, -1.0 / 720.0, 1.0 / 40_320.0]);
    let (cos, sin) = match (quarters as i64).rem_euclid(4) {
        0 => (cos, sin),
        1 => (-sin, cos),
        2 => (-cos, -sin),
        _ => (sin, -cos),
    };
    (sin as f32, cos as f32)
}

/// The angle whose tangent is y / x, between -pi and pi; 0 where both are zero.
///
/// This work is based on: Abramowitz and Stegun, Handbook of Mathematical Functions, 4.4.49 (error below 2e-8).
#[must_use]
pub fn atan2(y: f32, x: f32) -> f32 {
    const TERMS: [f64; 8] = [
        -0.333_331_452_8,
        0.199_935_508_5,
        -0.142_088_994_4,
        0.106_562_639_3,
        -0.075_289_640_0,
        0.042_909_613_8,
        -0.016_165_736_7,
        0.002_866_225_7,
    ];
    let (y, x) = (f64::from(y), f64::from(x));
    let (least, most) = (x.abs().min(y.abs()), x.abs().max(y.abs()));
    let tangent = if most > 0.0 { least / most } else { 0.0 };
    let square = tangent * tangent;
    let first = tangent * (TERMS.iter().rev().fold(0.0, |sum, term| (sum + term) * square) + 1.0);
    let first = if y.abs() > x.abs() { FRAC_PI_2 - first } else { first };
    let half = if x < 0.0 { PI - first } else { first };
    (if y < 0.0 { -half } else { half }) as f32
}

/// The same angle between -pi and pi.
#[must_use]
pub fn half_turn(angle: f32) -> f32 {
    let turns = (angle / std::f32::consts::TAU).round();
    angle - turns * std::f32::consts::TAU
}

/// Functions that multiply and add in one rounding, for kernels that are compiled for processors that can.
///
/// Where a processor cannot, each step is a call of the platform's library: right, but slow. The same bits either way.
pub mod fused {
    /// Angle in [0, pi/2] whose tangent is `y / x`, both not negative and not both zero; relative error below 4e-7.
    #[inline(always)]
    #[must_use]
    pub fn quarter_atan2(y: f32, x: f32) -> f32 {
        let steep = y > x;
        let (low, high) = if steep { (x, y) } else { (y, x) };
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
    #[must_use]
    pub fn ln(x: f32) -> f32 {
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
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest error of `f` against `truth`, relative to the larger of 1 and the value, over `from` to `to`.
    fn worst(from: f64, to: f64, f: impl Fn(f32) -> f32, truth: impl Fn(f64) -> f64) -> f64 {
        let steps = 20_000;
        let mut worst = 0.0_f64;
        for step in 0..=steps {
            let x = (from + (to - from) * f64::from(step) / f64::from(steps)) as f32;
            let expected = truth(f64::from(x));
            worst = worst.max((f64::from(f(x)) - expected).abs() / expected.abs().max(1.0));
        }
        worst
    }

    #[test]
    fn functions_are_exact_to_single_precision() {
        assert!(worst(-20.0, 20.0, exp, f64::exp) < 2e-7);
        assert!(worst(1e-3, 50.0, ln, f64::ln) < 2e-7);
        assert!(worst(1e-9, 1e-3, ln, f64::ln) < 2e-7);
        assert!(worst(0.0, FRAC_PI_2, quarter_sin, f64::sin) < 2e-7);
        assert!(worst(0.0, FRAC_PI_2, quarter_cos, f64::cos) < 2e-7);
        assert!(worst(0.0, 40.0, |x| quarter_atan2(x, 1.0), f64::atan) < 3e-7);
        assert!(worst(0.0, 4.0, |x| quarter_atan2(1.0, x), |x| 1.0_f64.atan2(x)) < 3e-7);
    }

    #[test]
    fn fused_functions_are_accurate() {
        for step in 0..10_000 {
            let angle = f64::from(step) * FRAC_PI_2 / 9_999.0;
            let (sin, cos) = (3.0 * angle.sin() as f32, 3.0 * angle.cos().abs() as f32);
            let want = f64::from(sin).atan2(f64::from(cos));
            assert!((f64::from(fused::quarter_atan2(sin, cos)) - want).abs() <= 4e-7 * want, "{angle}");
            let x = (f64::from(step - 5_000) * 0.005).exp() as f32;
            let want = f64::from(x).ln();
            assert!((f64::from(fused::ln(x)) - want).abs() <= 1.5e-7 * (1.0 + want.abs()), "ln {x}");
        }
        assert_eq!(fused::quarter_atan2(0.0, 1.0), 0.0);
        assert_eq!(fused::ln(1.0), 0.0);
        assert_eq!(fused::ln(2.0), std::f32::consts::LN_2);
    }

    #[test]
    fn angles_are_the_platforms() {
        for step in -2000..2000 {
            let heading = step as f32 * 0.01;
            let (sin, cos) = sin_cos(heading);
            assert!((sin - heading.sin()).abs() < 3e-7 && (cos - heading.cos()).abs() < 3e-7, "{heading}");
            assert!(
                (atan2(sin, cos) - half_turn(heading)).abs() < 2e-6
                    || half_turn(heading).abs() > std::f32::consts::PI - 1e-3
            );
            let (y, x) = (heading, 3.0 - heading * heading);
            assert!((atan2(y, x) - y.atan2(x)).abs() < 3e-7, "{y} {x}");
        }
        assert_eq!(atan2(0.0, 0.0), 0.0);
    }

    /// A checksum of the bits of numbers (FNV-1a).
    fn checksum(numbers: impl Iterator<Item = f32>) -> u64 {
        numbers.fold(0xcbf2_9ce4_8422_2325, |sum, x| {
            x.to_bits()
                .to_le_bytes()
                .iter()
                .fold(sum, |sum, &byte| (sum ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
        })
    }

    /// Bundles, plans and walks hang on these bits: whoever changes one of them changes those.
    #[test]
    fn the_bits_are_the_same_everywhere() {
        let numbers = |least: f32, step: f32| (0..4_096_u16).map(move |k| least + step * f32::from(k));
        let quarters = || numbers(0.0, 0.000_383);
        assert_eq!(checksum(numbers(-20.0, 0.01).map(exp)), 0xa2f3_e9ae_190a_8c8e);
        assert_eq!(checksum(numbers(0.001, 0.007).map(ln)), 0xa6fe_f7ba_37d3_e210);
        assert_eq!(checksum(quarters().map(|x| quarter_atan2(x, 1.5 - x.min(1.5)))), 0x5bb3_476a_d8ac_0fec);
        assert_eq!(checksum(quarters().flat_map(|x| [quarter_sin(x), quarter_cos(x)])), 0x603e_e9d2_aee9_cd46);
        assert_eq!(checksum(numbers(-20.0, 0.01).flat_map(|x| <[f32; 2]>::from(sin_cos(x)))), 0x1775_7ef0_2b3e_893c);
        assert_eq!(checksum(numbers(-20.0, 0.01).map(|x| atan2(x, 3.0 - x * x))), 0xf3c7_2a08_88a8_d2b0);
        assert_eq!(checksum(numbers(-20.0, 0.01).map(half_turn)), 0x4d0a_0d97_0129_59b4);
        assert_eq!(checksum(quarters().map(|x| fused::quarter_atan2(x, 1.5 - x.min(1.5)))), 0x0f28_c5d6_06e7_a639);
        assert_eq!(checksum(numbers(0.001, 0.007).map(fused::ln)), 0x7ee8_fd8d_f113_e87b);
    }
}
