//! Sums in a fixed order.

/// Lanes of a sum: one AVX-512 register, two of AVX2, four of SSE2.
const LANES: usize = 16;

/// The sum of `values`: every sixteenth in `f32`, then the sixteen in `f64`.
#[inline(always)]
pub(super) fn lane_sum<const N: usize>(values: &[f32; N]) -> f64 {
    const { assert!(N.is_multiple_of(LANES)) };
    let mut lanes = [0.0_f32; LANES];
    for start in (0..N).step_by(LANES) {
        for lane in 0..LANES {
            lanes[lane] += values[start + lane];
        }
    }
    let mut total = 0.0;
    for lane in lanes {
        total += f64::from(lane);
    }
    total
}
