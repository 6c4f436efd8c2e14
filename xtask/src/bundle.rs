//! Joins the player's modules into a few files: one request for a page, and text that packs a quarter smaller.
//!
//! Each module becomes a function that is called once, in the order in which a browser would evaluate them, and hands
//! its exports on. Names stay, so that errors can be read. What a module imports only later, when it is needed
//! (`await import`), becomes a script of its own: a function that is handed the modules of the first script that it uses, so
//! that no module is there twice. It knows the forms that `www/` is written in, one statement a line, and refuses any other;
//! `tests/browser/tests/joined.mjs` compares what comes out with what went in.

use std::collections::{BTreeSet, HashMap};
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

use crate::strip::strip;

/// A file that comes out.
pub struct Script {
    /// Its name, beside the others.
    pub name: String,
    /// What is in it.
    pub text: String,
}

/// The script `entry` in `folder` with everything that it imports, and behind it those that it imports later; stripped.
pub fn bundle(folder: &Path, entry: &str) -> Result<Vec<Script>> {
    let mut modules = Modules { folder: folder.to_path_buf(), ..Default::default() };
    let module = modules.read(Path::new(entry))?;
    let exports = match module.exports.as_slice() {
        [] => String::new(),
        names => format!("export{{{}}};", names.join(",")),
    };
    let mut first = format!("{}{}{}{exports}", modules.out, module.imports, module.body);
    let mut later = Vec::new();
    for path in std::mem::take(&mut modules.later) {
        later.push(modules.add_later(path, entry)?);
    }
    let stamp = stamp(std::iter::once(&first).chain(later.iter().map(|one| &one.body)));
    let mut scripts = Vec::new();
    for Later { path, name, body, needs } in later {
        let call = format!("(await import('./{name}')).{stamp}({needs})");
        first = first.replace(&mark(&path), &call);
        scripts.push(Script { name, text: strip(&format!("export const {stamp}=({needs})=>{{{body}}};\n")) });
    }
    scripts.insert(0, Script { name: entry.to_owned(), text: strip(&first) });
    Ok(scripts)
}

/// Where a module lies, seen from the folder, and what stands in its text.
struct Module {
    /// Statements that take the imported names out of the modules before.
    imports: String,
    exports: Vec<String>,
    body: String,
}

/// A script that is imported later.
struct Later {
    path: PathBuf,
    name: String,
    body: String,
    /// The first script's modules that it is handed, with commas between them.
    needs: String,
}

#[derive(Default)]
struct Modules {
    folder: PathBuf,
    /// Modules that have been written, by path, as numbers.
    done: HashMap<PathBuf, usize>,
    /// Modules whose imports are being written.
    open: Vec<PathBuf>,
    out: String,
    /// Modules that are imported later.
    later: Vec<PathBuf>,
    /// The modules before this number are another script's.
    before: usize,
    /// Those of them that this script uses.
    needs: BTreeSet<usize>,
}

impl Modules {
    /// Number of the module at `path`, written with all it imports if it has not been.
    fn add(&mut self, path: PathBuf) -> Result<usize> {
        if let Some(&number) = self.done.get(&path) {
            if number < self.before {
                self.needs.insert(number);
            }
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

    /// A script of the module at `path` and of all that it imports and `entry` does not.
    fn add_later(&mut self, path: PathBuf, entry: &str) -> Result<Later> {
        if self.before > 0 {
            bail!("{}: only one module can be imported later", path.display());
        }
        if self.done.contains_key(&path) {
            bail!("{} is imported later, and at once as well", path.display());
        }
        self.before = self.done.len();
        self.out.clear();
        let number = self.add(path.clone())?;
        if !self.later.is_empty() {
            bail!("{:?}: what is imported later can import nothing later itself", self.later);
        }
        let needs: Vec<String> = self.needs.iter().map(|number| format!("m{number}")).collect();
        let body = format!("{}return m{number};", self.out);
        Ok(Later { name: name_beside(entry, &path), path, body, needs: needs.join(",") })
    }

    fn read(&mut self, path: &Path) -> Result<Module> {
        let file = self.folder.join(path);
        let source = fs::read_to_string(&file).with_context(|| format!("cannot read {}", file.display()))?;
        let mut module = Module { imports: String::new(), exports: Vec::new(), body: String::new() };
        let mut known = 0;
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
                if is_module_form(line.trim_start()) {
                    bail!(place());
                }
                let line = self.rebased(path, line);
                known += usize::from(line.contains(PACKAGE_IMPORT));
                module.body.push_str(&line);
                module.body.push('\n');
            }
        }
        // Behind the comments, which are full of types that are imported.
        if strip(&module.body).matches("import(").count() != known {
            bail!("{}: it has an import() of a form that is not known to the bundler", file.display());
        }
        Ok(module)
    }

    /// A line whose paths to other files, if it has any, start at the folder.
    fn rebased(&mut self, path: &Path, line: &str) -> String {
        for (before, after) in [("await import('", "')"), ("new URL('", "', import.meta.url)")] {
            let Some((head, (target, tail))) =
                line.split_once(before).and_then(|(head, rest)| Some((head, rest.split_once(after)?)))
            else {
                continue;
            };
            let target = beside(path, target);
            // Bindings are written by another tool and stay a file of their own.
            return if before.contains("import") && !target.starts_with("pkg") {
                if !self.later.contains(&target) {
                    self.later.push(target.clone());
                }
                format!("{head}{}{tail}", mark(&target))
            } else {
                format!("{head}{before}./{}{after}{tail}", target.display())
            };
        }
        line.to_owned()
    }
}

/// How the bindings are imported once paths start at the folder.
const PACKAGE_IMPORT: &str = "await import('./pkg/";

/// What stands for the import of a script that is not written yet.
fn mark(path: &Path) -> String {
    format!("LATER_{:?}", path.display().to_string())
}

/// The name of a script beside `entry`, by the module that it begins with: `reprise-tools.js` for `tools/tools.js`.
fn name_beside(entry: &str, path: &Path) -> String {
    let family = entry.rsplit_once('-').map_or(String::new(), |(family, _)| format!("{family}-"));
    format!("{family}{}", path.file_name().unwrap_or_default().display())
}

/// A name that scripts of one build have in common, and no others: a page that is older than the files beside it gets no
/// script that does not fit, but an error. FNV-1a.
fn stamp<'a>(texts: impl Iterator<Item = &'a String>) -> String {
    let bytes = texts.flat_map(|text| text.bytes());
    let hash =
        bytes.fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3));
    format!("build{:08x}", hash >> 32)
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

/// Whether a line begins as an import or an export does.
fn is_module_form(line: &str) -> bool {
    let rest = line.strip_prefix("import").or_else(|| line.strip_prefix("export"));
    rest.is_some_and(|rest| rest.starts_with([' ', '{', '*', '\'', '"']) || rest.is_empty())
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
    use super::{Script, bundle};
    use std::fs;
    use std::path::Path;
    use std::process::Command;

    fn write(folder: &Path, files: &[(&str, &str)]) {
        for (name, text) in files {
            let path = folder.join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
    }

    fn bundled(files: &[(&str, &str)]) -> anyhow::Result<Vec<Script>> {
        let folder = tempfile::tempdir()?;
        write(folder.path(), files);
        bundle(folder.path(), "a-main.js")
    }

    /// What `main` of the script prints in node, from the files as they are and joined.
    fn told(files: &[(&str, &str)]) -> [String; 2] {
        let (plain, joined) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        write(plain.path(), files);
        for Script { name, text } in bundle(plain.path(), "a-main.js").unwrap() {
            fs::write(joined.path().join(name), text).unwrap();
        }
        // Files that stay what they are.
        for (name, text) in files.iter().filter(|(name, _)| name.starts_with("pkg/")) {
            write(joined.path(), &[(name, text)]);
        }
        [plain, joined].map(|folder| {
            write(folder.path(), &[("package.json", "{\"type\":\"module\"}")]);
            let script = "const all = await import('./a-main.js'); console.log(Object.keys(all), await all.main());";
            let command =
                Command::new("node").args(["--input-type=module", "-e", script]).current_dir(&folder).output();
            let output = command.expect("the joined scripts are loaded in node 20, which has to be there");
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            String::from_utf8(output.stdout).unwrap().replace(&folder.path().display().to_string(), "")
        })
    }

    #[test]
    fn modules_are_written_once_in_order() {
        let scripts = bundled(&[
            (
                "a-main.js",
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
        let [Script { name, text }] = &scripts.unwrap()[..] else { panic!("there are more scripts than one") };
        assert_eq!((name.as_str(), text.as_str()), ("a-main.js", expected));
    }

    /// All forms of modules that `www/` uses, and that the joined scripts do what the modules do.
    const FORMS: [(&str, &str); 7] = [
        (
            "a-main.js",
            "/** `export { none }` */\nimport './parts/effect.js';\nimport { One, two, THREE, four } from './parts/forms.js';\nimport { load } from './parts/load.js';\n\n\
             // import { nothing } from './nowhere.js';\nconst own = `${two()}\n  // import { text }`;\nexport { One, own };\nexport async function main() {\n  return JSON.stringify([new One().two, two(), THREE, await four(), own, globalThis.effects, await load()]);\n}\n",
        ),
        ("parts/effect.js", "globalThis.effects = (globalThis.effects ?? 0) + 1;\n"),
        (
            "parts/forms.js",
            "import './effect.js';\nconst hidden = { a: 1 };\nexport class One {\n  two = two();\n}\nexport function two() {\n  return hidden.a / 2; // /half/\n}\n\
             export const THREE = /[/]\\/3/.source;\nexport async function four() {\n  return 4;\n}\n",
        ),
        (
            "parts/load.js",
            "/** @returns {import('./tools/tools.js').Tools} */\nexport async function load() {\n  const bindings = await import('../pkg/web.js');\n  const address = new URL('../pkg/web.wasm', import.meta.url);\n\
             const tools = await import('./tools/tools.js');\n  const { Tools } = tools;\n  return [bindings.bound, address.pathname, Object.keys(tools), new Tools().about];\n}\n",
        ),
        (
            "parts/tools/tools.js",
            "import { two, THREE } from '../forms.js';\nimport { help } from './help.js';\nexport class Tools {\n  about = [two(), THREE, help];\n}\nexport const others = [];\n",
        ),
        ("parts/tools/help.js", "import '../effect.js';\nexport const help = `see ${globalThis.effects}`;\n"),
        ("pkg/web.js", "export const bound = 'bound';\n"),
    ];

    #[test]
    fn joined_scripts_do_in_node_what_the_modules_do() {
        let [plain, joined] = told(&FORMS);
        assert_eq!(plain, joined);
        assert!(plain.contains("see 1"), "{plain}");
    }

    #[test]
    fn what_is_imported_later_is_a_script_of_its_own() {
        let scripts = bundled(&FORMS).unwrap();
        let names: Vec<_> = scripts.iter().map(|script| script.name.as_str()).collect();
        assert_eq!(names, ["a-main.js", "a-tools.js"]);
        assert!(!scripts[0].text.contains("see ") && scripts[1].text.contains("see "));
        // Modules of the first script are handed over, not written again.
        assert!(!scripts[1].text.contains("effects ??"), "{}", scripts[1].text);
        let stamp = scripts[1].text.strip_prefix("export const ").and_then(|text| text.split_once('=')).unwrap().0;
        assert!(scripts[0].text.contains(&format!("(await import('./a-tools.js')).{stamp}(m")), "{}", scripts[0].text);
    }

    #[test]
    fn scripts_of_another_build_have_another_stamp() {
        let stamp = |effect: &str| {
            let mut files = FORMS;
            files[1].1 = effect;
            bundled(&files).unwrap().remove(1).text[..30].to_owned()
        };
        assert_eq!(stamp(FORMS[1].1), stamp(FORMS[1].1));
        assert_ne!(stamp(FORMS[1].1), stamp("globalThis.effects = 2;\n"));
    }

    #[test]
    fn forms_that_are_not_known_are_refused_with_their_line() {
        for bad in [
            "import a from './b.js';",
            "import * as a from './b.js';",
            "import { a as c } from './b.js';",
            "import { a } from 'b';",
            "import {",
            "export default 1;",
            "export let a = 1;",
            "export * from './b.js';",
            "export function* a() {}",
            "export const { a } = b;",
        ] {
            let files = [("a-main.js", &*format!("\n{bad}\n")), ("b.js", "export const a = 1;\n")];
            let error = bundled(&files).err().unwrap();
            assert!(format!("{error:#}").contains("a-main.js:2"), "{error:#}");
        }
    }

    #[test]
    fn forms_within_a_line_are_refused_with_their_file() {
        for bad in [
            "  import { a } from './b.js';",
            "  export const c = 1;",
            "import('./b.js').then(() => {});",
            "const b = import('./b.js');",
            "const b = await import(name);",
        ] {
            let files = [("a-main.js", &*format!("\n{bad}\n")), ("b.js", "export const a = 1;\n")];
            let error = bundled(&files).err().unwrap();
            assert!(format!("{error:#}").contains("a-main.js"), "{error:#}");
        }
    }

    #[test]
    fn circles_are_refused() {
        let circle =
            [("a-main.js", "import './a.js';\n"), ("a.js", "import './b.js';\n"), ("b.js", "import './a.js';\n")];
        assert!(format!("{:#}", bundled(&circle).err().unwrap()).contains("imports itself"));
    }

    #[test]
    fn what_is_imported_at_once_cannot_be_imported_later() {
        let both =
            [("a-main.js", "import './b.js';\nconst b = await import('./b.js');\n"), ("b.js", "export const a = 1;\n")];
        assert!(format!("{:#}", bundled(&both).err().unwrap()).contains("at once"));
    }
}
