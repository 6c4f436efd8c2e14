//! `builder transfer`: the man walks as the woman does.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

fn builder(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_builder")).args(arguments).current_dir(folder).output().unwrap()
}

fn done(output: &Output) -> String {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn refused(output: &Output, words: &str) {
    assert_eq!(output.status.code(), Some(1));
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(told.contains(words), "{told}");
}

fn keys(folder: &Path, pairs: &[(&str, u32, &str, u32)]) {
    let pair = |(from, from_frame, to, to_frame): &(&str, u32, &str, u32)| {
        format!("[[pair]]\nfrom = {from:?}\nfrom_frame = {from_frame}\nto = {to:?}\nto_frame = {to_frame}\n")
    };
    fs::write(folder.join("keys.toml"), pairs.iter().map(pair).collect::<String>()).unwrap();
}

#[test]
fn a_capture_of_the_target_with_the_sources_sequences_comes_out() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let performer = ["performer", "--vertices", "1500", "--texture-size", "128", "-q"];
    done(&builder(folder, &[&performer[..], &["-o", "woman", "--frames", "170", "--rate", "14"]].concat()));
    let man = ["-o", "man", "--frames", "120", "--rate", "10", "--figure", "man"];
    done(&builder(folder, &[&performer[..], &man].concat()));
    let transfer = ["transfer", "--from", "woman", "--to", "man", "--keys", "keys.toml", "-q"];
    let run = |more: &[&str]| builder(folder, &[&transfer[..], more].concat());

    keys(folder, &[("stroll", 0, "walk", 0)]);
    refused(&run(&["-o", "out"]), "pair 1 of the keys: the source has no sequence \"stroll\"");
    keys(folder, &[("walk", 0, "walk", 90)]);
    refused(&run(&["-o", "out"]), "no frame 90");
    keys(folder, &[("walk", 0, "walk", 0)]);
    refused(&run(&["-o", "out"]), "too few");
    fs::write(folder.join("keys.toml"), "[[pair]]\nfrm = 3\n").unwrap();
    refused(&run(&["-o", "out"]), "frm");

    keys(
        folder,
        &[
            ("walk", 0, "walk", 0),
            ("walk", 10, "walk", 7),
            ("walk", 20, "walk", 14),
            ("jump", 0, "jump", 0),
            ("jump", 13, "jump", 9),
        ],
    );
    let told = done(&run(&["-o", "out", "--sequences", "walk,kick", "--json"]));
    let told: Value = serde_json::from_str(&told).unwrap();
    assert_eq!(told["learned"]["keys"], 5);
    assert_eq!(told["learned"]["parts"], 5);
    let names: Vec<&str> =
        told["sequences"].as_array().unwrap().iter().map(|one| one["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["walk_transferred", "kick_transferred"]);
    assert_eq!((&told["sequences"][0]["has_keys"], &told["sequences"][1]["has_keys"]), (&true.into(), &false.into()));
    assert!(told["sequences"][0]["slide_mm"].as_f64().unwrap() < 1.0);
    let manifest = fs::read_to_string(folder.join("out/capture.toml")).unwrap();
    assert!(manifest.contains("# walk_transferred: from walk") && manifest.contains("../man/"), "{manifest}");
    let seen: Value = serde_json::from_str(&done(&builder(folder, &["inspect", "out", "--json"]))).unwrap();
    assert_eq!(seen["sequences"].as_array().unwrap().len(), 12, "ten of the man and two new ones");

    done(&run(&["-o", "alone", "--sequences", "walk", "--alone"]));
    let seen: Value = serde_json::from_str(&done(&builder(folder, &["inspect", "alone", "--json"]))).unwrap();
    assert_eq!(seen["sequences"].as_array().unwrap().len(), 1);
    refused(&run(&["-o", "alone"]), "is not empty");
}
