//! The performer as a scan, registered and held against its truth: figures of docs/results, not a test.
//!
//! `cargo run --release -p reprise --example scanned_performer -- [FRAMES]`
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "an example that prints, and may panic")]

use std::fs;
use std::path::Path;

use capture_io::import::{ImportOptions, ScannedFrame, scans};
use glam::Vec3;
use performer::{PerformerOptions, ScannedOptions, write_scanned};
use reprise::Job;
use reprise::scans::{RegisterReport, ScanOptions, register};

/// Where a vertex of a scan lies on the figure: a triangle and barycentric coordinates, and metres off.
type Truth = (u32, Vec3, f32);

fn truth(path: &Path) -> Vec<Truth> {
    let bytes = fs::read(path).unwrap();
    let float = |b: &[u8]| f32::from_le_bytes(b.try_into().unwrap());
    let of = |b: &[u8]| {
        let weights = Vec3::new(float(&b[4..8]), float(&b[8..12]), float(&b[12..16]));
        (u32::from_le_bytes(b[..4].try_into().unwrap()), weights, float(&b[16..]))
    };
    bytes.chunks_exact(20).map(of).collect()
}

fn at(frame: &ScannedFrame, (triangle, weights, _): Truth) -> Vec3 {
    let [a, b, c] = frame.triangles[triangle as usize].map(|v| frame.positions[v as usize]);
    a * weights.x + b * weights.y + c * weights.z
}

fn input(path: &Path) -> [String; 1] {
    [path.to_string_lossy().into_owned()]
}

/// Performs, scans and registers; the mean, 95th percentile and largest distance of each frame's template to where it is in truth,
/// millimetres.
fn figures(options: &PerformerOptions, scanned: &ScannedOptions, colour: f32) -> (RegisterReport, Vec<[f32; 3]>) {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    let summary = write_scanned(options, scanned, &f.join("scan"), &|_| {}).unwrap();
    let mut register_options = ScanOptions::default();
    register_options.texture_size = Some(256);
    register_options.register.track.colour = colour;
    let report = register(&input(&f.join("scan")), &register_options, &f.join("capture"), &Job::silent()).unwrap();
    let read = |name: &str| scans(&input(&f.join(name)), &ImportOptions::default()).unwrap();
    let (scan, figure, capture) = (read("scan"), read("scan/truth"), read("capture"));
    let (take, number) = scan.place_of(report.template).unwrap();
    let name = &summary.sequences[take].0;
    let points = truth(&f.join(format!("scan/truth/scan/{name}/frame_{number:05}.bin")));
    // Cleaning may renumber the template's vertices: they are where they were.
    let root = scan.read(report.template).unwrap();
    let place = |frame: usize| {
        let (take, number) = scan.place_of(frame).unwrap();
        let wanted = format!("{take:03}/frame_{number:05}.ply");
        let files = capture.sequences.iter().flat_map(|sequence| &sequence.files);
        files.into_iter().position(|file| file.ends_with(&wanted)).map(|at| capture.read(at).unwrap())
    };
    let template = place(report.template).unwrap();
    let vertices: Vec<usize> = template
        .positions
        .iter()
        .map(|p| (0..root.positions.len()).min_by_key(|&k| (root.positions[k].distance(*p) * 1e7) as u64).unwrap())
        .collect();
    let others = report.registered.iter().filter(|frame| frame.frame != report.template);
    let of = |frame: usize| -> Option<[f32; 3]> {
        let (pose, figure) = (place(frame)?, figure.read(frame).unwrap());
        let pairs = vertices.iter().zip(&pose.positions).map(|(&v, p)| (points[v], *p));
        let mut off: Vec<f32> =
            pairs.filter(|(t, _)| t.2.abs() < 0.005).map(|(t, p)| 1000.0 * at(&figure, t).distance(p)).collect();
        off.sort_by(f32::total_cmp);
        Some([off.iter().sum::<f32>() / off.len() as f32, off[off.len() * 95 / 100], off[off.len() - 1]])
    };
    let errors = others.filter_map(|frame| of(frame.frame)).collect();
    (report, errors)
}

fn mean(errors: &[[f32; 3]], k: usize) -> f32 {
    errors.iter().map(|e| e[k]).sum::<f32>() / errors.len() as f32
}

fn main() {
    let frames = std::env::args().nth(1).map_or(120, |word| word.parse().unwrap());
    let options =
        PerformerOptions { frames, vertices: 3000, texture_size: 512, fps: 25.0, ..PerformerOptions::default() };
    for (group, colour) in [(1, 1.0), (1, 0.0), (6, 1.0)] {
        let start = std::time::Instant::now();
        let (report, errors) = figures(&options, &ScannedOptions { group, noise: 0.001 }, colour);
        let worst = |k: usize| errors.iter().map(|e| e[k]).fold(0.0, f32::max);
        let followed = report.registered.iter().filter(|frame| frame.followed).count();
        println!(
            "group {group}, colour {colour}: template {}, {} vertices, {} meshes, {followed} followed, lost {:?}, mean {:.1} (worst \
             {:.1}), p95 {:.1} (worst {:.1}) mm, seconds {:?} of {:.0}",
            report.template,
            report.vertices,
            report.meshes,
            report.lost.iter().map(|lost| (lost.frame, &lost.reason)).collect::<Vec<_>>(),
            mean(&errors, 0),
            worst(0),
            mean(&errors, 1),
            worst(1),
            report.seconds,
            start.elapsed().as_secs_f64()
        );
    }
}
