//! All three stages once on a capture of the size of the papers' largest, with the peak memory.
//!
//! `cargo bench -p reprise-builder --bench capture`. `RAYON_NUM_THREADS=1` for one thread; `REPRISE_FRAMES` for another
//! number of frames than 2,633. Too long for repeats, so this does not use criterion.
#![allow(clippy::print_stdout, reason = "prints its figures")]

mod synthetic;

use std::time::Instant;

use builder::distance::{DistanceOptions, pose_distances};
use builder::essential::{essential_edges, strongly_connected};
use builder::transitions::{LengthChoice, TransitionOptions, WarpFinder, optimal_transitions};

fn main() {
    let frames = std::env::var("REPRISE_FRAMES").ok().and_then(|text| text.parse().ok()).unwrap_or(2_633);
    let (topology, poses) = synthetic::capture(frames, 5_000);
    let timeline = synthetic::timeline(frames);
    let triangles = topology.triangles().len();
    println!("{frames} frames, {} vertices, {triangles} triangles", topology.vertex_count());
    println!("{} threads, poses in memory: {}", rayon::current_num_threads(), peak_memory());

    let start = Instant::now();
    let distances = pose_distances(&topology, &poses, &DistanceOptions::default(), &|_| ()).unwrap();
    let seconds = start.elapsed().as_secs_f64();
    let pairs = (frames * (frames - 1) / 2 * triangles) as f64;
    println!("pose distances: {seconds:.2} s, {:.2} ns a pair of triangles; {}", 1e9 * seconds / pairs, peak_memory());
    let mean = (0..frames).map(|i| distances.row(i).iter().map(|&d| f64::from(d)).sum::<f64>()).sum::<f64>();
    println!("  mean distance {:.3} rad", mean / (frames * frames) as f64);

    for choice in [LengthChoice::Mean, LengthChoice::Total] {
        let options = TransitionOptions { choice, ..Default::default() };
        let start = Instant::now();
        let transitions = optimal_transitions(&distances, &timeline, &options, &|_| ()).unwrap();
        println!("transitions, {choice:?}: {:.2} s; {}", start.elapsed().as_secs_f64(), peak_memory());
        let start = Instant::now();
        let essential = essential_edges(&transitions, &timeline, 0.01).unwrap();
        println!("essential graph: {:.2} s; {}", start.elapsed().as_secs_f64(), peak_memory());
        let start = Instant::now();
        let finder = WarpFinder::new(&distances, &timeline, &options).unwrap();
        for &(from, to) in &essential.edges {
            let cost = transitions.get(from as usize, to as usize).unwrap();
            let (li, lj) = (usize::from(cost.source_length), usize::from(cost.destination_length));
            finder.find(from, to, li, lj).unwrap();
        }
        println!("{} warps: {:.2} s", essential.edges.len(), start.elapsed().as_secs_f64());
        let components = strongly_connected(&timeline, &essential.edges);
        println!("  largest component: {} frames", components.largest_frames().count());
    }
}

/// The process's peak memory, where the system tells it.
fn peak_memory() -> String {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap_or("not known");
    format!("peak memory {}", peak.trim())
}
