//! What an evaluation finds: tables, plots and how they agree with the papers. Page, CSV and JSON are made of it.

use serde::Serialize;
use serde_json::{Value, json};

use super::plot::Plot;

/// A whole report.
#[derive(Clone, Debug, Default)]
pub struct Document {
    /// What was evaluated.
    pub title: String,
    /// A sentence or two about it.
    pub lead: String,
    /// Facts, as (name, value).
    pub facts: Vec<(String, String)>,
    /// The sections, in order.
    pub sections: Vec<SectionReport>,
}

/// A section of a report.
#[derive(Clone, Debug, Default)]
pub struct SectionReport {
    /// Its number.
    pub number: u8,
    /// Its title.
    pub title: String,
    /// Why it could not be made; then the rest is empty.
    pub missing: Option<String>,
    /// Paragraphs on what was done.
    pub text: Vec<String>,
    /// What the papers say beside what was found.
    pub agreements: Vec<Agreement>,
    /// Tables.
    pub tables: Vec<Table>,
    /// Plots.
    pub plots: Vec<Plot>,
    /// Pictures.
    pub pictures: Vec<Picture>,
}

/// A picture within a report.
#[derive(Clone, Debug)]
pub struct Picture {
    /// The bytes of a PNG file.
    pub png: Vec<u8>,
    /// Its width and height in pixels.
    pub size: [u32; 2],
    /// What it shows.
    pub caption: String,
}

/// A table; what the CSV file `name.csv` holds.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// Name of its file, without ending.
    pub name: &'static str,
    /// What it shows.
    pub caption: String,
    /// Heads of its columns.
    pub columns: Vec<String>,
    /// Its rows, as long as the columns.
    pub rows: Vec<Vec<Cell>>,
    /// Whether it holds times, which no seed makes the same again.
    pub timed: bool,
}

/// A cell of a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Words.
    Text(String),
    /// A number and how many decimals are shown.
    Number(f64, usize),
    /// A count.
    Count(u64),
    /// Nothing to tell.
    Empty,
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

/// How something found compares with what the papers found.
#[derive(Clone, Debug, Serialize)]
pub struct Agreement {
    /// What the papers say.
    pub papers: String,
    /// What was found.
    pub found: String,
    /// Whether it holds.
    pub verdict: Verdict,
    /// Why not, or what to make of it.
    pub why: String,
}

/// Whether a finding of the papers holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Direction and size hold.
    Holds,
    /// The direction holds, the size does not.
    Direction,
    /// It does not hold.
    Fails,
    /// It was not tried.
    Missing,
}

impl Verdict {
    /// [`Self::Holds`] where `all`, [`Self::Direction`] where only `direction`, otherwise [`Self::Fails`].
    #[must_use]
    pub fn of(direction: bool, all: bool) -> Self {
        match (direction, all) {
            (true, true) => Self::Holds,
            (true, false) => Self::Direction,
            _ => Self::Fails,
        }
    }

    /// In words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Direction => "direction holds",
            Self::Fails => "does not hold",
            Self::Missing => "missing",
        }
    }
}

impl Cell {
    /// As it is shown.
    #[must_use]
    pub fn shown(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Number(number, decimals) if number.is_finite() => format!("{number:.decimals$}"),
            Self::Number(..) | Self::Empty => "\u{2013}".into(),
            Self::Count(count) => count.to_string(),
        }
    }

    /// As it is written into a CSV file: numbers to nine significant digits.
    fn csv(&self) -> String {
        match self {
            Self::Text(text) if text.contains([',', '"', '\n']) => format!("\"{}\"", text.replace('"', "\"\"")),
            Self::Text(text) => text.clone(),
            Self::Number(number, _) if number.is_finite() => significant(*number).to_string(),
            Self::Number(..) | Self::Empty => String::new(),
            Self::Count(count) => count.to_string(),
        }
    }

    fn json(&self) -> Value {
        match self {
            Self::Text(text) => json!(text),
            Self::Number(number, _) if number.is_finite() => json!(significant(*number)),
            Self::Number(..) | Self::Empty => Value::Null,
            Self::Count(count) => json!(count),
        }
    }
}

/// The number, rounded to nine significant digits.
fn significant(number: f64) -> f64 {
    format!("{number:.8e}").parse().unwrap_or(number)
}

impl Table {
    /// A table without rows.
    #[must_use]
    pub fn new(name: &'static str, caption: impl Into<String>, columns: &[&str]) -> Self {
        let columns = columns.iter().map(|&column| column.to_owned()).collect();
        Self { name, caption: caption.into(), columns, rows: Vec::new(), timed: false }
    }

    /// The table as CSV (RFC 4180, but lines end with a line feed).
    #[must_use]
    pub fn csv(&self) -> String {
        let head: Vec<String> = self.columns.iter().map(|column| Cell::Text(column.clone()).csv()).collect();
        let rows = self.rows.iter().map(|row| row.iter().map(Cell::csv).collect::<Vec<_>>().join(","));
        std::iter::once(head.join(",")).chain(rows).map(|line| line + "\n").collect()
    }

    fn json(&self) -> Value {
        let rows: Vec<Value> = self
            .rows
            .iter()
            .map(|row| self.columns.iter().zip(row).map(|(column, cell)| (column.clone(), cell.json())).collect())
            .collect();
        json!({ "name": self.name, "caption": self.caption, "timed": self.timed, "rows": rows })
    }
}

impl SectionReport {
    /// A section without content.
    #[must_use]
    pub fn new(number: u8, title: &str) -> Self {
        Self { number, title: title.to_owned(), ..Self::default() }
    }
}

impl Document {
    /// All of it but the pictures, as one JSON object.
    #[must_use]
    pub fn json(&self) -> Value {
        let sections: Vec<Value> = self
            .sections
            .iter()
            .map(|section| {
                json!({
                    "number": section.number,
                    "title": section.title,
                    "missing": section.missing,
                    "agreement": section.agreements,
                    "tables": section.tables.iter().map(Table::json).collect::<Vec<_>>(),
                })
            })
            .collect();
        let facts: serde_json::Map<String, Value> =
            self.facts.iter().map(|(name, value)| (name.clone(), json!(value))).collect();
        json!({ "title": self.title, "facts": facts, "sections": sections })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_csv() {
        let mut table = Table::new("t", "", &["a, b", "c"]);
        table.rows.push(vec!["say \"no\"".into(), Cell::Number(1.0 / 3.0, 2)]);
        table.rows.push(vec![Cell::Count(7), Cell::Number(f64::NAN, 2)]);
        assert_eq!(table.csv(), "\"a, b\",c\n\"say \"\"no\"\"\",0.333333333\n7,\n");
        assert_eq!(table.rows[0][1].shown(), "0.33");
    }

    #[test]
    fn verdicts() {
        assert_eq!(Verdict::of(true, true), Verdict::Holds);
        assert_eq!(Verdict::of(true, false), Verdict::Direction);
        assert_eq!(Verdict::of(false, true), Verdict::Fails);
    }
}
