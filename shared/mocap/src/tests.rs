//! Readers of motion capture: what they agree on, and what they refuse.

use driving::Clip;

use super::{MocapError, Note, Options, amc, asf, bvh, read};

const BVH: &str = "HIERARCHY\nROOT hips\n{\n OFFSET 0 0 0\n CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation \
                   Yrotation\n JOINT spine\n {\n  OFFSET 0 10 0\n  CHANNELS 3 Zrotation Xrotation Yrotation\n  End Site\n  \
                   {\n   OFFSET 0 5 0\n  }\n }\n}\nMOTION\nFrames: 2\nFrame Time: 0.05\n1 2 3 90 0 0 0 0 0\n1 2 3 0 0 0 90 90 0\n";

const ASF: &str = ":version 1.10\n:units\n length 0.45\n angle deg\n:root\n order TX TY TZ RX RY RZ\n axis XYZ\n position 0 0 0\n \
                   orientation 0 0 0\n:bonedata\n begin\n  name thigh\n  direction 0 -1 0\n  length 8\n  axis 0 0 20 XYZ\n  dof rx \
                   rz\n end\n:hierarchy\n begin\n root thigh\n end\n";
const AMC: &str = ":FULLY-SPECIFIED\n:DEGREES\n1\nroot 0 1 0 0 0 0\nthigh 0 0\n2\nroot 0 1 0 0 0 0\nthigh 90 0\n";

fn bvh(text: &str) -> Result<Clip, MocapError> {
    bvh::read("a.bvh", text.as_bytes())
}

fn amc(skeleton: &str, motion: &str) -> Result<Clip, MocapError> {
    let skeleton = asf::read("a.asf", skeleton.as_bytes())?;
    amc::read("a.amc", motion.as_bytes(), &skeleton, 120.0)
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
        let _ = bvh::read("a.bvh", &bytes);
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
fn files_are_told_by_their_names() {
    let one = |name: &str, text: &str| read(&[(name, text.as_bytes())], &Options::default());
    let file = |name| (name, &b""[..]);
    assert!(matches!(read(&[file("walk.AMC")], &Options::default()), Err(MocapError::Half { .. })));
    assert!(matches!(read(&[file("02.asf")], &Options::default()), Err(MocapError::Half { .. })));
    assert!(matches!(read(&[file("walk.fbx")], &Options::default()), Err(MocapError::Format { .. })));
    assert!(matches!(read(&[], &Options::default()), Err(MocapError::Format { .. })));
    assert!(matches!(read(&[file("a.asf"), file("b.asf")], &Options::default()), Err(MocapError::Half { .. })));
    assert!(matches!(read(&[file("a.asf"), file("b.bvh")], &Options::default()), Err(MocapError::Format { .. })));
    let (clip, notes) = one("A.BVH", BVH).unwrap();
    // 10 units tall: decimetres.
    assert!((clip.height() - 1.0).abs() < 1e-3, "{}", clip.height());
    assert_eq!(notes.iter().map(Note::code).collect::<Vec<_>>(), ["unit"]);
    let pair = [("b.amc", AMC.as_bytes()), ("a.asf", ASF.as_bytes())];
    let (clip, notes) = read(&pair, &Options { unit: Some(0.1), z_up: true, ..Options::default() }).unwrap();
    assert_eq!(notes, [Note::Rate(120.0)]);
    // What was up points forwards: (x, y, z) becomes (x, z, -y).
    assert!(clip.positions(0)[0].distance(glam::Vec3::new(0.0, 0.0, -0.1)) < 1e-6);
}
