//! Trajectories of the centre of mass of blended sequences, with and without recurring alignment.
//!
//! TVCG figures 11 and 12: two sequences that turn apart are blended frame by frame. Without recurring alignment, the
//! second is laid on the first once, at their first frames, and their centres of mass are blended: the trajectory
//! collapses where the two go apart. With it (thesis algorithm 2), the blended displacements are followed.

use glam::Vec2;
use kernels::align::rotate;

use pipeline::distance::HeadingMatrix;

/// Two runs of frames of the same length, blended pair by pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pairing {
    /// First frames of both.
    pub first: [u32; 2],
    /// Number of pairs.
    pub length: u32,
}

/// Centres of mass, along (X, Z).
pub type Trajectory = Vec<Vec2>;

/// Both sides as recorded, the second laid on the first at their first frames.
#[must_use]
pub fn sides(pairing: Pairing, headings: &HeadingMatrix, centres: &[Vec2]) -> [Trajectory; 2] {
    let [a, b] = pairing.first.map(|first| first as usize);
    let turn = headings.get(a, b);
    let length = pairing.length as usize;
    let first = centres[a..a + length].to_vec();
    let second = (b..b + length).map(|frame| centres[a] + rotate(turn, centres[frame] - centres[b])).collect();
    [first, second]
}

/// The blend without recurring alignment, with the weight `lambda(t)` of the second, t from 0 to 1.
#[must_use]
pub fn linear(pairing: Pairing, headings: &HeadingMatrix, centres: &[Vec2], lambda: &dyn Fn(f32) -> f32) -> Trajectory {
    let [first, second] = sides(pairing, headings, centres);
    let last = (pairing.length.max(2) - 1) as f32;
    let pairs = first.iter().zip(&second).enumerate();
    pairs.map(|(step, (a, b))| a.lerp(*b, lambda(step as f32 / last))).collect()
}

/// The blend with recurring alignment (thesis algorithm 2).
#[must_use]
pub fn aligned(
    pairing: Pairing,
    headings: &HeadingMatrix,
    centres: &[Vec2],
    lambda: &dyn Fn(f32) -> f32,
) -> Trajectory {
    let [a, b] = pairing.first.map(|first| first as usize);
    let last = (pairing.length.max(2) - 1) as f32;
    // Headings of what remains of both sides.
    let mut turns = [0.0, headings.get(a, b)];
    let mut centre = centres[a];
    let mut trajectory = Vec::new();
    for step in 0..pairing.length as usize {
        let weight = lambda(step as f32 / last);
        let (m, n) = (a + step, b + step);
        let apart = turns[0] + headings.get(m, n) - turns[1];
        let apart = apart - (apart / std::f32::consts::TAU).round() * std::f32::consts::TAU;
        turns = [turns[0] - weight * apart, turns[1] + (1.0 - weight) * apart];
        trajectory.push(centre);
        if step + 1 < pairing.length as usize {
            let steps = [rotate(turns[0], centres[m + 1] - centres[m]), rotate(turns[1], centres[n + 1] - centres[n])];
            centre += steps[0].lerp(steps[1], weight);
        }
    }
    trajectory
}

/// The length of a trajectory in metres.
#[must_use]
pub fn length(trajectory: &[Vec2]) -> f64 {
    trajectory.windows(2).map(|pair| f64::from(pair[0].distance(pair[1]))).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two circles, one to the left and one to the right, whose bodies face along them.
    fn circles(frames: usize) -> (HeadingMatrix, Vec<Vec2>) {
        let angle = |step: usize| 0.05 * step as f32;
        let headings: Vec<f32> = (0..frames).map(angle).chain((0..frames).map(|step| -angle(step))).collect();
        let centre = |heading: f32, side: f32| Vec2::new(side * (1.0 - heading.cos()), heading.abs().sin());
        let centres = headings.iter().enumerate().map(|(i, &h)| centre(h, if i < frames { 1.0 } else { -1.0 }));
        let matrix = HeadingMatrix::from_fn(2 * frames, |i, j| headings[i] - headings[j]);
        (matrix, centres.collect())
    }

    #[test]
    fn recurring_alignment_keeps_the_length() {
        let (headings, centres) = circles(60);
        let pairing = Pairing { first: [0, 60], length: 60 };
        let half = |_: f32| 0.5;
        let whole = length(&centres[..60]);
        let kept = aligned(pairing, &headings, &centres, &half);
        assert!((length(&kept) / whole - 1.0).abs() < 1e-3, "{}", length(&kept) / whole);
        // Left and right in equal parts go straight on.
        assert!(kept.iter().all(|point| point.x.abs() < 1e-3));
        let collapsed = linear(pairing, &headings, &centres, &half);
        assert!(length(&collapsed) < 0.8 * whole);
    }

    #[test]
    fn a_side_alone_is_itself() {
        let (headings, centres) = circles(20);
        let pairing = Pairing { first: [0, 20], length: 20 };
        let alone = aligned(pairing, &headings, &centres, &|_| 0.0);
        assert!(alone.iter().zip(&centres).all(|(a, b)| a.distance(*b) < 1e-5));
    }
}
