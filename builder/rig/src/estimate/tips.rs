//! The ends of a body: points of the surface that are far from everything.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::Vec3;

/// The vertex nearest to the middle of `pose`, and up to `count` tips with how far each is, along edges, from it and the tips
/// before it, in metres.
#[must_use]
pub fn tips(pose: &[Vec3], around: &[Vec<u32>], count: usize) -> (u32, Vec<(u32, f32)>) {
    let middle = pose.iter().sum::<Vec3>() / pose.len().max(1) as f32;
    let off = |v: u32| pose[v as usize].distance_squared(middle);
    let centre = (1..pose.len() as u32).fold(0, |best, v| if off(v) < off(best) { v } else { best });
    let mut distances = vec![f32::INFINITY; pose.len()];
    spread(pose, around, centre, &mut distances);
    let mut tips = Vec::new();
    while tips.len() < count {
        let finite = (0..pose.len() as u32).filter(|&v| distances[v as usize].is_finite());
        let next = finite.reduce(|best, v| if distances[v as usize] > distances[best as usize] { v } else { best });
        let Some(tip) = next.filter(|&tip| distances[tip as usize] > 0.0) else { break };
        tips.push((tip, distances[tip as usize]));
        spread(pose, around, tip, &mut distances);
    }
    (centre, tips)
}

/// Lowers `distances` to those from `from` along edges where these are less (Dijkstra).
pub fn spread(pose: &[Vec3], around: &[Vec<u32>], from: u32, distances: &mut [f32]) {
    distances[from as usize] = 0.0;
    // The bits of a positive float are in its order.
    let mut queue = BinaryHeap::from([(Reverse(0_u32), from)]);
    while let Some((Reverse(bits), v)) = queue.pop() {
        let at = f32::from_bits(bits);
        if at > distances[v as usize] {
            continue;
        }
        for &other in &around[v as usize] {
            let next = at + pose[v as usize].distance(pose[other as usize]);
            if next < distances[other as usize] {
                distances[other as usize] = next;
                queue.push((Reverse(next.to_bits()), other));
            }
        }
    }
}
