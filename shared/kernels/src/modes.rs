//! Sums of modes of motion: small whole numbers, each mode by a coefficient.

use glam::Vec4;

use crate::number::{self, BYTES};

/// Numbers that are summed up together, in four registers.
const BLOCK: usize = BYTES;

/// Sets `sums` to the sum of each mode times its coefficient, in their order: the same bits whatever the machine.
///
/// # Panics
/// Where a mode has fewer numbers than `sums`.
pub fn sum_up(modes: &[(f32, &[i8])], sums: &mut [f32]) {
    let (blocks, rest) = sums.as_chunks_mut::<BLOCK>();
    let done = blocks.len() * BLOCK;
    for (number, block) in blocks.iter_mut().enumerate() {
        let mut sum = [Vec4::ZERO; BLOCK / 4];
        for &(coefficient, mode) in modes {
            let Some(bytes) = mode[number * BLOCK..].first_chunk() else {
                unreachable!("a mode is as long as the sums")
            };
            let parts = number::of_bytes(bytes);
            for (sum, part) in sum.iter_mut().zip(parts) {
                *sum += part * coefficient;
            }
        }
        for (numbers, sum) in block.chunks_exact_mut(4).zip(sum) {
            numbers.copy_from_slice(&sum.to_array());
        }
    }
    for (at, sum) in rest.iter_mut().enumerate() {
        *sum = modes.iter().fold(0.0, |sum, (coefficient, mode)| sum + coefficient * f32::from(mode[done + at]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::signed;

    #[test]
    fn sums_are_those_of_the_plain_loop() {
        for length in [0, 1, 15, 16, 17, 48, 301] {
            let modes: Vec<Vec<i8>> =
                (0..7).map(|mode| (0..length).map(|k| (127.0 * signed(mode, k)) as i8).collect()).collect();
            let own: Vec<(f32, &[i8])> =
                modes.iter().enumerate().map(|(k, mode)| (0.01 * signed(99, k as u64), mode.as_slice())).collect();
            let mut sums = vec![f32::NAN; length as usize];
            sum_up(&own, &mut sums);
            for (at, sum) in sums.iter().enumerate() {
                let mut plain = 0.0_f32;
                own.iter().for_each(|(coefficient, mode)| plain += coefficient * f32::from(mode[at]));
                assert_eq!(sum.to_bits(), plain.to_bits(), "{at} of {length}");
            }
        }
        let mut nothing = [1.0; 20];
        sum_up(&[], &mut nothing);
        assert_eq!(nothing, [0.0; 20]);
    }
}
