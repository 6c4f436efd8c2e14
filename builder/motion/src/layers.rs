//! Layers of a surface that face each other, such as a thigh and the skirt over it: variations bring none through another.
//!
//! Where mixtures of a stretch's alternatives would bring layers through each other, that which moves these layers towards each other is taken out of
//! them; what moves layers together stays.

use std::collections::BTreeMap;
use std::ops::Range;

use actor::capture::Poses;
use glam::{IVec3, Vec3};
use kernels::topology::Topology;
use learn::dense::Matrix;
use rayon::prelude::*;

use crate::numbers::Numbers;
use crate::reach::{Differences, softened};

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
/// How firmly layers are held apart: the first that is enough, or the last.
const FIRM: [f64; 5] = [0.001, 0.003, 0.01, 0.03, 0.1];
/// Enough is where no more than this part of vertices that face each other might meet.
const MEET: f64 = 0.01;
/// Deviation of what smooths it over time, in looked frames: what faces what changes from frame to frame.
const SMOOTH: f64 = 1.5;

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

    /// Takes out of all variations of each stretch what moves layers through each other: more of it where they are near, and no more
    /// than is needed that few of them meet.
    pub fn hold(&self, differences: &mut Differences, stretches: &[Range<usize>]) {
        for stretch in stretches {
            let looked: Vec<usize> = (0..self.frames.len()).filter(|k| stretch.contains(&(k * EVERY))).collect();
            if self.meet(differences, &looked) <= MEET {
                continue;
            }
            let tight: Vec<Matrix> = looked.par_iter().map(|&k| self.tightness(k)).collect();
            let given: Differences = differences.iter().map(|one| one[stretch.clone()].to_vec()).collect();
            for firm in FIRM {
                let softened: Vec<Option<Vec<Vec<f64>>>> = (0..stretch.len())
                    .into_par_iter()
                    .map(|k| {
                        let rows: Vec<&Vec<f64>> = given.iter().map(|one| &one[k]).collect();
                        softened(&rows, &between(&tight, looked[0] * EVERY, stretch.start + k), firm)
                    })
                    .collect();
                for (k, rows) in softened.into_iter().enumerate() {
                    for (one, row) in differences.iter_mut().zip(rows.unwrap_or_default()) {
                        one[stretch.start + k] = row;
                    }
                }
                if self.meet(differences, &looked) <= MEET {
                    break;
                }
            }
        }
    }

    /// The part of vertices that face each other which mixtures of variations may bring through each other, in some looked frames.
    fn meet(&self, differences: &Differences, looked: &[usize]) -> f64 {
        let of = |&looked: &usize| -> [usize; 2] {
            let (places, facing) = &self.frames[looked];
            let k = looked * EVERY;
            let mut squares = vec![0.0_f32; facing.len()];
            for one in differences {
                let moved = self.numbers.moved(places, k * self.numbers.stride as usize, &one[k]);
                for (square, facing) in squares.iter_mut().zip(facing) {
                    let [own, other] = facing.ends.map(|vertex| moved[vertex] - places[vertex]);
                    *square += (own - other).dot(facing.normal).powi(2);
                }
            }
            // Mixtures of length one bring two of them nearer to each other by at most the length of what each variation does; most do by half of it.
            let meets = |(square, facing): &(&f32, &Facing)| 0.5 * square.sqrt() > facing.gap + self.gives;
            [squares.iter().zip(facing).filter(meets).count(), facing.len()]
        };
        let counts: Vec<[usize; 2]> = looked.par_iter().map(of).collect();
        let [meet, all] = counts.iter().fold([0, 0], |sum, own| [sum[0] + own[0], sum[1] + own[1]]);
        meet as f64 / all.max(1) as f64
    }

    /// What numbers move layers by towards each other in a frame, beside their gaps: x' A x is the mean square of that.
    fn tightness(&self, looked: usize) -> Matrix {
        let facing = &self.frames[looked].1;
        let ways: Vec<([usize; 2], Vec3)> =
            facing.iter().map(|one| (one.ends, one.normal / (one.gap + self.gives))).collect();
        self.numbers.along(looked * EVERY * self.numbers.stride as usize, &ways)
    }
}

/// The matrix of a learned frame, from those of looked frames, of which the first is at `first`.
fn between(tight: &[Matrix], first: usize, frame: usize) -> Matrix {
    let at = (frame as f64 - first as f64) / EVERY as f64;
    let mut sum = Matrix::zeros(tight[0].rows(), tight[0].columns());
    let mut total = 0.0;
    for (k, own) in tight.iter().enumerate() {
        let weight = (-0.5 * ((k as f64 - at) / SMOOTH).powi(2)).exp();
        if weight > 1e-4 {
            total += weight;
            sum.values_mut().iter_mut().zip(own.values()).for_each(|(sum, own)| *sum += weight * own);
        }
    }
    sum.values_mut().iter_mut().for_each(|value| *value /= f64::max(total, f64::MIN_POSITIVE));
    sum
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
    fn what_moves_layers_through_each_other_goes_and_what_moves_both_stays() {
        // Two numbers: one moves both layers, one moves them towards each other by twice their gap.
        let tight = Matrix::from_fn(2, 2, |row, column| if (row, column) == (1, 1) { 4.0 } else { 0.0 });
        let row = vec![1.0, 1.0, 7.0];
        let soft = softened(&[&row], &tight, 1.0).unwrap();
        assert!((soft[0][0] - 1.0).abs() < 1e-9 && (soft[0][1] - 0.2).abs() < 1e-9 && soft[0][2] == 7.0, "{soft:?}");
        let two = [tight.clone(), Matrix::zeros(2, 2)];
        let of = |frame: usize| between(&two, 30, frame)[(1, 1)];
        assert!(of(30) > of(32) && of(32) > of(34) && of(30) < 4.0 && of(34) > 0.0);
    }
}
