//! Pose distances against a plain version: 3x3 matrices, an eigenvalue decomposition, `f64`.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test that panics has failed; what it measured is printed"
)]

mod common;

use std::ops::ControlFlow;

use actor::capture::Poses;
use fixtures::{Captured, crane_and_jumping};
use glam::{DMat3, DVec3, Vec3};
use job::{Job, Progress};
use kernels::align::{Placement, align_heading, centre_of_mass, rotate};
use kernels::topology::Topology;
use pipeline::distance::{DistanceKind, DistanceMatrix, DistanceOptions, pose_distances};

fn distances(topology: &Topology, poses: &Poses, options: &DistanceOptions) -> DistanceMatrix {
    pose_distances(topology, poses, options, &Job::new(&within)).unwrap()
}

/// TVCG equation 2, word for word, in `f64`.
fn plain_distance(topology: &Topology, poses: &Poses, i: u32, j: u32, options: &DistanceOptions) -> f64 {
    let pose_i = poses.frame(i);
    let heading = align_heading(pose_i, poses.frame(j), topology.weights());
    let (sin, cos) = f64::from(heading).sin_cos();
    let turned: Vec<DVec3> = poses
        .frame(j)
        .iter()
        .map(|p| p.as_dvec3())
        .map(|p| DVec3::new(cos * p.x + sin * p.z, p.y, cos * p.z - sin * p.x))
        .collect();
    let (mut sum, mut total) = (0.0, 0.0);
    for &corners in topology.triangles() {
        let source = gradient_basis(corners.map(|v| pose_i[v as usize].as_dvec3()));
        let target = gradient_basis(corners.map(|v| turned[v as usize]));
        let (angle, logarithm, difference) = polar(target * source.inverse());
        let stretch = if options.kind == DistanceKind::DeformationFrobenius { difference } else { logarithm };
        let weight = if options.area_weighted { mean_share(topology, poses, corners) } else { 1.0 };
        sum += weight * (angle + f64::from(options.stretch_weight) * stretch);
        total += weight;
    }
    sum / total
}

/// Two edges and the unit normal.
fn gradient_basis([p, q, r]: [DVec3; 3]) -> DMat3 {
    let (e1, e2) = (p - r, q - r);
    DMat3::from_cols(e1, e2, e1.cross(e2).normalize())
}

/// The angle of R, ||log S|| and ||S - I|| of T = R S.
fn polar(t: DMat3) -> (f64, f64, f64) {
    let (values, vectors) = symmetric_eigen(t.transpose() * t);
    let norm = |of: fn(f64) -> f64| values.to_array().map(of).iter().map(|x| x * x).sum::<f64>().sqrt();
    let inverse_root = vectors * DMat3::from_diagonal(values.map(|value| 1.0 / value.sqrt())) * vectors.transpose();
    let r = t * inverse_root;
    let axis = DVec3::new(r.y_axis.z - r.z_axis.y, r.z_axis.x - r.x_axis.z, r.x_axis.y - r.y_axis.x);
    let trace = r.x_axis.x + r.y_axis.y + r.z_axis.z;
    (axis.length().atan2(trace - 1.0), norm(|value| 0.5 * value.ln()), norm(|value| value.sqrt() - 1.0))
}

/// Jacobi's method.
fn symmetric_eigen(mut m: DMat3) -> (DVec3, DMat3) {
    let mut vectors = DMat3::IDENTITY;
    for _ in 0..8 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let angle = 0.5 * (2.0 * m.col(q)[p]).atan2(m.col(q)[q] - m.col(p)[p]);
            let (sin, cos) = angle.sin_cos();
            let mut turn = DMat3::IDENTITY;
            turn.col_mut(p)[p] = cos;
            turn.col_mut(q)[q] = cos;
            turn.col_mut(q)[p] = sin;
            turn.col_mut(p)[q] = -sin;
            m = turn.transpose() * m * turn;
            vectors *= turn;
        }
    }
    (DVec3::new(m.x_axis.x, m.y_axis.y, m.z_axis.z), vectors)
}

fn mean_share(topology: &Topology, poses: &Poses, corners: [u32; 3]) -> f64 {
    let area = |pose: &[Vec3], corners: [u32; 3]| {
        let [p, q, r] = corners.map(|v| pose[v as usize].as_dvec3());
        (q - p).cross(r - p).length()
    };
    let share = |pose: &[Vec3]| area(pose, corners) / topology.triangles().iter().map(|&c| area(pose, c)).sum::<f64>();
    poses.iter().map(share).sum::<f64>()
}

fn check_against_plain(topology: &Topology, poses: &Poses, options: &DistanceOptions, every: usize, bound: f64) {
    let matrix = distances(topology, poses, options);
    let n = poses.len();
    let (mut worst, mut pairs) = (0.0_f64, 0);
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).step_by(every) {
        let want = plain_distance(topology, poses, i as u32, j as u32, options);
        worst = worst.max((f64::from(matrix.get(i, j)) - want).abs());
        pairs += 1;
    }
    println!("{pairs} pairs, largest difference {worst:.2e} (bound {bound:.0e})");
    assert!(worst < bound, "{worst:e}");
}

/// No stage is ever more than done.
fn within(progress: Progress) -> ControlFlow<()> {
    assert!(progress.done <= progress.total, "{progress:?}");
    ControlFlow::Continue(())
}

#[test]
fn matches_plain_matrices_on_random_meshes() {
    for (seed, noise) in [(1, 0.0), (2, 0.02), (3, 0.1)] {
        let (topology, poses) = common::random_tube(9, 11, 37, noise, seed);
        check_against_plain(&topology, &poses, &DistanceOptions::default(), 3, 5e-6);
        let options = DistanceOptions { stretch_weight: 1.0, area_weighted: true, ..Default::default() };
        check_against_plain(&topology, &poses, &options, 3, 1e-5);
    }
}

#[test]
fn frobenius_variant_matches_plain_matrices() {
    let (topology, poses) = common::random_tube(9, 11, 21, 0.05, 4);
    let kind = DistanceKind::DeformationFrobenius;
    let options = DistanceOptions { kind, stretch_weight: 1.0, ..Default::default() };
    let upper = distances(&topology, &poses, &options);
    // From i < j only: this variant is not symmetric, the matrix is.
    for (i, j) in (0..21).flat_map(|i| (i + 1..21).map(move |j| (i, j))) {
        let want = plain_distance(&topology, &poses, i as u32, j as u32, &options);
        assert!((f64::from(upper.get(i, j)) - want).abs() < 1e-5, "{i} {j}");
    }
}

#[test]
#[ignore = "reads ../shared/data"]
fn matches_plain_matrices_on_a_real_capture() {
    let Captured { topology, poses, .. } = crane_and_jumping(13);
    check_against_plain(&topology, &poses, &DistanceOptions::default(), 23, 2e-6);
}

#[test]
fn rigid_motion_in_the_plane_costs_nothing_and_a_lean_costs_its_angle() {
    let (topology, tube) = common::random_tube(8, 9, 1, 0.01, 7);
    let mut poses = Poses::new(tube.vertex_count());
    poses.push(tube.frame(0));
    let placement = Placement { heading: 2.5, translation: glam::Vec2::new(4.0, -3.0) };
    poses.push(&tube.frame(0).iter().map(|&p| placement.apply(p)).collect::<Vec<_>>());
    poses.push(&tube.frame(0).iter().map(|&p| p * 1.5).collect::<Vec<_>>());
    let matrix = distances(&topology, &poses, &DistanceOptions::default());
    assert!(matrix.get(0, 1) < 2e-6, "{}", matrix.get(0, 1));
    // Scaling by 1.5: no rotation, two singular values of 1.5 in the plane.
    let scaled = 0.01 * 2.0_f32.sqrt() * 1.5_f32.ln();
    assert!((matrix.get(0, 2) - scaled).abs() < 1e-6, "{} against {scaled}", matrix.get(0, 2));
}

#[test]
fn is_symmetric_with_zero_diagonal() {
    let (topology, poses) = common::random_tube(7, 8, 70, 0.05, 11);
    let matrix = distances(&topology, &poses, &DistanceOptions::default());
    for i in 0..70 {
        assert_eq!(matrix.get(i, i), 0.0);
        for j in 0..70 {
            assert_eq!(matrix.get(i, j), matrix.get(j, i));
            assert!(i == j || matrix.get(i, j) > 0.0);
        }
    }
}

#[test]
fn threads_do_not_change_a_bit() {
    let (topology, poses) = common::random_tube(12, 13, 100, 0.05, 5);
    let with_threads = |count| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap();
        pool.install(|| distances(&topology, &poses, &DistanceOptions::default()))
    };
    assert_eq!(with_threads(1), with_threads(3));
}

#[test]
fn euclidean_residual_is_that_of_the_aligned_poses() {
    let (topology, poses) = common::random_tube(9, 11, 12, 0.05, 3);
    let options = DistanceOptions { kind: DistanceKind::Euclidean, ..Default::default() };
    let matrix = distances(&topology, &poses, &options);
    for (i, j) in [(0_u32, 1_u32), (3, 9), (11, 2), (5, 6)] {
        let (a, b, weights) = (poses.frame(i), poses.frame(j), topology.weights());
        let heading = align_heading(a, b, weights);
        let (from, to) = (centre_of_mass(b, weights), centre_of_mass(a, weights));
        let placement = Placement::turning(heading, glam::Vec2::new(from.x, from.z), glam::Vec2::new(to.x, to.z));
        let want: f32 = (0..a.len()).map(|v| weights[v] * a[v].distance_squared(placement.apply(b[v]))).sum();
        let found = matrix.get(i as usize, j as usize);
        assert!((found - want).abs() < 1e-5 * (1.0 + want), "{found} against {want}");
        assert!(rotate(heading, glam::Vec2::X).is_finite());
    }
}

#[test]
fn degenerate_triangles_are_left_out() {
    let (topology, poses) = common::random_tube(6, 7, 5, 0.02, 9);
    let matrix = distances(&topology, &poses, &DistanceOptions::default());
    let mut triangles = topology.triangles().to_vec();
    triangles.extend([[3, 3, 5], [1, 2, 2]]);
    let padded = Topology::new(topology.vertex_count() as u32, triangles, topology.weights().to_vec()).unwrap();
    assert_eq!(distances(&padded, &poses, &DistanceOptions::default()), matrix);
    let collapsed =
        Topology::new(topology.vertex_count() as u32, vec![[3, 3, 5]], topology.weights().to_vec()).unwrap();
    let refused = pose_distances(&collapsed, &poses, &DistanceOptions::default(), &Job::silent());
    assert!(refused.is_err());
}
