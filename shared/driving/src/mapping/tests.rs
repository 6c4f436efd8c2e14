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

/// An animal that stands on four legs, its head ahead of it; or one that rests upright.
fn animal(rests_upright: bool) -> Clip {
    let mut parts: Vec<(String, Option<usize>, [f32; 3])> = vec![("hip".into(), None, [0.0, 0.6, 0.0])];
    parts.push(("breast".into(), Some(0), [0.0, 0.62, 0.6]));
    parts.push(("neck".into(), Some(1), [0.0, 0.75, 0.8]));
    parts.push(("nose".into(), Some(2), [0.0, 0.8, 0.95]));
    for (from, z, word) in [(0, 0.0, "hind"), (1, 0.6, "fore")] {
        for (side, sign) in [("L", 1.0), ("R", -1.0)] {
            for (k, y) in [0.58, 0.32, 0.1, 0.02].into_iter().enumerate() {
                let parent = if k == 0 { from } else { parts.len() - 1 };
                let ahead = if k == 3 { 0.08 } else { 0.0 };
                parts.push((format!("{word}{k}{side}"), Some(parent), [0.1 * sign, y, z + ahead]));
            }
        }
    }
    let positions: Vec<Vec3> = parts.iter().map(|(.., at)| Vec3::from(*at)).collect();
    let joints = parts.iter().map(|(name, parent, _)| ClipJoint { name: name.clone(), parent: *parent }).collect();
    let rotations = vec![Quat::IDENTITY; positions.len()];
    let upright = positions.iter().map(|p| Vec3::new(p.x, p.z, -p.y)).collect();
    let rest = rests_upright.then(|| Stance { positions: upright, rotations: rotations.clone() });
    Clip::new(joints, 30.0, vec![Stance { positions, rotations }], rest).unwrap()
}

#[test]
fn an_animal_is_no_human_but_may_be_called_one() {
    let refused = Mapping::of(&animal(false), &MappingFile::default()).unwrap_err();
    assert!(matches!(refused, MappingError::FourLegs { .. }), "{refused}");
    assert!(refused.to_string().contains("fore3") && refused.to_string().contains("hind3"), "{refused}");
    // Who only crawls is a human.
    assert!(Mapping::of(&animal(true), &MappingFile::default()).is_ok());
    let file = MappingFile { joints: BTreeMap::from([(Role::Head, "nose".into())]) };
    assert!(Mapping::of(&animal(false), &file).is_ok());
}

#[test]
fn legs_that_are_named_are_enough_for_the_rest() {
    // Legs without an ankle: nothing says where they end.
    let whole = figure(false, true);
    let keeps = |name: &str| !["d", "e", "h", "i"].contains(&name);
    let kept: Vec<usize> = (0..whole.joints().len()).filter(|&k| keeps(&whole.joints()[k].name)).collect();
    let place = |joint: usize| kept.iter().position(|&k| k == joint);
    let mut joints: Vec<ClipJoint> = kept
        .iter()
        .map(|&k| ClipJoint { name: whole.joints()[k].name.clone(), parent: whole.joints()[k].parent.and_then(place) })
        .collect();
    let mut positions: Vec<Vec3> = kept.iter().map(|&k| whole.positions(0)[k]).collect();
    // As animators have them: feet hang on the root, for a control moves them.
    for (name, x) in [("d", 0.1), ("h", -0.1)] {
        joints.push(ClipJoint { name: name.into(), parent: Some(0) });
        positions.push(Vec3::new(x, 0.1, 0.0));
    }
    let rotations = vec![Quat::IDENTITY; positions.len()];
    let clip = Clip::new(joints, 30.0, vec![Stance { positions, rotations }], None).unwrap();
    let named = [
        (Role::Pelvis, "a"),
        (Role::HipL, "b"),
        (Role::KneeL, "c"),
        (Role::AnkleL, "d"),
        (Role::HipR, "f"),
        (Role::KneeR, "g"),
        (Role::AnkleR, "h"),
        (Role::ElbowR, ""),
    ];
    let file = MappingFile { joints: named.into_iter().map(|(role, name)| (role, name.to_owned())).collect() };
    let found = Mapping::of(&clip, &file).unwrap().file(&clip).joints;
    let told = [Role::Chest, Role::Head, Role::ShoulderL, Role::WristR, Role::ElbowR].map(|role| found[&role].as_str());
    assert_eq!(told, ["j", "k", "l", "r", ""]);
}

#[test]
fn what_has_no_legs_is_refused() {
    let joints = (0..5).map(|k| ClipJoint { name: format!("j{k}"), parent: (k > 0).then(|| k - 1) }).collect();
    let positions = (0..5).map(|k| Vec3::Y * k as f32).collect();
    let stance = Stance { positions, rotations: vec![Quat::IDENTITY; 5] };
    let clip = Clip::new(joints, 30.0, vec![stance], None).unwrap();
    assert!(matches!(Mapping::of(&clip, &MappingFile::default()), Err(MappingError::NoLegs(_))));
}
