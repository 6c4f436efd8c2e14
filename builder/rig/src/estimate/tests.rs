use actor::capture::Poses;
use glam::{Quat, Vec3};
use kernels::topology::Topology;

use super::*;

/// Three boxes in a row, each of its own, that turn about hinges between them as a robot's arm does; and its poses.
fn robot(frames: usize) -> (Topology, Poses) {
    let mut rest = Vec::new();
    let mut triangles = Vec::new();
    for part in 0..3 {
        let base = rest.len() as u32;
        for v in 0..27 {
            let [x, y, z] = [v % 3, (v / 3) % 3, v / 9].map(|k| k as f32 * 0.1);
            rest.push(Vec3::new(x, y + 0.35 * part as f32, z));
        }
        for v in 0..27_u32 {
            for [a, b] in [[1, 3], [3, 9], [9, 1]] {
                let fits = |step: u32| match step {
                    1 => v % 3 < 2,
                    3 => (v / 3) % 3 < 2,
                    _ => v / 9 < 2,
                };
                if fits(a) && fits(b) {
                    triangles.push([base + v, base + v + a, base + v + b]);
                }
            }
        }
    }
    let topology = Topology::new(81, triangles, vec![1.0; 81]).unwrap();
    let hinge = |k: usize| Vec3::new(0.1, 0.275 + 0.35 * k as f32, 0.1);
    let mut poses = Poses::new(81);
    for frame in 0..frames {
        let angle = |k: usize| (frame as f32 * (0.3 + 0.2 * k as f32)).sin() * 0.8;
        let lower = |p: Vec3| hinge(0) + Quat::from_rotation_z(angle(0)) * (p - hinge(0));
        let upper = |p: Vec3| lower(hinge(1) + Quat::from_rotation_x(angle(1)) * (p - hinge(1)));
        let pose: Vec<Vec3> = rest
            .iter()
            .enumerate()
            .map(|(v, &p)| match v / 27 {
                0 => p,
                1 => lower(p),
                _ => upper(p),
            })
            .collect();
        poses.push(&pose);
    }
    (topology, poses)
}

#[test]
fn rigid_parts_are_found_exactly_and_their_joints_lie_on_the_hinges() {
    let (topology, poses) = robot(40);
    let found = estimate(&topology, &poses, &RigOptions::default()).unwrap();
    assert_eq!((found.parts, found.rig.bones().len(), found.is_human), (3, 3, false));
    assert!(found.misfit[0] < 1e-4, "{:?}", found.misfit);
    for part in 0..3 {
        let bone = found.rig.bone_of(part * 27);
        assert!((0..27).all(|v| found.rig.bone_of(part * 27 + v) == bone), "part {part}");
    }
    // Anywhere along its hinge, and near it: the pull towards where the pieces are linked takes it a few millimetres aside.
    for bone in &found.rig.bones()[1..] {
        assert!(bone.gap < 5e-3, "{} gapes by {}", bone.name, bone.gap);
    }
    // The bones of every frame, found again, take the rest pose to it.
    for pose in poses.iter().step_by(7) {
        let motions = found.rig.fit(pose);
        for (v, &point) in pose.iter().enumerate() {
            let motion = &motions[found.rig.bone_of(v as u32)];
            assert!(motion.apply(found.rig.rest()[v]).distance(point) < 1e-3);
        }
    }
}

#[test]
fn what_moves_as_one_piece_has_no_rig() {
    let (topology, poses) = robot(1);
    let mut turned = Poses::new(81);
    for k in 0..5 {
        let turn = Quat::from_rotation_y(k as f32);
        turned.push(&poses.frame(0).iter().map(|&p| turn * p + Vec3::X * k as f32).collect::<Vec<_>>());
    }
    let error = estimate(&topology, &turned, &RigOptions::default()).unwrap_err();
    assert_eq!(error, RigError::Rigid { frames: 5 });
    assert!(estimate(&topology, &poses, &RigOptions::default()).is_err(), "one pose tells of no joint");
    let options = RigOptions { parts: 1, ..RigOptions::default() };
    assert_eq!(estimate(&topology, &poses, &options).unwrap_err(), RigError::Parts(1));
}
