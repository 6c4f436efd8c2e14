//! Files of motion capture: which are read, and what real ones agree on.

use driving::{Clip, Mapping, MappingFile, Role};
use fixtures::data;
use mocap::MocapError as Text;

use super::{MocapError, MocapOptions, read_clip};

#[test]
fn halves_and_other_files_are_refused() {
    let refused = |input: &str| read_clip(input, &MocapOptions::default()).unwrap_err();
    assert!(matches!(refused("walk.amc"), MocapError::Text(Text::Half { .. })));
    assert!(matches!(refused("02.asf"), MocapError::Text(Text::Half { .. })));
    assert!(matches!(refused("walk.fbx"), MocapError::Text(Text::Format { .. })));
    assert!(matches!(refused("nowhere.bvh"), MocapError::Io { .. }));
}

fn real(input: &str) -> Clip {
    let folder = data().join("mocap");
    let input: Vec<String> = input.split('+').map(|file| folder.join(file).display().to_string()).collect();
    read_clip(&input.join("+"), &MocapOptions::default()).unwrap().clip
}

/// Subject 2's clips are there as AMC and as BVH of every second or third frame.
#[test]
#[ignore = "reads ../shared/data"]
fn bvh_and_amc_of_one_take_agree() {
    for (motion, other, step) in [("02_01.amc", "02_01_60fps.bvh", 2), ("02_05.amc", "02_05_40fps.bvh", 3)] {
        let amc = real(&format!("02.asf+{motion}"));
        let bvh = real(other);
        assert_eq!(bvh.len(), amc.len().div_ceil(step));
        let mut worst = 0.0_f32;
        for (index, joint) in bvh.joints().iter().enumerate() {
            let same = amc.joints().iter().position(|other| other.name == joint.name);
            let same = same.unwrap_or_else(|| panic!("{} is missing", joint.name));
            for frame in 0..bvh.len() {
                worst = worst.max(bvh.positions(frame)[index].distance(amc.positions(frame * step)[same]));
            }
        }
        assert!(worst < 1e-4, "{motion}: {} mm apart", 1000.0 * worst);
    }
}

#[test]
#[ignore = "reads ../shared/data"]
fn joints_of_real_skeletons_are_found() {
    let told = |clip: &Clip| Mapping::of(clip, &MappingFile::default()).unwrap().file(clip).joints;
    let asf = told(&real("02.asf+02_01.amc"));
    let bvh = told(&real("cmu1_jumping_jacks.bvh"));
    let expected = [
        (Role::Pelvis, "root", "Hips"),
        (Role::HipL, "lfemur", "LeftHip"),
        (Role::KneeR, "rtibia", "RightKnee"),
        (Role::AnkleL, "lfoot", "LeftAnkle"),
        (Role::BallR, "rtoes", "RightToe"),
        (Role::ShoulderL, "lhumerus", "LeftShoulder"),
        (Role::ElbowR, "rradius", "RightElbow"),
        (Role::Head, "head", "Head"),
    ];
    for (role, own, other) in expected {
        assert_eq!((asf[&role].as_str(), bvh[&role].as_str()), (own, other), "{role:?}");
    }
}
