//! Poisson interpolation against a plain solution in double precision.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests fail as tests do")]

mod common;

use common::exact::{Exact, volume};
use common::meshes::{bent, together, tube};
use common::{aligned, largest_difference};
use fixtures::Random;
use fixtures::captured;
use glam::{DVec3, Quat, Vec3};
use kernels::cholesky::CholeskyError;
use kernels::poisson::{Effort, GUARANTEE, KeyedPose, PoissonInterpolator};
use kernels::topology::Topology;

fn keyed(frame: u32, pose: &[Vec3]) -> KeyedPose<'_> {
    KeyedPose { frame, pose }
}

/// Interpolates, and holds the result against the exact solution; the largest error in metres.
#[track_caller]
fn check(
    interpolator: &mut PoissonInterpolator,
    topology: &Topology,
    source: KeyedPose<'_>,
    destination: KeyedPose<'_>,
    lambda: f32,
) -> (Vec<Vec3>, Effort) {
    let mut out = vec![Vec3::ZERO; topology.vertex_count()];
    let effort = interpolator.interpolate(source, destination, lambda, &mut out).unwrap();
    let truth = Exact::new(topology).interpolate(source.pose, destination.pose, f64::from(lambda));
    let error = largest_difference(&out, &truth.blended);
    assert!(error < f64::from(GUARANTEE), "lambda {lambda}: {error:.2e} m off, {effort:?}");
    (out, effort)
}

#[test]
#[ignore = "reads ../shared/data"]
fn a_captured_kick_keeps_its_volume() {
    let (topology, poses) = captured("crane", &[0, 120]);
    let destination = aligned(&topology, &poses[0], &poses[1]);
    let mut interpolator = PoissonInterpolator::new(&topology, None).unwrap();
    let volume_of = |pose: &[Vec3]| volume(&topology, &pose.iter().map(|v| v.as_dvec3()).collect::<Vec<_>>());
    let mut out = vec![Vec3::ZERO; topology.vertex_count()];
    for (lambda, expected) in [(0.0, &poses[0]), (1.0, &destination)] {
        interpolator.interpolate(keyed(0, &poses[0]), keyed(120, &destination), lambda, &mut out).unwrap();
        assert!(out.iter().zip(expected).all(|(a, b)| a.distance(*b) <= 1e-6));
    }
    // Nearly there is nearly the same: the ends are met by solving, too.
    for (lambda, expected) in [(1e-6, &poses[0]), (1.0 - 1e-6, &destination)] {
        interpolator.interpolate(keyed(0, &poses[0]), keyed(120, &destination), lambda, &mut out).unwrap();
        let worst = out.iter().zip(expected).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
        assert!(worst < 2e-5, "{worst}");
    }
    let (middle, _) = check(&mut interpolator, &topology, keyed(0, &poses[0]), keyed(120, &destination), 0.5);
    // Thesis figure 2.8, in numbers: a linear blend loses a tenth.
    let [start, end, between] = [&poses[0], &destination, &middle].map(|pose| volume_of(pose));
    assert!((start - 0.109).abs() < 1e-3 && (end - 0.102).abs() < 1e-3, "{start} {end}");
    assert!((between - 0.105).abs() < 1e-3, "{between}");
    let linear: Vec<Vec3> = poses[0].iter().zip(&destination).map(|(a, b)| a.lerp(*b, 0.5)).collect();
    assert!((volume_of(&linear) - 0.093).abs() < 1e-3, "{}", volume_of(&linear));
    let truth = Exact::new(&topology).interpolate(&poses[0], &destination, 0.5);
    assert!(truth.sides_differ < 6e-3, "{}", truth.sides_differ);
}

#[test]
#[ignore = "reads ../shared/data"]
fn captured_frames_warm_cold_and_far_from_any_factor() {
    let frames: Vec<usize> = (0..9).map(|k| 15 * k).collect();
    let (topology, crane) = captured("crane", &frames);
    let (_, jumping) = captured("jumping", &(40..49).collect::<Vec<_>>());
    let mut interpolator = PoissonInterpolator::new(&topology, None).unwrap();
    // Poses that follow each other closely on one side and hardly at all on the other.
    for k in 0..9 {
        let destination = aligned(&topology, &crane[k], &jumping[k]);
        let lambda = (k + 1) as f32 / 10.0;
        let (frame, other) = (15 * k as u32, 215 + k as u32);
        let (_, effort) =
            check(&mut interpolator, &topology, keyed(frame, &crane[k]), keyed(other, &destination), lambda);
        println!("{k}: {effort:?}");
        assert_eq!(effort.regularised, 0);
    }
}

#[test]
fn bent_tubes_of_several_components() {
    for seed in 0..6 {
        let mut random = Random::new(seed);
        let parts = [tube(12, 9), tube(5, 5), tube(3, 4)];
        let (topology, points) = together(&parts, 2);
        let mut interpolator = PoissonInterpolator::new(&topology, None).unwrap();
        let source = bent(&points, 0.4 + random.signed().abs(), random.signed(), 0.01, &mut random);
        for frame in 0..4 {
            let bend = if seed == 5 { 6.0 } else { 2.0 * random.signed() };
            let destination = bent(&points, bend, 2.0 * random.signed(), 0.01, &mut random);
            let lambda = 0.5 + 0.45 * random.signed();
            check(&mut interpolator, &topology, keyed(0, &source), keyed(1 + frame, &destination), lambda);
        }
    }
}

#[test]
fn rigid_motion_in_gives_rigid_motion_out() {
    let mut random = Random::new(7);
    let (topology, points) = together(&[tube(10, 8)], 0);
    let source = bent(&points, 0.8, 0.5, 0.01, &mut random);
    let axis = Vec3::new(0.3, 1.0, -0.2).normalize();
    let centre = |pose: &[Vec3]| pose.iter().zip(topology.weights()).map(|(p, &w)| *p * w).sum::<Vec3>();
    let (c, shift) = (centre(&source), Vec3::new(0.4, -0.3, 0.2));
    let turned = |angle: f32, shift: Vec3| -> Vec<Vec3> {
        source.iter().map(|p| Quat::from_axis_angle(axis, angle) * (*p - c) + c + shift).collect()
    };
    // Up to nearly half a turn; the short way round beyond it.
    for (angle, way) in [(0.5, 0.5), (2.0, 2.0), (3.1, 3.1), (3.5, 3.5 - std::f32::consts::TAU)] {
        let mut interpolator = PoissonInterpolator::new(&topology, None).unwrap();
        let destination = turned(angle, shift);
        let mut out = vec![Vec3::ZERO; topology.vertex_count()];
        for lambda in [0.25, 0.5, 0.9] {
            interpolator.interpolate(keyed(0, &source), keyed(1, &destination), lambda, &mut out).unwrap();
            let expected: Vec<DVec3> = turned(way * lambda, shift * lambda).iter().map(|p| p.as_dvec3()).collect();
            let error = largest_difference(&out, &expected);
            assert!(error < 2e-5, "{angle} at {lambda}: {error}");
        }
    }
}

#[test]
fn degenerate_triangles_do_no_harm() {
    let (points, mut triangles) = tube(8, 7);
    let n = points.len() as u32;
    // A point, a line on an edge, and a vertex held by nothing but a line.
    triangles.extend([[3, 3, 3], [4, 5, 4], [10, 11, n]]);
    let mut points = points;
    points.push(points[10]);
    let (topology, points) = together(&[(points, triangles)], 0);
    let mut random = Random::new(3);
    let destination = bent(&points, 1.2, 0.8, 0.0, &mut random);
    let mut interpolator = PoissonInterpolator::new(&topology, None).unwrap();
    let mut out = vec![Vec3::ZERO; topology.vertex_count()];
    let (source, destination) = (keyed(0, &points), keyed(1, &destination));
    let effort = interpolator.interpolate(source, destination, 0.5, &mut out).unwrap();
    assert!(effort.regularised > 0, "the loose vertex leaves the Laplacian singular");
    assert!(out.iter().all(|p| p.is_finite() && p.length() < 4.0));
    // Without the useless triangles and the vertex the rest comes out the same.
    let plain = topology.triangles()[..topology.triangles().len() - 3].to_vec();
    let mut weights = topology.weights().to_vec();
    assert!(weights.pop().unwrap() < 1e-9);
    let plain = Topology::new(n, plain, weights).unwrap();
    let truth = Exact::new(&plain).interpolate(&points[..n as usize], &destination.pose[..n as usize], 0.5);
    let error = largest_difference(&out[..n as usize], &truth.blended);
    assert!(error < f64::from(GUARANTEE), "{error}");
}

#[test]
fn needles_do_no_harm() {
    let (mut points, triangles) = tube(8, 7);
    // One vertex all but on the edge of its neighbours: triangles of a height of a micrometre.
    points[20] = (points[19] + points[21]) / 2.0 + Vec3::new(1e-6, 0.0, 0.0);
    let (topology, points) = together(&[(points, triangles)], 0);
    let destination = bent(&points, 1.2, 0.8, 0.0, &mut Random::new(3));
    let mut interpolator = PoissonInterpolator::new(&topology, None).unwrap();
    let mut out = vec![Vec3::ZERO; topology.vertex_count()];
    for lambda in [1e-5, 0.5, 1.0 - 1e-5] {
        interpolator.interpolate(keyed(0, &points), keyed(1, &destination), lambda, &mut out).unwrap();
        let blend = points.iter().zip(&destination).map(|(a, b)| a.lerp(*b, lambda));
        let most = out.iter().zip(blend).map(|(a, b)| a.distance(b)).fold(0.0, f32::max);
        let allowed = if lambda == 0.5 { 0.4 } else { 1e-4 };
        assert!(most < allowed, "{lambda}: {most}");
    }
}

#[test]
fn orders_are_exported_taken_back_and_checked() {
    let (topology, points) = together(&[tube(9, 8), tube(4, 5)], 1);
    let mut random = Random::new(11);
    let destination = bent(&points, 1.0, 1.0, 0.01, &mut random);
    let own = PoissonInterpolator::new(&topology, None).unwrap();
    let again = PoissonInterpolator::new(&topology, Some(own.elimination_order())).unwrap();
    assert_eq!(own.elimination_order(), again.elimination_order());
    // Any order that is one will do.
    let n = topology.vertex_count() as u32;
    let mut shuffled: Vec<u32> = (0..n).collect();
    for k in (1..n as usize).rev() {
        shuffled.swap(k, ((random.signed().abs() * k as f32) as usize).min(k));
    }
    let mut interpolator = PoissonInterpolator::new(&topology, Some(&shuffled)).unwrap();
    check(&mut interpolator, &topology, keyed(0, &points), keyed(1, &destination), 0.4);
    let refused = |order: &[u32]| PoissonInterpolator::new(&topology, Some(order)).err();
    let error = Some(CholeskyError::Order(n as usize));
    assert_eq!(refused(&shuffled[1..]), error);
    assert_eq!(refused(&[]), error);
    shuffled[0] = shuffled[1];
    assert_eq!(refused(&shuffled), error);
    shuffled[0] = n;
    assert_eq!(refused(&shuffled), error);
}

#[test]
fn what_is_not_finite_is_an_error_and_does_not_linger() {
    let (topology, points) = together(&[tube(6, 6)], 0);
    let destination = bent(&points, 1.0, 1.0, 0.01, &mut Random::new(1));
    let mut broken = points.clone();
    broken[7].x = f32::NAN;
    let mut interpolator = PoissonInterpolator::new(&topology, None).unwrap();
    let mut out = vec![Vec3::ZERO; topology.vertex_count()];
    assert!(interpolator.interpolate(keyed(0, &broken), keyed(1, &destination), 0.5, &mut out).is_err());
    check(&mut interpolator, &topology, keyed(2, &points), keyed(1, &destination), 0.5);
}
