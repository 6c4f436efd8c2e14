//! Readers of motion capture: what they agree on, and what they refuse.

use std::path::Path;

use drive::{Clip, Mapping, MappingFile, Role};
use fixtures::data;

use super::{MocapError, MocapOptions, amc, asf, bvh, read_clip};

const BVH: &str = "HIERARCHY\nROOT hips\n{\n OFFSET 0 0 0\n CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation \
                   Yrotation\n JOINT spine\n {\n  OFFSET 0 10 0\n  CHANNELS 3 Zrotation Xrotation Yrotation\n  End Site\n  \
                   {\n   OFFSET 0 5 0\n  }\n }\n}\nMOTION\nFrames: 2\nFrame Time: 0.05\n1 2 3 90 0 0 0 0 0\n1 2 3 0 0 0 90 90 0\n";

const ASF: &str = ":version 1.10\n:units\n length 0.45\n angle deg\n:root\n order TX TY TZ RX RY RZ\n axis XYZ\n position 0 0 0\n \
                   orientation 0 0 0\n:bonedata\n begin\n  name thigh\n  direction 0 -1 0\n  length 8\n  axis 0 0 20 XYZ\n  dof rx \
                   rz\n end\n:hierarchy\n begin\n root thigh\n end\n";
const AMC: &str = ":FULLY-SPECIFIED\n:DEGREES\n1\nroot 0 1 0 0 0 0\nthigh 0 0\n2\nroot 0 1 0 0 0 0\nthigh 90 0\n";

fn bvh(text: &str) -> Result<Clip, MocapError> {
    bvh::read(Path::new("a.bvh"), text.as_bytes())
}

fn amc(skeleton: &str, motion: &str) -> Result<Clip, MocapError> {
    let skeleton = asf::read(Path::new("a.asf"), skeleton.as_bytes())?;
    amc::read(Path::new("a.amc"), motion.as_bytes(), &skeleton, 120.0)
}

#[test]
fn channels_are_multiplied_in_the_files_order() {
    let clip = bvh(BVH).unwrap();
    assert_eq!((clip.len(), clip.rate().round()), (2, 20.0));
    let near = |frame: usize, joint: usize, to: [f32; 3]| {
        let at = clip.positions(frame)[joint];
        assert!(at.distance(to.into()) < 1e-4, "{frame} {joint}: {at}");
    };
    // Rz(90) takes +Y to -X.
    near(0, 1, [-9.0, 2.0, 3.0]);
    // Rz(90) Rx(90) takes +Y to +Z.
    near(1, 2, [1.0, 12.0, 8.0]);
    assert_eq!(clip.joints()[2].name, "spine end");
}

#[test]
fn bones_turn_in_their_own_axes() {
    let clip = amc(ASF, AMC).unwrap();
    assert_eq!((clip.len(), clip.rate()), (2, 120.0));
    assert!(clip.positions(0)[2].distance(glam::Vec3::new(0.0, -7.0, 0.0)) < 1e-4);
    // About an x axis that is turned by 20 degrees.
    let (sin, cos) = 20.0_f32.to_radians().sin_cos();
    let down = glam::Vec3::new(cos * sin, sin * sin, cos) * -8.0;
    let off = clip.positions(1)[2] - clip.positions(1)[1];
    assert!((off.z - down.z).abs() < 1e-3 && (off.length() - 8.0).abs() < 1e-3, "{off}");
}

/// Each fault with words that its message must have.
#[test]
fn faults_are_told_with_their_line() {
    let faults: [(&str, &str, &str); 14] = [
        ("Frames: 2", "Frames: 0", "line 17: 0 frames"),
        ("Frames: 2", "Frames: 3", "in the middle of frame 3"),
        ("Frames: 2", "Frames: 1", "more than the 1 frames"),
        ("Frames: 2", "Frames: 999999999", "more than 1048576"),
        ("Frames: 2", "Frames: -1", "line 17"),
        ("1 2 3 90", "1 2 90", "line 19: 8 numbers for 9 channels"),
        ("1 2 3 90", "1 2 nan 90", "line 19"),
        ("1 2 3 90", "1 2 x 90", "line 19: \"x\" is not a number"),
        ("1 2 3 90", "1 2 1e300 90", "line 19"),
        ("0.05", "0", "no rate"),
        ("CHANNELS 3", "CHANNELS 300", "line 9: a joint has up to 6"),
        ("CHANNELS 3 Zrotation", "CHANNELS 3 Wrotation", "\"Wrotation\" is no channel"),
        ("JOINT spine", "JOINT hips", "two joints are called"),
        ("OFFSET 0 5 0", "OFFSET 0 5e12 0", "line 12"),
    ];
    for (from, to, words) in faults {
        let error = bvh(&BVH.replacen(from, to, 1)).unwrap_err();
        assert!(error.to_string().contains(words), "{to}: {error}");
        assert!(error.code().contains("MOCAP"), "{error:?}");
    }
}

#[test]
fn faults_of_asf_and_amc_are_told() {
    let told = |skeleton: &str, motion: &str, words: &str| {
        let error = amc(skeleton, motion).unwrap_err();
        assert!(error.to_string().contains(words), "{words}: {error}");
    };
    told(ASF, "", "no frame");
    told(ASF, &AMC.replacen("thigh 0 0", "thigh 0", 1), "line 5: 1 numbers for the 2 of bone \"thigh\"");
    told(ASF, &AMC.replacen("thigh 0 0\n", "", 1), "line 3: the frame that begins here says nothing of bone \"thigh\"");
    told(ASF, &AMC.replacen("thigh 0 0", "shin 0 0", 1), "line 5: the skeleton has no bone \"shin\"");
    told(ASF, &AMC.replacen("thigh 0 0", "thigh inf 0", 1), "line 5");
    told(ASF, &AMC.replacen("1\n", "", 1), "line 3: a frame's number is missing");
    told(&ASF.replacen("root thigh", "root thigh shin", 1), AMC, "\"shin\", which is not described");
    told(&ASF.replacen("root thigh", "root thigh thigh", 1), AMC, "hangs in two places");
    told(&ASF.replacen("dof rx", "dof l", 1), AMC, "bones that move by \"l\" are not read");
    told(&ASF.replacen(" end\n:hier", ":hier", 1), AMC, "in the middle of a bone");
    told(&ASF.replacen("length 0.45", "length 0", 1), AMC, "line 3");
}

#[test]
fn a_thousand_joints_are_enough() {
    let mut text = String::from("HIERARCHY\nROOT j\n{\nOFFSET 0 0 0\nCHANNELS 0\n");
    (0..1001).for_each(|k| text.push_str(&format!("JOINT j{k}\n{{\nOFFSET 0 1 0\nCHANNELS 0\n")));
    assert!(bvh(&text).unwrap_err().to_string().contains("more than 1000 joints"));
}

/// Cut and changed anywhere, files are read or refused.
#[test]
fn damaged_files_never_panic() {
    for cut in 0..BVH.len() {
        let _ = bvh(&BVH[..cut]);
        let mut bytes = BVH.as_bytes().to_vec();
        bytes[cut] = bytes[cut].wrapping_mul(31).wrapping_add(7);
        let _ = bvh::read(Path::new("a.bvh"), &bytes);
    }
    for cut in 0..ASF.len() {
        let mut bytes = ASF.as_bytes().to_vec();
        bytes[cut] = bytes[cut].wrapping_mul(31).wrapping_add(7);
        let _ = amc(&String::from_utf8_lossy(&bytes), AMC);
        let _ = amc(&ASF[..cut], AMC);
    }
    for cut in 0..AMC.len() {
        let _ = amc(ASF, &AMC[..cut]);
    }
}

#[test]
fn halves_and_other_files_are_refused() {
    let refused = |input: &str| read_clip(input, &MocapOptions::default()).unwrap_err();
    assert!(matches!(refused("walk.amc"), MocapError::Half { .. }));
    assert!(matches!(refused("02.asf"), MocapError::Half { .. }));
    assert!(matches!(refused("walk.fbx"), MocapError::Format { .. }));
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
