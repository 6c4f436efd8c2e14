//! Painted parts of the body: from the manifest into the bundle, and onto the report.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::fs;
use std::path::Path;
use std::process::Command;

fn builder(folder: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_builder")).args(arguments).current_dir(folder).output().unwrap();
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

/// Vertices that a PLY file declares.
fn vertices(file: &Path) -> usize {
    let bytes = fs::read(file).unwrap();
    let head = String::from_utf8_lossy(&bytes[..400]).into_owned();
    head.lines().find_map(|line| line.strip_prefix("element vertex ")).unwrap().parse().unwrap()
}

#[test]
fn painted_parts_are_on_the_report() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let performer = ["performer", "-o", "in", "--vertices", "1500", "--texture-size", "128", "--frames", "120", "-q"];
    assert_eq!(builder(folder, &[&performer[..], &["--rate", "10"]].concat()).0, Some(0));
    let walk = folder.join("in/walk");
    let first = fs::read_dir(&walk).unwrap().map(|entry| entry.unwrap().path()).min().unwrap();
    let count = vertices(&first);
    let manifest = fs::read_to_string(folder.join("in/capture.toml")).unwrap();
    fs::write(folder.join("in/capture.toml"), format!("parts = \"parts.txt\"\n{manifest}")).unwrap();
    let numbers = |all: usize| (0..all).map(|v| if v < all / 2 { "3\n" } else { "5\n" }).collect::<String>();
    fs::write(folder.join("in/parts.txt"), numbers(count - 1)).unwrap();
    let (code, told) = builder(folder, &["pack", "in", "-o", "a.reprise", "-q"]);
    assert!(code == Some(1) && told.contains("parts.txt") && told.contains("numbers for"), "{told}");

    fs::write(folder.join("in/parts.txt"), numbers(count)).unwrap();
    assert_eq!(builder(folder, &["pack", "in", "-o", "a.reprise", "-q"]).0, Some(0));
    assert_eq!(builder(folder, &["validate", "a.reprise", "-q"]).0, Some(0));
    assert_eq!(builder(folder, &["report", "a.reprise", "-o", "a.html", "-q"]).0, Some(0));
    let page = fs::read_to_string(folder.join("a.html")).unwrap();
    // What is made of the capture elsewhere still finds the file.
    let pair = |frame: u32| format!("[[pair]]\nfrom = 'walk'\nfrom_frame = {frame}\nto = 'walk'\nto_frame = {frame}\n");
    fs::write(folder.join("keys.toml"), [0, 4, 9].map(pair).concat()).unwrap();
    let transfer = ["transfer", "--from", "a.reprise", "--to", "in", "--keys", "keys.toml", "-o", "out"];
    let (code, told) = builder(folder, &[&transfer[..], &["--sequences", "walk", "-q"]].concat());
    assert_eq!(code, Some(0), "{told}");
    let made = fs::read_to_string(folder.join("out/transfer.json")).unwrap();
    assert!(made.contains("\"parts\": 2"), "{made}");
    let (code, told) = builder(folder, &["inspect", "out", "-q"]);
    assert_eq!(code, Some(0), "{told}");
    assert!(page.contains("Parts of the body") && page.contains("painted 3") && page.contains("painted 5"));
}
