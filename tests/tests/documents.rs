//! What the documents name is there: files of the repository, and packages with their benchmarks, examples and tests.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Component, Path, PathBuf};

/// Folders that no document speaks of as part of the repository: what is built or installed.
const MADE: [&str; 5] = ["target", "dist", "node_modules", "pkg", "out"];
/// Endings of source files. Whatever ends so in a document is one of the repository's, named in full or by its end.
const SOURCES: [&str; 4] = [".rs", ".wgsl", ".mjs", ".py"];
/// Options of cargo that name a target of a package, and the folder that such targets lie in.
const TARGETS: [(&str, &str); 3] = [("--bench", "benches"), ("--example", "examples"), ("--test", "tests")];

#[test]
fn documents_name_what_is_there() {
    let repository = Repository::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join(".."));
    let (mut missing, mut named) = (Vec::new(), 0);
    for document in repository.documents() {
        let text = fs::read_to_string(repository.root.join(&document)).unwrap();
        let (wrong, count) = repository.check(&document, &text);
        missing.extend(wrong.into_iter().map(|what| format!("{document}: {what}")));
        named += count;
    }
    assert!(missing.is_empty(), "documents name what is not there:\n{}", missing.join("\n"));
    assert!(named > 100, "only {named} names were found in all documents: the test does not see them");
}

#[test]
fn wrong_names_are_found() {
    let repository = Repository::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join(".."));
    let check = |text: &str| repository.check("docs/method.md", text).0;
    assert_eq!(
        check("`shared/actor/src/walk.rs` of [all](method.md#x), `walk.rs`, `cargo test -p reprise-tests`."),
        [""; 0]
    );
    assert_eq!(check("see `shared/nowhere/`, that is all"), ["shared/nowhere/ does not exist"]);
    assert_eq!(check("(`builder/cli/src/no_such_file.rs`)."), ["builder/cli/src/no_such_file.rs does not exist"]);
    assert_eq!(check("`alk.rs`"), ["no file ends in alk.rs"]);
    assert_eq!(check("[here](nowhere.md)"), ["the link nowhere.md leads nowhere"]);
    assert_eq!(check("    cargo bench -p reprise-nowhere"), ["there is no package reprise-nowhere"]);
    assert_eq!(check("`cargo bench -p reprise-kernels\n--bench nothing`"), ["reprise-kernels has no --bench nothing"]);
}

/// `docs/notation.md` has in each row names of ours, and the files in which they stand for a symbol or compute a formula.
#[test]
fn names_of_the_notation_are_in_its_files() {
    let repository = Repository::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join(".."));
    let text = fs::read_to_string(repository.root.join("docs/notation.md")).unwrap();
    let (mut missing, mut found) = (Vec::new(), 0);
    for row in text.lines().filter(|line| line.starts_with('|')) {
        let (files, names): (Vec<&str>, Vec<&str>) =
            row.split('`').skip(1).step_by(2).partition(|span| repository.is_path(span));
        let sources = files.iter().filter(|file| file.ends_with(".rs"));
        // Files that are not there are told by the test above.
        let sources: Vec<String> =
            sources.filter_map(|file| fs::read_to_string(repository.root.join(file)).ok()).collect();
        for name in names.iter().filter(|name| !sources.is_empty() && !name.starts_with("--")) {
            let has = |source: &String| identifiers(name).all(|part| identifiers(source).any(|word| word == part));
            found += 1;
            if !sources.iter().any(has) {
                missing.push(format!("`{name}` is not in {}", files.join(", ")));
            }
        }
    }
    assert!(
        missing.is_empty(),
        "docs/notation.md has names that are not in the files beside them:\n{}",
        missing.join("\n")
    );
    assert!(found > 100, "only {found} names were found: the test does not see them");
}

/// What there is to be named.
struct Repository {
    root: PathBuf,
    /// All files, as paths from the root with `/` between folders.
    files: BTreeSet<String>,
    /// Folders of the root.
    folders: BTreeSet<String>,
    /// The folder of each package.
    packages: BTreeMap<String, String>,
}

impl Repository {
    fn read(root: &Path) -> Self {
        let mut files = BTreeSet::new();
        list(root, "", &mut files);
        let folders = files.iter().filter_map(|file| Some(file.split_once('/')?.0.to_owned())).collect();
        let mut packages = BTreeMap::new();
        for manifest in files.iter().filter(|file| file.ends_with("/Cargo.toml")) {
            let text = fs::read_to_string(root.join(manifest)).unwrap();
            let name = text.lines().find_map(|line| line.strip_prefix("name = \"")?.strip_suffix('"'));
            packages.insert(name.unwrap().to_owned(), manifest.trim_end_matches("Cargo.toml").to_owned());
        }
        Self { root: root.to_path_buf(), files, folders, packages }
    }

    /// The documents that describe the repository as it is.
    fn documents(&self) -> Vec<String> {
        let is_document = |file: &&String| file.starts_with("docs/") && file.ends_with(".md");
        let docs = self.files.iter().filter(is_document).cloned();
        ["README.md".to_owned(), "ARCHITECTURE.md".to_owned()].into_iter().chain(docs).collect()
    }

    /// What `text` of `document` names that is not there, and how many names were looked up.
    fn check(&self, document: &str, text: &str) -> (Vec<String>, usize) {
        let links: Vec<&str> = links(text).collect();
        let paths: Vec<&str> = words(text).filter(|word| self.is_path(word)).collect();
        let sources: Vec<&str> = words(text).filter(|word| !self.is_path(word) && is_source(word)).collect();
        let options = options(text);
        let named = links.len() + paths.len() + sources.len() + options.len();
        let mut wrong = Vec::new();
        for link in links.into_iter().filter(|link| !self.has(&beside(document, link))) {
            wrong.push(format!("the link {link} leads nowhere"));
        }
        for path in paths.into_iter().filter(|path| !self.has(path)) {
            wrong.push(format!("{path} does not exist"));
        }
        for source in sources.into_iter().filter(|source| !self.files.iter().any(|file| ends_in(file, source))) {
            wrong.push(format!("no file ends in {source}"));
        }
        for Named { package, target } in options {
            match (self.packages.get(package), target) {
                (None, _) => wrong.push(format!("there is no package {package}")),
                (Some(folder), Some((option, kind, name))) => {
                    let places = [format!("{folder}{kind}/{name}.rs"), format!("{folder}{kind}/{name}/main.rs")];
                    if !places.iter().any(|place| self.files.contains(place)) {
                        wrong.push(format!("{package} has no {option} {name}"));
                    }
                }
                (Some(_), None) => {}
            }
        }
        (wrong, named)
    }

    /// Whether a word begins like a path from the root.
    fn is_path(&self, word: &str) -> bool {
        word.split_once('/').is_some_and(|(first, _)| self.folders.contains(first))
    }

    /// Whether a path is that of a file or of a folder.
    fn has(&self, path: &str) -> bool {
        let folder = format!("{}/", path.trim_end_matches('/'));
        self.files.contains(path)
            || self.files.range(folder.clone()..).next().is_some_and(|file| file.starts_with(&folder))
    }
}

/// Adds the files of a folder and of those below it.
fn list(folder: &Path, prefix: &str, files: &mut BTreeSet<String>) {
    for entry in fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        let name = entry.file_name().into_string().unwrap();
        if !entry.path().is_dir() {
            files.insert(format!("{prefix}{name}"));
        } else if !MADE.contains(&name.as_str()) && name != ".git" {
            list(&entry.path(), &format!("{prefix}{name}/"), files);
        }
    }
}

/// Words that may be paths, without the full stop of a sentence; addresses of other sites left out.
fn words(text: &str) -> impl Iterator<Item = &str> {
    let is_separator = |c: char| !(c.is_ascii_alphanumeric() || "_./-".contains(c));
    let words = text.split(is_separator).map(|word| word.trim_end_matches('.'));
    words.filter(|word| !word.is_empty() && !word.starts_with("//"))
}

/// Identifiers of a text.
fn identifiers(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !(c.is_alphanumeric() || c == '_')).filter(|word| !word.is_empty())
}

/// Whether a word is the name of a source file, and not an ending alone.
fn is_source(word: &str) -> bool {
    SOURCES.iter().any(|ending| word.strip_suffix(ending).is_some_and(|name| !name.is_empty() && !name.ends_with('/')))
}

/// Whether the last folders and the name of `file` are `end`.
fn ends_in(file: &str, end: &str) -> bool {
    file.strip_suffix(end).is_some_and(|before| before.is_empty() || before.ends_with('/'))
}

/// What the links and pictures of a text point to, those to other sites and within a page left out.
fn links(text: &str) -> impl Iterator<Item = &str> {
    let targets = text.split("](").skip(1).filter_map(|rest| Some(rest.split_once(')')?.0));
    let files = targets.map(|target| target.split('#').next().unwrap_or_default());
    files.filter(|file| !file.is_empty() && !file.contains("://"))
}

/// A link of a document as a path from the root.
fn beside(document: &str, link: &str) -> String {
    let mut path: Vec<&str> = document.split('/').collect();
    path.pop();
    for component in Path::new(link).components() {
        match component {
            Component::ParentDir => drop(path.pop()),
            Component::Normal(name) => path.push(name.to_str().unwrap()),
            _ => {}
        }
    }
    path.join("/")
}

/// What a command of cargo's names.
struct Named<'a> {
    package: &'a str,
    /// Option, folder and name of a target of the package; `None` for the package itself.
    target: Option<(&'static str, &'static str, &'a str)>,
}

/// What cargo's commands name in a text.
fn options(text: &str) -> Vec<Named<'_>> {
    let mut found = Vec::new();
    let mut package = None;
    let is_around = |c: char| !c.is_ascii_alphanumeric();
    let mut words = text.split_whitespace();
    while let Some(word) = words.next() {
        let target = TARGETS.iter().find(|(option, _)| *option == word);
        if word.trim_matches(is_around) == "cargo" {
            package = None;
        } else if word == "-p" {
            package = words.next().map(|name| name.trim_matches(is_around));
            found.extend(package.map(|package| Named { package, target: None }));
        } else if let (Some(&(option, folder)), Some(package)) = (target, package) {
            let name = words.next().map(|name| name.trim_matches(is_around));
            found.extend(name.map(|name| Named { package, target: Some((option, folder, name)) }));
        }
    }
    found
}
