//! The section `editing` of an evaluation with its tables as text and its pictures as files: the figures of Tejera, Casas and Hilton (2013).
//!
//! ```text
//! editing_pictures OUT CAPTURE CLIP.bvh SKELETON.asf+CLIP.amc ...
//! ```
//!
//! What `builder evaluate CAPTURE --sections editing --clips ...` puts into its page.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a tool for measuring: it prints, and may stop at what is amiss"
)]

use std::path::PathBuf;

use capture_io::import::ImportOptions;
use evaluate::{EvaluateOptions, Section, Subject, evaluate};
use job::Job;

fn main() {
    let mut arguments = std::env::args().skip(1);
    let (out, capture) = (PathBuf::from(arguments.next().unwrap()), arguments.next().unwrap());
    std::fs::create_dir_all(&out).unwrap();
    let options =
        EvaluateOptions { sections: vec![Section::Editing], clips: arguments.collect(), ..EvaluateOptions::default() };
    let subject = Subject::read(&[capture], &ImportOptions::default(), options, &Job::silent()).unwrap();
    let document = evaluate(&subject, &Job::silent()).unwrap();
    for section in &document.sections {
        for text in &section.text {
            println!("{text}\n");
        }
        for agreement in &section.agreements {
            println!("{}: {}: {}\n", agreement.verdict.words(), agreement.papers, agreement.found);
        }
        for table in &section.tables {
            println!("{}\n\n| {} |\n|{}", table.caption, table.columns.join(" | "), "---|".repeat(table.columns.len()));
            for row in &table.rows {
                println!("| {} |", row.iter().map(|cell| cell.shown()).collect::<Vec<_>>().join(" | "));
            }
            println!();
        }
        for (number, picture) in section.pictures.iter().enumerate() {
            let file = out.join(format!("{number:02}.png"));
            std::fs::write(&file, &picture.png).unwrap();
            println!("{}: {}\n", file.display(), picture.caption);
        }
    }
}
