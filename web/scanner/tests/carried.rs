//! What carries each point of a scan.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use actor::carry::Surface;
use glam::Vec3;
use scanner::carried::carried;

/// A sheet of `n` by `n` squares at height `y`, facing up or down.
fn sheet(n: u32, y: f32, up: bool, triangles: &mut Vec<[u32; 3]>, pose: &mut Vec<Vec3>) {
    let first = pose.len() as u32;
    for x in 0..=n {
        for z in 0..=n {
            pose.push(Vec3::new(x as f32 / n as f32, y, z as f32 / n as f32));
        }
    }
    for x in 0..n {
        for z in 0..n {
            let corner = |dx: u32, dz: u32| first + (x + dx) * (n + 1) + z + dz;
            for [a, b, c] in [[corner(0, 0), corner(0, 1), corner(1, 0)], [corner(1, 0), corner(0, 1), corner(1, 1)]] {
                triangles.push(if up { [a, b, c] } else { [a, c, b] });
            }
        }
    }
}

#[test]
fn each_point_is_carried_from_the_nearest_point_of_the_mesh() {
    let (mut triangles, mut pose) = (Vec::new(), Vec::new());
    sheet(20, 0.0, true, &mut triangles, &mut pose);
    let points =
        [Vec3::new(0.37, 0.01, 0.71), Vec3::new(0.5, -0.3, 0.5), Vec3::new(3.0, 0.0, 0.2), Vec3::new(-0.2, 1.0, 2.0)];
    let carried = carried(&triangles, &pose, &points, &[Vec3::Y; 4]);
    let surface = Surface::new(&triangles, &pose);
    for (point, one) in points.iter().zip(&carried) {
        assert!(surface.place(one).unwrap().distance(*point) < 1e-6);
        // No triangle is nearer than the one that carries it, among all.
        let far = Vec3::from_array(one.offset).length();
        let nearest = point.clamp(Vec3::ZERO, Vec3::new(1.0, 0.0, 1.0)).distance(*point);
        assert!((far - nearest).abs() < 1e-5, "{point}: {far} and {nearest}");
    }
}

#[test]
fn of_two_sides_the_one_that_faces_as_the_point_does_carries_it() {
    let (mut triangles, mut pose) = (Vec::new(), Vec::new());
    sheet(8, 0.0, true, &mut triangles, &mut pose);
    let above = triangles.len() as u32;
    sheet(8, -0.01, false, &mut triangles, &mut pose);
    // Both points are nearer to the upper side.
    let points = [Vec3::new(0.4, -0.004, 0.6); 2];
    let found = carried(&triangles, &pose, &points, &[Vec3::Y, Vec3::NEG_Y]);
    assert!(found[0].triangle < above && found[1].triangle >= above, "{found:?}");
}

#[test]
fn nothing_carries_nothing() {
    assert!(carried(&[], &[], &[Vec3::X], &[Vec3::Y]).is_empty());
    assert!(carried(&[[0, 1, 2]], &[Vec3::ZERO; 3], &[Vec3::X], &[Vec3::Y]).is_empty());
    let flat = [Vec3::ZERO, Vec3::X, 2.0 * Vec3::X];
    assert_eq!(carried(&[[0, 1, 2]], &flat, &[Vec3::new(1.5, 0.1, 0.0)], &[Vec3::Y]).len(), 1);
    // A triangle without its vertices is none.
    assert!(carried(&[[0, 1, 9]], &flat, &[Vec3::X], &[Vec3::Y]).is_empty());
}

#[test]
fn what_is_damaged_is_given_up() {
    // All triangles as large as the body: every one is looked at for each point.
    let pose = [Vec3::ZERO, Vec3::new(1.0, 1.0, 0.0), Vec3::new(0.0, 1.0, 1.0)];
    let triangles = vec![[0, 1, 2]; 20_000];
    assert!(carried(&triangles, &pose, &vec![Vec3::X; 5000], &vec![Vec3::Y; 5000]).is_empty());
    assert_eq!(carried(&triangles, &pose, &[Vec3::X; 5], &[Vec3::Y; 5]).len(), 5);
}
