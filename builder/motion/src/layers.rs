//! Layers of a surface that face each other, such as a thigh and the skirt over it: variations bring none through another.
//!
//! Nothing of the surface is pulled: where mixtures of a stretch's alternatives would bring layers through each other, all of them are drawn nearer
//! to the recording for a while.

use std::collections::BTreeMap;
use std::ops::Range;

use actor::capture::Poses;
use glam::{IVec3, Vec3};
use kernels::topology::Topology;
use rayon::prelude::*;

use crate::numbers::Numbers;
use crate::reach::Differences;
use crate::smooth::smoothed;

/// Vertices that are looked at, at most.
const LOOKED_AT: usize = 1500;
/// Every so many learned frames are.
const EVERY: usize = 3;
/// Layers are no farther apart than this, in body sizes: 5 cm of 1.8 m.
const APART: f32 = 0.03;
/// Vertices that face each other are no farther aside than this, in body sizes.
const ASIDE: f32 = 0.015;
/// The cosine of the angle between normals of layers that face each other, at most.
const OPPOSED: f32 = -0.3;
/// So much nearer than their gap layers may come, in body sizes: 2 mm of 1.8 m. What lies on something is not held by it.
const GIVES: f32 = 0.0011;
/// Over so many learned frames what is drawn nearer goes back to what it would be.
const BACK: f64 = 12.0;
/// So many learned frames before and after are drawn as near.
const WIDE: f64 = 5.0;
/// Deviation of what smooths it, in learned frames.
const SMOOTH: f64 = 2.0;

/// What faces what, in the frames that a model learned.
pub struct Layers {
    numbers: Numbers,
    /// Where the vertices are in every few learned frames, and which of them face each other.
    frames: Vec<(Vec<Vec3>, Vec<Facing>)>,
    gives: f32,
}

/// Two vertices that face each other.
struct Facing {
    ends: [usize; 2],
    /// The normal of the second one, which the first one lies before.
    normal: Vec3,
    /// By how much.
    gap: f32,
}

impl Layers {
    /// Those of a body of `size` metres with these numbers.
    pub fn new(numbers: &Numbers, topology: &Topology, poses: &Poses, size: f64) -> Self {
        let size = size as f32;
        let count = topology.vertex_count();
        let chosen: Vec<u32> = (0..count as u32).step_by(count.div_ceil(LOOKED_AT).max(1)).collect();
        let frame = |&frame: &u32| {
            let pose = poses.frame(frame);
            let normals = normals(topology, pose);
            let some = |of: &[Vec3]| chosen.iter().map(|&vertex| of[vertex as usize]).collect::<Vec<Vec3>>();
            let places = some(pose);
            let facing = facing(&places, &some(&normals), size);
            (places, facing)
        };
        let looked: Vec<u32> = numbers.frames.iter().copied().step_by(EVERY).collect();
        let frames = looked.par_iter().map(frame).collect();
        Self { numbers: numbers.thinned(&chosen), frames, gives: GIVES * size }
    }

    /// Draws all variations of each stretch nearer to the recording where mixtures of them would bring layers through each other.
    pub fn hold(&self, differences: &mut Differences, stretches: &[Range<usize>]) {
        for stretch in stretches {
            let tight: Vec<(usize, f64)> = (0..self.frames.len())
                .into_par_iter()
                .filter(|looked| stretch.contains(&(looked * EVERY)))
                .map(|looked| (looked * EVERY, self.share(differences, looked)))
                .filter(|(_, share)| *share < 1.0)
                .collect();
            if tight.is_empty() {
                continue;
            }
            for (k, share) in eased(&tight, stretch).into_iter().enumerate() {
                for one in differences.iter_mut() {
                    one[stretch.start + k].iter_mut().for_each(|number| *number *= share);
                }
            }
        }
    }

    /// The largest share, up to one, of all variations by which no mixture of them brings layers through each other in a frame.
    fn share(&self, differences: &Differences, looked: usize) -> f64 {
        let (places, facing) = &self.frames[looked];
        let k = looked * EVERY;
        if facing.is_empty() {
            return 1.0;
        }
        let mut squares = vec![0.0_f32; facing.len()];
        for one in differences {
            let moved = self.numbers.moved(places, k * self.numbers.stride as usize, &one[k]);
            for (square, facing) in squares.iter_mut().zip(facing) {
                let [own, other] = facing.ends.map(|vertex| moved[vertex] - places[vertex]);
                *square += (own - other).dot(facing.normal).powi(2);
            }
        }
        // Of all vectors of length one, the mixture that brings these two nearest to each other does so by the length of what each does.
        let share = |(square, facing): (&f32, &Facing)| (facing.gap + self.gives) / square.sqrt().max(f32::MIN_POSITIVE);
        f64::from(squares.iter().zip(facing).map(share).fold(1.0, f32::min))
    }
}

/// Shares for all frames of a stretch, from those that are tight.
fn eased(tight: &[(usize, f64)], stretch: &Range<usize>) -> Vec<f64> {
    let of = |k: usize| {
        let from = |&(at, share): &(usize, f64)| {
            let far = (at.abs_diff(k) as f64 - WIDE).max(0.0) / BACK;
            share + far
        };
        vec![tight.iter().map(from).fold(1.0, f64::min)]
    };
    let shares: Vec<Vec<f64>> = stretch.clone().map(of).collect();
    smoothed(&shares, SMOOTH).into_iter().map(|share| share[0].clamp(0.0, 1.0)).collect()
}

/// For each vertex the nearest one that faces it.
fn facing(places: &[Vec3], normals: &[Vec3], size: f32) -> Vec<Facing> {
    let cell = |place: Vec3| (place / (APART * size)).floor().as_ivec3().to_array();
    let mut cells: BTreeMap<[i32; 3], Vec<usize>> = BTreeMap::new();
    for (vertex, &place) in places.iter().enumerate() {
        cells.entry(cell(place)).or_default().push(vertex);
    }
    let of = |own: usize| -> Option<Facing> {
        let around = IVec3::from_array(cell(places[own]));
        let near = (0..27).map(|k| around + IVec3::new(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1));
        let others = near.filter_map(|at| cells.get(&at.to_array())).flatten();
        let faces = |&other: &usize| -> Option<(f32, Facing)> {
            let (off, normal) = (places[own] - places[other], normals[other]);
            let gap = off.dot(normal);
            let is_before = gap > 0.0 && off.dot(normals[own]) < 0.0 && normals[own].dot(normal) < OPPOSED;
            let is_near = off.length() < APART * size && (off - normal * gap).length() < ASIDE * size;
            (is_before && is_near).then_some((off.length(), Facing { ends: [own, other], normal, gap }))
        };
        others.filter_map(faces).min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, facing)| facing)
    };
    (0..places.len()).filter_map(of).collect()
}

/// Unit normals of vertices.
fn normals(topology: &Topology, pose: &[Vec3]) -> Vec<Vec3> {
    let mut normals = vec![Vec3::ZERO; pose.len()];
    for triangle in topology.triangles() {
        let [a, b, c] = triangle.map(|vertex| pose[vertex as usize]);
        let normal = (b - a).cross(c - a);
        triangle.iter().for_each(|&vertex| normals[vertex as usize] += normal);
    }
    normals.iter().map(|normal| normal.normalize_or_zero()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid of 12 x 12 vertices at a height, 2 cm apart, facing up or down.
    fn sheet(height: f32, up: bool) -> (Vec<Vec3>, Vec<Vec3>) {
        let place = |k: usize| Vec3::new(0.02 * (k % 12) as f32, height, 0.02 * (k / 12) as f32);
        ((0..144).map(place).collect(), vec![if up { Vec3::Y } else { -Vec3::Y }; 144])
    }

    fn both(a: (Vec<Vec3>, Vec<Vec3>), b: (Vec<Vec3>, Vec<Vec3>)) -> Vec<Facing> {
        facing(&[a.0, b.0].concat(), &[a.1, b.1].concat(), 1.8)
    }

    #[test]
    fn sheets_that_face_each_other_do_and_backs_do_not() {
        let found = both(sheet(0.0, true), sheet(0.01, false));
        assert_eq!(found.len(), 288);
        assert!(found.iter().all(|one| (one.gap - 0.01).abs() < 1e-6 && one.ends[0].abs_diff(one.ends[1]) == 144));
        assert!(both(sheet(0.0, false), sheet(0.01, true)).is_empty(), "the two sides of cloth");
        assert!(both(sheet(0.0, true), sheet(0.2, false)).is_empty(), "far from each other");
        assert!(both(sheet(0.0, true), sheet(0.01, true)).is_empty(), "one behind the other");
    }

    #[test]
    fn what_is_tight_eases_in_and_out() {
        let shares = eased(&[(30, 0.4)], &(0..61));
        assert!((shares[30] - 0.4).abs() < 1e-6 && shares[0] == 1.0 && shares[60] == 1.0, "{shares:?}");
        assert!(shares.windows(2).all(|two| (two[1] - two[0]).abs() <= 1.0 / BACK + 1e-9));
        assert!((26..=34).all(|k| shares[k] < 0.45), "{shares:?}");
    }
}
