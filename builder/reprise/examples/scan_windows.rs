//! Candidate windows of a scan, and one template for each, tracked through both of its windows: how many succeed, and what that takes.
//! Figures of docs/results, not a test.
//!
//! `cargo run -p reprise --example scan_windows -- MOST APART SPREAD TRIED SCAN...`: candidates up to MOST times as unlike as consecutive frames (3
//! in the paper), APART frames from each other in one sequence (60), SPREAD from other candidates (20), of which TRIED at most are
//! tracked.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "an example that prints, and may panic")]

use registration::candidates::CandidateOptions;
use reprise::Job;
use reprise::scan_windows::scan_windows;
use reprise::scans::ScanOptions;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |k: usize| arguments[k].parse::<usize>().unwrap();
    let options = CandidateOptions { apart: number(1), spread: number(2), ..CandidateOptions::default() };
    let wanted = (&options, &[3.0, arguments[0].parse().unwrap()][..], number(3));
    let found = scan_windows(&arguments[4..], &ScanOptions::default(), wanted, &Job::silent()).unwrap();
    println!("threshold, candidates: {:?}", found.thresholds);
    for trial in &found.trials {
        println!("{trial:?}");
    }
    let good = found.trials.iter().filter(|trial| trial.is_whole()).count();
    println!("{} tracked, {good} of them in full", found.trials.len());
}
