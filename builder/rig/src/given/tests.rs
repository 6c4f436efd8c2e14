//! A skeleton is given back as it came, whatever else its file hangs between.
use actor::capture::Poses;
use editing::rotation::turn_by;
use glam::Vec3;
use kernels::random::signed;

use super::*;

/// Vertices of each bone's tube.
const TUBE: usize = 40;

fn bone_of(name: &str, parent: Option<usize>, joint: [f32; 3], role: Option<&'static str>) -> GivenBone {
    GivenBone { name: name.into(), parent, joint: Vec3::from(joint), role }
}

/// Two legs on a pelvis, with nodes above that move nothing, a foot on a control, and toes.
fn walker() -> Vec<GivenBone> {
    vec![
        bone_of("Scene", None, [0.0, 0.0, 0.0], None),
        bone_of("Armature", Some(0), [0.0, 0.0, 0.0], None),
        bone_of("Hips", Some(1), [0.0, 1.0, 0.0], Some("pelvis")),
        bone_of("LeftUpLeg", Some(2), [0.1, 0.9, 0.0], Some("thigh_l")),
        bone_of("LeftLeg", Some(3), [0.1, 0.5, 0.0], Some("shin_l")),
        bone_of("LeftFoot", Some(4), [0.1, 0.1, 0.0], Some("foot_l")),
        bone_of("LeftToe", Some(5), [0.1, 0.0, 0.15], None),
        bone_of("RightUpLeg", Some(2), [-0.1, 0.9, 0.0], Some("thigh_r")),
        bone_of("RightLeg", Some(7), [-0.1, 0.5, 0.0], Some("shin_r")),
        bone_of("RightFoot", Some(1), [-0.1, 0.1, 0.0], Some("foot_r")),
        bone_of("Ring", Some(2), [0.0, 1.1, 0.0], None),
    ]
}

/// Poses in which the bones turn about their joints as their parents take them: the foot on its control as its shin does. The ring does
/// not turn, nor do toes that go into their foot.
fn scene(bones: &[GivenBone]) -> (Topology, Poses, Vec<Vec<(u32, f32)>>) {
    let on = |bone: usize| if bone == 9 { Some(8) } else { bones[bone].parent };
    let movers: Vec<usize> = (2..bones.len()).collect();
    let (mut rest, mut influences) = (Vec::new(), Vec::new());
    for &bone in &movers {
        let count = if bone == 10 { 3 } else { TUBE };
        for k in 0..count {
            let seed = (100 * bone + k) as u64;
            let off = Vec3::new(0.5 * signed(seed, 0), 0.5 + 0.5 * signed(seed, 1), 0.5 * signed(seed, 2))
                * Vec3::new(0.08, -0.3, 0.08);
            rest.push(bones[bone].joint + off);
            let parent = on(bone).filter(|&parent| parent > 1 && k % 8 == 0);
            influences.push(match parent {
                Some(parent) => vec![(bone as u32, 0.6), (parent as u32, 0.4)],
                None => vec![(bone as u32, 1.0)],
            });
        }
    }
    let mut poses = Poses::new(rest.len());
    for frame in 0..30 {
        let mut motions: Vec<Rigid> = Vec::new();
        for bone in 0..bones.len() {
            let is_still = frame == 0 || bone == 10 || (bone == 6 && bones[5].role.is_some());
            let swing = |salt: u64| if is_still { 0.0 } else { 0.5 * signed(31 * bone as u64 + salt, frame) };
            let turn = turn_by(Vec3::new(swing(1), 0.3 * swing(2), 0.3 * swing(3)));
            let joint = bones[bone].joint;
            let own = Rigid { rotation: turn, translation: joint - turn * joint };
            motions.push(match on(bone).and_then(|parent| motions.get(parent)) {
                Some(parent) => parent.after(&own),
                None => Rigid { rotation: glam::Quat::IDENTITY, translation: Vec3::ZERO },
            });
        }
        let skinned = |v: usize| -> Vec3 {
            influences[v]
                .iter()
                .map(|&(bone, weight): &(u32, f32)| motions[bone as usize].apply(rest[v]) * weight)
                .sum()
        };
        poses.push(&(0..rest.len()).map(skinned).collect::<Vec<Vec3>>());
    }
    let triangles = (0..rest.len() as u32 - 2).map(|v| [v, v + 1, v + 2]).collect();
    let weights = vec![1.0; rest.len()];
    (Topology::new(rest.len() as u32, triangles, weights).unwrap(), poses, influences)
}

#[test]
fn a_humans_skeleton_hangs_as_a_humans_does_and_moves_the_surface_exactly() {
    let bones = walker();
    let (topology, poses, influences) = scene(&bones);
    let found = given(&topology, &poses, (&bones, &influences), &RigOptions::default()).unwrap().unwrap();
    assert!(found.is_human && found.is_given);
    // Blends are of the rest pose here, in the file of the pose that was bound.
    let rig = &found.rig;
    let names: Vec<&str> = rig.bones().iter().map(|bone| bone.name.as_str()).collect();
    assert_eq!(names, ["pelvis", "thigh_l", "thigh_r", "shin_l", "shin_r", "foot_l", "foot_r"]);
    let parents: Vec<&str> = rig.bones().iter().map(|bone| rig.bones()[bone.parent].name.as_str()).collect();
    assert_eq!(parents, ["pelvis", "pelvis", "pelvis", "thigh_l", "thigh_r", "shin_l", "shin_r"]);
    assert_eq!(rig.bones().iter().map(|bone| bone.limb).collect::<Vec<_>>(), [0, 3, 4, 3, 4, 3, 4]);
    assert!(found.misfit[0] < 2e-3, "{:?}", found.misfit);
    for bone in &rig.bones()[1..] {
        assert!(bone.gap < 2e-3, "{} gapes by {}", bone.name, bone.gap);
    }
    // Fitted to a pose, joints are where the skeleton has them.
    let motions = rig.fit(poses.frame(0));
    let joints = rig.joints(&motions);
    for (name, came) in [("shin_r", 8), ("foot_r", 9), ("thigh_l", 3)] {
        let at = names.iter().position(|own| *own == name).unwrap();
        assert!(joints[at].distance(bones[came].joint) < 2e-3, "{name} is at {}", joints[at]);
    }
}

#[test]
fn what_is_no_human_keeps_its_names_and_one_bone_is_no_rig() {
    let mut bones = walker();
    bones.iter_mut().for_each(|bone| bone.role = None);
    bones[6].name = "LeftFoot".into();
    let (topology, poses, influences) = scene(&bones);
    let found = given(&topology, &poses, (&bones, &influences), &RigOptions::default()).unwrap().unwrap();
    assert!(!found.is_human);
    let names: Vec<&str> = found.rig.bones().iter().map(|bone| bone.name.as_str()).collect();
    assert_eq!(names[0], "Hips");
    assert!(names.contains(&"LeftFoot") && names.contains(&"LeftFoot 2") && names.contains(&"RightFoot"), "{names:?}");
    assert!(!names.contains(&"Scene") && !names.contains(&"Ring"));
    assert!(found.misfit[0] < 2e-3, "{:?}", found.misfit);
    let alone = vec![vec![(2, 1.0)]; influences.len()];
    assert!(given(&topology, &poses, (&bones, &alone), &RigOptions::default()).unwrap().is_none());
}

#[test]
fn of_very_many_bones_the_smallest_go_into_their_parents() {
    let mut bones =
        vec![bone_of("Scene", None, [0.0, 0.0, 0.0], None), bone_of("Body", Some(0), [0.0, 1.0, 0.0], None)];
    bones.extend((0..60).map(|k| bone_of("leg", Some(1), [0.1 * k as f32, 0.9, 0.0], None)));
    // The body moves least, but what it hangs on moves nothing: it is the root.
    let counts = (1..bones.len()).map(|bone| if bone == 1 { 4 } else { 6 + bone });
    let influences: Vec<BonesOfVertex> =
        (1..).zip(counts).flat_map(|(bone, count)| vec![vec![(bone as u32, 1.0)]; count]).collect();
    let into = kept(&bones, &influences, &vec![1.0; influences.len()]);
    let left: Vec<usize> = (0..bones.len()).filter(|&bone| into[bone] == bone).collect();
    assert_eq!(left.len(), MOST);
    assert!(left.contains(&1) && left.contains(&61) && !left.contains(&2), "{left:?}");
    assert!((0..bones.len()).all(|bone| left.contains(&bone) || into[bone] == 1), "{into:?}");
}
