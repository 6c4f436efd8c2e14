//! The house stands: no file imports in a circle, and no crate uses one above it.
//!
//! The compiler lets no crate depend on one that depends on it; which of two crates is the lower one is decided here. Within
//! a crate it lets files import each other in circles, which this finds.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The crates from the ground up: each may use those of the lines above it, and none of its own line.
const FLOORS: [&[&str]; 17] = [
    &["shared/kernels", "builder/job"],
    &["shared/actor", "shared/texture", "builder/geometry", "builder/learn"],
    &["shared/editing", "builder/parts"],
    &[
        "shared/bundle",
        "shared/synthesis",
        "shared/search",
        "shared/driving",
        "builder/rig",
        "builder/motion",
        "builder/registration",
    ],
    &["shared/mocap", "builder/drive", "builder/family"],
    &["builder/pipeline", "builder/appearance", "builder/performer", "builder/io", "builder/transfer"],
    &["builder/reprise"],
    &["builder/evaluate"],
    &["builder/cli"],
    // The player and what searches for it: the engine and nothing of the builder.
    &["web/searcher"],
    // What edits poses for it; what passes between memories is written as the searcher does.
    &["web/editor"],
    // What drives the actor by motion capture for it; it is told of the actor as the editor is.
    &["web/driver"],
    // What reads scanned meshes for it.
    &["web/scanner"],
    &["web"],
    &["tests/fixtures"],
    &["tests"],
    &["xtask"],
];
/// What belongs to the builder; the page must not carry it.
const NATIVE: &str = "builder/";

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_path_buf()
}

/// Packages that a crate depends on, those that its tests alone use left out.
fn dependencies(folder: &str) -> Vec<String> {
    let text = fs::read_to_string(root().join(folder).join("Cargo.toml")).unwrap();
    let mut section = String::new();
    let mut found = Vec::new();
    for line in text.lines() {
        if let Some(name) = line.strip_prefix('[') {
            section = name.trim_end_matches(']').to_owned();
        } else if section.ends_with("dependencies")
            && !section.contains("dev-")
            && let Some(name) = line.split(['.', ' ', '=']).next().filter(|name| name.starts_with("reprise"))
        {
            found.push(name.to_owned());
        }
    }
    found
}

fn package(folder: &str) -> String {
    let text = fs::read_to_string(root().join(folder).join("Cargo.toml")).unwrap();
    text.lines().find_map(|line| line.strip_prefix("name = \"")).unwrap().trim_end_matches('"').to_owned()
}

/// Folders of all crates of the workspace.
fn crates() -> Vec<String> {
    let mut folders = vec![
        "web".to_owned(),
        "web/searcher".into(),
        "web/editor".into(),
        "web/driver".into(),
        "web/scanner".into(),
        "tests".into(),
        "tests/fixtures".into(),
        "xtask".into(),
    ];
    for parent in ["shared", "builder"] {
        for entry in fs::read_dir(root().join(parent)).unwrap() {
            let name = entry.unwrap().file_name().into_string().unwrap();
            folders.push(format!("{parent}/{name}"));
        }
    }
    folders
}

#[test]
fn crates_use_only_what_lies_below_them() {
    let floor = |folder: &str| FLOORS.iter().position(|floor| floor.contains(&folder));
    let folders = crates();
    let folder_of: BTreeMap<String, &str> = folders.iter().map(|folder| (package(folder), folder.as_str())).collect();
    for folder in &folders {
        let own =
            floor(folder).unwrap_or_else(|| panic!("{folder} stands on no floor: say in FLOORS what it is above"));
        for used in dependencies(folder) {
            let used = folder_of[&used];
            assert!(floor(used).unwrap() < own, "{folder} must not use {used}, which does not lie below it");
            let mixed = !folder.starts_with(NATIVE) && !folder.starts_with("tests") && used.starts_with(NATIVE);
            assert!(!mixed, "{folder} must not use {used}: the page would carry it");
        }
    }
}

#[test]
fn no_files_import_each_other_in_a_circle() {
    let mut circles = Vec::new();
    for folder in crates() {
        let source = root().join(&folder).join("src");
        let imports = imports(&source);
        circles.extend(circles_of(&imports).into_iter().map(|circle| format!("{folder}: {}", circle.join(" -> "))));
    }
    assert!(circles.is_empty(), "files import each other in a circle:\n{}", circles.join("\n"));
}

#[test]
fn circles_are_found() {
    let graph = |edges: &[(&str, &str)]| {
        let mut graph: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
        for (from, to) in edges {
            graph.entry((*from).into()).or_default().insert((*to).into());
            graph.entry((*to).into()).or_default();
        }
        graph
    };
    assert!(circles_of(&graph(&[("a", "b"), ("b", "c"), ("a", "c")])).is_empty());
    assert_eq!(circles_of(&graph(&[("a", "b"), ("b", "c"), ("c", "b")])), [["b", "c"]]);
    let paths = |text: &str| paths_of(text);
    assert_eq!(paths("use super::a::{B, c::{self, D}};"), ["super::a::B", "super::a::c::self", "super::a::c::D"]);
    assert!(paths("// use super::a;\n#[cfg(test)]\nmod tests {\n    use super::*;\n}").is_empty());
    assert_eq!(paths("fn f() { crate::a::b(); }"), ["crate::a::b"]);
}

/// Which file of a crate imports which, by module path.
fn imports(source: &Path) -> BTreeMap<String, BTreeSet<String>> {
    let mut files: BTreeMap<Vec<String>, PathBuf> = BTreeMap::new();
    collect(source, &mut Vec::new(), &mut files);
    let mut graph = BTreeMap::new();
    for (module, file) in &files {
        let mut used = BTreeSet::new();
        for path in paths_of(&fs::read_to_string(file).unwrap()) {
            let words: Vec<&str> = path.split("::").collect();
            let ups = words.iter().take_while(|word| **word == "super").count();
            let mut absolute: Vec<String> = match words[0] {
                "crate" => Vec::new(),
                "super" => module[..module.len().saturating_sub(ups)].to_vec(),
                "self" => module.clone(),
                first if files.contains_key(&[module.as_slice(), &[first.to_owned()]].concat()) => module.clone(),
                _ => continue,
            };
            let skipped = match words[0] {
                "super" => ups,
                "crate" | "self" => 1,
                _ => 0,
            };
            absolute.extend(words[skipped..].iter().map(|&word| word.to_owned()));
            while !files.contains_key(&absolute) && !absolute.is_empty() {
                absolute.pop();
            }
            // A file that opens a folder hands on what lies in it.
            let hands_on = absolute.len() > module.len() && absolute.starts_with(module);
            if absolute != *module && !(hands_on && is_handed_on(file, &path)) {
                used.insert(name_of(&absolute));
            }
        }
        graph.insert(name_of(module), used);
    }
    graph
}

/// Whether a file only passes a path on: `pub use`.
fn is_handed_on(file: &Path, path: &str) -> bool {
    let text = fs::read_to_string(file).unwrap();
    let statements = text.split(';').filter_map(|statement| statement.rsplit_once("use "));
    statements
        .filter(|(before, _)| {
            before.trim_end().rsplit_once("pub").is_some_and(|(_, reach)| !reach.contains(char::is_whitespace))
        })
        .any(|(_, used)| {
            expanded(&used.split_whitespace().collect::<Vec<_>>().join(" ")).iter().any(|known| known == path)
        })
}

fn name_of(module: &[String]) -> String {
    if module.is_empty() { "lib".into() } else { module.join("::") }
}

fn collect(folder: &Path, module: &mut Vec<String>, files: &mut BTreeMap<Vec<String>, PathBuf>) {
    for entry in fs::read_dir(folder).into_iter().flatten() {
        let path = entry.unwrap().path();
        let stem = path.file_stem().unwrap().to_str().unwrap().to_owned();
        if path.is_dir() {
            module.push(stem);
            collect(&path, module, files);
            module.pop();
        } else if path.extension().is_some_and(|ending| ending == "rs") && stem != "tests" && stem != "main" {
            let own = if matches!(stem.as_str(), "mod" | "lib") { vec![] } else { vec![stem] };
            files.insert([module.as_slice(), &own].concat(), path);
        }
    }
}

/// Paths that a file uses, its tests and comments left out.
fn paths_of(text: &str) -> Vec<String> {
    let text = text.split("#[cfg(test)]").next().unwrap();
    let code: String = text.lines().map(|line| line.split("//").next().unwrap().to_owned() + "\n").collect();
    let mut paths = Vec::new();
    let mut rest = String::new();
    for statement in code.split_inclusive(';') {
        let trimmed = statement.trim_end_matches(';');
        let used = trimmed.rsplit_once("use ").filter(|(before, used)| {
            let word = before.chars().last().is_none_or(|c| c.is_whitespace() || c == ')');
            word && used.chars().all(|c| c.is_alphanumeric() || "_:{},* \n".contains(c))
        });
        match used {
            Some((before, used)) => {
                rest.push_str(before);
                paths.extend(expanded(&used.split_whitespace().collect::<Vec<_>>().join(" ")));
            }
            None => rest.push_str(statement),
        }
    }
    let word = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    for token in rest.split(|c| !word(c)) {
        if token.starts_with("crate::") || token.starts_with("super::") {
            paths.push(token.trim_end_matches(':').to_owned());
        }
    }
    paths
}

/// The paths of a tree of imports such as `a::{b, c::{d}}`.
fn expanded(tree: &str) -> Vec<String> {
    let tree = tree.trim();
    let Some(open) = tree.find('{') else {
        return vec![tree.split(" as ").next().unwrap().trim().to_owned()];
    };
    let (prefix, inner) = (&tree[..open], &tree[open + 1..tree.rfind('}').unwrap()]);
    let (mut depth, mut start, mut parts) = (0, 0, Vec::new());
    for (at, c) in inner.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(&inner[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    parts.push(&inner[start..]);
    let whole = parts.into_iter().map(str::trim).filter(|part| !part.is_empty());
    whole.flat_map(|part| expanded(&format!("{prefix}{part}"))).collect()
}

/// Groups of nodes that reach each other, each of two or more, sorted.
fn circles_of(graph: &BTreeMap<String, BTreeSet<String>>) -> Vec<Vec<String>> {
    let reach = |start: &String| {
        let (mut seen, mut stack) = (BTreeSet::new(), vec![start]);
        while let Some(node) = stack.pop() {
            for next in graph.get(node).into_iter().flatten() {
                if seen.insert(next.clone()) {
                    stack.push(next);
                }
            }
        }
        seen
    };
    let reached: BTreeMap<&String, BTreeSet<String>> = graph.keys().map(|node| (node, reach(node))).collect();
    let mut circles: Vec<Vec<String>> = Vec::new();
    for (node, onwards) in &reached {
        let members: Vec<String> = onwards.iter().filter(|other| reached[other].contains(*node)).cloned().collect();
        if members.len() > 1 && !circles.contains(&members) {
            circles.push(members);
        }
    }
    circles
}
