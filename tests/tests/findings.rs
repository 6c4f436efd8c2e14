//! The fuzz targets' seeds and findings, read again: nothing panics.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::fs;
use std::path::{Path, PathBuf};

use tests::hostile;

/// Whatever reads bytes, and says whether it accepts them.
type Target = fn(&[u8]) -> bool;

/// The targets, by the names of their folders.
const TARGETS: [(&str, Target); 7] = [
    ("bundle", hostile::bundle),
    ("glb", hostile::glb),
    ("gltf", hostile::gltf),
    ("obj", hostile::obj),
    ("ply", hostile::ply),
    ("manifest", hostile::manifest),
    ("request", hostile::request),
];

fn fuzz() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz")
}

fn files(kind: &str, target: &str) -> Vec<PathBuf> {
    let Ok(folder) = fs::read_dir(fuzz().join(kind).join(target)) else { return Vec::new() };
    let mut files: Vec<PathBuf> = folder.map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

#[test]
fn what_was_found_is_read_without_panic() {
    for (target, run) in TARGETS {
        for path in files("findings", target) {
            println!("{}", path.display());
            let _ = run(&fs::read(&path).unwrap());
        }
    }
}

#[test]
fn every_target_has_seeds_that_are_accepted() {
    for (target, run) in TARGETS {
        assert!(fuzz().join(format!("fuzz_targets/{target}.rs")).is_file(), "{target}");
        let seeds = files("seeds", target);
        assert!(!seeds.is_empty(), "{target} begins with nothing");
        for path in seeds {
            assert!(run(&fs::read(&path).unwrap()), "{} is refused", path.display());
        }
    }
    let targets = fs::read_dir(fuzz().join("fuzz_targets")).unwrap().count();
    assert_eq!(targets, TARGETS.len(), "a target is not tested here");
}

#[test]
fn seeds_that_are_cut_off_are_read_without_panic() {
    for (target, run) in TARGETS {
        for path in files("seeds", target) {
            let bytes = fs::read(&path).unwrap();
            let step = bytes.len().div_ceil(24).max(1);
            for end in (0..bytes.len()).step_by(step) {
                let _ = run(&bytes[..end]);
            }
        }
    }
}
