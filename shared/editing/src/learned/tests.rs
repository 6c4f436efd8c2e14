//! Against a plain version: all unknowns in one dense system of least squares.
use kernels::random::signed;
use kernels::topology::Topology;

use super::*;
use crate::descent::Descent;

const COUNT: usize = 24;

/// A ribbon that is bent and crumpled, and modes of it.
fn scene(seed: u64, modes: usize) -> (Topology, Vec<Vec3>, Vec<Vec<Vec3>>) {
    let triangles =
        (0..COUNT as u32 / 2 - 1).flat_map(|k| [[2 * k, 2 * k + 2, 2 * k + 1], [2 * k + 1, 2 * k + 2, 2 * k + 3]]);
    let topology = Topology::new(COUNT as u32, triangles.collect(), vec![1.0; COUNT]).unwrap();
    let noise = |salt: u64, v: usize| {
        Vec3::new(
            signed(seed + salt, 3 * v as u64),
            signed(seed + salt, 3 * v as u64 + 1),
            signed(seed + salt, 3 * v as u64 + 2),
        )
    };
    let pose =
        (0..COUNT).map(|v| Vec3::new((v / 2) as f32 * 0.1, (v % 2) as f32 * 0.1, 0.0) + 0.02 * noise(1, v)).collect();
    let mode = |k: usize| (0..COUNT).map(|v| 0.2 * noise(100 + k as u64, v)).collect();
    (topology, pose, (0..modes).map(mode).collect())
}

/// Ready for drags.
fn prepared(
    deformer: &mut Deformer,
    held: &Held,
    pose: &[Vec3],
    modes: (Vec<Vec<Vec3>>, Vec<f64>),
    prior: f64,
) -> Learned {
    let mut learned = Learned::new(held, pose.len(), modes, prior);
    learned.prepare(deformer, held, pose).unwrap();
    learned
}

/// Dragged until it is at rest.
fn settled(
    learned: &mut Learned,
    deformer: &mut Deformer,
    held: &Held,
    asked: (&[Vec3], &[Vec3]),
) -> Result<Vec<Vec3>, CholeskyError> {
    let mut descent = Descent::new(learned, COUNT);
    loop {
        if let Some(rest) = descent.step(learned, deformer, held, asked)? {
            return Ok(rest);
        }
    }
}

/// The x and r that the energy is least for, with these rotations: the normal equations of all of them.
fn plain(
    deformer: &Deformer,
    held: &Held,
    pose: &[Vec3],
    (modes, variances): (&[Vec<Vec3>], &[f64]),
    turns: &[Quat],
    wanted: &[Vec3],
) -> Vec<Vec3> {
    let free: Vec<usize> = (0..COUNT).filter(|&v| !held.vertices().contains(&(v as u32))).collect();
    let size = 3 * free.len() + modes.len();
    let (mut matrix, mut right) = (vec![0.0; size * size], vec![0.0; size]);
    let mut row = |entries: &[(usize, f64)], constant: f64, weight: f64| {
        for &(a, x) in entries {
            right[a] -= weight * x * constant;
            entries.iter().for_each(|&(b, y)| matrix[a * size + b] += weight * x * y);
        }
    };
    let place = |v: usize| free.iter().position(|&own| own == v);
    let known = |v: usize| {
        let at = held.vertices().iter().position(|&own| own as usize == v);
        at.map_or(Vec3::ZERO, |at| pose[v] + wanted[at])
    };
    let mut residual = |ends: &[(usize, f64)], rest: Vec3, of_modes: &[Vec3], weight: f64| {
        for axis in 0..3 {
            let mut entries: Vec<(usize, f64)> =
                ends.iter().filter_map(|&(v, sign)| Some((3 * place(v)? + axis, sign))).collect();
            let constant: f64 = ends.iter().map(|&(v, sign)| sign * f64::from(known(v)[axis])).sum();
            entries.extend(of_modes.iter().enumerate().map(|(k, mode)| (3 * free.len() + k, -f64::from(mode[axis]))));
            row(&entries, constant - f64::from(rest[axis]), weight);
        }
    };
    for (&[i, j], &weight) in deformer.edges().iter().zip(held.weights()) {
        let (i, j) = (i as usize, j as usize);
        let turned = |edge: Vec3| 0.5 * (turns[i] * edge + turns[j] * edge);
        let of_modes: Vec<Vec3> = modes.iter().map(|mode| turned(mode[i] - mode[j])).collect();
        residual(&[(i, 1.0), (j, -1.0)], turned(pose[i] - pose[j]), &of_modes, f64::from(weight));
    }
    for v in 0..COUNT {
        let of_modes: Vec<Vec3> = modes.iter().map(|mode| mode[v]).collect();
        residual(&[(v, 1.0)], pose[v], &of_modes, f64::from(held.anchor()));
    }
    for (k, variance) in variances.iter().enumerate() {
        let at = 3 * free.len() + k;
        matrix[at * size + at] += PRIOR / variance;
    }
    let found = solve_dense(&matrix, &right, 0.0).unwrap();
    let at = |v: usize| match place(v) {
        Some(at) => Vec3::new(found[3 * at] as f32, found[3 * at + 1] as f32, found[3 * at + 2] as f32),
        None => known(v),
    };
    (0..COUNT).map(at).collect()
}

#[test]
fn it_is_what_one_large_system_gives_with_and_without_rotations() {
    for seed in 0..6 {
        let (topology, pose, modes) = scene(1000 * seed, 5);
        let variances = [0.4, 0.2, 0.1, 0.05, 0.01];
        let mut deformer = Deformer::new(&topology, None).unwrap();
        let held = deformer.hold(&pose, &[0, 1, 22, 13], 1e-2).unwrap();
        let wanted = [Vec3::ZERO, Vec3::ZERO, Vec3::new(0.1, 0.2, -0.15), Vec3::new(-0.05, 0.0, 0.1)];
        let mut learned = prepared(&mut deformer, &held, &pose, (modes.clone(), variances.to_vec()), PRIOR);
        for _ in 0..3 {
            let turns = learned.turns().to_vec();
            let wanted_pose = plain(&deformer, &held, &pose, (&modes, &variances), &turns, &wanted);
            let moved = learned.iterate(&mut deformer, &held, &pose, &wanted, true).unwrap();
            for v in 0..COUNT {
                let off = (pose[v] + moved[v]).distance(wanted_pose[v]);
                assert!(off < 2e-4, "seed {seed}, vertex {v}: {off}");
            }
            assert_ne!(turns, learned.turns(), "nothing turned");
            learned.prepare(&mut deformer, &held, &pose).unwrap();
        }
    }
}

#[test]
fn what_is_held_is_met_and_nothing_wanted_is_nothing_moved() {
    let (topology, pose, modes) = scene(5, 7);
    let variances = [0.3; 7];
    let mut deformer = Deformer::new(&topology, None).unwrap();
    let held = deformer.hold(&pose, &[2, 3, 23], 1e-4).unwrap();
    let mut learned = prepared(&mut deformer, &held, &pose, (modes, variances.to_vec()), PRIOR);
    let still = learned.pull(&mut deformer, &held, &pose, &[Vec3::ZERO; 3]).unwrap();
    assert!(still.iter().all(|moved| *moved == Vec3::ZERO), "{still:?}");
    let wanted = [Vec3::ZERO, Vec3::ZERO, Vec3::new(0.0, 0.3, 0.2)];
    let moved = settled(&mut learned, &mut deformer, &held, (&pose, &wanted)).unwrap();
    assert_eq!([moved[2], moved[3], moved[23]], wanted);
    // Back from there it is the pose again.
    learned.still(&mut deformer, &held, &pose).unwrap();
    let again = settled(&mut learned, &mut deformer, &held, (&pose, &wanted)).unwrap();
    assert_eq!(moved, again);
}

#[test]
fn a_pose_of_the_space_is_found_from_its_ends() {
    // A ribbon that bends in one way, which rotations alone do not find.
    let (topology, _, _) = scene(5, 0);
    let at = |v: usize| Vec3::new((v / 2) as f32 * 0.1, 0.0, (v % 2) as f32 * 0.1);
    let pose: Vec<Vec3> = (0..COUNT).map(at).collect();
    let bent: Vec<Vec3> = pose.iter().map(|p| Vec3::Y * (9.0 * p.x).sin() * 0.1).collect();
    let mut deformer = Deformer::new(&topology, None).unwrap();
    let held = deformer.hold(&pose, &[0, 1, 3, 4], 1e-4).unwrap();
    let wanted: Vec<Vec3> = held.vertices().iter().map(|&v| 0.5 * bent[v as usize]).collect();
    let off = |moved: &[Vec3]| moved.iter().zip(&bent).map(|(a, b)| a.distance(0.5 * *b)).fold(0.0, f32::max);
    let mut one = prepared(&mut deformer, &held, &pose, (vec![bent.clone()], vec![1.0]), 1e-6);
    let by_mode = one.pull(&mut deformer, &held, &pose, &wanted).unwrap();
    let mut none = Learned::new(&held, COUNT, (Vec::new(), Vec::new()), 1e-6);
    let without = settled(&mut none, &mut deformer, &held, (&pose, &wanted)).unwrap();
    assert!(off(&by_mode) < 2e-3 && off(&without) > 0.02, "{} {}", off(&by_mode), off(&without));
}
