//! Deformation gradients against 3x3 singular value decompositions in double precision.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests fail as tests do")]

mod common;

use common::exact;
use fixtures::Random;
use glam::{DVec3, Vec3};
use kernels::gradients::{PairGradients, TriangleBatches};

fn triangle(random: &mut Random) -> [Vec3; 3] {
    loop {
        let [a, b, c] = [random.vector(), random.vector(), random.vector()];
        let (e, f) = (b - a, c - a);
        if e.cross(f).length() > 0.05 {
            return [a, b, c];
        }
    }
}

fn edges(t: [Vec3; 3]) -> [DVec3; 2] {
    [(t[1] - t[0]).as_dvec3(), (t[2] - t[0]).as_dvec3()]
}

#[test]
fn wanted_edges_match_the_polar_decomposition_from_both_sides() {
    let mut random = Random::new(1);
    let pairs: Vec<_> = (0..2003).map(|_| (triangle(&mut random), triangle(&mut random))).collect();
    let corners: Vec<[u32; 3]> = (0..pairs.len() as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let source: Vec<Vec3> = pairs.iter().flat_map(|pair| pair.0).collect();
    let destination: Vec<Vec3> = pairs.iter().flat_map(|pair| pair.1).collect();
    let mut gradients = PairGradients::default();
    gradients.set(&TriangleBatches::new(&corners), &source, &destination);
    for (k, &(i, j)) in pairs.iter().enumerate() {
        let (to, back) = (i.map(|v| v.as_dvec3()), j.map(|v| v.as_dvec3()));
        let (rotation, ..) = exact::polar(to, back);
        let cosine = (rotation.x_axis.x + rotation.y_axis.y + rotation.z_axis.z - 1.0) / 2.0;
        let angle = cosine.clamp(-1.0, 1.0).acos();
        assert!((f64::from(gradients.rotation_angle(k)) - angle).abs() < 2e-3, "{k}: {angle}");
        // Within a thousandth of half a turn, single precision may take the other way round.
        if angle > std::f64::consts::PI - 1e-3 {
            continue;
        }
        for lambda in [0.0, 0.1, 0.5, 0.77, 1.0] {
            let found = gradients.triangle_edges(k, lambda as f32).map(|e| e.as_dvec3());
            let forth = exact::gradient(to, back, lambda);
            // Thesis section 2.4.3 deforms the destination by its own gradient, 1 - lambda of the way back.
            let other = exact::gradient(back, to, 1.0 - lambda);
            for ((found, from), to) in found.iter().zip(edges(i)).zip(edges(j)) {
                let error = found.distance(forth * from).max(found.distance(other * to));
                assert!(error < 2e-5, "triangle {k} at {lambda}: {error:.1e}, angle {angle}");
            }
        }
    }
}

#[test]
fn half_turns_stay_rotations() {
    let source = [Vec3::ZERO, Vec3::X, Vec3::Z];
    // Half a turn about X flips the normal.
    let destination = [Vec3::ZERO, Vec3::X, -Vec3::Z];
    let mut gradients = PairGradients::default();
    gradients.set(&TriangleBatches::new(&[[0, 1, 2]]), &source, &destination);
    assert!((gradients.rotation_angle(0) - std::f32::consts::PI).abs() < 1e-5);
    let [first, second] = gradients.triangle_edges(0, 0.5);
    assert!(first.distance(Vec3::X) < 1e-6);
    assert!((second.length() - 1.0).abs() < 1e-6 && second.x.abs() < 1e-6 && second.z.abs() < 1e-6, "{second}");
}

#[test]
fn triangles_without_a_normal_blend_linearly() {
    let source = [Vec3::ZERO, Vec3::X, 0.5 * Vec3::X];
    let destination = [Vec3::ZERO, Vec3::Y, Vec3::Z];
    let mut gradients = PairGradients::default();
    gradients.set(&TriangleBatches::new(&[[0, 1, 2], [0, 0, 1]]), &source, &destination);
    let [first, second] = gradients.triangle_edges(0, 0.25);
    assert!(first.distance(Vec3::new(0.75, 0.25, 0.0)) < 1e-6);
    assert!(second.distance(Vec3::new(0.375, 0.0, 0.25)) < 1e-6);
    assert_eq!(gradients.rotation_angle(0), 0.0);
    assert!(gradients.triangle_edges(1, 0.25).iter().all(|e| e.is_finite()));
}
