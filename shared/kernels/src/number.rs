//! A number, or four of them in a register: what functions of numbers are written for once.
//!
//! Compilers make vector instructions of loops over arrays where they optimise for speed. The page is optimised for size as a
//! whole, and gets none by itself: what it computes a frame of is written in fours.

use std::ops::{Add, Div, Mul, Sub};

use glam::Vec4;

/// One `f32`, or four of them that are computed alike: the same bits either way.
pub trait Number: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> {
    /// The same number in all of them.
    #[must_use]
    fn splat(value: f32) -> Self;

    /// `yes` where `self` is greater than `other`, `no` elsewhere.
    #[must_use]
    fn greater(self, other: Self, yes: Self, no: Self) -> Self;

    /// 2 to the power of the whole number n, between -126 and 127, of which this is 1.5 * 2^23 + n.
    #[must_use]
    fn power_of_two(self) -> Self;

    /// Mantissa, in [sqrt(1/2), sqrt(2)), and exponent of a positive, normal number.
    #[must_use]
    fn split(self) -> (Self, Self);
}

/// The bits of the square root of a half.
const ROOT_HALF: u32 = 0x3f35_04f3;
/// Those of an exponent are above these.
const MANTISSA_BITS: u32 = 23;
const MANTISSA: u32 = (1 << MANTISSA_BITS) - 1;
/// What the bits of an exponent are more than it.
const BIAS: u32 = 127;

impl Number for f32 {
    #[inline(always)]
    fn splat(value: f32) -> Self {
        value
    }

    #[inline(always)]
    fn greater(self, other: Self, yes: Self, no: Self) -> Self {
        if self > other { yes } else { no }
    }

    #[inline(always)]
    fn power_of_two(self) -> Self {
        // Above the mantissa's bits only n is left.
        Self::from_bits(self.to_bits().wrapping_add(BIAS) << MANTISSA_BITS)
    }

    #[inline(always)]
    fn split(self) -> (Self, Self) {
        let bits = self.to_bits().wrapping_sub(ROOT_HALF);
        let mantissa = Self::from_bits((bits & MANTISSA).wrapping_add(ROOT_HALF));
        (mantissa, ((bits as i32) >> MANTISSA_BITS) as Self)
    }
}

impl Number for Vec4 {
    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self::splat(value)
    }

    #[inline(always)]
    fn greater(self, other: Self, yes: Self, no: Self) -> Self {
        Self::select(self.cmpgt(other), yes, no)
    }

    #[inline(always)]
    fn power_of_two(self) -> Self {
        four::power_of_two(self)
    }

    #[inline(always)]
    fn split(self) -> (Self, Self) {
        four::split(self)
    }
}

/// Square roots of four numbers.
#[inline(always)]
#[must_use]
pub fn sqrt(numbers: Vec4) -> Vec4 {
    four::sqrt(numbers)
}

/// Whole numbers that are read at once.
pub const BYTES: usize = 16;

/// Sixteen small whole numbers, in fours.
#[inline(always)]
#[must_use]
pub fn of_bytes(bytes: &[i8; BYTES]) -> [Vec4; 4] {
    four::of_bytes(bytes)
}

#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
mod four {
    use core::arch::wasm32::{
        f32x4_convert_i32x4, f32x4_sqrt, i16x8_extend_high_i8x16, i16x8_extend_low_i8x16, i32x4_extend_high_i16x8,
        i32x4_extend_low_i16x8, i32x4_shr, i64x2, u32x4_add, u32x4_shl, u32x4_splat, u32x4_sub, v128, v128_and,
    };

    use glam::Vec4;

    use super::{BIAS, BYTES, MANTISSA, MANTISSA_BITS, ROOT_HALF};

    #[inline(always)]
    pub fn power_of_two(numbers: Vec4) -> Vec4 {
        u32x4_shl(u32x4_add(numbers.into(), u32x4_splat(BIAS)), MANTISSA_BITS).into()
    }

    #[inline(always)]
    pub fn split(numbers: Vec4) -> (Vec4, Vec4) {
        let bits: v128 = u32x4_sub(numbers.into(), u32x4_splat(ROOT_HALF));
        let mantissa = u32x4_add(v128_and(bits, u32x4_splat(MANTISSA)), u32x4_splat(ROOT_HALF));
        (mantissa.into(), f32x4_convert_i32x4(i32x4_shr(bits, MANTISSA_BITS)).into())
    }

    #[inline(always)]
    pub fn sqrt(numbers: Vec4) -> Vec4 {
        f32x4_sqrt(numbers.into()).into()
    }

    #[inline(always)]
    pub fn of_bytes(bytes: &[i8; BYTES]) -> [Vec4; 4] {
        let [low, high]: [i64; 2] = bytemuck::pod_read_unaligned(bytemuck::bytes_of(bytes));
        let all = i64x2(low, high);
        let (low, high) = (i16x8_extend_low_i8x16(all), i16x8_extend_high_i8x16(all));
        [
            i32x4_extend_low_i16x8(low),
            i32x4_extend_high_i16x8(low),
            i32x4_extend_low_i16x8(high),
            i32x4_extend_high_i16x8(high),
        ]
        .map(|four| f32x4_convert_i32x4(four).into())
    }
}

#[cfg(not(all(target_arch = "wasm32", target_feature = "simd128")))]
mod four {
    use glam::Vec4;

    use super::{BYTES, Number};

    #[inline(always)]
    pub fn power_of_two(numbers: Vec4) -> Vec4 {
        numbers.to_array().map(f32::power_of_two).into()
    }

    #[inline(always)]
    pub fn split(numbers: Vec4) -> (Vec4, Vec4) {
        let parts = numbers.to_array().map(f32::split);
        (parts.map(|(mantissa, _)| mantissa).into(), parts.map(|(_, exponent)| exponent).into())
    }

    #[inline(always)]
    pub fn sqrt(numbers: Vec4) -> Vec4 {
        numbers.to_array().map(f32::sqrt).into()
    }

    #[inline(always)]
    pub fn of_bytes(bytes: &[i8; BYTES]) -> [Vec4; 4] {
        std::array::from_fn(|four| Vec4::from_array(std::array::from_fn(|at| f32::from(bytes[4 * four + at]))))
    }
}
