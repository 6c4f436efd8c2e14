//! Takes comments and needless white space out of JavaScript and the style sheets in it, and nothing else: names stay, so that errors
//! can be read.

/// What may stand before a regular expression but not before a division, besides punctuation.
const BEFORE_EXPRESSION: [&str; 13] =
    ["await", "case", "delete", "do", "else", "in", "instanceof", "new", "of", "return", "throw", "typeof", "void"];

/// After these a line may go on: no semicolon is ever inserted there.
const GOES_ON_AFTER: &str = "{([,;=:?&|<>*%~^!";
/// Before these as well.
const GOES_ON_BEFORE: &str = "})],;.?:=&|";

/// A template behind this is a style sheet.
const STYLES: &str = "Styles=`";

/// `source` without comments and needless white space. Strings, templates and regular expressions stay as they are, but for templates
/// that are style sheets.
pub fn strip(source: &str) -> String {
    let mut stripper = Stripper { rest: source, out: String::with_capacity(source.len()), gap: Gap::None };
    stripper.code(false);
    stripper.out.push('\n');
    stripper.out
}

/// White space and comments since the last token.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Gap {
    None,
    Space,
    Line,
}

struct Stripper<'a> {
    rest: &'a str,
    out: String,
    gap: Gap,
}

impl Stripper<'_> {
    /// Goes on to the end, or in a template's substitution to the brace that closes it.
    fn code(&mut self, substitution: bool) {
        let mut depth = 0;
        while let Some(next) = self.rest.chars().next() {
            match next {
                _ if next.is_whitespace() => self.skip(next.len_utf8()),
                '/' if self.rest.starts_with("//") => self.skip(self.rest.find('\n').unwrap_or(self.rest.len())),
                '/' if self.rest.starts_with("/*") => {
                    self.skip(self.rest.find("*/").map_or(self.rest.len(), |at| at + 2))
                }
                '/' if self.expects_expression() => self.token(regular_expression(self.rest)),
                '"' | '\'' => self.token(string(self.rest, next)),
                '`' => self.template(),
                '}' if substitution && depth == 0 => return,
                _ => {
                    depth += i32::from(next == '{') - i32::from(next == '}');
                    self.token(word(self.rest).max(next.len_utf8()));
                }
            }
        }
    }

    fn skip(&mut self, length: usize) {
        let (skipped, rest) = self.rest.split_at(length);
        let gap = if skipped.contains('\n') { Gap::Line } else { Gap::Space };
        self.gap = if self.gap == Gap::Line { Gap::Line } else { gap };
        self.rest = rest;
    }

    /// Writes the next `length` bytes as they are, and before them what must part them from the token before.
    fn token(&mut self, length: usize) {
        let (token, rest) = self.rest.split_at(length);
        if let (Some(before), Some(after)) = (self.out.chars().next_back(), token.chars().next()) {
            match self.gap {
                Gap::Line if !goes_on(before, after) => self.out.push('\n'),
                Gap::Line | Gap::Space if must_part(before, after) => self.out.push(' '),
                _ => {}
            }
        }
        self.out.push_str(token);
        (self.rest, self.gap) = (rest, Gap::None);
    }

    fn template(&mut self) {
        self.token(1);
        let is_style = self.out.ends_with(STYLES);
        loop {
            let text = end(self.rest, |rest| rest.starts_with('`') || rest.starts_with("${"));
            let (text, rest) = self.rest.split_at(text);
            self.out.push_str(&if is_style { style(text) } else { text.to_owned() });
            self.rest = rest;
            if !rest.starts_with("${") {
                self.copy(1);
                return;
            }
            self.copy(2);
            self.code(true);
            self.gap = Gap::None;
            self.copy(1);
        }
    }

    fn copy(&mut self, length: usize) {
        let (text, rest) = self.rest.split_at(length.min(self.rest.len()));
        self.out.push_str(text);
        (self.rest, self.gap) = (rest, Gap::None);
    }

    /// Whether a slash here begins a regular expression. One behind a closing bracket is taken for a division.
    fn expects_expression(&self) -> bool {
        let last = self.out.trim_end().len() - self.out.trim_end().trim_end_matches(is_word).len();
        let word = &self.out.trim_end()[self.out.trim_end().len() - last..];
        match self.out.trim_end().chars().next_back() {
            Some(before) if is_word(before) => BEFORE_EXPRESSION.contains(&word),
            Some(')' | ']' | '}' | '"' | '\'' | '`') => false,
            _ => true,
        }
    }
}

/// A style sheet without needless white space. Colons keep what stands before them: there it may part selectors.
fn style(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut gap = false;
    let mut quoted = None;
    for next in text.chars() {
        if quoted.is_none() && next.is_whitespace() {
            gap = true;
            continue;
        }
        let needless = out.ends_with(['{', '}', ';', ',', ':', '>']) || "{};,>".contains(next) || out.is_empty();
        if gap && !needless {
            out.push(' ');
        }
        if next == '}' && out.ends_with(';') {
            out.pop();
        }
        gap = false;
        match quoted {
            Some(quote) if next == quote => quoted = None,
            None if next == '"' || next == '\'' => quoted = Some(next),
            _ => {}
        }
        out.push(next);
    }
    out
}

fn goes_on(before: char, after: char) -> bool {
    let number = before.is_ascii_digit() && after == '.';
    (GOES_ON_AFTER.contains(before) || GOES_ON_BEFORE.contains(after)) && !number
}

fn must_part(before: char, after: char) -> bool {
    let number = before.is_ascii_digit() && after == '.';
    let doubled = before == after && "+-".contains(after);
    (is_word(before) && is_word(after)) || number || doubled || before == '/' || after == '/'
}

fn is_word(character: char) -> bool {
    character.is_alphanumeric() || "_$#\\".contains(character)
}

fn word(rest: &str) -> usize {
    rest.find(|character| !is_word(character)).unwrap_or(rest.len())
}

fn string(rest: &str, quote: char) -> usize {
    let body = end(&rest[1..], |rest| rest.starts_with(quote) || rest.starts_with('\n'));
    (body + 2).min(rest.len())
}

/// Length of a regular expression with its flags; a slash within brackets does not end it.
fn regular_expression(rest: &str) -> usize {
    let mut inside = false;
    let body = end(&rest[1..], |rest| {
        inside = (inside || rest.starts_with('[')) && !rest.starts_with(']');
        rest.starts_with('\n') || (rest.starts_with('/') && !inside)
    });
    let end = (body + 2).min(rest.len());
    end + word(&rest[end..])
}

/// Where `found` first holds, what is behind a backslash left out; the whole length where it never does.
fn end(text: &str, mut found: impl FnMut(&str) -> bool) -> usize {
    let mut escaped = false;
    for (at, character) in text.char_indices() {
        if !escaped && character != '\\' && found(&text[at..]) {
            return at;
        }
        escaped = !escaped && character == '\\';
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::strip;

    fn check(source: &str, expected: &str) {
        assert_eq!(strip(source).trim_end(), expected, "from {source:?}");
        assert_eq!(strip(&strip(source)), strip(source), "not the same when stripped again");
    }

    #[test]
    fn comments_and_white_space_go() {
        check("/** Docs. */\nexport class A {\n  // why\n  b = 1;\n}\n", "export class A{b=1;}");
        check("const  a = b /* c */ + d; // e", "const a=b+d;");
        check("return /* x */ typeof x;", "return typeof x;");
    }

    #[test]
    fn style_sheets_are_packed_and_mean_the_same() {
        check(
            "const a = 1, barStyles = `\n.a :hover, .b > i {\n  margin: 0 2px;\n  content: \"a: b\";\n}\n.c { top: 0; }\n`;",
            "const a=1,barStyles=`.a :hover,.b>i{margin:0 2px;content:\"a: b\"}.c{top:0}`;",
        );
        check("const text = `a: b; `;", "const text=`a: b; `;");
    }

    #[test]
    fn lines_without_a_semicolon_stay_apart() {
        check("a\nb", "a\nb");
        check("a = b\n(c)", "a=b\n(c)");
        check("a\n++b", "a\n++b");
        check("return // here\na", "return\na");
        check("x = {\n  a,\n  b,\n}\ny()", "x={a,b,}\ny()");
        check("a\n  .b()\n  ?.c", "a.b()?.c");
        check("class A {\n  #a\n  [b] = 1\n}", "class A{#a\n[b]=1}");
    }

    #[test]
    fn what_must_be_parted_is() {
        check("a + +b - -c", "a+ +b- -c");
        check("a + ++b", "a+ ++b");
        check("1 .toFixed()", "1 .toFixed()");
        check("1\n.toFixed()", "1\n.toFixed()");
        check("a / /b c/.d", "a / /b c/.d");
        check("#a in b", "#a in b");
    }

    #[test]
    fn strings_stay() {
        check(r#"a = "b  // c" + '/* d  */' + "\"  e";"#, r#"a="b  // c"+'/* d  */'+"\"  e";"#);
        check(r"a = '\\'; // b", r"a='\\';");
    }

    #[test]
    fn templates_stay_and_their_substitutions_are_code() {
        check(
            "a = `b  // c\n  ${ d + /* e */ f }  \\` ${`g  ${ {h: 1}.h }`}`;",
            "a=`b  // c\n  ${d+f}  \\` ${`g  ${{h:1}.h}`}`;",
        );
        check("css`a { b: c; }  /* kept */`", "css`a { b: c; }  /* kept */`");
    }

    #[test]
    fn regular_expressions_stay() {
        check(r"a.replace(/[/'  ]+\/\//g, b) / c / d // e", r"a.replace(/[/'  ]+\/\//g,b) / c / d");
        check("return /a  b/u.test(c)", "return /a  b/u.test(c)");
        check("x = (a) / 2; // '", "x=(a) / 2;");
    }

    #[test]
    fn what_is_cut_off_does_no_harm() {
        for source in ["'a", "`a", "`a ${", "/* a", "/a", "a\\", "\"\\", "}", "`${}"] {
            strip(source);
        }
    }
}
