//! Eight numbers at a time: plain arrays that compilers turn into vector instructions, natively and in wasm alike.
//!
//! No fused multiply-add and no library call, so that every target computes the same bits. The polynomials of
//! `exp`, `ln` and `atan` are those of Moshier's Cephes library (single precision, about one unit in the last place).

use std::ops::{Add, Div, Mul, Neg, Sub};

/// Number of lanes.
pub const LANES: usize = 8;

/// Eight numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(32))]
pub struct Lanes(pub [f32; LANES]);

impl Lanes {
    #[inline(always)]
    pub fn splat(value: f32) -> Self {
        Self([value; LANES])
    }

    #[inline(always)]
    pub fn map(self, f: impl Fn(f32) -> f32) -> Self {
        let mut out = [0.0; LANES];
        for lane in 0..LANES {
            out[lane] = f(self.0[lane]);
        }
        Self(out)
    }

    #[inline(always)]
    pub fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        let mut out = [0.0; LANES];
        for lane in 0..LANES {
            out[lane] = f(self.0[lane], other.0[lane]);
        }
        Self(out)
    }

    /// `yes` where `self` is at least `other`, `no` elsewhere.
    #[inline(always)]
    pub fn at_least(self, other: Self, yes: Self, no: Self) -> Self {
        let mut out = [0.0; LANES];
        for lane in 0..LANES {
            out[lane] = if self.0[lane] >= other.0[lane] { yes.0[lane] } else { no.0[lane] };
        }
        Self(out)
    }

    /// The larger of two numbers; `other` where `self` is not a number.
    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    pub fn sqrt(self) -> Self {
        self.map(f32::sqrt)
    }

    #[inline(always)]
    pub fn recip(self) -> Self {
        self.map(|x| 1.0 / x)
    }

    #[inline(always)]
    pub fn abs(self) -> Self {
        self.map(f32::abs)
    }

    /// Exponential, for arguments between -87 and 87.
    #[inline(always)]
    pub fn exp(self) -> Self {
        // Adding and taking away 1.5 * 2^23 rounds to a whole number.
        const ROUND: f32 = 12_582_912.0;
        self.map(|x| {
            let whole = (x * std::f32::consts::LOG2_E + ROUND) - ROUND;
            let r = x - whole * 0.693_359_4 - whole * -2.121_944_4e-4;
            let mut p = 1.987_569_2e-4;
            p = p * r + 1.398_2e-3;
            p = p * r + 8.333_452e-3;
            p = p * r + 4.166_579_6e-2;
            p = p * r + 1.666_666_5e-1;
            p = p * r + 0.5;
            (p * r * r + r + 1.0) * f32::from_bits(((whole as i32 + 127) as u32) << 23)
        })
    }

    /// Natural logarithm of positive, normal numbers.
    #[inline(always)]
    pub fn ln(self) -> Self {
        self.map(|x| {
            // Mantissa in [sqrt(1/2), sqrt(2)).
            let bits = x.to_bits().wrapping_sub(0x3f35_04f3);
            let exponent = ((bits as i32) >> 23) as f32;
            let m = f32::from_bits((bits & 0x007f_ffff).wrapping_add(0x3f35_04f3)) - 1.0;
            let z = m * m;
            let mut p = 7.037_683_6e-2;
            p = p * m - 1.151_461e-1;
            p = p * m + 1.167_699_9e-1;
            p = p * m - 1.242_014_1e-1;
            p = p * m + 1.424_932_3e-1;
            p = p * m - 1.666_805_7e-1;
            p = p * m + 2.000_071_5e-1;
            p = p * m - 2.499_999_4e-1;
            p = p * m + 3.333_333e-1;
            m + (p * m * z - exponent * 2.121_944_4e-4 - 0.5 * z) + exponent * 0.693_359_4
        })
    }

    /// Angle in [0, pi/2] whose tangent is `self / x`, both not negative and not both zero.
    #[inline(always)]
    pub fn quarter_atan2(self, x: Self) -> Self {
        self.zip(x, |y, x| {
            let (small, large) = if y > x { (x, y) } else { (y, x) };
            // Beyond tan(pi/8) the arc tangent is taken from pi/4.
            let far = small > 0.414_213_57 * large;
            let (top, bottom) = if far { (small - large, small + large) } else { (small, large) };
            let t = top / bottom;
            let z = t * t;
            let mut p = 8.053_744_6e-2;
            p = p * z - 1.387_768_6e-1;
            p = p * z + 1.997_771_1e-1;
            p = p * z - 3.333_295e-1;
            let angle = p * z * t + t + if far { std::f32::consts::FRAC_PI_4 } else { 0.0 };
            if y > x { std::f32::consts::FRAC_PI_2 - angle } else { angle }
        })
    }

    /// Sine and cosine of angles in [0, pi/2].
    #[inline(always)]
    pub fn quarter_sin_cos(self) -> (Self, Self) {
        let sin = self.map(|x| {
            let z = x * x;
            let mut p = -2.505_210_8e-8;
            p = p * z + 2.755_732e-6;
            p = p * z - 1.984_127e-4;
            p = p * z + 8.333_334e-3;
            p = p * z - 1.666_666_7e-1;
            p * z * x + x
        });
        let cos = self.map(|x| {
            let z = x * x;
            let mut p = 2.087_675_7e-9;
            p = p * z - 2.755_732e-7;
            p = p * z + 2.480_158_8e-5;
            p = p * z - 1.388_889e-3;
            p = p * z + 4.166_666_8e-2;
            p * z * z - 0.5 * z + 1.0
        });
        (sin, cos)
    }
}

macro_rules! lanewise {
    ($operator:ident, $method:ident, $symbol:tt) => {
        impl $operator for Lanes {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.zip(other, |a, b| a $symbol b)
            }
        }
    };
}
lanewise!(Add, add, +);
lanewise!(Sub, sub, -);
lanewise!(Mul, mul, *);
lanewise!(Div, div, /);

impl Neg for Lanes {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|x| -x)
    }
}

/// Eight vectors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lanes3 {
    pub x: Lanes,
    pub y: Lanes,
    pub z: Lanes,
}

impl Lanes3 {
    #[inline(always)]
    pub fn dot(self, other: Self) -> Lanes {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        Self {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }

    #[inline(always)]
    pub fn scale(self, by: Lanes) -> Self {
        Self { x: self.x * by, y: self.y * by, z: self.z * by }
    }
}

impl Add for Lanes3 {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }
}

impl Sub for Lanes3 {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }
}

impl Neg for Lanes3 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { x: -self.x, y: -self.y, z: -self.z }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest error of `f` against `truth`, relative to the larger of 1 and the value, over `from` to `to`.
    fn worst(from: f64, to: f64, f: impl Fn(Lanes) -> Lanes, truth: impl Fn(f64) -> f64) -> f64 {
        let steps = 20_000;
        let mut worst = 0.0_f64;
        for step in 0..=steps {
            let x = (from + (to - from) * f64::from(step) / f64::from(steps)) as f32;
            let expected = truth(f64::from(x));
            let found = f64::from(f(Lanes::splat(x)).0[3]);
            worst = worst.max((found - expected).abs() / expected.abs().max(1.0));
        }
        worst
    }

    #[test]
    fn functions_are_exact_to_single_precision() {
        let half_pi = std::f64::consts::FRAC_PI_2;
        assert!(worst(-20.0, 20.0, Lanes::exp, f64::exp) < 2e-7);
        assert!(worst(1e-3, 50.0, Lanes::ln, f64::ln) < 2e-7);
        assert!(worst(1e-9, 1e-3, Lanes::ln, f64::ln) < 2e-7);
        assert!(worst(0.0, half_pi, |x| x.quarter_sin_cos().0, f64::sin) < 2e-7);
        assert!(worst(0.0, half_pi, |x| x.quarter_sin_cos().1, f64::cos) < 2e-7);
        assert!(worst(0.0, 40.0, |x| x.quarter_atan2(Lanes::splat(1.0)), f64::atan) < 3e-7);
        assert!(worst(0.0, 4.0, |x| Lanes::splat(1.0).quarter_atan2(x), |x| 1.0_f64.atan2(x)) < 3e-7);
    }
}
