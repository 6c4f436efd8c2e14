//! Joints of a stick figure, and what a file corrects.

use super::*;
use crate::clip::{ClipJoint, Stance};
use glam::{Quat, Vec3};

/// A stick figure that faces +Z or, turned, -Z; its joints are named by letters.
fn figure(turned: bool, arms: bool) -> Clip {
    let mut parts: Vec<(&str, Option<usize>, [f32; 3])> = vec![("a", None, [0.0, 1.0, 0.0])];
    for (names, side) in [(["b", "c", "d", "e"], 1.0), (["f", "g", "h", "i"], -1.0)] {
        let first = parts.len();
        parts.push((names[0], Some(0), [0.1 * side, 0.95, 0.0]));
        parts.push((names[1], Some(first), [0.1 * side, 0.53, 0.0]));
        parts.push((names[2], Some(first + 1), [0.1 * side, 0.1, 0.0]));
        parts.push((names[3], Some(first + 2), [0.1 * side, 0.02, 0.14]));
    }
    let chest = parts.len();
    parts.push(("j", Some(0), [0.0, 1.25, 0.0]));
    parts.push(("k", Some(chest), [0.0, 1.55, 0.0]));
    parts.push(("k end", Some(chest + 1), [0.0, 1.75, 0.0]));
    for (names, side) in [(["l", "m", "n", "o"], 1.0), (["p", "q", "r", "s"], -1.0)].into_iter().filter(|_| arms) {
        let first = parts.len();
        for (k, (name, x)) in names.into_iter().zip([0.18, 0.47, 0.72, 0.9]).enumerate() {
            parts.push((name, Some(if k == 0 { chest } else { first + k - 1 }), [x * side, 1.42, 0.0]));
        }
    }
    let turn = Quat::from_rotation_y(if turned { std::f32::consts::PI } else { 0.0 });
    let positions: Vec<Vec3> = parts.iter().map(|(.., at)| turn * Vec3::from(*at)).collect();
    let joints = parts.iter().map(|&(name, parent, _)| ClipJoint { name: name.into(), parent }).collect();
    let stance = Stance { rotations: vec![Quat::IDENTITY; positions.len()], positions };
    Clip::new(joints, 30.0, vec![stance], None).unwrap()
}

#[test]
fn a_figure_is_known_whichever_way_it_faces() {
    for turned in [false, true] {
        let clip = figure(turned, true);
        let file = Mapping::of(&clip, &MappingFile::default()).unwrap().file(&clip);
        for (role, name) in [
            (Role::Pelvis, "a"),
            (Role::HipL, "b"),
            (Role::KneeL, "c"),
            (Role::AnkleR, "h"),
            (Role::BallR, "i"),
            (Role::Chest, "j"),
            (Role::Head, "k"),
            (Role::ShoulderL, "l"),
            (Role::ElbowR, "q"),
            (Role::WristL, "n"),
        ] {
            assert_eq!(file.joints[&role], name, "{role:?}");
        }
    }
}

#[test]
fn a_file_corrects_what_is_found_and_limbs_may_be_missing() {
    let clip = figure(false, false);
    let file = MappingFile { joints: BTreeMap::from([(Role::Head, String::new()), (Role::BallL, "d".into())]) };
    let error = Mapping::of(&clip, &file).unwrap_err();
    assert_eq!(error, MappingError::Twice { first: "ankle_l", second: "ball_l", name: "d".into() });
    let file = MappingFile { joints: BTreeMap::from([(Role::Head, String::new())]) };
    let missing = Mapping::of(&clip, &file).unwrap().missing();
    assert!(missing.contains(&Role::Head) && missing.contains(&Role::ElbowL) && !missing.contains(&Role::BallL));
    let unknown = MappingFile { joints: BTreeMap::from([(Role::Head, "z".into())]) };
    assert!(matches!(Mapping::of(&clip, &unknown), Err(MappingError::Unknown { .. })));
}

#[test]
fn what_has_no_legs_is_refused() {
    let joints = (0..5).map(|k| ClipJoint { name: format!("j{k}"), parent: (k > 0).then(|| k - 1) }).collect();
    let positions = (0..5).map(|k| Vec3::Y * k as f32).collect();
    let stance = Stance { positions, rotations: vec![Quat::IDENTITY; 5] };
    let clip = Clip::new(joints, 30.0, vec![stance], None).unwrap();
    assert!(matches!(Mapping::of(&clip, &MappingFile::default()), Err(MappingError::NoLegs(_))));
}
