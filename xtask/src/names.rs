//! Short names for what WebAssembly takes from its bindings: the given ones are long, end in a hash and do not pack.

use std::collections::HashMap;

/// Gives every name in `names` that stands for an import a short one, and the same in the script that provides them.
pub fn shorten<'a>(names: impl Iterator<Item = &'a mut String>, script: &str) -> String {
    let mut short = HashMap::new();
    for name in names {
        let next = format!("_{}", short.len());
        *name = short.entry(std::mem::take(name)).or_insert(next).clone();
    }
    rename(script, &short)
}

/// `script` with every identifier that `names` knows replaced, as a whole word.
fn rename(script: &str, names: &HashMap<String, String>) -> String {
    let mut renamed = String::with_capacity(script.len());
    let mut rest = script;
    while !rest.is_empty() {
        let end = rest.find(|letter: char| !is_in_name(letter)).unwrap_or(rest.len());
        let (word, after) = rest.split_at(end);
        renamed.push_str(names.get(word).map_or(word, String::as_str));
        let next = after.find(is_in_name).unwrap_or(after.len());
        let (between, after) = after.split_at(next);
        renamed.push_str(between);
        rest = after;
    }
    renamed
}

fn is_in_name(letter: char) -> bool {
    letter.is_alphanumeric() || letter == '_' || letter == '$'
}

#[cfg(test)]
mod tests {
    use super::shorten;

    #[test]
    fn whole_names_are_shortened_on_both_sides() {
        let mut names = ["__wbg_a_1".to_owned(), "__wbg_b_2".to_owned(), "__wbg_a_1".to_owned()];
        let script = "import0={__wbg_a_1:function(){return __wbg_a_11+x.__wbg_a_1;},__wbg_b_2};";
        let script = shorten(names.iter_mut(), script);
        assert_eq!(names, ["_0", "_1", "_0"]);
        assert_eq!(script, "import0={_0:function(){return __wbg_a_11+x._0;},_1};");
    }

    #[test]
    fn a_script_without_them_stays() {
        let script = "const größe = `a${b}`; // ü";
        assert_eq!(shorten(std::iter::empty(), script), script);
    }
}
