//! How differently the surface accelerates in two frames.
//!
//! TVCG section 3.3: "the average difference between accelerations computed at each vertex for every pair of source and
//! target meshes in the dynamic time warping path". Accelerations are second differences of the recorded positions,
//! turned by the pair's planar alignment; a sequence's first and last frame take their neighbour's.

use actor::capture::Poses;
use actor::timeline::Timeline;
use glam::Vec3;
use rayon::prelude::*;

use kernels::simd::{Kernel, Level};
use pipeline::distance::{DistanceMatrix, Measured};

/// Lanes of a sum.
const LANES: usize = 16;

/// A frame's accelerations in m/s^2, by vertex, padded with zeros to whole lanes.
struct Field {
    x: Vec<[f32; LANES]>,
    y: Vec<[f32; LANES]>,
    z: Vec<[f32; LANES]>,
}

/// The mean over the vertices of how much accelerations differ, in m/s^2, for all pairs of frames.
pub(super) fn differences(poses: &Poses, timeline: &Timeline, measured: &Measured) -> DistanceMatrix {
    let frames = timeline.frame_count();
    let fields: Vec<Field> = (0..frames).into_par_iter().map(|frame| field(poses, timeline, frame)).collect();
    let level = Level::best();
    let rows: Vec<Vec<f32>> = (0..frames as usize)
        .into_par_iter()
        .map(|i| {
            let pair = |j: usize| {
                let (sin, cos) = measured.headings.get(i, j).sin_cos();
                level.run(Difference { i: &fields[i], j: &fields[j], cos, sin }) / poses.vertex_count() as f32
            };
            (i + 1..frames as usize).map(pair).collect()
        })
        .collect();
    DistanceMatrix::from_fn(frames as usize, |i, j| rows[i][j - i - 1])
}

fn field(poses: &Poses, timeline: &Timeline, frame: u32) -> Field {
    let rate = timeline.fps() * timeline.fps();
    let middle = [frame, frame.wrapping_sub(1), frame + 1].into_iter().find(|&middle| {
        let same = timeline.sequence_index(middle) == timeline.sequence_index(frame);
        same && timeline.offset(middle, -1).is_some() && timeline.next(middle).is_some()
    });
    let lanes = vec![[0.0; LANES]; poses.vertex_count().div_ceil(LANES)];
    let mut field = Field { x: lanes.clone(), y: lanes.clone(), z: lanes };
    let neighbours = middle.and_then(|m| Some((timeline.offset(m, -1)?, m, timeline.next(m)?)));
    // A sequence of fewer than three frames has none.
    let Some((before, middle, after)) = neighbours else { return field };
    let (before, middle, after) = (poses.frame(before), poses.frame(middle), poses.frame(after));
    for (vertex, ((&b, &m), &a)) in before.iter().zip(middle).zip(after).enumerate() {
        let acceleration: Vec3 = (a - m - (m - b)) * rate;
        let (place, lane) = (vertex / LANES, vertex % LANES);
        field.x[place][lane] = acceleration.x;
        field.y[place][lane] = acceleration.y;
        field.z[place][lane] = acceleration.z;
    }
    field
}

struct Difference<'a> {
    i: &'a Field,
    j: &'a Field,
    cos: f32,
    sin: f32,
}

impl Kernel for Difference<'_> {
    type Output = f32;

    #[inline(always)]
    fn run(self) -> f32 {
        let Self { i, j, cos, sin } = self;
        let mut sums = [0.0_f32; LANES];
        for place in 0..i.x.len() {
            let (jx, jz) = (&j.x[place], &j.z[place]);
            for lane in 0..LANES {
                let dx = i.x[place][lane] - cos.mul_add(jx[lane], sin * jz[lane]);
                let dy = i.y[place][lane] - j.y[place][lane];
                let dz = i.z[place][lane] - cos.mul_add(jz[lane], -(sin * jx[lane]));
                sums[lane] += dx.mul_add(dx, dy.mul_add(dy, dz * dz)).sqrt();
            }
        }
        let mut total = 0.0;
        for lane in 0..LANES {
            total += sums[lane];
        }
        total
    }
}

#[cfg(test)]
mod tests {
    use actor::timeline::Sequence;
    use job::Job;

    use super::*;
    use pipeline::distance::{DistanceOptions, measure};

    #[test]
    fn parabolas_of_different_gravity() {
        // Two throws of a triangle, one falling twice as fast, the other turned about: the difference is one g.
        let throw = |gravity: f32, turn: f32| {
            (0..6).map(move |t| {
                let t = t as f32 * 0.1;
                let (sin, cos) = turn.sin_cos();
                [(0.0, 0.0), (1.0, 0.0), (0.0, 0.5)]
                    .map(|(x, z): (f32, f32)| Vec3::new(cos * x + sin * z, -0.5 * gravity * t * t, cos * z - sin * x))
            })
        };
        let mut poses = Poses::new(3);
        throw(2.0, 0.0).chain(throw(5.0, 1.0)).for_each(|pose| poses.push(&pose));
        let sequence = |first_frame: u32| Sequence {
            name: first_frame.to_string(),
            labels: vec![],
            first_frame,
            frame_count: 6,
            cyclic: false,
        };
        let timeline = Timeline::new(10.0, vec![sequence(0), sequence(6)]).unwrap();
        let topology = kernels::topology::Topology::new(3, vec![[0, 1, 2]], vec![1.0; 3]).unwrap();
        let measured = measure(&topology, &poses, &DistanceOptions::default(), &Job::silent()).unwrap();
        let matrix = differences(&poses, &timeline, &measured);
        for (i, j) in (0..6).flat_map(|i| (6..12).map(move |j| (i, j))) {
            assert!((matrix.get(i, j) - 3.0).abs() < 1e-3, "{i} {j} {}", matrix.get(i, j));
        }
        assert!(matrix.get(0, 5) < 1e-3);
    }
}
