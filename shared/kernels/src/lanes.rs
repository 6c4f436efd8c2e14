//! Eight numbers at a time: plain arrays that compilers turn into vector instructions, natively and in wasm alike.
//!
//! No fused multiply-add and no library call ([`crate::scalar`] has the functions), so that every target computes the same
//! bits.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::scalar;

/// Number of lanes.
pub const LANES: usize = 8;

/// Eight numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(32))]
pub struct Lanes(pub [f32; LANES]);

impl Lanes {
    /// The same number in all lanes.
    #[inline(always)]
    #[must_use]
    pub fn splat(value: f32) -> Self {
        Self([value; LANES])
    }

    /// `f` of each lane.
    #[inline(always)]
    #[must_use]
    pub fn map(self, f: impl Fn(f32) -> f32) -> Self {
        let mut out = [0.0; LANES];
        for lane in 0..LANES {
            out[lane] = f(self.0[lane]);
        }
        Self(out)
    }

    /// `f` of each lane and the other's.
    #[inline(always)]
    #[must_use]
    pub fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        let mut out = [0.0; LANES];
        for lane in 0..LANES {
            out[lane] = f(self.0[lane], other.0[lane]);
        }
        Self(out)
    }

    /// `yes` where `self` is at least `other`, `no` elsewhere.
    #[inline(always)]
    #[must_use]
    pub fn at_least(self, other: Self, yes: Self, no: Self) -> Self {
        let mut out = [0.0; LANES];
        for lane in 0..LANES {
            out[lane] = if self.0[lane] >= other.0[lane] { yes.0[lane] } else { no.0[lane] };
        }
        Self(out)
    }

    /// The larger of two numbers; `other` where `self` is not a number.
    #[inline(always)]
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }

    /// Square roots.
    #[inline(always)]
    #[must_use]
    pub fn sqrt(self) -> Self {
        self.map(f32::sqrt)
    }

    /// What 1 is divided by each lane.
    #[inline(always)]
    #[must_use]
    pub fn recip(self) -> Self {
        self.map(|x| 1.0 / x)
    }

    /// Absolute values.
    #[inline(always)]
    #[must_use]
    pub fn abs(self) -> Self {
        self.map(f32::abs)
    }

    /// Exponentials, see [`scalar::exp`].
    #[inline(always)]
    #[must_use]
    pub fn exp(self) -> Self {
        self.map(scalar::exp)
    }

    /// Natural logarithms, see [`scalar::ln`].
    #[inline(always)]
    #[must_use]
    pub fn ln(self) -> Self {
        self.map(scalar::ln)
    }

    /// Angles whose tangents are `self / x`, see [`scalar::quarter_atan2`].
    #[inline(always)]
    #[must_use]
    pub fn quarter_atan2(self, x: Self) -> Self {
        self.zip(x, scalar::quarter_atan2)
    }

    /// Sines and cosines of angles in [0, pi/2].
    #[inline(always)]
    #[must_use]
    pub fn quarter_sin_cos(self) -> (Self, Self) {
        (self.map(scalar::quarter_sin), self.map(scalar::quarter_cos))
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
    /// Their first coordinates.
    pub x: Lanes,
    /// Their second ones.
    pub y: Lanes,
    /// Their third ones.
    pub z: Lanes,
}

impl Lanes3 {
    /// Dot products.
    #[inline(always)]
    #[must_use]
    pub fn dot(self, other: Self) -> Lanes {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// Cross products.
    #[inline(always)]
    #[must_use]
    pub fn cross(self, other: Self) -> Self {
        Self {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }

    /// Each vector times a number of its own.
    #[inline(always)]
    #[must_use]
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

/// Lanes of [`lane_sum`]: one AVX-512 register, two of AVX2, four of SSE2.
const SUMMED: usize = 16;

/// The sum of `values` in a fixed order: every sixteenth in `f32`, then the sixteen in `f64`.
#[inline(always)]
#[must_use]
pub fn lane_sum<const N: usize>(values: &[f32; N]) -> f64 {
    const { assert!(N.is_multiple_of(SUMMED)) };
    let mut lanes = [0.0_f32; SUMMED];
    for start in (0..N).step_by(SUMMED) {
        for lane in 0..SUMMED {
            lanes[lane] += values[start + lane];
        }
    }
    let mut total = 0.0;
    for lane in lanes {
        total += f64::from(lane);
    }
    total
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lanes_compute_what_single_numbers_do() {
        let numbers = Lanes([0.1, 0.2, 0.4, 0.6, 0.8, 1.0, 1.2, 1.5]);
        let other = Lanes([1.5, 0.0, 0.4, 3.0, 0.1, 0.7, 1.3, 0.2]);
        let (sin, cos) = numbers.quarter_sin_cos();
        for lane in 0..LANES {
            let (x, y) = (numbers.0[lane], other.0[lane]);
            assert_eq!(numbers.exp().0[lane], scalar::exp(x));
            assert_eq!(numbers.ln().0[lane], scalar::ln(x));
            assert_eq!(numbers.quarter_atan2(other).0[lane], scalar::quarter_atan2(x, y));
            assert_eq!((sin.0[lane], cos.0[lane]), (scalar::quarter_sin(x), scalar::quarter_cos(x)));
            assert_eq!((numbers * other - numbers).0[lane], x * y - x);
            assert_eq!(numbers.max(other).0[lane], x.max(y));
            assert_eq!(numbers.at_least(other, numbers, other).0[lane], x.max(y));
        }
        assert_eq!(Lanes::splat(f32::NAN).max(other), other);
    }

    #[test]
    fn sums_run_by_lanes() {
        // Large numbers swallow small ones within a lane, not across lanes.
        let mut values = [0.0; 48];
        (values[0], values[16], values[17], values[33]) = (1e8, 1.0, 1.0, 2.0);
        assert_eq!(lane_sum(&values), 100_000_003.0);
    }
}
