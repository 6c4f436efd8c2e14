//! Numbered files: which belong to one run of frames, in which order, and which numbers are missing.

use super::warning::Warning;
use std::cmp::Ordering;
use std::path::{Path, PathBuf};

/// Files of one folder that share everything but a trailing number, in the order of that number.
#[derive(Debug, PartialEq)]
pub(super) struct Run {
    /// What the names share: for `walk_0012.obj` it is `walk_`.
    pub prefix: String,
    /// The files.
    pub files: Vec<PathBuf>,
}

/// Groups `files` into runs, in natural order: `f2` before `f10`. A file without a number is a run of its own.
pub(super) fn runs(files: Vec<PathBuf>) -> Vec<Run> {
    let mut keyed: Vec<(String, Option<u64>, PathBuf)> = files
        .into_iter()
        .map(|path| {
            let (prefix, number) = prefix_and_number(&path);
            let folder = path.parent().map(|p| p.to_string_lossy().into_owned()).unwrap_or_default();
            (format!("{folder}/{prefix}"), number, path)
        })
        .collect();
    keyed.sort_by(|a, b| natural(&a.0, &b.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
    let mut runs: Vec<(String, bool, Run)> = Vec::new();
    for (key, number, path) in keyed {
        match runs.last_mut() {
            Some((last, true, run)) if *last == key && number.is_some() => run.files.push(path),
            _ => {
                let prefix = prefix_and_number(&path).0;
                runs.push((key, number.is_some(), Run { prefix, files: vec![path] }));
            }
        }
    }
    runs.into_iter().map(|(_, _, run)| run).collect()
}

/// A sentence about the numbers that a run skips; `None` where the numbers rise by equal steps.
pub(super) fn gap_warning(files: &[PathBuf]) -> Option<Warning> {
    let numbers: Vec<u64> = files.iter().filter_map(|path| prefix_and_number(path).1).collect();
    let step = numbers.windows(2).map(|w| w[1].saturating_sub(w[0])).filter(|&d| d > 0).min()?;
    let gaps: Vec<[u64; 2]> =
        numbers.windows(2).filter(|w| w[1].saturating_sub(w[0]) > step).map(|w| [w[0], w[1]]).collect();
    let [from, to] = *gaps.first()?;
    let first = files.first()?.display();
    let message = format!(
        "{first}: {} gap(s) in the numbers of this run, the first between {from} and {to}: the frames play on without a \
         pause; if the motion jumps there, make two sequences with patterns (START:END)",
        gaps.len()
    );
    Some(Warning::new("W_FRAMES_MISSING", message))
}

/// Splits the file name without its ending into what comes before a trailing number, and the number.
pub(super) fn prefix_and_number(path: &Path) -> (String, Option<u64>) {
    let stem = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    let digits = stem.bytes().rev().take_while(u8::is_ascii_digit).count();
    let (prefix, number) = stem.split_at(stem.len() - digits);
    match number.parse() {
        Ok(number) => (prefix.to_owned(), Some(number)),
        Err(_) => (stem, None),
    }
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

    #[test]
    fn runs_follow_the_numbers_not_the_letters() {
        let found = runs(paths(&["d/w10.obj", "d/run_1.obj", "d/w9.obj", "d/w1.obj", "d/rest.obj", "d/run_0.obj"]));
        let expected = vec![
            Run { prefix: "rest".into(), files: paths(&["d/rest.obj"]) },
            Run { prefix: "run_".into(), files: paths(&["d/run_0.obj", "d/run_1.obj"]) },
            Run { prefix: "w".into(), files: paths(&["d/w1.obj", "d/w9.obj", "d/w10.obj"]) },
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn equal_steps_are_no_gap() {
        assert_eq!(gap_warning(&paths(&["f2", "f4", "f6"])), None);
        assert_eq!(gap_warning(&paths(&["f7"])), None);
        let warning = gap_warning(&paths(&["f2", "f3", "f6", "f7"])).unwrap();
        assert!(warning.contains("between 3 and 6"), "{warning}");
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
