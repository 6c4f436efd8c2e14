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

    check_joins(&report);

    // Without an edit the frames are as they were driven: in the middle those are the same.
    let plain = ["drive", "squat.bvh", "--actor", "p", "-o", "plain", "--as-driven", "--json"];
    let plain: Value = serde_json::from_str(&done(&builder(folder, &plain))).unwrap();
    assert!(plain["joins"].is_null(), "{plain}");
    let frames = plain["frames"].as_u64().unwrap();
    let is_same = |frame: u64| {
        let file = |of: &str| fs::read(folder.join(format!("{of}/frames/{frame:05}.ply"))).unwrap();
        file("more") == file("plain")
    };
    let changed: u64 = joins(&report).iter().map(|join| join["changed"].as_u64().unwrap()).sum();
    let differ = (0..frames).filter(|&frame| !is_same(frame)).count() as u64;
    assert!(differ <= changed && (changed == 0 || differ > 0), "{differ} of {changed}");

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

fn joins(report: &Value) -> Vec<Value> {
    report["joins"].as_array().cloned().unwrap_or_default()
}

/// The ways in and out: an edit that is kept makes the way cheaper and brings the poses together.
fn check_joins(report: &Value) {
    let joins = joins(report);
    assert_eq!(joins.len(), 2, "{report}");
    assert_eq!([&joins[0]["inwards"], &joins[1]["inwards"]], [true, false]);
    for join in joins {
        let number = |when: &str, name: &str| join[when][name].as_f64().unwrap();
        let (changed, is_kept) = (join["changed"].as_u64().unwrap(), join["after"].is_object());
        assert_eq!(changed > 0, is_kept, "{join}");
        if is_kept {
            assert!(number("after", "cost") < number("before", "cost"), "{join}");
            assert!(number("after", "apart_mm") < number("before", "apart_mm"), "{join}");
        }
    }
}

#[test]
#[ignore = "reads ../shared/data"]
fn a_walk_of_motion_capture_is_joined_to_the_performers() {
    let temporary = tempfile::tempdir().unwrap();
    let folder = temporary.path();
    let performer = ["performer", "-o", "p", "--frames", "400", "--vertices", "2500", "--texture-size", "128", "-q"];
    done(&builder(folder, &performer));
    let clip = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data/mocap/02_01_60fps.bvh");
    let report = done(&builder(folder, &["drive", clip, "--actor", "p", "-o", "more", "--json"]));
    let report: Value = serde_json::from_str(&report).unwrap();
    check_joins(&report);
    // The way in from a turn stays as it is driven: any edit would make it more abrupt.
    let edited: Vec<Value> = joins(&report).into_iter().filter(|join| join["after"].is_object()).collect();
    assert!(!edited.is_empty(), "{report}");
    for join in edited {
        let cost = |when: &str| join[when]["cost"].as_f64().unwrap();
        assert!(cost("after") < 0.8 * cost("before"), "{join}");
    }
    let number = |name: &str, at: usize| report["measures"][name][at].as_f64().unwrap();
    assert!(number("sole_off_mm", 1) < 10.0 && number("slide_mm", 1) < 1.0, "{report}");
}

/// The clip as a program writes it whose Z points up: (x, y, z) becomes (x, -z, y).
fn z_up(text: &str) -> String {
    let (mut out, mut signs, mut moves) = (String::new(), Vec::new(), false);
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words.first() {
            Some(&"OFFSET") => {
                let at: Vec<f64> = words[1..].iter().map(|word| word.parse().unwrap()).collect();
                out.push_str(&format!("OFFSET {} {} {}\n", at[0], -at[2], at[1]));
            }
            Some(&"CHANNELS") => {
                signs.extend(words[2..].iter().map(|name| if name.starts_with('Z') { -1.0 } else { 1.0 }));
                let name = |name: &&str| match name.split_at(1) {
                    ("Y", rest) => format!("Z{rest}"),
                    ("Z", rest) => format!("Y{rest}"),
                    _ => (*name).to_owned(),
                };
                let names: Vec<String> = words[2..].iter().map(name).collect();
                out.push_str(&format!("CHANNELS {} {}\n", words[1], names.join(" ")));
            }
            Some(word) if moves && word.parse::<f64>().is_ok() => {
                let values = words.iter().zip(&signs);
                let values: Vec<String> =
                    values.map(|(word, sign)| (word.parse::<f64>().unwrap() * sign).to_string()).collect();
                out.push_str(&values.join(" "));
                out.push('\n');
            }
            _ => {
                moves |= words == ["MOTION"];
                out.push_str(line);
                out.push('\n');
            }
        }
    }
    out
}

#[test]
fn a_clip_whose_z_points_up_is_packed_into_an_actor() {
    let temporary = tempfile::tempdir().unwrap();
    let folder = temporary.path();
    let performer = ["performer", "-o", "p", "--frames", "220", "--vertices", "2500", "--texture-size", "128", "-q"];
    done(&builder(folder, &performer));
    fs::write(folder.join("squat.bvh"), squat()).unwrap();
    fs::write(folder.join("z.bvh"), z_up(&squat())).unwrap();
    done(&builder(folder, &["drive", "squat.bvh", "--actor", "p", "-o", "upright", "-q"]));
    let lying = builder(folder, &["drive", "z.bvh", "--actor", "p", "-o", "lying", "-q"]);
    let into =
        ["drive", "z.bvh", "--actor", "p", "-o", "z", "--clip-up", "z", "--into", "actor.reprise", "--work", "w"];
    done(&builder(folder, &[&into[..], &["--as", "squat", "--labels", "low", "-q"]].concat()));
    let frame = |of: &str, number: &str| fs::read(folder.join(format!("{of}/frames/{number}.ply"))).unwrap();
    for number in ["00000", "00020"] {
        assert!(frame("z", number) == frame("upright", number), "{number}");
    }
    // Without being told it is another motion, or none at all.
    assert!(!lying.status.success() || frame("lying", "00020") != frame("upright", "00020"));
    // The actor has the sequence and its behaviour; so small a capture has hardly any transition.
    let inspected: Value =
        serde_json::from_str(&done(&builder(folder, &["inspect", "actor.reprise", "--json"]))).unwrap();
    assert!(inspected.to_string().contains("squat"), "{inspected}");
    let walk = ["direct", "actor.reprise", "--behaviour", "low", "-o", "w.glb", "--json"];
    let walked: Value = serde_json::from_str(&done(&builder(folder, &walk))).unwrap();
    assert_eq!(walked["answer"]["parts"][0]["goal"]["behaviour"]["reached"], true, "{walked}");
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
