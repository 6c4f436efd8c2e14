//! Captures whose glTF file brings a skeleton: that is the rig, a human's with a human's names, and motion capture drives it.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use capture_io::import::{ImportOptions, Imported, import};
use capture_io::mocap::{MocapOptions, read_clip};
use drive::{Mapping, MappingFile};
use glam::Vec3;
use reprise::rigged::{FoundRig, found_rig};
use rig::{RigError, RigFile, RigOrigin};

const FILES: [(&str, bool); 5] = [
    ("cesium-man/CesiumMan.glb", true),
    ("fox/Fox.glb", false),
    ("kaykit-knight/Knight.glb", true),
    ("lumberjack/lumberjack.glb", true),
    ("robot-expressive/RobotExpressive.glb", true),
];

fn read(name: &str) -> Imported {
    let path = fixtures::data().join("gltf").join(name);
    let options = ImportOptions { fps: Some(20.0), ..ImportOptions::default() };
    import(&[path.to_str().unwrap().to_owned()], &options, &job::Job::silent()).unwrap()
}

fn found(imported: &Imported, file: &RigFile) -> Result<FoundRig, RigError> {
    let capture = &imported.capture;
    found_rig((&capture.topology, &capture.poses), imported.skeleton.as_ref(), file, None)
}

fn size(pose: &[Vec3]) -> f32 {
    let low = pose.iter().copied().reduce(Vec3::min).unwrap();
    (pose.iter().copied().reduce(Vec3::max).unwrap() - low).max_element()
}

#[test]
fn the_skeleton_of_a_file_is_the_rig() {
    for (name, is_human) in FILES {
        let imported = read(name);
        let FoundRig { estimate, rig, warning } = found(&imported, &RigFile::default()).unwrap();
        assert!(estimate.is_given && warning.is_none(), "{name}: {warning:?}");
        assert_eq!(estimate.is_human, is_human, "{name}");
        let size = size(imported.capture.poses.frame(0));
        assert!(estimate.misfit[0] < 0.008 * size, "{name}: {} of {size} m", estimate.misfit[0]);
        let named = |wanted: &str| rig.bones().iter().position(|bone| bone.name == wanted);
        if !is_human {
            assert!(named("b_Head_05").is_some() && named("b_Tail02_013").is_some());
            continue;
        }
        assert_eq!(rig.bones()[0].name, "pelvis", "{name}");
        for side in ["l", "r"] {
            for chain in [["thigh", "shin", "foot"].as_slice(), &["upper_arm", "forearm"]] {
                for pair in chain.windows(2) {
                    let [above, below] = [pair[0], pair[1]].map(|part| named(&format!("{part}_{side}")));
                    assert_eq!(Some(rig.bones()[below.unwrap()].parent), above, "{name}: {}_{side}", pair[1]);
                }
            }
        }
        // Left is left of where the feet point, and feet are below knees.
        let joint = |bone: &str| rig.bones()[named(bone).unwrap()].joint;
        assert!(joint("foot_l").y < joint("shin_l").y + 0.1 * size && joint("head").y > joint("pelvis").y, "{name}");
    }
}

#[test]
fn motion_capture_drives_what_animators_made() {
    let clip = fixtures::data().join("mocap/02_01_60fps.bvh");
    let clip = read_clip(clip.to_str().unwrap(), &MocapOptions::default()).unwrap().clip;
    let mapping = Mapping::of(&clip, &MappingFile::default()).unwrap();
    for (name, _) in FILES.into_iter().filter(|(_, is_human)| *is_human) {
        let imported = read(name);
        let rig = found(&imported, &RigFile::default()).unwrap().rig;
        let (capture, fps) = (&imported.capture, imported.capture.timeline.fps());
        let body = drive::body(&rig, &capture.poses).unwrap();
        let driven =
            drive::retarget((&clip, &mapping), &body, (&capture.topology, None), (&capture.poses, fps)).unwrap();
        let size = size(capture.poses.frame(0));
        assert!(driven.stands, "{name}");
        assert!(driven.measures.slide_mm[1] < 1.0, "{name}: {:?}", driven.measures);
        for pose in &driven.poses {
            let (own, low) = (self::size(pose), pose.iter().map(|point| point.y).fold(f32::MAX, f32::min));
            assert!((0.6 * size..1.6 * size).contains(&own), "{name}: {own} of {size} m");
            assert!((low - body.floor).abs() < 0.1 * size, "{name}: {low}, the floor is at {}", body.floor);
        }
    }
}

#[test]
fn a_rig_from_the_motion_is_had_for_the_asking() {
    let imported = read("cesium-man/CesiumMan.glb");
    let by_motion = RigFile { from: Some(RigOrigin::Motion), ..RigFile::default() };
    assert!(!found(&imported, &by_motion).unwrap().estimate.is_given);
    let parts = RigFile { parts: Some(20), ..RigFile::default() };
    assert!(!found(&imported, &parts).unwrap().estimate.is_given);
    let from_file = RigFile { from: Some(RigOrigin::File), ..RigFile::default() };
    let mut bare = imported;
    bare.skeleton = None;
    assert!(matches!(found(&bare, &from_file), Err(RigError::NoSkeleton)));
    // A skeleton that misses the surface is said, and left.
    let mut other = read("cesium-man/CesiumMan.glb");
    let skeleton = other.skeleton.as_mut().unwrap();
    let all = skeleton.influences.len();
    skeleton.influences.rotate_left(all / 2);
    let left = found(&other, &RigFile::default()).unwrap();
    assert!(!left.estimate.is_given);
    assert_eq!(left.warning.unwrap().code, "W_RIG_FILE");
}
