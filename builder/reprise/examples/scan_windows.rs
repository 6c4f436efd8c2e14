//! Candidate windows of a scan, and one template for each, tracked through both of its windows: how many succeed, and what that takes.
//! Figures of docs/results, not a test.
//!
//! `cargo run -p reprise --example scan_windows -- MOST TRIED SCAN...`: candidates up to MOST times as unlike as consecutive frames (3 in the
//! paper), of which TRIED at most are tracked.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "an example that prints, and may panic")]

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use capture_io::import::{ImportOptions, Scans, scans};
use registration::candidates::{CandidateOptions, candidates};
use registration::descriptor::{Descriptor, DescriptorOptions};
use registration::dissimilarity::Dissimilarity;
use registration::register::cleaned;
use registration::scan::Scan;
use registration::surface::Surface;
use registration::template::scale_of;
use reprise::Job;
use reprise::scans::{RegisterReport, ScanOptions, register};

fn surface(scans: &Scans, frame: usize) -> Surface {
    let read = scans.read(frame).unwrap();
    let mut scan = Scan { positions: read.positions, triangles: read.triangles, ..Scan::default() };
    cleaned(&mut scan).unwrap().0.surface
}

/// Puts the windows about `s` and `t` into a folder, a sequence each.
fn windows(files: &[PathBuf], pair: [usize; 2], reach: usize, folder: &Path) -> Vec<String> {
    let mut inputs = Vec::new();
    for (name, centre) in ["source", "target"].into_iter().zip(pair) {
        let window = folder.join(name);
        fs::create_dir_all(&window).unwrap();
        for (k, file) in files[centre - reach..=centre + reach].iter().enumerate() {
            let ending = file.extension().unwrap().to_string_lossy();
            fs::copy(file, window.join(format!("frame_{k:05}.{ending}"))).unwrap();
        }
        inputs.push(window.to_string_lossy().into_owned());
    }
    inputs
}

/// One template through both windows; from frame `template` of them.
fn track(inputs: &[String], template: usize, folder: &Path) -> Option<RegisterReport> {
    let mut options = ScanOptions::default();
    options.register.template = Some(template);
    options.texture_size = Some(256);
    register(inputs, &options, &folder.join(format!("capture {template}")), &Job::silent()).ok()
}

/// Seconds that all threads of this process have worked so far; 0 where the system does not tell.
fn worked() -> f64 {
    let text = fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields: Vec<&str> = text.rsplit(')').next().unwrap_or_default().split_whitespace().collect();
    let ticks = |k: usize| fields.get(k).and_then(|field| field.parse::<f64>().ok()).unwrap_or(0.0);
    (ticks(11) + ticks(12)) / 100.0
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (most, tried) = (arguments[0].parse().unwrap(), arguments[1].parse::<usize>().unwrap());
    let scans = scans(&arguments[2..], &ImportOptions::default()).unwrap();
    let files: Vec<PathBuf> = scans.sequences.iter().flat_map(|sequence| sequence.files.clone()).collect();
    let sequence: Vec<usize> = (0..files.len()).map(|frame| scans.place_of(frame).unwrap().0).collect();
    let start = Instant::now();
    let surfaces: Vec<Surface> = (0..files.len()).map(|frame| surface(&scans, frame)).collect();
    let mut scales: Vec<f32> = surfaces.iter().map(scale_of).collect();
    scales.sort_by(f32::total_cmp);
    let scale = scales[scales.len() / 2];
    let options = DescriptorOptions::default();
    let descriptors: Vec<Descriptor> = surfaces.iter().map(|s| Descriptor::new(s, scale, &options)).collect();
    let wanted = CandidateOptions { most, ..CandidateOptions::default() };
    let windowed = Dissimilarity::windowed(&descriptors, &sequence, wanted.reach);
    println!("{} frames: described and compared in {:.1} s", files.len(), start.elapsed().as_secs_f64());
    let folder = tempfile::tempdir().unwrap();
    let mut count = 0;
    let found = candidates(&windowed, &sequence, &wanted, |s, t| {
        count += 1;
        if count > tried {
            return true;
        }
        let here = folder.path().join(count.to_string());
        let inputs = windows(&files, [s, t], wanted.reach, &here);
        let (start, before) = (Instant::now(), worked());
        // The better of both ends is the template: that which loses fewer, the source's where both are as good.
        let lost = |report: &Option<RegisterReport>| report.as_ref().map_or(usize::MAX, |report| report.lost.len());
        let mut report = track(&inputs, wanted.reach, &here);
        if lost(&report) > 0 {
            let other = track(&inputs, 3 * wanted.reach + 1, &here);
            if lost(&other) < lost(&report) {
                report = other;
            }
        }
        let (seconds, work) = (start.elapsed().as_secs_f64(), worked() - before);
        fs::remove_dir_all(&here).unwrap();
        let good = lost(&report) == 0;
        let doubtful = report.as_ref().map_or(0, |report| report.warnings.len());
        println!(
            "{s} and {t}, {:.4}: {} frames lost, {doubtful} warnings, {seconds:.1} s, {work:.1} s of the processor",
            windowed.get(s, t),
            lost(&report)
        );
        good
    });
    let good = found.iter().take(tried).filter(|(_, good)| *good).count();
    println!("{} candidates, {} tracked, {good} of them in full", found.len(), found.len().min(tried));
}
