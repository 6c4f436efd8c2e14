//! Candidate windows of a scan, and one template for each, tracked through both of its windows: how many succeed, and what that takes.
//! Figures of docs/results, not a test.
//!
//! `cargo run -p reprise --example scan_windows -- MOST TRIED SCAN...`: candidates up to MOST times as unlike as consecutive frames (3 in the
//! paper), of which TRIED at most are tracked.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "an example that prints, and may panic")]

use registration::candidates::CandidateOptions;
use reprise::Job;
use reprise::scan_windows::scan_windows;
use reprise::scans::ScanOptions;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (most, tried) = (arguments[0].parse().unwrap(), arguments[1].parse().unwrap());
    let wanted = (&CandidateOptions::default(), &[3.0, most][..], tried);
    let found = scan_windows(&arguments[2..], &ScanOptions::default(), wanted, &Job::silent()).unwrap();
    println!("threshold, candidates: {:?}", found.thresholds);
    for trial in &found.trials {
        println!("{trial:?}");
    }
    let good = found.trials.iter().filter(|trial| trial.is_whole()).count();
    println!("{} tracked, {good} of them in full", found.trials.len());
}
