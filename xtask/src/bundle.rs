//! Joins the player's modules into one file: one request for a page, and text that packs a quarter smaller.
//!
//! Each module becomes a function that is called once, in the order in which a browser would evaluate them, and hands
//! its exports on. Names stay, so that errors can be read. It knows the forms that `www/` is written in, one statement a
//! line, and refuses any other.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

use crate::strip::strip;

/// The script `entry` in `folder` with everything that it imports, stripped.
pub fn bundle(folder: &Path, entry: &str) -> Result<String> {
    let mut modules = Modules { folder, done: HashMap::new(), open: Vec::new(), out: String::new() };
    let module = modules.read(Path::new(entry))?;
    let exports = match module.exports.as_slice() {
        [] => String::new(),
        names => format!("export{{{}}};", names.join(",")),
    };
    Ok(strip(&format!("{}{}{}{exports}", modules.out, module.imports, module.body)))
}

/// Where a module lies, seen from the folder, and what stands in its text.
struct Module {
    /// Statements that take the imported names out of the modules before.
    imports: String,
    exports: Vec<String>,
    body: String,
}

struct Modules<'a> {
    folder: &'a Path,
    /// Modules that have been written, by path, as numbers.
    done: HashMap<PathBuf, usize>,
    /// Modules whose imports are being written.
    open: Vec<PathBuf>,
    out: String,
}

impl Modules<'_> {
    /// Number of the module at `path`, written with all it imports if it has not been.
    fn add(&mut self, path: PathBuf) -> Result<usize> {
        if let Some(&number) = self.done.get(&path) {
            return Ok(number);
        }
        if self.open.contains(&path) {
            bail!("{} imports itself by way of {:?}", path.display(), self.open);
        }
        self.open.push(path.clone());
        let Module { imports, exports, body } = self.read(&path)?;
        self.open.pop();
        let number = self.done.len();
        let exports = exports.join(",");
        self.out.push_str(&format!("const m{number}=(()=>{{{imports}{body}\nreturn{{{exports}}};}})();\n"));
        self.done.insert(path, number);
        Ok(number)
    }

    fn read(&mut self, path: &Path) -> Result<Module> {
        let file = self.folder.join(path);
        let source = fs::read_to_string(&file).with_context(|| format!("cannot read {}", file.display()))?;
        let mut module = Module { imports: String::new(), exports: Vec::new(), body: String::new() };
        for (index, line) in source.lines().enumerate() {
            let place = || format!("{}:{}: this form is not known to the bundler: {line}", file.display(), index + 1);
            if let Some(statement) = line.strip_prefix("import ") {
                let (names, from) = import(statement).with_context(place)?;
                let number = self.add(beside(path, from))?;
                module.imports.push_str(&names.map_or(String::new(), |names| format!("const{names}=m{number};")));
            } else if let Some(statement) = line.strip_prefix("export ") {
                let (names, kept) = export(statement).with_context(place)?;
                module.exports.extend(names);
                module.body.push_str(kept);
                module.body.push('\n');
            } else {
                module.body.push_str(&self.rebased(path, line)?);
                module.body.push('\n');
            }
        }
        Ok(module)
    }

    /// A line whose paths to other files, if it has any, start at the folder.
    fn rebased(&mut self, path: &Path, line: &str) -> Result<String> {
        for (before, after) in [("await import('", "')"), ("new URL('", "', import.meta.url)")] {
            let Some((head, (target, tail))) =
                line.split_once(before).and_then(|(head, rest)| Some((head, rest.split_once(after)?)))
            else {
                continue;
            };
            let target = beside(path, target);
            // Bindings are written by another tool and stay a file of their own; what is ours is in here already.
            return Ok(if before.contains("import") && !target.starts_with("pkg") {
                format!("{head}m{}{tail}", self.add(target)?)
            } else {
                format!("{head}{before}./{}{after}{tail}", target.display())
            });
        }
        Ok(line.to_owned())
    }
}

/// Names (braces and all) and path of `{ a, b } from './c.js';` or `'./c.js';`.
fn import(statement: &str) -> Option<(Option<&str>, &str)> {
    let (names, from) = match statement.strip_prefix('{') {
        Some(_) => statement.split_once(" from ").map(|(names, from)| (Some(names), from))?,
        None => (None, statement),
    };
    let simple = names.is_none_or(|names| names.ends_with('}') && !names.contains(" as "));
    let from = from.strip_prefix('\'')?.strip_suffix("';")?;
    (simple && from.starts_with('.')).then_some((names, from))
}

/// Names that a statement behind `export` declares, and what stays of it.
fn export(statement: &str) -> Option<(Vec<String>, &str)> {
    if let Some(names) = statement.strip_prefix("{ ") {
        let names = names.strip_suffix(" };")?;
        return Some((names.split(", ").map(str::to_owned).collect(), ""));
    }
    let declared =
        ["class ", "function ", "async function ", "const "].iter().find_map(|&kind| statement.strip_prefix(kind))?;
    let end = declared.find(|character: char| !character.is_alphanumeric() && character != '_')?;
    (end > 0).then(|| (vec![declared[..end].to_owned()], statement))
}

/// The path that `target` means in the file at `path`.
fn beside(path: &Path, target: &str) -> PathBuf {
    let mut folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
    for part in target.split('/') {
        match part {
            "." => {}
            ".." => _ = folder.pop(),
            part => folder.push(part),
        }
    }
    folder
}

#[cfg(test)]
mod tests {
    use super::bundle;
    use std::fs;

    fn bundled(files: &[(&str, &str)]) -> anyhow::Result<String> {
        let folder = tempfile::tempdir()?;
        fs::create_dir(folder.path().join("parts"))?;
        for (name, text) in files {
            fs::write(folder.path().join(name), text)?;
        }
        bundle(folder.path(), "main.js")
    }

    #[test]
    fn modules_are_written_once_in_order() {
        let text = bundled(&[
            (
                "main.js",
                "import { A } from './parts/a.js';\nimport { b } from './parts/b.js';\nexport class C extends A {}\nb();\n",
            ),
            ("parts/a.js", "import { b } from './b.js';\nexport class A {\n  x = b;\n}\n"),
            (
                "parts/b.js",
                "/** Counts. */\nconst D = 1;\nexport function b() {\n  return D;\n}\nexport const E = 2;\n",
            ),
        ]);
        let expected = "const m0=(()=>{const D=1;function b(){return D;}\nconst E=2;return{b,E};})();\
                        const m1=(()=>{const{b}=m0;class A{x=b;}\nreturn{A};})();\
                        const{A}=m1;const{b}=m0;class C extends A{}\nb();export{C};\n";
        assert_eq!(text.unwrap(), expected);
    }

    #[test]
    fn paths_of_other_files_start_at_the_folder() {
        let text = bundled(&[
            ("main.js", "import './parts/a.js';\n"),
            (
                "parts/a.js",
                "const a = await import('../pkg/w.js');\nconst u = new URL('../pkg/w.wasm', import.meta.url);\nconst b = await import('./b.js');\n",
            ),
            ("parts/b.js", "export const c = 1;\n"),
        ])
        .unwrap();
        assert!(text.contains("await import('./pkg/w.js')"), "{text}");
        assert!(text.contains("new URL('./pkg/w.wasm',import.meta.url)"), "{text}");
        assert!(text.contains("const b=m0;"), "{text}");
    }

    #[test]
    fn forms_that_are_not_known_are_refused_with_their_line() {
        for bad in [
            "import a from './b.js';",
            "import * as a from './b.js';",
            "import { a as c } from './b.js';",
            "import { a } from 'b';",
            "export default 1;",
            "export let a = 1;",
            "export * from './b.js';",
        ] {
            let error = bundled(&[("main.js", &format!("\n{bad}\n")), ("b.js", "export const a = 1;\n")]).unwrap_err();
            assert!(format!("{error:#}").contains("main.js:2"), "{error:#}");
        }
    }

    #[test]
    fn circles_are_refused() {
        let circle =
            [("main.js", "import './a.js';\n"), ("a.js", "import './b.js';\n"), ("b.js", "import './a.js';\n")];
        assert!(format!("{:#}", bundled(&circle).unwrap_err()).contains("imports itself"));
    }
}
