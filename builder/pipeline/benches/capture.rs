//! All three stages once on a capture of the size of the papers' largest, with the peak memory.
//!
//! `cargo bench -p reprise-pipeline --bench capture`. `RAYON_NUM_THREADS=1` for one thread; `REPRISE_FRAMES` for
//! another number of frames than 2,633. Too long for repeats, so this does not use criterion.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "prints its figures; nothing to recover")]

mod synthetic;

use std::time::Instant;

use job::Job;
use pipeline::distance::{DistanceOptions, pose_distances};
use pipeline::essential::{essential_edges, strongly_connected};
use pipeline::transitions::{LengthChoice, TransitionOptions, WarpFinder, optimal_transitions};

fn main() {
    let frames = std::env::var("REPRISE_FRAMES").ok().and_then(|text| text.parse().ok()).unwrap_or(2_633);
    let (topology, poses) = synthetic::capture(frames, 5_000);
    let timeline = synthetic::timeline(frames);
    let triangles = topology.triangles().len();
    println!("{frames} frames, {} vertices, {triangles} triangles", topology.vertex_count());
    println!("{} threads, poses in memory: {}", rayon::current_num_threads(), peak_memory());

    let stage = StageTime::start("pose distances");
    let distances = pose_distances(&topology, &poses, &DistanceOptions::default(), &Job::silent()).unwrap();
    let seconds = stage.end();
    let pairs = (frames * (frames - 1) / 2 * triangles) as f64;
    println!("  {:.2} ns a pair of triangles", 1e9 * seconds / pairs);
    let mean = (0..frames).map(|i| distances.row(i).iter().map(|&d| f64::from(d)).sum::<f64>()).sum::<f64>();
    println!("  mean distance {:.3} rad", mean / (frames * frames) as f64);

    for choice in [LengthChoice::Mean, LengthChoice::Total] {
        let options = TransitionOptions { choice, ..Default::default() };
        let stage = StageTime::start(&format!("transitions, {choice:?}"));
        let transitions = optimal_transitions(&distances, &timeline, &options, &Job::silent()).unwrap();
        stage.end();
        let stage = StageTime::start("essential graph");
        let essential = essential_edges(&transitions, &timeline, 0.01).unwrap();
        stage.end();
        let stage = StageTime::start(&format!("{} warps", essential.edges.len()));
        let finder = WarpFinder::new(&distances, &timeline, &options).unwrap();
        for &(from, to) in &essential.edges {
            let cost = transitions.get(from as usize, to as usize).unwrap();
            let (li, lj) = (usize::from(cost.source_length), usize::from(cost.destination_length));
            finder.find(from, to, li, lj).unwrap();
        }
        stage.end();
        let components = strongly_connected(&timeline, &essential.edges);
        println!("  largest component: {} frames", components.largest_frames().count());
    }
}

/// A stage under way: its name, when it began, and the processor time until then.
struct StageTime(String, Instant, f64);

impl StageTime {
    fn start(name: &str) -> Self {
        Self(name.to_owned(), Instant::now(), processor_seconds())
    }

    /// Prints what it took and returns the seconds that passed.
    fn end(self) -> f64 {
        let (seconds, processor) = (self.1.elapsed().as_secs_f64(), processor_seconds() - self.2);
        println!("{}: {seconds:.2} s ({processor:.2} s of all cores), {}", self.0, peak_memory());
        seconds
    }
}

/// Seconds that all threads of this process have run, where the system tells it (Linux, in hundredths).
fn processor_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields: Vec<f64> = text.rsplit(')').next().unwrap_or("").split(' ').map(|f| f.parse().unwrap_or(0.0)).collect();
    fields.get(12..14).map_or(f64::NAN, |ticks| (ticks[0] + ticks[1]) / 100.0)
}

/// The process's peak memory, where the system tells it.
fn peak_memory() -> String {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap_or("not known");
    format!("peak memory {}", peak.trim())
}
