//! `builder drive`: the built-in performer does what a stick figure does.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use fixtures::squat;
use serde_json::Value;

fn builder(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_builder")).args(arguments).current_dir(folder).output().unwrap()
}

fn done(output: &Output) -> String {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn the_performer_squats_and_its_soles_stay() {
    let temporary = tempfile::tempdir().unwrap();
    let folder = temporary.path();
    let performer = ["performer", "-o", "p", "--frames", "220", "--vertices", "2500", "--texture-size", "128", "-q"];
    done(&builder(folder, &performer));
    fs::write(folder.join("squat.bvh"), squat()).unwrap();

    let drive = ["drive", "squat.bvh", "--actor", "p", "-o", "more", "--json", "--write-mapping", "m.toml"];
    let report: Value = serde_json::from_str(&done(&builder(folder, &drive))).unwrap();
    let mapping = &report["mapping"]["joints"];
    let roles = [("hip_l", "b"), ("knee_r", "o"), ("ankle_l", "d"), ("ball_r", "q"), ("head", "g"), ("elbow_l", "i")];
    roles.iter().for_each(|(role, joint)| assert_eq!(mapping[role], *joint, "{role}"));
    let codes: Vec<&str> = report["warnings"].as_array().unwrap().iter().filter_map(|w| w["code"].as_str()).collect();
    assert_eq!(codes, ["W_MOCAP_UNIT", "W_MOCAP_FIRST"]);
    let number = |name: &str, at: usize| report["measures"][name][at].as_f64().unwrap();
    assert!(report["measures"]["standing"].as_f64().unwrap() > 0.9, "{report}");
    assert!(number("sole_off_mm", 1) < 10.0 && number("slide_mm", 1) < 1.0, "{report}");
    assert!(number("volume", 0) > 0.8, "{report}");

    // The capture has one sequence more, of the same mesh.
    let inspected: Value = serde_json::from_str(&done(&builder(folder, &["inspect", "more", "--json"]))).unwrap();
    let mut names = inspected["sequences"].as_array().unwrap().iter().map(|s| s["name"].as_str().unwrap().to_owned());
    assert_eq!(names.next_back().unwrap(), "squat", "{inspected}");

    // The number of threads changes nothing; the mapping that was written says the same.
    let again = ["drive", "squat.bvh", "--actor", "p", "-o", "again", "--mapping", "m.toml", "--threads", "1", "-q"];
    done(&builder(folder, &again));
    for frame in ["00000", "00020"] {
        let file = |folder_of: &str| fs::read(folder.join(format!("{folder_of}/frames/{frame}.ply"))).unwrap();
        assert!(file("more") == file("again"), "{frame}");
    }
    done(&builder(folder, &["drive", "squat.bvh", "--actor", "p", "-o", "s.glb", "--every", "20", "-q"]));
    assert!(fs::metadata(folder.join("s.glb")).unwrap().len() > 10_000);
}

#[test]
fn what_cannot_be_driven_is_refused() {
    let temporary = tempfile::tempdir().unwrap();
    let folder = temporary.path();
    fs::write(folder.join("a.bvh"), squat()).unwrap();
    fs::write(folder.join("m.toml"), "[joints]\nhip_l = \"nobody\"\n").unwrap();
    let refused = |arguments: &[&str], code: i32, words: &str| {
        let output = builder(folder, arguments);
        let told = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{told}");
        assert!(told.contains(words), "{told}");
    };
    refused(&["drive", "a.bvh", "--actor", "p", "-o", "a.glb", "--mapping", "m.toml"], 1, "no joint \"nobody\"");
    refused(&["drive", "a.amc", "--actor", "p", "-o", "a.glb"], 1, "its skeleton (.asf) is missing");
    refused(&["drive", "a.bvh", "--actor", "p", "-o", "a.xyz"], 2, "-o names walk.glb");
    refused(&["drive", "a.bvh", "--actor", "p", "-o", "a.glb", "--into", "b.reprise"], 2, "--into packs a capture");
    refused(&["drive", "a.bvh", "--actor", "p", "-o", "a.glb"], 1, "p");
}
