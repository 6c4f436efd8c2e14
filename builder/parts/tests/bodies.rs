//! Parts of the performer's figures against their skeletons, and of captured and animated bodies.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use actor::capture::Poses;
use fixtures::crane_and_jumping;
use glam::Vec3;
use kernels::topology::{Topology, barycentric_areas};
use parts::{Parts, Shape, shape_of};
use performer::Kind;
use performer::figure::Figure;
use performer::perform::{perform, takes};
use performer::skeleton::joint;

/// A figure and some frames of all its takes.
fn performed(kind: Kind, vertices: usize) -> (Figure, Topology, Poses) {
    let figure = Figure::of(kind, vertices, 128);
    let mut poses = Poses::new(figure.mesh.positions.len());
    for take in takes(150, 12.0, 1) {
        perform(&figure, &take, 12.0).iter().step_by(3).for_each(|frame| poses.push(&frame.positions));
    }
    let weights = barycentric_areas(&figure.mesh.triangles, poses.frame(0));
    let topology = Topology::new(poses.vertex_count() as u32, figure.mesh.triangles.clone(), weights).unwrap();
    (figure, topology, poses)
}

/// For each vertex the part that the skeleton says: 0 the torso, then arms and legs, left and right.
fn truth(figure: &Figure) -> Vec<usize> {
    let part = |index: usize| match index {
        _ if (joint::ARM[0] + 1..joint::ARM[1]).contains(&index) => 1,
        _ if (joint::ARM[1] + 1..joint::LEG[0]).contains(&index) => 2,
        _ if (joint::LEG[0]..joint::LEG[1]).contains(&index) => 3,
        _ if (joint::LEG[1]..joint::TAIL).contains(&index) => 4,
        _ => 0,
    };
    let shares = figure.skirt.shares(figure.mesh.positions.len());
    let of = |(vertex, influences): (usize, &rig::Influences)| {
        let mut sums = [0.0; 5];
        influences.joints.iter().zip(&influences.weights).for_each(|(&j, w)| sums[part(j as usize)] += w);
        // Cloth that swings belongs to the torso.
        if shares[vertex] > 0.5 { 0 } else { (0..5).max_by(|&a, &b| f32::total_cmp(&sums[a], &sums[b])).unwrap() }
    };
    figure.influences.iter().enumerate().map(of).collect()
}

/// Shared area over joined area of each part of the truth and the part that is most like it.
fn agreements(parts: &Parts, truth: &[usize], areas: &[f32]) -> [f32; 5] {
    std::array::from_fn(|wanted| {
        let agreement = |part: usize| {
            let (mut both, mut either) = (0.0, 0.0);
            for (vertex, area) in areas.iter().enumerate() {
                let [a, b] = [truth[vertex] == wanted, parts.weights(part)[vertex] > 0.5];
                both += if a && b { *area } else { 0.0 };
                either += if a || b { *area } else { 0.0 };
            }
            both / either
        };
        (0..parts.count()).map(agreement).fold(0.0, f32::max)
    })
}

/// The names that parts are given whose ends are those of the skeleton's left arm, right arm, left leg and right leg.
fn sides(parts: &Parts, truth: &[usize], poses: &Poses) -> [String; 4] {
    let names = parts.names(poses);
    assert_eq!((names.len(), names[0].as_str()), (parts.count(), "torso"));
    std::array::from_fn(|wanted| {
        let limb = parts.limbs.iter().position(|limb| truth[limb.tip as usize] == wanted + 1).unwrap();
        names[limb + 1].clone()
    })
}

fn check_bands(parts: &Parts, triangles: &[[u32; 3]]) {
    for limb in &parts.limbs {
        assert!(limb.is_disc, "the limb at {}", limb.tip);
        let within = |low: f32, high: f32| -> Vec<[u32; 3]> {
            let inside = |&v: &u32| limb.weights[v as usize] > low && limb.weights[v as usize] < high;
            triangles.iter().filter(|corners| corners.iter().all(inside)).copied().collect()
        };
        assert_eq!(shape_of(&within(0.0, 2.0)), Shape::DISC);
        assert_eq!(shape_of(&within(0.0, 1.0)), Shape::CYLINDER);
    }
    for vertex in 0..parts.torso.len() {
        let sum: f32 = (0..parts.count()).map(|part| parts.weights(part)[vertex]).sum();
        assert!((sum - 1.0).abs() < 1e-5);
    }
}

#[test]
fn the_figures_parts_are_those_of_their_skeletons() {
    // In trousers the hips above the crotch stay with the torso; under a skirt nobody sees them.
    for (kind, vertices, torso) in [(Kind::Woman, 2667, 0.85), (Kind::Man, 3500, 0.72), (Kind::Child, 3000, 0.72)] {
        let (figure, topology, poses) = performed(kind, vertices);
        let parts = Parts::find(&topology, &poses);
        assert_eq!((parts.limbs.len(), parts.head.is_some()), (4, true), "{kind:?}");
        let found = agreements(&parts, &truth(&figure), &barycentric_areas(topology.triangles(), poses.frame(0)));
        println!("{kind:?} {vertices}: {found:.3?}");
        let [arms, legs] = [found[1].min(found[2]), found[3].min(found[4])];
        assert_eq!(sides(&parts, &truth(&figure), &poses), ["left arm", "right arm", "left leg", "right leg"]);
        assert!(found[0] >= torso && arms >= 0.8 && legs >= 0.7, "{kind:?}: {found:?}");
        check_bands(&parts, topology.triangles());
    }
}

#[test]
fn painted_parts_are_as_painted_and_overlap() {
    let (figure, topology, poses) = performed(Kind::Man, 2000);
    let truth = truth(&figure);
    // Any numbers will do; the lowest is the torso's. Hands are parts of their own, beside arms.
    let height = |v: usize| poses.frame(0)[v].y;
    let lowest = (0..truth.len()).filter(|&v| truth[v] == 1).map(height).fold(f32::INFINITY, f32::min);
    let hand = |v: usize| truth[v] == 1 && height(v) < lowest + 0.2;
    let numbers: Vec<u8> = (0..truth.len()).map(|v| if hand(v) { 90 } else { 7 + 3 * truth[v] as u8 }).collect();
    let parts = Parts::of_painted(&topology, &poses, &numbers);
    assert_eq!(parts.painted, [7, 10, 13, 16, 19, 90]);
    assert_eq!(parts.count(), 6);
    assert_eq!(parts.names(&poses)[5], "part 90");
    for (vertex, number) in numbers.iter().enumerate() {
        let weights: Vec<f32> = (0..6).map(|part| parts.weights(part)[vertex]).collect();
        assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-5 && weights.iter().all(|w| *w >= 0.0));
        assert_eq!(parts.painted[parts.of_vertices()[vertex]], *number, "{vertex}: {weights:?}");
    }
    // A hand's band is shared with its arm alone, and the hand is a disc.
    let hand = &parts.limbs[4];
    assert!(hand.is_disc, "{:?}", hand.shapes(topology.triangles()));
    let shared = hand.weights.iter().zip(&parts.limbs[0].weights).filter(|(hand, _)| **hand > 0.0 && **hand < 1.0);
    assert!(shared.clone().count() > 10);
    shared.for_each(|(hand, arm)| assert!((hand + arm - 1.0).abs() < 1e-5));

    let one = Parts::of_painted(&topology, &poses, &vec![3; truth.len()]);
    assert!(one.limbs.is_empty() && one.torso.iter().all(|w| *w == 1.0));
    assert_eq!(Parts::of_painted(&topology, &poses, &[1, 2]).count(), 1);
}

#[test]
fn what_has_no_limbs_is_one_part() {
    let ring = |k: u32| (0..12).map(move |j| (k, j)).collect::<Vec<_>>();
    let at = |(k, j): (u32, u32)| {
        let [a, b] = [k as f32 * 0.25, j as f32 * std::f32::consts::TAU / 12.0];
        Vec3::new(a.sin() * b.cos(), a.cos(), a.sin() * b.sin())
    };
    let pose: Vec<Vec3> = (1..12).flat_map(ring).map(at).collect();
    let triangles = (0..10_u32)
        .flat_map(|k| {
            (0..12).flat_map(move |j| {
                let (a, b) = (12 * k + j, 12 * k + (j + 1) % 12);
                [[a, b, a + 12], [b, b + 12, a + 12]]
            })
        })
        .collect();
    let topology = Topology::new(132, triangles, vec![1.0; 132]).unwrap();
    let ball = Poses::from_positions(132, pose.repeat(3));
    let parts = Parts::find(&topology, &ball);
    assert!(parts.limbs.len() < 3 && parts.torso.iter().all(|w| w.is_finite()), "{}", parts.limbs.len());
    assert_eq!(Parts::whole(132).count(), 1);
    assert_eq!(Parts::whole(132).names(&ball), ["torso"]);
}

#[test]
#[ignore = "reads ../shared/data"]
fn captured_bodies_have_five_parts() {
    let both = crane_and_jumping(6);
    for sequence in both.timeline.sequences() {
        let mut poses = Poses::new(both.poses.vertex_count());
        (sequence.first_frame..sequence.end_frame()).for_each(|frame| poses.push(both.poses.frame(frame)));
        let parts = Parts::find(&both.topology, &poses);
        let mut names = parts.names(&poses);
        names.sort();
        assert_eq!(names, ["left arm", "left leg", "right arm", "right leg", "torso"]);
        println!(
            "{}: {:?}",
            sequence.name,
            parts.limbs.iter().map(|l| (l.tip, l.hinge, l.is_disc)).collect::<Vec<_>>()
        );
        assert_eq!((parts.limbs.len(), parts.head.is_some()), (4, true), "{}", sequence.name);
        check_bands(&parts, both.topology.triangles());
    }
}
