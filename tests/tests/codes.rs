//! `docs/codes.md` lists every code of the source, and no other.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_owned()
}

/// The Rust files of the builder's crates, without tests.
fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        if path.is_dir() && !["tests", "benches", "examples", "target"].contains(&name.as_str()) {
            sources(&path, found);
        } else if name.ends_with(".rs") {
            found.push(path);
        }
    }
}

/// The codes that stand between two of the character `quote`.
fn codes(text: &str, quote: char) -> BTreeSet<String> {
    let is_code = |word: &&str| {
        let rest = word.strip_prefix("W_").or_else(|| word.strip_prefix("E_"));
        rest.is_some_and(|rest| {
            !rest.is_empty() && rest.bytes().all(|b| b.is_ascii_uppercase() || b.is_ascii_digit() || b == b'_')
        })
    };
    text.split(quote).filter(is_code).map(str::to_owned).collect()
}

#[test]
fn every_code_is_explained_and_every_explained_code_exists() {
    let mut files = Vec::new();
    sources(&root().join("builder"), &mut files);
    let mut in_source = BTreeSet::new();
    for file in &files {
        let text = fs::read_to_string(file).unwrap();
        // Tests of the same file come last.
        let code = text.split("#[cfg(test)]").next().unwrap();
        in_source.extend(codes(code, '"'));
    }
    let page = fs::read_to_string(root().join("docs/codes.md")).unwrap();
    let rows: String = page.lines().filter(|line| line.starts_with('|')).flat_map(|line| [line, "\n"]).collect();
    let on_page = codes(&rows, '`');
    assert!(in_source.len() > 50, "{in_source:?}");
    let missing: Vec<_> = in_source.difference(&on_page).collect();
    let unknown: Vec<_> = on_page.difference(&in_source).collect();
    assert!(missing.is_empty(), "docs/codes.md does not explain {missing:?}");
    assert!(unknown.is_empty(), "docs/codes.md explains {unknown:?}, which the source does not have");
}

#[test]
fn codes_are_told_from_other_words() {
    let text = "a(\"W_SIZE\", \"E_\") \"E_NO\" E_METRES \"W_x\" \"W_A2\"";
    assert_eq!(codes(text, '"').into_iter().collect::<Vec<_>>(), ["E_NO", "W_A2", "W_SIZE"]);
}
