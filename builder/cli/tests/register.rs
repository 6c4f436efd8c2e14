//! `builder register`, and what `inspect` and `validate` say of scans: exit codes, nothing half-written, killed and resumed, the
//! same bytes on any number of threads.
#![cfg(feature = "complete")]
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use geometry::mesh::Mesh;
use geometry::polygonise::polygonise;
use geometry::sdf::{blend, cone, ellipsoid};
use glam::Vec3;
use serde_json::Value;

fn builder(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_builder")).args(arguments).output().unwrap()
}

fn code(output: &Output) -> i32 {
    output.status.code().unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A body with two arms, of which one is raised by `angle`.
fn body(angle: f32, cell: f32) -> Mesh {
    let distance = |p: Vec3| {
        let trunk = ellipsoid(p, Vec3::new(0.0, 0.9, 0.0), Vec3::new(0.28, 0.8, 0.2));
        let shoulder = Vec3::new(0.2, 1.3, 0.0);
        let hand = shoulder + 0.6 * Vec3::new(angle.cos(), angle.sin(), 0.0);
        let raised = cone(p, shoulder, hand, 0.1, 0.07);
        let other = cone(p, Vec3::new(-0.2, 1.3, 0.0), Vec3::new(-0.55, 0.75, 0.2), 0.1, 0.07);
        blend(blend(trunk, raised, 0.05), other, 0.05)
    };
    polygonise(Vec3::new(-1.0, 0.0, -0.5), Vec3::new(1.0, 2.2, 0.5), cell, distance)
}

/// `count` frames, of which every one has its own mesh; every `empty`-th of them none.
fn write_scan(folder: &Path, count: usize, empty: usize) {
    fs::create_dir_all(folder).unwrap();
    for k in 0..count {
        let mesh = body(-0.3 + 0.12 * k as f32, 0.052 + 0.001 * k as f32);
        let mut text: String = mesh.positions.iter().map(|p| format!("v {} {} {}\n", p.x, p.y, p.z)).collect();
        if k % empty != empty - 1 {
            text.extend(mesh.triangles.iter().map(|t| format!("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1)));
        }
        fs::write(folder.join(format!("frame_{k:03}.obj")), text).unwrap();
    }
}

fn whole(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = BTreeMap::new();
    let mut open = vec![folder.to_owned()];
    while let Some(at) = open.pop() {
        for entry in fs::read_dir(at).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else {
                files.insert(
                    path.strip_prefix(folder).unwrap().to_string_lossy().into_owned(),
                    fs::read(&path).unwrap(),
                );
            }
        }
    }
    files
}

#[test]
fn a_scan_is_inspected_validated_registered_and_packed() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    write_scan(&folder.path().join("scan"), 6, usize::MAX);
    let scan = path("scan");

    let inspected = builder(&["inspect", &scan, "--json"]);
    assert_eq!(code(&inspected), 0, "{}", stderr(&inspected));
    let found: Value = serde_json::from_slice(&inspected.stdout).unwrap();
    assert_eq!(
        (found["kind"].as_str(), found["frames"].as_u64(), found["meshes"].as_u64()),
        (Some("scan"), Some(6), Some(6))
    );
    let validated = builder(&["validate", &scan, "--json"]);
    assert_eq!(code(&validated), 0, "{}", stderr(&validated));
    let lines: Value = serde_json::from_slice(&validated.stdout).unwrap();
    let codes: Vec<&str> = lines.as_array().unwrap().iter().map(|line| line["code"].as_str().unwrap()).collect();
    assert!(codes.contains(&"W_SCAN_REGISTERED") && codes.contains(&"W_FPS_ASSUMED"), "{codes:?}");

    let registered = builder(&[
        "register",
        &scan,
        "-o",
        &path("one"),
        "--fps",
        "30",
        "--threads",
        "1",
        "--json",
        "--report",
        &path("page.html"),
    ]);
    assert_eq!(code(&registered), 0, "{}", stderr(&registered));
    let report: Value = serde_json::from_slice(&registered.stdout).unwrap();
    assert_eq!(report["template"], found["template"]);
    assert_eq!(report["registered"].as_array().unwrap().len(), 6);
    assert!(fs::read_to_string(path("page.html")).unwrap().contains("Worst frames"));
    let again = builder(&["register", &scan, "-o", &path("two"), "--fps", "30", "--threads", "2"]);
    assert_eq!(code(&again), 0, "{}", stderr(&again));
    assert!(whole(&folder.path().join("one")) == whole(&folder.path().join("two")), "bytes differ with the threads");
    // The capture is no scan any more.
    let inspected: Value = serde_json::from_slice(&builder(&["inspect", &path("one"), "--json"]).stdout).unwrap();
    assert_eq!((inspected["kind"].as_str(), inspected["capture"]["frames"].as_u64()), (Some("input"), Some(6)));
    // The folder is taken.
    let taken = builder(&["register", &scan, "-o", &path("one")]);
    assert!(code(&taken) == 1 && stderr(&taken).contains("not empty"), "{}", stderr(&taken));
}

#[test]
fn what_cannot_be_registered_is_refused_with_the_frame_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let scan = folder.path().join("scan");
    write_scan(&scan, 6, 2);
    let scan = scan.to_str().unwrap();
    let out = folder.path().join("capture");
    let register =
        |arguments: &[&str]| builder(&[&["register", scan, "-o", out.to_str().unwrap()], arguments].concat());
    // Three of six hold nothing: they are left out, what stands alone is left out, too, and nothing is left.
    let refused = register(&[]);
    assert_eq!(code(&refused), 1, "{}", stderr(&refused));
    assert!(stderr(&refused).contains("frame 1 of sequence"), "{}", stderr(&refused));
    // An empty frame is no template, nor is one that is not there.
    for (wanted, said) in [("1", "no surface"), ("77", "no such frame")] {
        let refused = register(&["--template-frame", wanted]);
        assert!(code(&refused) == 1 && stderr(&refused).contains(said), "{}", stderr(&refused));
    }
    for wrong in [["--colour", "-1"], ["--detail", "nan"], ["--texture-size", "3"]] {
        assert_eq!(code(&register(&wrong)), 2, "{wrong:?}");
    }
    assert_eq!(code(&builder(&["register", "no-such-folder", "-o", out.to_str().unwrap()])), 1);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "something was left behind");
}

#[test]
fn a_run_that_was_killed_goes_on_in_its_work_folder() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    write_scan(&folder.path().join("scan"), 8, usize::MAX);
    let (scan, work, out) = (path("scan"), path("work"), path("capture"));
    let arguments = ["register", &scan, "-o", &out, "--fps", "30", "--work", &work, "--threads", "1"];
    let mut child = Command::new(env!("CARGO_BIN_EXE_builder")).args(arguments).stderr(Stdio::null()).spawn().unwrap();
    // As soon as some poses are kept.
    let kept = || walked(Path::new(&work));
    let begun = Instant::now();
    while kept() < 3 && child.try_wait().unwrap().is_none() && begun.elapsed() < Duration::from_secs(300) {
        std::thread::sleep(Duration::from_millis(10));
    }
    child.kill().unwrap();
    let ended = child.wait().unwrap();
    assert!(!Path::new(&out).exists() || ended.success(), "a capture is half-written");
    let before = kept();
    assert!(before >= 3, "{before} poses are kept");
    if !ended.success() {
        let resumed = builder(&arguments);
        assert_eq!(code(&resumed), 0, "{}", stderr(&resumed));
    }
    let fresh = builder(&["register", &scan, "-o", &path("fresh"), "--fps", "30"]);
    assert_eq!(code(&fresh), 0, "{}", stderr(&fresh));
    assert!(whole(Path::new(&out)) == whole(&folder.path().join("fresh")), "resumed work gives other bytes");
}

/// Results in a work folder.
fn walked(folder: &Path) -> usize {
    let Ok(entries) = fs::read_dir(folder) else { return 0 };
    let of = |path: std::path::PathBuf| if path.is_dir() { walked(&path) } else { 1 };
    entries.flatten().map(|entry| of(entry.path())).sum()
}
