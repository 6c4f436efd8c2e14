//! Numbered files: which belong to one run of frames, in which order, and which numbers are missing.
//!
//! The number may stand anywhere in a name (`walk_0012.obj`, `walk (12).obj`, `0012_walk.obj`) and may be negative. Of
//! several numbers, that of the frame is the one by which the names fall into the fewest runs.

use std::cmp::Ordering;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::{Path, PathBuf};

use super::warning::Warning;

/// Files of one folder whose names differ in one number only, in its order.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Run {
    /// What the names share, without the number: for `walk_0012.obj` it is `walk`.
    pub name: String,
    /// The files.
    pub files: Vec<PathBuf>,
    /// Their numbers, in ascending order; empty for a single file whose name holds none.
    pub numbers: Vec<i64>,
}

/// Groups `files` into runs, in natural order: `f2` before `f10`. A file without a number is a run of its own.
pub(super) fn runs(files: Vec<PathBuf>) -> Vec<Run> {
    let names: Vec<Name> = files.iter().map(|path| Name::of_file(path)).collect();
    let mut runs: Vec<(String, Run)> = grouped(names)
        .into_iter()
        .map(|run| {
            let folder = run.indices.first().and_then(|&k| files[k].parent()).map(Path::to_string_lossy);
            let key = format!("{}/{}", folder.unwrap_or_default(), run.name);
            let members = run.indices.iter().map(|&k| files[k].clone()).collect();
            (key, Run { name: run.name, files: members, numbers: run.numbers })
        })
        .collect();
    runs.sort_by(|a, b| natural(&a.0, &b.0).then_with(|| a.1.files.cmp(&b.1.files)));
    runs.into_iter().map(|(_, run)| run).collect()
}

/// As [`runs`], but the number may be that of each file's folder: `f_001/mesh.obj`, `f_002/mesh.obj`.
///
/// `None` where folders are no frames: where one holds several files, or names or numbers do not make one run.
pub(super) fn run_of_folders(files: &[PathBuf]) -> Option<Run> {
    let run = folders_as_frames(files)?;
    let members = run.indices.iter().map(|&k| files[k].clone()).collect();
    Some(Run { name: run.name, files: members, numbers: run.numbers })
}

fn folders_as_frames(files: &[PathBuf]) -> Option<Indices> {
    let folders: Vec<&Path> = files.iter().map(|file| file.parent()).collect::<Option<_>>()?;
    let distinct: HashSet<&Path> = folders.iter().copied().collect();
    let within: HashSet<Option<&Path>> = folders.iter().map(|folder| folder.parent()).collect();
    if files.len() < 2 || distinct.len() != files.len() || within.len() != 1 {
        return None;
    }
    // Files in them have one name, or are numbered themselves.
    let alone: Vec<PathBuf> = files.iter().filter_map(|file| file.file_name()).map(PathBuf::from).collect();
    let same: HashSet<&PathBuf> = alone.iter().collect();
    if same.len() > 1 && grouped(alone.iter().map(|name| Name::of_file(name)).collect()).len() > 1 {
        return None;
    }
    let names: Vec<Name> = folders.iter().map(|folder| Name::new(String::new(), &name_of(folder))).collect();
    let mut runs = grouped(names);
    runs.pop().filter(|run| runs.is_empty() && run.numbers.len() == files.len())
}

/// The number of each of `files`, which together are one run; `None` where they are not.
pub(super) fn numbers_of(files: &[PathBuf]) -> Option<Vec<i64>> {
    let mut runs = grouped(files.iter().map(|path| Name::of_file(path)).collect());
    let run = match runs.len() {
        1 => runs.pop()?,
        _ => folders_as_frames(files)?,
    };
    let mut of_file = vec![0; files.len()];
    run.indices.iter().zip(&run.numbers).for_each(|(&k, &number)| of_file[k] = number);
    (run.numbers.len() == files.len()).then_some(of_file)
}

/// A sentence about the numbers that a run skips; `None` where the numbers rise by equal steps.
pub(super) fn gap_warning(run: &Run) -> Option<Warning> {
    let pairs = || run.numbers.windows(2).map(|pair| [pair[0], pair[1]]);
    let step = pairs().map(|[a, b]| b.saturating_sub(a)).filter(|&d| d > 0).min()?;
    let gaps: Vec<[i64; 2]> = pairs().filter(|[a, b]| b.saturating_sub(*a) > step).collect();
    let first = run.files.first()?.display();
    let told: Vec<String> = gaps.iter().take(8).map(|&[from, to]| gap(from, to, step)).collect();
    let more =
        if gaps.len() > told.len() { format!(" and {} gaps more", gaps.len() - told.len()) } else { String::new() };
    (!gaps.is_empty()).then(|| {
        Warning::new(
            "W_FRAMES_MISSING",
            format!(
                "{first}: of this run is missing {}{more}: the frames play on without a pause; if the motion jumps there, \
                 make two sequences with patterns (START:END)",
                told.join(", ")
            ),
        )
    })
}

fn gap(from: i64, to: i64, step: i64) -> String {
    let (first, last) = (from.saturating_add(step), to.saturating_sub(step));
    let missing = if first >= last { format!("{first}") } else { format!("{first} to {last}") };
    format!("{missing} (between {from} and {to})")
}

/// A sentence about files of a run that have the same number, as `f1` and `f01`.
pub(super) fn double_warning(run: &Run) -> Option<Warning> {
    let at = run.numbers.windows(2).position(|pair| pair[0] == pair[1])?;
    let (first, second) = (run.files.get(at)?.display(), run.files.get(at + 1)?.display());
    Some(Warning::new(
        "W_FRAMES_DOUBLE",
        format!("{first} and {second} both are number {}: they are played one after the other", run.numbers[at]),
    ))
}

/// A sentence about a run all of whose numbers count as negative; a dash may be a dash.
pub(super) fn negative_warning(run: &Run) -> Option<Warning> {
    let [first, .., last] = run.numbers.as_slice() else { return None };
    (*last < 0).then(|| {
        Warning::new(
            "W_NUMBERS_NEGATIVE",
            format!(
                "{}: all numbers of this run are negative, so that it is played from {first} to {last}: if the dash before \
                 them is none, rename the files",
                run.files.first().map(|file| file.display().to_string()).unwrap_or_default()
            ),
        )
    })
}

/// A name taken apart.
struct Name {
    folder: String,
    /// What stands before each number, and after the last one; one more than numbers.
    texts: Vec<String>,
    numbers: Vec<Number>,
}

struct Number {
    value: i64,
    /// Its digits as written, without a sign.
    digits: String,
    sign: Sign,
}

/// What a dash before a number is.
#[derive(Clone, Copy, PartialEq)]
enum Sign {
    /// There is none.
    None,
    /// A minus: it follows a separator, or begins the name.
    Minus,
    /// A minus only where other files of the run have none: it follows a blank or another dash.
    Perhaps,
}

impl Name {
    fn of_file(path: &Path) -> Self {
        let folder = path.parent().map(|parent| parent.to_string_lossy().into_owned()).unwrap_or_default();
        let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        Self::new(folder, &stem)
    }

    fn new(folder: String, stem: &str) -> Self {
        let (mut texts, mut numbers) = (vec![String::new()], Vec::new());
        let mut rest = stem;
        while let Some(first) = rest.chars().next() {
            let length = rest.bytes().take_while(u8::is_ascii_digit).count();
            let (digits, tail) = rest.split_at(length);
            let before = texts.last_mut();
            match (digits.parse::<i64>(), before) {
                (Ok(value), Some(before)) => {
                    let sign = sign_at_end(before, numbers.is_empty());
                    if sign != Sign::None {
                        before.pop();
                    }
                    let value = if sign == Sign::None { value } else { -value };
                    numbers.push(Number { value, digits: digits.to_owned(), sign });
                    texts.push(String::new());
                    rest = tail;
                }
                // No digit, or more of them than a number has.
                (_, Some(before)) => {
                    let length = length.max(first.len_utf8());
                    before.push_str(&rest[..length]);
                    rest = &rest[length..];
                }
                (_, None) => break,
            }
        }
        Self { folder, texts, numbers }
    }

    /// Makes a dash of what may be a minus.
    fn without_doubt(&mut self) {
        for (text, number) in self.texts.iter_mut().zip(&mut self.numbers) {
            if number.sign == Sign::Perhaps {
                text.push('-');
                number.value = number.value.saturating_neg();
                number.sign = Sign::None;
            }
        }
    }

    /// What names of one run have in common; the number of the frame is one of those left out.
    fn template(&self) -> (String, String) {
        (self.folder.clone(), self.texts.join("\0"))
    }

    /// What the name says without number `at` and those of `dropped`.
    fn without(&self, at: usize, dropped: &[usize]) -> String {
        let mut parts: Vec<String> = vec![String::new()];
        for (k, text) in self.texts.iter().enumerate() {
            if let Some(part) = parts.last_mut() {
                part.push_str(text);
            }
            let Some(number) = self.numbers.get(k) else { continue };
            if k == at || dropped.contains(&k) {
                parts.push(String::new());
            } else if let Some(part) = parts.last_mut() {
                part.push_str(if number.sign == Sign::None { "" } else { "-" });
                part.push_str(&number.digits);
            }
        }
        let separators = |c: char| c.is_whitespace() || "_-.()[]{}#=+".contains(c);
        let parts = parts.iter().map(|part| part.trim_matches(separators)).filter(|part| !part.is_empty());
        parts.collect::<Vec<_>>().join("_")
    }
}

/// What a dash at the end of `before` is; `first` where the name begins with it.
fn sign_at_end(before: &str, first: bool) -> Sign {
    let Some(start) = before.strip_suffix('-') else { return Sign::None };
    match start.chars().next_back() {
        None => {
            if first {
                Sign::Minus
            } else {
                Sign::None
            }
        }
        Some('_' | '.' | '(' | '[' | '{' | '=' | '#') => Sign::Minus,
        Some('-') => Sign::Perhaps,
        Some(c) if c.is_whitespace() => Sign::Perhaps,
        Some(_) => Sign::None,
    }
}

/// A run, as indices of names.
struct Indices {
    name: String,
    indices: Vec<usize>,
    numbers: Vec<i64>,
}

fn grouped(mut names: Vec<Name>) -> Vec<Indices> {
    // What may be a minus is one where the same name exists without it.
    let without: HashSet<_> = names
        .iter()
        .filter(|name| name.numbers.iter().all(|number| number.sign == Sign::None))
        .map(Name::template)
        .collect();
    for name in &mut names {
        if name.numbers.iter().any(|number| number.sign == Sign::Perhaps) && !without.contains(&name.template()) {
            name.without_doubt();
        }
    }
    let mut groups: BTreeMap<(String, String), Vec<usize>> = BTreeMap::new();
    for (k, name) in names.iter().enumerate() {
        groups.entry(name.template()).or_default().push(k);
    }
    groups.into_values().flat_map(|group| split(&names, &group)).collect()
}

/// The runs of names of one template.
fn split(names: &[Name], group: &[usize]) -> Vec<Indices> {
    let places = names[group[0]].numbers.len();
    let distinct = |place: usize| group.iter().map(|&k| names[k].numbers[place].value).collect::<HashSet<_>>();
    let counts: Vec<usize> = (0..places).map(|place| distinct(place).len()).collect();
    let varying: Vec<usize> = (0..places).filter(|&place| counts[place] > 1).collect();
    let Some(&last) = varying.last() else {
        return unvaried(names, group);
    };
    // Numbers that no two files share, such as times, count along with the frames.
    let unique: Vec<usize> = varying.iter().copied().filter(|&place| counts[place] == group.len()).collect();
    let partition = |frame: usize| -> HashMap<Vec<i64>, Vec<usize>> {
        let others: Vec<usize> = varying.iter().copied().filter(|&p| p != frame && !unique.contains(&p)).collect();
        let mut parts: HashMap<Vec<i64>, Vec<usize>> = HashMap::new();
        for &k in group {
            let key = others.iter().map(|&place| names[k].numbers[place].value).collect();
            parts.entry(key).or_default().push(k);
        }
        parts
    };
    let extent = |place: usize| {
        let values = distinct(place);
        let (least, most) = (values.iter().min().copied(), values.iter().max().copied());
        i128::from(most.unwrap_or(0)) - i128::from(least.unwrap_or(0))
    };
    // Written the same way twice in one run, a number cannot be that of the frame.
    let serves = |place: usize| {
        partition(place).values().all(|part| {
            let written: HashSet<_> =
                part.iter().map(|&k| (names[k].numbers[place].value, &names[k].numbers[place].digits)).collect();
            written.len() == part.len()
        })
    };
    let frame = varying
        .iter()
        .copied()
        .filter(|&place| serves(place))
        .min_by_key(|&place| (partition(place).len(), extent(place), std::cmp::Reverse(place)))
        .unwrap_or(last);
    partition(frame).into_values().map(|part| ordered(names, part, frame, &unique)).collect()
}

/// Files whose names differ in no number's value: each is a run of its own, but for `f1` beside `f01`.
fn unvaried(names: &[Name], group: &[usize]) -> Vec<Indices> {
    match names[group[0]].numbers.len() {
        0 => group
            .iter()
            .map(|&k| Indices { name: names[k].texts.concat(), indices: vec![k], numbers: vec![] })
            .collect(),
        places => vec![ordered(names, group.to_vec(), places - 1, &[])],
    }
}

fn ordered(names: &[Name], mut part: Vec<usize>, frame: usize, dropped: &[usize]) -> Indices {
    let key = |&k: &usize| (names[k].numbers[frame].value, names[k].numbers[frame].digits.len(), k);
    part.sort_by_key(key);
    let numbers = part.iter().map(|&k| names[k].numbers[frame].value).collect();
    let name = part.first().map(|&k| names[k].without(frame, dropped)).unwrap_or_default();
    Indices { name, indices: part, numbers }
}

/// The last part of a path.
pub(super) fn name_of(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

/// Compares names with runs of digits as numbers.
pub(super) fn natural(a: &str, b: &str) -> Ordering {
    let (mut x, mut y) = (a.as_bytes(), b.as_bytes());
    while let (Some(&p), Some(&q)) = (x.first(), y.first()) {
        let order = if p.is_ascii_digit() && q.is_ascii_digit() {
            let (m, n) = (take_digits(&mut x), take_digits(&mut y));
            m.len().cmp(&n.len()).then_with(|| m.cmp(n))
        } else {
            (x, y) = (&x[1..], &y[1..]);
            p.cmp(&q)
        };
        if order.is_ne() {
            return order;
        }
    }
    x.len().cmp(&y.len()).then_with(|| a.cmp(b))
}

/// Takes the leading digits off `rest`, without leading zeros.
fn take_digits<'a>(rest: &mut &'a [u8]) -> &'a [u8] {
    let count = rest.iter().take_while(|c| c.is_ascii_digit()).count();
    let (digits, tail) = rest.split_at(count);
    *rest = tail;
    let zeros = digits.iter().take_while(|&&c| c == b'0').count();
    &digits[zeros..]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paths(names: &[&str]) -> Vec<PathBuf> {
        names.iter().map(PathBuf::from).collect()
    }

    /// Names of runs, and their files in order.
    fn found(names: &[&str]) -> Vec<(String, Vec<String>)> {
        let files = |run: &Run| run.files.iter().map(|file| file.to_string_lossy().into_owned()).collect();
        runs(paths(names)).iter().map(|run| (run.name.clone(), files(run))).collect()
    }

    fn run(name: &str, files: &[&str]) -> (String, Vec<String>) {
        (name.to_owned(), files.iter().map(|&file| file.to_owned()).collect())
    }

    #[test]
    fn runs_follow_the_numbers_not_the_letters() {
        let names = ["d/w10.obj", "d/run_1.obj", "d/w9.obj", "d/w1.obj", "d/rest.obj", "d/run_0.obj"];
        assert_eq!(
            found(&names),
            [
                run("rest", &["d/rest.obj"]),
                run("run", &["d/run_0.obj", "d/run_1.obj"]),
                run("w", &["d/w1.obj", "d/w9.obj", "d/w10.obj"]),
            ]
        );
    }

    #[test]
    fn numbers_stand_anywhere_in_a_name() {
        for (names, name) in [
            (["walk (1).obj", "walk (2).obj", "walk (10).obj"], "walk"),
            (["walk_1_x.obj", "walk_02_x.obj", "walk_10_x.obj"], "walk_x"),
            (["1_walk.obj", "2_walk.obj", "10_walk.obj"], "walk"),
            (["t2 1 v3.obj", "t2 2 v3.obj", "t2 10 v3.obj"], "t2_v3"),
            (["f[1].obj", "f[2].obj", "f[10].obj"], "f"),
            (["f0001_170.ply", "f0002_204.ply", "f0003_171.ply"], "f"),
            (["a1_1.obj", "a2_2.obj", "a3_3.obj"], "a"),
        ] {
            assert_eq!(found(&names), [run(name, &names)]);
        }
    }

    #[test]
    fn takes_and_cameras_are_runs_of_their_own() {
        let takes = ["take1_1.obj", "take1_2.obj", "take2_3.obj", "take2_4.obj", "take2_5.obj"];
        assert_eq!(found(&takes), [run("take1", &takes[..2]), run("take2", &takes[2..])]);
        let cameras = ["f1_c1.obj", "f1_c2.obj", "f2_c1.obj", "f2_c2.obj", "f3_c1.obj", "f3_c2.obj"];
        let of = |k: usize| run(&format!("f_c{}", k + 1), &[cameras[k], cameras[k + 2], cameras[k + 4]]);
        assert_eq!(found(&cameras), [of(0), of(1)]);
    }

    #[test]
    fn negative_numbers_come_first_and_dashes_are_dashes() {
        let names = ["w_-0010.obj", "w_-0002.obj", "w_0000.obj", "w_0003.obj"];
        assert_eq!(found(&names), [run("w", &names)]);
        assert_eq!(runs(paths(&names))[0].numbers, [-10, -2, 0, 3]);
        let dashes = ["w-1.obj", "w-2.obj", "w-10.obj"];
        assert_eq!(found(&dashes), [run("w", &dashes)]);
        let dates = ["w2024-01-1.obj", "w2024-01-2.obj", "w2024-01-10.obj"];
        assert_eq!(found(&dates), [run("w2024-01", &dates)]);
        let starts = ["-2.obj", "-1.obj", "0.obj"];
        assert_eq!(found(&starts), [run("", &starts)]);
        let blanks = ["w -1.obj", "w -2.obj", "w -10.obj"];
        assert_eq!(found(&blanks), [run("w", &blanks)]);
        let both = ["w -2.obj", "w -1.obj", "w 0.obj", "w 1.obj"];
        assert_eq!(found(&both), [run("w", &both)]);
        let all = &runs(paths(&["w_-1.obj", "w_-2.obj"]))[0];
        assert!(negative_warning(all).is_some() && all.numbers == [-2, -1]);
    }

    #[test]
    fn folders_may_be_frames() {
        let names = ["c/f_2/mesh.obj", "c/f_10/mesh.obj", "c/f_1/mesh.obj"];
        let run = run_of_folders(&paths(&names)).unwrap();
        assert_eq!((run.name.as_str(), run.numbers), ("f", vec![1, 2, 10]));
        assert_eq!(run.files, paths(&["c/f_1/mesh.obj", "c/f_2/mesh.obj", "c/f_10/mesh.obj"]));
        assert_eq!(numbers_of(&paths(&names)), Some(vec![2, 10, 1]));
        for other in [
            &["c/walk/f1.obj", "c/run/f1.obj"][..],
            &["c/f1/a.obj", "c/f2/b.obj"],
            &["c/f1/a.obj", "c/f1/b.obj"],
            &["c/f1/a.obj", "d/f2/a.obj"],
            &["c/f1/a.obj"],
        ] {
            assert_eq!(run_of_folders(&paths(other)), None, "{other:?}");
        }
    }

    #[test]
    fn equal_steps_are_no_gap() {
        let warning = |names: &[&str]| gap_warning(&runs(paths(names))[0]);
        assert_eq!(warning(&["f2", "f4", "f6"]), None);
        assert_eq!(warning(&["f7"]), None);
        let told = warning(&["f2", "f3", "f6", "f7", "f9"]).unwrap();
        assert!(told.contains("4 to 5 (between 3 and 6), 8 (between 7 and 9)"), "{told}");
        let double = double_warning(&runs(paths(&["f1", "f01", "f2"]))[0]).unwrap();
        assert!(double.contains("f1 and f01 both are number 1"), "{double}");
        assert!(double_warning(&runs(paths(&["f1", "f01"]))[0]).is_some());
    }

    #[test]
    fn hostile_names_are_names() {
        for name in ["", "99999999999999999999999", "-", "--1", "-9223372036854775808", "1-2-3", "ä1ö2", "a\u{0}1"] {
            assert_eq!(runs(paths(&[name])).len(), 1, "{name:?}");
        }
        assert_eq!(runs(paths(&["f99999999999999999999999", "f1"])).len(), 2);
    }

    #[test]
    fn natural_order_is_total() {
        let names = ["a", "a01", "a1", "a2", "a10", "b", "", "a1b", "10", "9"];
        for a in names {
            for b in names {
                assert_eq!(natural(a, b), natural(b, a).reverse(), "{a} {b}");
                assert_eq!(natural(a, b).is_eq(), a == b);
            }
        }
        assert!(natural("a2", "a10").is_lt());
    }
}
