//! Seeded random numbers and smooth noise. All of it is a pure function of a seed and a place, so that frames can be
//! made in any order and by any number of threads.

use glam::Vec3;

/// Mixes a seed with an index into a new seed (the finaliser of SplitMix64, Steele et al. 2014).
#[must_use]
pub fn mix(seed: u64, index: u64) -> u64 {
    let mut z = seed.wrapping_add(index.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// A number in [-1, 1) that depends on `seed` and `index` only.
#[must_use]
pub fn signed(seed: u64, index: u64) -> f32 {
    (mix(seed, index) >> 40) as f32 / (1 << 23) as f32 - 1.0
}

/// Smooth noise over `x` with knots at the integers, in about [-1, 1], twice differentiable.
#[must_use]
pub fn noise1(seed: u64, x: f32) -> f32 {
    let floor = x.floor();
    let t = fade(x - floor);
    let knot = floor as i64 as u64;
    signed(seed, knot) * (1.0 - t) + signed(seed, knot.wrapping_add(1)) * t
}

/// Smooth noise over space and time with knots at the integers, in about [-1, 1].
#[must_use]
pub fn noise4(seed: u64, place: Vec3, time: f32) -> f32 {
    let coordinates = [place.x, place.y, place.z, time];
    let floors = coordinates.map(f32::floor);
    let fractions: [f32; 4] = std::array::from_fn(|axis| fade(coordinates[axis] - floors[axis]));
    let mut sum = 0.0;
    for corner in 0..16_u32 {
        let mut weight = 1.0;
        let mut key = seed;
        for axis in 0..4 {
            let upper = corner >> axis & 1;
            weight *= if upper == 1 { fractions[axis] } else { 1.0 - fractions[axis] };
            key = mix(key, (floors[axis] as i64 + i64::from(upper)) as u64);
        }
        sum += weight * ((key >> 40) as f32 / (1 << 23) as f32 - 1.0);
    }
    sum
}

/// Three independent [`noise4`] fields as a vector.
#[must_use]
pub fn vector_noise(seed: u64, place: Vec3, time: f32) -> Vec3 {
    Vec3::new(noise4(mix(seed, 1), place, time), noise4(mix(seed, 2), place, time), noise4(mix(seed, 3), place, time))
}

fn fade(t: f32) -> f32 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_continuous_and_bounded() {
        let mut last = noise1(7, -3.0);
        for step in 1..6000 {
            let value = noise1(7, -3.0 + step as f32 * 1e-3);
            assert!((value - last).abs() < 5e-3 && value.abs() <= 1.0);
            last = value;
        }
        for step in 0..500 {
            let place = Vec3::new(step as f32 * 0.137, -0.2, step as f32 * 0.071);
            let here = noise4(3, place, 0.4);
            let beside = noise4(3, place + Vec3::splat(1e-3), 0.401);
            assert!(here.abs() <= 1.0 && (here - beside).abs() < 2e-2);
        }
    }

    #[test]
    fn seeds_tell_streams_apart() {
        let same = (0..100).filter(|&i| signed(1, i) == signed(2, i)).count();
        assert_eq!(same, 0);
    }
}
