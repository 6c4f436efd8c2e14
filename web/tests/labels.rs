//! Every wgpu object that the player makes has a label of the form `reprise.pass.thing`.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::fs;
use std::path::Path;

/// Rust sources in `folder`, as (path, text without tests).
fn sources(folder: &Path) -> Vec<(String, String)> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|kind| kind == "rs") {
            let text = fs::read_to_string(&path).unwrap();
            let code = text.split("#[cfg(test)]").next().unwrap_or_default();
            found.push((path.display().to_string(), code.to_owned()));
        }
    }
    found
}

fn gpu() -> Vec<(String, String)> {
    let sources = sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src/gpu"));
    assert!(sources.len() > 15, "{} files", sources.len());
    sources
}

/// The fields of every descriptor that is written out in `code`, up to the brace that ends it.
fn descriptors(code: &str) -> Vec<&str> {
    let starts = code.match_indices("Descriptor {").map(|(at, word)| at + word.len());
    let body = |start: usize| {
        let mut depth = 1;
        let end = code[start..].find(|c| {
            depth += i32::from(c == '{') - i32::from(c == '}');
            depth == 0
        });
        &code[start..start + end.unwrap()]
    };
    starts.map(body).collect()
}

#[test]
fn no_descriptor_goes_without_a_label() {
    let mut count = 0;
    for (path, code) in gpu() {
        assert!(!code.contains("label: None"), "{path}: `label: None`");
        assert!(!code.contains("Descriptor::default()"), "{path}: a descriptor without a label");
        for fields in descriptors(&code) {
            // A field of the descriptor itself comes before any other struct in it.
            let own = fields.split('{').next().unwrap();
            assert!(own.contains("label"), "{path}: a descriptor without a label: {fields}");
            count += 1;
        }
    }
    assert!(count >= 15, "{count} descriptors: the test does not find them any more");
}

#[test]
fn labels_say_pass_and_thing() {
    let mut count = 0;
    for (path, code) in gpu() {
        let literals = code.split('"').skip(1).step_by(2);
        for label in literals.filter(|literal| literal.starts_with("reprise")) {
            let words: Vec<_> = label.split('.').collect();
            let plain = |word: &&str| !word.is_empty() && word.chars().all(|c| c.is_ascii_lowercase() || c == '_');
            assert!(words.len() == 3 && words.iter().all(plain), "{path}: {label:?} is not reprise.pass.thing");
            count += 1;
        }
    }
    assert!(count > 50, "{count} labels");
}

#[test]
fn the_test_itself_sees_what_is_missing() {
    let code = "create_buffer(&BufferDescriptor { size, usage }); create(&XDescriptor { label: named(a), y: Y { z } })";
    let own: Vec<_> = descriptors(code).iter().map(|fields| fields.contains("label")).collect();
    assert_eq!(own, [false, true]);
}
