//! Headings that a body may have, of which not all parts were turned alike: where a frame is tracked from a wrong heading, limbs are
//! found all the same, but what is round, as a skirt, stays as it was turned, and the waist is twisted. A pose that starts with the
//! limbs' heading has no need to twist.

use glam::Vec3;

/// Bins of the circle.
const BINS: usize = 64;
/// Share of the surface that must be turned alike.
const LEAST: f32 = 0.05;
/// Radians by which headings must differ to be worth trying both.
const APART: f32 = 0.12;
/// So many headings at most.
const MOST: usize = 3;
/// What is nearer to the axis says little about a heading, metres on a person.
const NEAR: f32 = 0.05;

/// By how much parts of a body turned about the vertical through `axis` from `start` to `found`, radians: headings that much of the
/// surface, of which `areas` are the vertices' shares, agrees on, the most first; what hardly turned is left out.
#[must_use]
pub fn headings((start, found): (&[Vec3], &[Vec3]), areas: &[f32], axis: Vec3, scale: f32) -> Vec<f32> {
    let mut bins = [0.0_f32; BINS];
    let width = std::f32::consts::TAU / BINS as f32;
    for ((start, found), area) in start.iter().zip(found).zip(areas) {
        let [from, to] = [start, found].map(|p| glam::Vec2::new(p.z - axis.z, p.x - axis.x));
        let near = NEAR * scale;
        let sure = from.length_squared().min(to.length_squared()) / (near * near);
        // About +Y, from +Z to +X.
        let turn = from.perp_dot(to).atan2(from.dot(to));
        let bin = (turn / width + BINS as f32 + 0.5) as usize % BINS;
        bins[bin] += area * (sure / (1.0 + sure));
    }
    let around = |k: usize| 0.5 * bins[(k + BINS - 1) % BINS] + bins[k] + 0.5 * bins[(k + 1) % BINS];
    let sum: f32 = bins.iter().sum();
    let smooth: Vec<f32> = (0..BINS).map(around).collect();
    let is_peak = |&k: &usize| {
        let beside = smooth[(k + BINS - 1) % BINS].max(smooth[(k + 1) % BINS]);
        smooth[k] >= beside && smooth[k] > LEAST * sum
    };
    let mut peaks: Vec<usize> = (0..BINS).filter(is_peak).collect();
    peaks.sort_by(|&a, &b| smooth[b].total_cmp(&smooth[a]).then(a.cmp(&b)));
    let turn = |k: usize| {
        let turn = k as f32 * width;
        if turn > std::f32::consts::PI { turn - std::f32::consts::TAU } else { turn }
    };
    let mut found: Vec<f32> = Vec::new();
    for turn in peaks.into_iter().map(turn).filter(|turn| turn.abs() > APART) {
        if found.len() < MOST && found.iter().all(|other| (other - turn).abs() > APART) {
            found.push(turn);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use glam::Quat;

    use super::*;

    #[test]
    fn what_turned_otherwise_than_the_rest_is_a_heading() {
        let place = |k: usize| {
            let angle = k as f32 * 0.7;
            Vec3::new(0.3 * angle.sin(), k as f32 * 0.01, 0.3 * angle.cos())
        };
        let start: Vec<Vec3> = (0..100).map(place).collect();
        // The lower half stays, a quarter turns by 0.6, another one by -0.4, and a few points by 2.
        let turn = |k: usize| match k {
            0..50 => 0.0,
            50..75 => 0.6,
            75..97 => -0.4,
            _ => 2.0,
        };
        let found: Vec<Vec3> = start.iter().enumerate().map(|(k, p)| Quat::from_rotation_y(turn(k)) * *p).collect();
        let turns = headings((&start, &found), &[1.0; 100], Vec3::ZERO, 1.0);
        assert_eq!(turns.len(), 2, "{turns:?}");
        assert!((turns[0] - 0.6).abs() < 0.06 && (turns[1] + 0.4).abs() < 0.06, "{turns:?}");
        assert!(headings((&start, &start), &[1.0; 100], Vec3::ZERO, 1.0).is_empty());
        assert!(headings((&[], &[]), &[], Vec3::ZERO, 1.0).is_empty());
    }
}
