//! Eight numbers at a time, in two registers of four: the same instructions natively and in wasm.
//!
//! No fused multiply-add and no library call ([`crate::scalar`] has the functions), so that every target computes the same
//! bits.

use std::ops::{Add, Div, Mul, Neg, Sub};

use glam::{Mat4, Vec3, Vec4};

use crate::number::{self, Number};
use crate::scalar;

/// Number of lanes.
pub const LANES: usize = 8;
/// Lanes of a register.
const FOUR: usize = 4;

/// Eight numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lanes([Vec4; 2]);

impl Lanes {
    /// The same number in all lanes.
    #[inline(always)]
    #[must_use]
    pub fn splat(value: f32) -> Self {
        Self([Vec4::splat(value); 2])
    }

    /// These numbers, lane by lane.
    #[inline(always)]
    #[must_use]
    pub fn new(numbers: [f32; LANES]) -> Self {
        let [a, b, c, d, e, f, g, h] = numbers;
        Self([Vec4::new(a, b, c, d), Vec4::new(e, f, g, h)])
    }

    /// The numbers, lane by lane.
    #[inline(always)]
    #[must_use]
    pub fn numbers(self) -> [f32; LANES] {
        let [[a, b, c, d], [e, f, g, h]] = [self.0[0].to_array(), self.0[1].to_array()];
        [a, b, c, d, e, f, g, h]
    }

    /// The number in one lane.
    #[must_use]
    pub fn lane(self, lane: usize) -> f32 {
        self.0[lane / FOUR][lane % FOUR]
    }

    /// `f` of each register.
    #[inline(always)]
    fn fours(self, f: impl Fn(Vec4) -> Vec4) -> Self {
        Self([f(self.0[0]), f(self.0[1])])
    }

    /// `f` of each register and the other's.
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(Vec4, Vec4) -> Vec4) -> Self {
        Self([f(self.0[0], other.0[0]), f(self.0[1], other.0[1])])
    }

    /// `yes` where `self` is at least `other`, `no` elsewhere.
    #[inline(always)]
    #[must_use]
    pub fn at_least(self, other: Self, yes: Self, no: Self) -> Self {
        let half = |k: usize| Vec4::select(self.0[k].cmpge(other.0[k]), yes.0[k], no.0[k]);
        Self([half(0), half(1)])
    }

    /// `yes` where `self` is greater than `other`, `no` elsewhere.
    #[inline(always)]
    #[must_use]
    pub fn greater(self, other: Self, yes: Self, no: Self) -> Self {
        let half = |k: usize| self.0[k].greater(other.0[k], yes.0[k], no.0[k]);
        Self([half(0), half(1)])
    }

    /// The larger of two numbers; `other` where `self` is not a number.
    #[inline(always)]
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        self.greater(other, self, other)
    }

    /// Square roots.
    #[inline(always)]
    #[must_use]
    pub fn sqrt(self) -> Self {
        self.fours(number::sqrt)
    }

    /// What 1 is divided by each lane.
    #[inline(always)]
    #[must_use]
    pub fn recip(self) -> Self {
        Self::splat(1.0) / self
    }

    /// Absolute values.
    #[inline(always)]
    #[must_use]
    pub fn abs(self) -> Self {
        self.fours(Vec4::abs)
    }

    /// Exponentials, see [`scalar::exp`].
    #[inline(always)]
    #[must_use]
    pub fn exp(self) -> Self {
        self.fours(scalar::exp)
    }

    /// Natural logarithms, see [`scalar::ln`].
    #[inline(always)]
    #[must_use]
    pub fn ln(self) -> Self {
        self.fours(scalar::ln)
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
        (self.fours(scalar::quarter_sin), self.fours(scalar::quarter_cos))
    }
}

macro_rules! lanewise {
    ($operator:ident, $method:ident, $symbol:tt) => {
        impl $operator for Lanes {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self([self.0[0] $symbol other.0[0], self.0[1] $symbol other.0[1]])
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
        Self([-self.0[0], -self.0[1]])
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
    /// Eight vectors, of each of which the fourth number does not count.
    #[inline(always)]
    #[must_use]
    pub fn of(vectors: &[Vec4; LANES]) -> Self {
        let [a, b, c, d, e, f, g, h] = *vectors;
        let low = Mat4::from_cols(a, b, c, d).transpose();
        let high = Mat4::from_cols(e, f, g, h).transpose();
        Self {
            x: Lanes([low.x_axis, high.x_axis]),
            y: Lanes([low.y_axis, high.y_axis]),
            z: Lanes([low.z_axis, high.z_axis]),
        }
    }

    /// The vectors, each with a fourth number of 0.
    #[inline(always)]
    #[must_use]
    pub fn vectors(self) -> [Vec4; LANES] {
        let four = |k: usize| Mat4::from_cols(self.x.0[k], self.y.0[k], self.z.0[k], Vec4::ZERO).transpose();
        let (low, high) = (four(0), four(1));
        [low.x_axis, low.y_axis, low.z_axis, low.w_axis, high.x_axis, high.y_axis, high.z_axis, high.w_axis]
    }

    /// The vector in one lane.
    #[must_use]
    pub fn lane(self, lane: usize) -> Vec3 {
        Vec3::new(self.x.lane(lane), self.y.lane(lane), self.z.lane(lane))
    }

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
        let numbers = Lanes::new([0.1, 0.2, 0.4, 0.6, 0.8, 1.0, 1.2, 1.5]);
        let other = Lanes::new([1.5, 0.0, 0.4, 3.0, 0.1, 0.7, 1.3, 0.2]);
        let (sin, cos) = numbers.quarter_sin_cos();
        for lane in 0..LANES {
            let (x, y) = (numbers.lane(lane), other.lane(lane));
            let same = |lanes: Lanes, single: f32| assert_eq!(lanes.lane(lane).to_bits(), single.to_bits());
            same(numbers.exp(), scalar::exp(x));
            same((-numbers * Lanes::splat(40.0)).exp(), scalar::exp(-x * 40.0));
            same(numbers.ln(), scalar::ln(x));
            same((numbers * Lanes::splat(1e-20)).ln(), scalar::ln(x * 1e-20));
            same(numbers.quarter_atan2(other), scalar::quarter_atan2(x, y));
            same(sin, scalar::quarter_sin(x));
            same(cos, scalar::quarter_cos(x));
            same(numbers.sqrt(), x.sqrt());
            same(numbers.recip(), 1.0 / x);
            same((other - numbers).abs(), (y - x).abs());
            same(numbers * other - numbers, x * y - x);
            same(other / numbers, y / x);
            same(numbers.max(other), x.max(y));
            same(numbers.at_least(other, numbers, other), x.max(y));
        }
        assert_eq!(Lanes::splat(f32::NAN).max(other), other);
        let equal = numbers.at_least(numbers, numbers, other);
        assert_eq!((equal, numbers.greater(numbers, numbers, other)), (numbers, other));
        assert_eq!(Lanes::new(other.numbers()), other);
    }

    #[test]
    fn vectors_go_into_lanes_and_come_out() {
        let vectors: [Vec4; LANES] = std::array::from_fn(|k| Vec3::new(k as f32, 0.5, -(k as f32)).extend(0.0));
        let lanes = Lanes3::of(&vectors);
        assert_eq!(lanes.vectors(), vectors);
        assert_eq!(lanes.lane(5), vectors[5].truncate());
    }

    #[test]
    fn sums_run_by_lanes() {
        // Large numbers swallow small ones within a lane, not across lanes.
        let mut values = [0.0; 48];
        (values[0], values[16], values[17], values[33]) = (1e8, 1.0, 1.0, 2.0);
        assert_eq!(lane_sum(&values), 100_000_003.0);
    }
}
