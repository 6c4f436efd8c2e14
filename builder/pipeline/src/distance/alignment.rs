//! Planar rigid alignment of all pairs of poses.
//!
//! Boukhayma, thesis (2017), equations 2.3 to 2.5 (with atan2). The sums are products of n x N matrices; they are
//! taken over blocks of vertices in `f32` and from block to block in `f64`.

use glam::{DVec3, Vec3};
use kernels::align::weighted_sum;
use kernels::lanes::lane_sum;
use rayon::prelude::*;

use super::tiles::{self, Tile};
use kernels::simd::{Kernel, Level};

/// Vertices of a block.
pub(super) const BLOCK: usize = 128;

/// Some vertices of a frame: relative to the frame's centre of mass in the ground plane, times the square root of each
/// vertex's weight.
#[derive(Clone)]
pub(super) struct VertexBlock {
    pub(super) x: [f32; BLOCK],
    pub(super) y: [f32; BLOCK],
    pub(super) z: [f32; BLOCK],
}

impl VertexBlock {
    /// Vertices `start..start + BLOCK` of `pose`; those beyond its end are zero.
    pub(super) fn new(pose: &[Vec3], weights: &[f32], centre: DVec3, start: usize) -> Self {
        let mut block = Self { x: [0.0; BLOCK], y: [0.0; BLOCK], z: [0.0; BLOCK] };
        for (slot, (point, &weight)) in pose.iter().zip(weights).skip(start).take(BLOCK).enumerate() {
            let root = f64::from(weight).sqrt();
            let moved = (point.as_dvec3() - DVec3::new(centre.x, 0.0, centre.z)) * root;
            (block.x[slot], block.y[slot], block.z[slot]) = (moved.x as f32, moved.y as f32, moved.z as f32);
        }
        block
    }
}

/// Weighted centres of mass of all frames. Divided by the sum of the weights, since in single precision that is not quite 1.
pub(super) fn centres(poses: &[&[Vec3]], weights: &[f32]) -> Vec<DVec3> {
    let total: f64 = weights.iter().map(|&weight| f64::from(weight)).sum();
    poses.par_iter().map(|pose| weighted_sum(pose, weights) / total).collect()
}

/// Leaves in each pair's `alignment` the cosine and sine of half the angle by which j is turned about +Y to lie on i.
pub(super) fn align_all(level: Level, poses: &[&[Vec3]], (weights, centres): (&[f32], &[DVec3]), tiles: &mut [Tile]) {
    for start in (0..weights.len()).step_by(BLOCK) {
        let blocks: Vec<_> = poses
            .par_iter()
            .zip(centres)
            .map(|(pose, &centre)| VertexBlock::new(pose, weights, centre, start))
            .collect();
        tiles::for_each(tiles, |tile| level.run(Products { blocks: &blocks, tile }));
    }
    tiles::for_each(tiles, |tile| {
        for pair in &mut tile.alignment {
            *pair = half_angle(pair[0], pair[1]);
        }
    });
}

/// Cosine and sine of half of `atan2(cross, dot)`, from square roots only; no turn where both are zero.
fn half_angle(dot: f64, cross: f64) -> [f64; 2] {
    let length = (dot * dot + cross * cross).sqrt();
    let (cos, sin) = if dot >= 0.0 { (length + dot, cross) } else { (cross.abs(), (length - dot).copysign(cross)) };
    let scale = (cos * cos + sin * sin).sqrt();
    if scale > 0.0 { [cos / scale, sin / scale] } else { [1.0, 0.0] }
}

struct Products<'a> {
    blocks: &'a [VertexBlock],
    tile: &'a mut Tile,
}

impl Kernel for Products<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { blocks, tile } = self;
        for i in tile.rows() {
            for j in tile.columns(i) {
                let slot = tile.slot(i, j);
                let (a, b) = (&blocks[i], &blocks[j]);
                let (mut dot, mut cross) = ([0.0; BLOCK], [0.0; BLOCK]);
                for v in 0..BLOCK {
                    dot[v] = a.x[v].mul_add(b.x[v], a.z[v] * b.z[v]);
                    cross[v] = a.x[v].mul_add(b.z[v], -(a.z[v] * b.x[v]));
                }
                tile.alignment[slot][0] += lane_sum(&dot);
                tile.alignment[slot][1] += lane_sum(&cross);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::half_angle;

    #[test]
    fn half_angles_are_those_of_atan2() {
        for step in -50..=50 {
            let angle = f64::from(step) * 0.0628;
            let [cos, sin] = half_angle(3.0 * angle.cos(), 3.0 * angle.sin());
            let (want_sin, want_cos) = (angle / 2.0).sin_cos();
            assert!((cos - want_cos).abs() + (sin - want_sin).abs() < 1e-14, "{angle}");
        }
        assert_eq!(half_angle(0.0, 0.0), [1.0, 0.0]);
        assert_eq!(half_angle(-2.0, 0.0), [0.0, 1.0]);
    }
}
