//! Poses that lie on a frame as well when what is round on them is turned a little: a skirt with dots is found turned by one or
//! two of them, and nothing but the twist of the waist tells.

use glam::{Quat, Vec3};
use rayon::prelude::*;

use super::surface::Surface;
use super::track::Target;

/// Turns that are tried, radians.
pub const SLIPS: [f32; 4] = [0.22, -0.22, 0.44, -0.44];
/// What lies farther from the frame when it is turned by so much is not round, metres on a person.
const TURN: f32 = 0.22;
const FARTHEST: f32 = 0.02;
/// Normals that agree less (cosine) belong to something else.
const LEAST_COSINE: f32 = 0.7;
/// How often shares are made smooth.
const SMOOTH: usize = 10;

/// How freely each vertex of `posed`, which lies on `target`, may be turned about the vertical through `axis`: from 0 to 1, and
/// without steps from one vertex to the next, of which `neighbours` are the ones around each.
#[must_use]
pub fn roundness(posed: &Surface, target: &Target, neighbours: &[Vec<u32>], (axis, scale): (Vec3, f32)) -> Vec<f32> {
    let farthest = FARTHEST * scale;
    let share = |v: usize, turn: f32| {
        let turn = Quat::from_rotation_y(turn);
        let (place, normal) = (turn * (posed.mesh.positions[v] - axis) + axis, turn * posed.normals[v]);
        let found = target.closest(place, normal)?;
        let off = found.position.distance(place) / farthest;
        (found.normal.dot(normal) > LEAST_COSINE).then_some((1.0 - off * off).max(0.0))
    };
    let both = |v: usize| share(v, TURN).unwrap_or(0.0).min(share(v, -TURN).unwrap_or(0.0));
    let mut shares: Vec<f32> = (0..posed.mesh.positions.len()).into_par_iter().map(both).collect();
    for _ in 0..SMOOTH {
        let mean = |v: usize| {
            let around = &neighbours[v];
            let sum: f32 = around.iter().map(|&n| shares[n as usize]).sum();
            0.5 * shares[v] + 0.5 * sum / around.len().max(1) as f32
        };
        shares = (0..shares.len()).map(mean).collect();
    }
    shares
}

/// `pose` with each vertex turned about the vertical through `axis` by its share of `turn` radians.
#[must_use]
pub fn slipped(pose: &[Vec3], shares: &[f32], axis: Vec3, turn: f32) -> Vec<Vec3> {
    let place = |(p, share): (&Vec3, &f32)| Quat::from_rotation_y(turn * share) * (*p - axis) + axis;
    pose.iter().zip(shares).map(place).collect()
}

#[cfg(test)]
mod tests {
    use geometry::polygonise::polygonise;

    use super::*;

    #[test]
    fn what_is_round_may_turn_and_what_sticks_out_may_not() {
        // A skirt about the vertical, and an arm that sticks out of it.
        let distance = |p: Vec3| {
            let skirt = (p / Vec3::new(0.3, 0.4, 0.3)).length() * 0.3 - 0.3;
            let arm = Vec3::new(p.x - p.x.clamp(0.0, 0.8), p.y - 0.35, p.z).length() - 0.06;
            skirt.min(arm)
        };
        let mesh = polygonise(Vec3::splat(-0.9), Vec3::splat(0.95), 0.04, distance);
        let surface = Surface::new(mesh, None);
        let neighbours = surface.mesh.neighbours();
        let target = Target::new(surface.clone(), 1.0);
        let shares = roundness(&surface, &target, &neighbours, (Vec3::ZERO, 1.0));
        let mean = |only: &dyn Fn(Vec3) -> bool| {
            let of = surface.mesh.positions.iter().zip(&shares).filter(|(p, _)| only(**p));
            let of: Vec<f32> = of.map(|(_, share)| *share).collect();
            of.iter().sum::<f32>() / of.len() as f32
        };
        let (skirt, arm) = (mean(&|p| p.y.abs() < 0.15), mean(&|p| p.y > 0.25 && p.x > 0.4));
        assert!(skirt > 0.9 && arm < 0.1, "{skirt} and {arm}");
        let turned = slipped(&surface.mesh.positions, &shares, Vec3::ZERO, 0.3);
        let moved = |k: usize| turned[k].distance(surface.mesh.positions[k]);
        let far = (0..turned.len()).filter(|&k| surface.mesh.positions[k].x > 0.7).map(moved).fold(0.0, f32::max);
        assert!(far < 0.03, "{far}");
    }
}
