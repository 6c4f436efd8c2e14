//! `builder family`, and families in manifests.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn builder(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_builder")).args(arguments).output().unwrap()
}

fn told(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout)
}

/// The walk and the run of the built-in performer, small.
fn performed(folder: &Path) -> PathBuf {
    let out = folder.join("performer");
    let path = out.to_str().unwrap().to_owned();
    let size = ["--frames", "600", "--rate", "25", "--vertices", "1500", "--texture-size", "128"];
    let output = builder(&[&["performer", "-o", &path][..], &size].concat());
    assert!(output.status.success(), "{}", told(&output));
    out
}

/// A manifest with the performer's walk, run and idle, and `more`.
fn manifest(folder: &Path, more: &str) -> String {
    let sequence = |name: &str, last: u32| {
        format!("[[sequence]]\nname = '{name}'\ninput = 'performer/{name}/frame_%05d.ply:0:{last}'\ncyclic = false\n")
    };
    let count = |name: &str| fs::read_dir(folder.join("performer").join(name)).unwrap().count() as u32 - 1;
    let sequences: String = ["walk", "run", "idle"].iter().map(|name| sequence(name, count(name))).collect();
    let path = folder.join("capture.toml");
    fs::write(&path, format!("name = 'Two gaits'\nfps = 25\n{sequences}\n{more}")).unwrap();
    path.to_str().unwrap().to_owned()
}

/// Frames of the walk, the run and the idling.
fn recorded_frames(folder: &Path) -> u64 {
    let count = |name: &str| fs::read_dir(folder.join("performer").join(name)).unwrap().count() as u64;
    ["walk", "run", "idle"].into_iter().map(count).sum()
}

#[test]
fn samples_are_found_written_and_packed() {
    let folder = tempfile::tempdir().unwrap();
    performed(folder.path());
    let plain = manifest(folder.path(), "");
    let proposed = builder(&["family", &plain]);
    assert!(proposed.status.success(), "{}", told(&proposed));
    let text = String::from_utf8(proposed.stdout).unwrap();
    assert!(text.contains("[[family]]") && text.contains("parameter = \"speed\""), "{text}");

    // What is proposed can be pasted, and asked for samples.
    let text = text.replace("parameter = \"speed\"", "parameter = \"speed\"\nsamples = [1.6, 9.0]");
    let asked = manifest(folder.path(), &text);
    let out = folder.path().join("more");
    let written = builder(&["family", &asked, "-o", out.to_str().unwrap(), "--by", "speed"]);
    assert!(written.status.success(), "{}", told(&written));
    assert!(told(&written).contains("has no speed of 9.00 m/s"), "{}", told(&written));
    let described = fs::read_to_string(out.join("capture.toml")).unwrap();
    assert!(described.contains("cyclic = true") && described.contains("values = ["), "{described}");
    let provenance: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(out.join("families.json")).unwrap()).unwrap();
    let sample = &provenance[0]["samples"][0];
    let value = sample["value"].as_f64().unwrap();
    assert!((value / 1.6 - 1.0).abs() < 0.03, "{sample}");
    assert!(sample["slide_mm"].as_f64().unwrap() < 0.7 && sample["lowest_mm"].as_f64().unwrap() > -5.0, "{sample}");

    // Packing the manifest itself makes the same sequences.
    let bundle = folder.path().join("actor.reprise");
    let packed = builder(&["pack", &asked, "-o", bundle.to_str().unwrap(), "--json", "-q"]);
    assert!(packed.status.success(), "{}", told(&packed));
    let report: serde_json::Value = serde_json::from_slice(&packed.stdout).unwrap();
    assert_eq!(report["families"][0]["samples"], provenance[0]["samples"]);
    assert_eq!(report["capture"]["sequences"], 5);
    let codes = report["warnings"].as_array().unwrap();
    assert!(codes.iter().any(|warning| warning["code"] == "W_FAMILY_RANGE"), "{codes:?}");
    // Variations of what lies between walk and run lie between their variations.
    let varied = folder.path().join("varied.reprise");
    let varied = ["vary", &asked, "-o", varied.to_str().unwrap(), "--as-sequences", "--count", "2", "--json", "-q"];
    let varied = builder(&[&varied[..], &["--sequences", "walk,run"]].concat());
    assert!(varied.status.success(), "{}", told(&varied));
    let varied: serde_json::Value = serde_json::from_slice(&varied.stdout).unwrap();
    // Three recorded ones and two samples; two of walk, of run and of each sample.
    assert_eq!(varied["capture"]["sequences"], 5 + 4 + 4, "{}", varied["warnings"]);

    // Either way the actor knows what members there are, and a behaviour can be asked for by its speed.
    let again = folder.path().join("again.reprise");
    let packed = builder(&["pack", out.to_str().unwrap(), "-o", again.to_str().unwrap(), "-q"]);
    assert!(packed.status.success(), "{}", told(&packed));
    let walk = folder.path().join("walk.glb");
    for actor in [&bundle, &again] {
        let asked = ["direct", actor.to_str().unwrap(), "--behaviour", "walk@1.5:2s", "-o", walk.to_str().unwrap()];
        let walked = builder(&[&asked[..], &["--every", "10", "--json"]].concat());
        assert!(walked.status.success(), "{}", told(&walked));
        let name = sample["sequence"].as_str().unwrap();
        assert!(told(&walked).contains(&format!("walk@1.5: \"{name}\", speed {value:.2} m/s")), "{}", told(&walked));
        let report: serde_json::Value = serde_json::from_slice(&walked.stdout).unwrap();
        let end = report["answer"]["end_frame"].as_u64().unwrap();
        assert!(end >= recorded_frames(folder.path()), "it ends in what was made, not in frame {end}");
        let valid = builder(&["validate", actor.to_str().unwrap()]);
        assert!(told(&valid).contains("nothing is wrong"), "{}", told(&valid));
    }
    let refused = builder(&["direct", bundle.to_str().unwrap(), "--behaviour", "idle@1", "-o", walk.to_str().unwrap()]);
    assert!(told(&refused).contains("there is no behaviour \"idle@1\""), "{}", told(&refused));
}

#[test]
fn what_cannot_be_made_says_why() {
    let folder = tempfile::tempdir().unwrap();
    performed(folder.path());
    let family = |name: &str, rest: &str| format!("[[family]]\nname = '{name}'\n{rest}\n");
    let fails = |more: &str, sentence: &str| {
        let path = manifest(folder.path(), more);
        let out = folder.path().join("never.reprise");
        let output = builder(&["pack", &path, "-o", out.to_str().unwrap()]);
        assert_eq!(output.status.code(), Some(1), "{}", told(&output));
        assert!(told(&output).contains(sentence), "{}", told(&output));
        assert!(!out.exists());
    };
    let gait = "parameter = 'speed'\nsequences = ['walk', 'run']";
    fails(&(family("a", gait) + &family("a", gait)), "two families are named \"a\"");
    fails(&family("a", "parameter = 'speed'\nsequences = ['walk', 'fly']"), "there is no sequence \"fly\"");
    fails(&family("a", "parameter = 'speed'\nsequences = ['walk', 'idle']"), "\"idle\" has no cycle");
    fails(&family("a", "parameter = 'height'\nsequences = ['walk', 'run']"), "\"walk\" has no cycle");
    fails(&family("a", &format!("{gait}\nstep = 0.1")), "unknown field `step`");
    let nothing = builder(&["family", &manifest(folder.path(), ""), "-o", folder.path().to_str().unwrap()]);
    assert!(told(&nothing).contains("is not empty"), "{}", told(&nothing));
}
